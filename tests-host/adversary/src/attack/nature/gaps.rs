//! No attack: receivers of 1 to 20 Hz that fall silent for 1 to 120 s again and again, with and without
//! range rates.
//!
//! Each comparison with the past meets a gap of its own length. None may find a contradiction.

use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "gaps",
    about: "no fault: receivers of 1, 5, 10 and 20 Hz, silent for 1 to 120 s every minute, two oscillators, with and without range rates",
    branch: Branch::Sigmas,
    before: "",
    note: "",
    run,
};

/// Rates of epochs, Hz, with the epochs of a run in the quick form and at length.
const RATES_HZ: [(f64, u32, u32); 4] =
    [(1.0, 1500, 7200), (5.0, 3000, 18_000), (10.0, 3000, 18_000), (20.0, 4000, 24_000)];

/// Runs of each kind at length.
const RUNS: [u64; 4] = [6, 3, 3, 3];

/// Silences, s, and time between two of them, s.
const GAPS_S: [f64; 8] = [1.0, 2.0, 5.0, 9.0, 15.0, 30.0, 60.0, 120.0];
const BETWEEN_S: std::ops::Range<f64> = 20.0..90.0;

/// Reasons that are false alarms.
const FALSE: [&str; 4] = ["CLOCK", "TRACK", "JUMP", "SPOOFED"];

/// Smallest share of promised epochs. The first epochs after a long silence may wait.
const PROMISED: f64 = 0.999;

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for has_range_rates in [true, false] {
        let word = if has_range_rates { "with rates" } else { "without rates" };
        for ((hertz, quick, long), runs) in RATES_HZ.into_iter().zip(RUNS) {
            let kinds: Vec<(u64, Oscillator)> = (0..effort.pick(1, runs))
                .flat_map(|seed| {
                    [(seed, Oscillator::temperature_compensated()), (seed, Oscillator::oven_controlled())]
                })
                .collect();
            let epochs = effort.pick(quick, long);
            let tally: Tally = kinds
                .iter()
                .together(|&(seed, oscillator)| listen(seed, oscillator, hertz, epochs, has_range_rates))
                .collect::<Result<_>>()?;
            let hours = f64::from(epochs) / hertz / 3600.0 * kinds.len() as f64;
            let count: usize = FALSE.iter().map(|reason| tally.of_reason(reason)).sum();
            let name = format!("{hours:.1} h at {hertz} Hz {word}");
            figures.push(Figure::at_most(format!("{name}: false alarms"), count as f64, 0.0));
            let promised = tally.share();
            figures.push(Figure::at_least("promised, share", promised, PROMISED));
        }
    }
    Ok(figures)
}

fn listen(
    seed: u64,
    oscillator: Oscillator,
    hertz: f64,
    epochs: u32,
    has_range_rates: bool,
) -> Result<Tally> {
    let step_s = 1.0 / hertz;
    let start_s = 3700.0 + 7200.0 * (seed % 12) as f64;
    let simulation =
        Simulation { oscillator, step_s, has_range_rates, ..Simulation::above_xian(start_s, epochs, seed) };
    let sky = Sky::of(&simulation, Frequency::Dual)?;
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let (mut victim, mut tally) = (Victim::new(&[], step_s)?, Tally::default());
    let (mut silent_from, mut silent_until) = (60.0, 60.0);
    for (index, bytes) in (0_u32..).zip(sky.unchanged()?) {
        let time_s = f64::from(index) * step_s;
        if time_s >= silent_until {
            silent_from = silent_until.max(time_s) + chance.random_range(BETWEEN_S);
            silent_until = silent_from + GAPS_S.choose(&mut chance).copied().unwrap_or(1.0);
        }
        let bytes = if time_s < silent_from { bytes } else { Vec::new() };
        tally.add_all(&victim.receive(&bytes, sky.truth)?);
    }
    Ok(tally)
}
