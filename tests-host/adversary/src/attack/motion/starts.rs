//! A receiver that starts anew, with another clock, and whose range rates sometimes contradict each
//! other.
//!
//! A supply that drops out for a moment gives a receiver a clock that no drift explains, as a
//! repeater does. This happens once, so that the alert has to end. Rates that are refused now and
//! then, as beside reflections, must not renew it.

use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "starts",
    about: "a receiver that starts anew after 0, 15 or 120 s, with a clock 37 km off and rates refused in one epoch of 40, which is no fault",
    branch: Branch::All,
    before: "none of 300 s promised",
    note: "`CLOCK` in its first epoch",
    run,
};

/// Silences of the receiver, s.
const SILENCES_S: [u32; 3] = [0, 15, 120];

/// Epochs before the silence and after it, one a second.
const BEFORE: u32 = 300;
const AFTER: u32 = 300;

/// Clock of the start, m: 123 µs.
const CLOCK_M: f64 = 36_900.0;

/// Number of epochs of which one has rates that are refused.
const REFUSED: usize = 40;

/// Difference of two refused rates, Hz: 4 m/s.
const APART_HZ: f64 = 20.0;

/// Longest time without a promise after the start, s.
const LONGEST_S: f64 = 30.0;

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for silence_s in SILENCES_S {
        let runs = (0..effort.pick(4, 40)).together(|seed| start(seed, silence_s));
        let runs = runs.collect::<Result<Vec<_>>>()?;
        let all: Tally = runs.iter().map(|(tally, _)| tally).collect();
        let longest_s = runs.iter().map(|(_, lost_s)| *lost_s).fold(0.0, f64::max);
        let quantity = format!("s without a promise after {silence_s} s");
        figures.push(Figure::at_most(quantity, longest_s, LONGEST_S));
        figures.push(Figure::plain("CLOCK", all.of_reason("CLOCK") as f64));
        figures.push(Figure::at_most("beyond", all.misleading(), 0.0));
    }
    Ok(figures)
}

/// Returns the epochs after a start, and the time of them without a promise, s.
fn start(seed: u64, silence_s: u32) -> Result<(Tally, f64)> {
    let start_s = 3700.0 + 7200.0 * (seed % 12) as f64;
    let simulation = Simulation {
        has_range_rates: true,
        ..Simulation::above_xian(start_s, BEFORE + silence_s + AFTER, seed)
    };
    let sky = Sky::of(&simulation, Frequency::Dual)?;
    let awake = (BEFORE + silence_s) as usize;
    let bytes = sky.bytes(|index, epoch| {
        if index >= awake {
            lengthen_all(epoch, CLOCK_M);
        }
        if index % REFUSED == 0 {
            for (number, raw) in epoch.satellites.iter_mut().enumerate() {
                let sign = if number % 2 == 0 { 0.5 } else { -0.5 };
                for doppler_hz in raw.signals.iter_mut().filter_map(|signal| signal.doppler_hz.as_mut()) {
                    *doppler_hz += sign * APART_HZ;
                }
            }
        }
    })?;
    let (mut victim, mut tally, mut lost_s) = (Victim::new(&[], 1.0)?, Tally::default(), 0.0);
    victim.judge(bytes.iter().take(BEFORE as usize), sky.truth)?;
    let _ = victim.silence(f64::from(silence_s), sky.truth)?;
    for bytes in &bytes[awake..] {
        tally.add_all(&victim.receive(bytes, sky.truth)?);
        lost_s += if victim.is_promised() { 0.0 } else { 1.0 };
    }
    Ok((tally, lost_s))
}
