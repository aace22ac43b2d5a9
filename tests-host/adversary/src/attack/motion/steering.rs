//! A receiver that begins to steer its clock, after minutes in which it did not.
//!
//! Until then its clock drifts as its oscillator does, and the range rates say so. From then on it is set
//! back in every epoch, and the rates still show the oscillator. In the first seconds this looks like a
//! drag-off, so that an alert is due. Nothing is wrong, so that it must end.

use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "steering",
    about: "a clock that drifts by 0.1 m/s to 1 km/s, and is set back every second from the fifth minute on, which is no fault",
    branch: Branch::All,
    before: "not tried",
    note: "`CLOCK` meanwhile, as for a drag-off",
    run,
};

/// Drifts of the oscillator, m/s.
const DRIFTS_M_S: [f64; 6] = [0.1, 1.0, 10.0, 100.0, 265.7, 1000.0];

/// Epochs without steering, and with it, one a second.
const BEFORE: u32 = 300;
const DURING: u32 = 900;

/// Longest time without a promise in all, s.
const LONGEST_S: f64 = 200.0;

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for drift_m_s in DRIFTS_M_S {
        let runs = (0..effort.pick(1, 12)).together(|seed| steered(seed, drift_m_s));
        let runs = runs.collect::<Result<Vec<_>>>()?;
        let all: Tally = runs.iter().map(|(tally, _)| tally).collect();
        let longest_s = runs.iter().map(|(_, lost_s)| *lost_s).fold(0.0, f64::max);
        let quantity = format!("s without a promise at {drift_m_s} m/s");
        figures.push(Figure::at_most(quantity, longest_s, LONGEST_S));
        figures.push(Figure::at_most("beyond", all.misleading(), 0.0));
    }
    Ok(figures)
}

/// Returns all epochs, and the time without a promise once the receiver steers, s.
fn steered(seed: u64, drift_m_s: f64) -> Result<(Tally, f64)> {
    let start_s = 3700.0 + 7200.0 * seed as f64;
    let frequency_offset = drift_m_s / SPEED_OF_LIGHT_M_S;
    let oscillator = Oscillator { frequency_offset, ..Oscillator::oven_controlled() };
    let simulation = Simulation {
        oscillator,
        has_range_rates: true,
        ..Simulation::above_xian(start_s, BEFORE + DURING, seed)
    };
    let sky = Sky::of(&simulation, Frequency::Dual)?;
    let (mut clock, mut held_s) = (simulation.clock(), 0.0);
    let bytes = sky.bytes(|index, epoch| {
        let clock_s = clock.advance();
        if index <= BEFORE as usize {
            held_s = clock_s;
        }
        lengthen_all(epoch, SPEED_OF_LIGHT_M_S * (held_s - clock_s));
    })?;
    let (mut victim, mut tally, mut lost_s) = (Victim::new(&[], 1.0)?, Tally::default(), 0.0);
    for (index, bytes) in (0_u32..).zip(&bytes) {
        let seen = victim.receive(bytes, sky.truth)?;
        if index >= BEFORE && !victim.is_promised() {
            lost_s += 1.0;
        }
        tally.add_all(&seen);
    }
    Ok((tally, lost_s))
}
