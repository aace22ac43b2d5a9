//! A receiver that begins to steer its clock, after minutes in which it did not.
//!
//! Until then its clock drifts as its oscillator does, and the range rates say so. From then on it is set
//! back in every epoch, and the rates still show the oscillator. In the first seconds this looks like a
//! drag-off, so that an alert is due. Nothing is wrong, so that it must end.

use anyhow::Result;
use raim::in_order::Together as _;
use raim::signal::encode::Frequency;
use raim::signal::fault::Measured as _;
use raim::signal::sky::Oscillator;
use raim::signal::sky::raw::Simulation;
use raim_core::frame::SPEED_OF_LIGHT_M_S;

use crate::attack::forgery::Sky;
use crate::attack::tally::Tally;
use crate::attack::victim::Victim;
use crate::attack::{Attack, Branch, Effort, Figure};

/// Steering that begins in the middle.
pub(super) const ATTACK: Attack = Attack {
    name: "steering",
    about: "a clock that drifts by 0.1 m/s to 1 km/s, and is set back every second from the fifth minute on, which is no fault",
    branch: Branch::All,
    before: "not tried",
    note: "`CLOCK` until then. At length it was promised again after at most 173 s, but two of twelve skies stayed `CLOCK` at 1 m/s, because their clock is as noisy as it drifts in a minute",
    run,
};

/// Drifts of the oscillator, m/s.
const DRIFTS_M_S: [f64; 6] = [0.1, 1.0, 10.0, 100.0, 265.7, 1000.0];

/// Epochs without steering, and with it, one a second.
const BEFORE: u32 = 300;
const DURING: u32 = 900;

/// Time after which the promise counts as lost, s. Where few satellites make the clock noisy, a slow drift
/// never stands out against it.
const LASTING_S: f64 = 300.0;

/// At most one of so many skies may lose it.
const ONE_OF: usize = 6;

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for drift_m_s in DRIFTS_M_S {
        let runs = (0..effort.pick(1, 12)).together(|seed| steered(seed, drift_m_s));
        let runs = runs.collect::<Result<Vec<_>>>()?;
        let all = runs.iter().fold(Tally::default(), |sum, (tally, _)| sum.with(tally));
        let waits = runs.iter().map(|(_, until_s)| *until_s);
        let lasting = waits.clone().filter(|until_s| *until_s > LASTING_S).count();
        let until_s = waits.filter(|until_s| *until_s <= LASTING_S).fold(0.0, f64::max);
        figures.push(Figure::plain(format!("s until promised for good at {drift_m_s} m/s"), until_s));
        let most = (runs.len() / ONE_OF) as f64;
        figures.push(Figure::at_most("skies without a promise for longer", lasting as f64, most));
        figures.push(Figure::at_most("beyond", all.outcomes.misleading as f64, 0.0));
    }
    Ok(figures)
}

/// Returns all epochs, and the time from the beginning of the steering to the last epoch that is not
/// promised, s.
fn steered(seed: u64, drift_m_s: f64) -> Result<(Tally, f64)> {
    let start_s = 3700.0 + 7200.0 * seed as f64;
    // What a receiver sets back it holds to metres. An oven leaves less than that when its drift is taken away.
    let frequency_offset = drift_m_s / SPEED_OF_LIGHT_M_S;
    let oscillator = Oscillator { frequency_offset, ..Oscillator::oven_controlled() };
    let simulation = Simulation {
        oscillator,
        has_range_rates: true,
        ..Simulation::above_xian(start_s, BEFORE + DURING, seed)
    };
    let sky = Sky::of(&simulation, Frequency::Dual)?;
    let bytes = sky.bytes(|index, epoch| {
        let steered_s = index as f64 - f64::from(BEFORE);
        for satellite in epoch.satellites() {
            epoch.lengthen(satellite, -drift_m_s * steered_s.max(0.0));
        }
    })?;
    let (mut victim, mut tally, mut until_s) = (Victim::new(&[], 1.0)?, Tally::default(), 0.0);
    for (index, bytes) in (0_u32..).zip(&bytes) {
        let seen = victim.hear(bytes, sky.truth)?;
        if index >= BEFORE && !victim.is_promised() {
            until_s = f64::from(index - BEFORE + 1);
        }
        tally.add_all(&seen);
    }
    Ok((tally, until_s))
}
