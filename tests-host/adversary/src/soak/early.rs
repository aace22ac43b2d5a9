//! Ephemerides that arrive hours before their time, as in merged broadcast files.
//!
//! Such a set is accurate around its reference time, and tens of metres wrong hours before. GPS
//! allows its use up to two hours before; a module that prefers the later reference time is then
//! wrong at once. Earlier it cannot be used yet; a module that keeps only this set loses the
//! satellite. For a recording they are its own later sets; those of a simulated sky drift away from
//! its true clocks.

use raim::signal::measurement::{MeasuredEpoch, TimedEphemeris};
use raim::signal::sky::broadcast::{drifting, ephemeris};
use raim::signal::sky::raw::Simulation;
use raim_core::satellite::Constellation;

/// Lead of the reference times in such files, ms: up to 3.9 hours. Less than one hour does no harm.
const AHEAD_MS: std::ops::RangeInclusive<i64> = 3_600_000..=14_040_000;

/// Reference times are multiples of this, s.
const GRID_S: f64 = 16.0;

/// Reference times after the start of a sky, s: within two hours of it, and far beyond.
const BEHIND_START_S: [f64; 2] = [7000.0, 14_000.0];

/// Error of a simulated set, m, and the time before its reference time at which it has that error,
/// s.
const WRONG_M: f64 = 60.0;
const BEFORE_S: f64 = 7200.0;

/// Returns later sets of the GPS satellites of a simulated sky.
pub(super) fn of_sky(simulation: &Simulation) -> Vec<TimedEphemeris> {
    let reference_s = |behind_s: f64| ((simulation.start_s + behind_s) / GRID_S).floor() * GRID_S;
    let gps = simulation.satellites.iter().filter(|known| known.id.constellation() == Constellation::Gps);
    let each = gps.flat_map(|satellite| BEHIND_START_S.map(|behind_s| (satellite, reference_s(behind_s))));
    let sets = each.filter_map(|(satellite, at_s)| ephemeris(satellite, simulation.origin, at_s, 77));
    sets.map(|set| drifting(set, WRONG_M, BEFORE_S)).collect()
}

/// Returns the sets that are early for a satellite of the epoch, as if they were sent then.
pub(super) fn at(epoch: &MeasuredEpoch, sets: &[TimedEphemeris]) -> Vec<TimedEphemeris> {
    let is_seen = |set: &&TimedEphemeris| epoch.satellites.iter().any(|seen| seen.satellite == set.satellite);
    let is_early = |set: &&TimedEphemeris| AHEAD_MS.contains(&set.toe.since_ms(epoch.time));
    let early = sets.iter().filter(is_early).filter(is_seen);
    early.map(|set| TimedEphemeris { sent: epoch.time, ..set.clone() }).collect()
}
