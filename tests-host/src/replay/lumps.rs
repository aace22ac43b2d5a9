//! From a recording to the bytes of each epoch: which epochs, with which faults.

use anyhow::{Context as _, Result, ensure};
use rai_core::frame::{Ecef, Enu, LocalFrame};
use rai_core::satellite::SatelliteId;

use super::corrected;
use super::lump::Lump;
use crate::encode::{Encoder, Selection};
use crate::fault::{Directions, Fault, Injector};
use crate::measurement::MeasuredEpoch;
use crate::recording::Recording;

/// Which part of a recording is used; seconds after its first epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// First second used.
    pub from_s: f64,
    /// First second that is not used any more.
    pub to_s: f64,
    /// Least time between two epochs, s.
    pub every_s: f64,
}

impl Window {
    /// Everything.
    pub const ALL: Self = Self { from_s: 0.0, to_s: f64::INFINITY, every_s: 0.0 };
}

/// Encodes a recording. Faults are timed from the recording's first epoch, whatever the window is.
///
/// # Errors
/// A fault of a satellite that is not in the recording, a number that has no room in its message, or an empty window.
pub fn encode(
    recording: &Recording,
    selection: &Selection,
    faults: &[Fault],
    window: &Window,
) -> Result<Vec<Lump>> {
    let satellites = satellites(recording);
    for fault in faults {
        fault.check_against(&satellites)?;
    }
    let is_directed = faults.iter().any(Fault::needs_directions);
    let directions = if is_directed { directions(recording, selection)? } else { Directions::default() };
    let source = Injector::new(recording.epochs.iter().cloned(), faults.to_vec()).towards(directions);
    lumps(recording, selection, window, source)
}

/// The epochs of a source within the window.
fn lumps(
    recording: &Recording,
    selection: &Selection,
    window: &Window,
    source: impl Iterator<Item = MeasuredEpoch>,
) -> Result<Vec<Lump>> {
    let Some(first) = recording.epochs.first().map(|epoch| epoch.time) else { return Ok(Vec::new()) };
    let mut encoder = Encoder::new(&recording.ephemerides, selection.clone()).as_receiver();
    let mut lumps: Vec<Lump> = Vec::new();
    for epoch in source {
        let elapsed_s = epoch.time.since_ms(first) as f64 * 1e-3;
        // Half a millisecond of grace: time tags are rounded to milliseconds.
        let is_next = lumps.last().is_none_or(|last| elapsed_s - last.elapsed_s >= window.every_s - 5e-4);
        if elapsed_s >= window.from_s && elapsed_s < window.to_s && is_next {
            lumps.push(Lump { time: epoch.time, elapsed_s, bytes: encoder.epoch(&epoch)? });
        }
    }
    ensure!(!lumps.is_empty(), "no epoch between {} s and {} s of the recording", window.from_s, window.to_s);
    Ok(lumps)
}

/// Where the satellites stand, as the module itself locates them, seen from where the recording says that it is.
fn directions(recording: &Recording, selection: &Selection) -> Result<Directions> {
    let antenna =
        recording.approximate_position.context("a shift needs the antenna's approximate position")?;
    let lumps = lumps(recording, selection, &Window::ALL, recording.epochs.iter().cloned())?;
    let frame = LocalFrame::at(antenna);
    let epochs = corrected(&lumps, antenna, 0.0, recording.klobuchar).into_iter().map(|epoch| {
        let towards = |position: Ecef| {
            let difference = position - antenna;
            let distance_m = difference.radius_m();
            let Enu { east, north, up } = frame.rotate(difference);
            Enu { east: east / distance_m, north: north / distance_m, up: up / distance_m }
        };
        let seen = epoch.observations().iter();
        (epoch.time_s(), seen.map(|one| (one.satellite, towards(one.position))).collect())
    });
    Ok(Directions::new(epochs.collect()))
}

/// The recording's own interval: the median time between neighbours, s; 0 where there are none.
pub fn interval_s(lumps: &[Lump]) -> f64 {
    let mut steps: Vec<f64> = lumps.windows(2).map(|pair| pair[1].elapsed_s - pair[0].elapsed_s).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(0.0)
}

/// Every satellite that is measured at least once.
fn satellites(recording: &Recording) -> Vec<SatelliteId> {
    let measured = recording.epochs.iter().flat_map(|epoch| &epoch.satellites);
    let mut satellites: Vec<SatelliteId> = measured.map(|measured| measured.satellite).collect();
    satellites.sort_unstable();
    satellites.dedup();
    satellites
}
