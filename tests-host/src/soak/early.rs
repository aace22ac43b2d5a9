//! Ephemerides for hours later that come now, as in merged broadcast files.
//!
//! Such a set is right around its reference time, and tens of metres wrong hours before. Up to two hours before, GPS may be
//! used with it: whoever prefers the later reference time is wrong at once. Earlier it is of no use yet: whoever keeps it loses
//! the satellite. Of a recording they are its own later ones; those of a simulated sky drift away from its true clocks.

use rai_core::satellite::Constellation;

use crate::measurement::{MeasuredEpoch, TimedEphemeris};
use crate::sky::broadcast::{drifting, ephemeris};
use crate::sky::raw::Simulation;

/// How far ahead reference times are in such files, ms: up to 3.9 hours; less than one does no harm.
const AHEAD_MS: std::ops::RangeInclusive<i64> = 3_600_000..=14_040_000;

/// Reference times are full multiples of this, s.
const GRID_S: f64 = 16.0;

/// How far behind the beginning of a sky reference times are, s: within two hours of it, and far beyond.
const BEHIND_START_S: [f64; 2] = [7000.0, 14_000.0];

/// How wrong a simulated set is two hours before its reference time, m, and this time, s.
const WRONG_M: f64 = 60.0;
const BEFORE_S: f64 = 7200.0;

/// Later sets of the satellites of a simulated sky, GPS alone.
pub(super) fn of_sky(simulation: &Simulation) -> Vec<TimedEphemeris> {
    let reference_s = |behind_s: f64| ((simulation.start_s + behind_s) / GRID_S).floor() * GRID_S;
    let gps = simulation.satellites.iter().filter(|known| known.id.constellation() == Constellation::Gps);
    let each = gps.flat_map(|satellite| BEHIND_START_S.map(|behind_s| (satellite, reference_s(behind_s))));
    let sets = each.filter_map(|(satellite, at_s)| ephemeris(satellite, simulation.origin, at_s, 77));
    sets.map(|set| drifting(set, WRONG_M, BEFORE_S)).collect()
}

/// Those of the satellites in an epoch that are early in it, as if they were sent then.
pub(super) fn at(epoch: &MeasuredEpoch, sets: &[TimedEphemeris]) -> Vec<TimedEphemeris> {
    let is_seen = |set: &&TimedEphemeris| epoch.satellites.iter().any(|seen| seen.satellite == set.satellite);
    let is_early = |set: &&TimedEphemeris| AHEAD_MS.contains(&set.toe.since_ms(epoch.time));
    let early = sets.iter().filter(is_early).filter(is_seen);
    early.map(|set| TimedEphemeris { sent: epoch.time, ..set.clone() }).collect()
}
