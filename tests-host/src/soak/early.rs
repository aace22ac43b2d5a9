//! Ephemerides for hours later that come now, as in merged broadcast files.
//!
//! Such a set is right around its reference time, and tens of metres wrong hours before. Of a recording they are its own later
//! ones; those of a simulated sky drift away from its true clocks.

use rai_core::satellite::Constellation;

use crate::measurement::{MeasuredEpoch, TimedEphemeris};
use crate::sky::broadcast::{drifting, ephemeris};
use crate::sky::raw::Simulation;

/// How far ahead reference times are in such files, ms: two to 3.9 hours.
const AHEAD_MS: std::ops::RangeInclusive<i64> = 7_200_000..=14_040_000;

/// Reference times are full multiples of this, s.
const GRID_S: f64 = 16.0;

/// How far behind the beginning of a sky the reference times are, s: further ahead than two hours until its end.
const BEHIND_START_S: f64 = 13_000.0;

/// How wrong a simulated set is two hours before its reference time, m, and this time, s.
const WRONG_M: f64 = 60.0;
const BEFORE_S: f64 = 7200.0;

/// Later sets of the satellites of a simulated sky, GPS alone.
pub(super) fn of_sky(simulation: &Simulation) -> Vec<TimedEphemeris> {
    let reference_s = ((simulation.start_s + BEHIND_START_S) / GRID_S).floor() * GRID_S;
    let sets = simulation.satellites.iter();
    let sets = sets.filter_map(|satellite| ephemeris(satellite, simulation.origin, reference_s, 77));
    sets.filter(|set| set.satellite.constellation() == Constellation::Gps)
        .map(|set| drifting(set, WRONG_M, BEFORE_S))
        .collect()
}

/// Those of the satellites in an epoch that are early in it, as if they were sent then.
pub(super) fn at(epoch: &MeasuredEpoch, sets: &[TimedEphemeris]) -> Vec<TimedEphemeris> {
    let is_seen = |set: &&TimedEphemeris| epoch.satellites.iter().any(|seen| seen.satellite == set.satellite);
    let is_early = |set: &&TimedEphemeris| AHEAD_MS.contains(&set.toe.since_ms(epoch.time));
    let early = sets.iter().filter(is_early).filter(is_seen);
    early.map(|set| TimedEphemeris { sent: epoch.time, ..set.clone() }).collect()
}
