//! Ephemerides of RINEX navigation files, for a capture without its own.
//!
//! A capture's own ephemerides have priority: a satellite with a recent one in the capture gets
//! none from the files.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use raim_core::satellite::SatelliteId;
use raim_firmware::ephemeris::Ephemeris;
use raim_firmware::time::GpsTime;

use crate::signal::calendar::readable;
use crate::signal::encode::{Encoder, Selection};
use crate::signal::measurement::{MeasuredEpoch, TimedEphemeris};
use crate::signal::recording::Recording;

/// Longest time from its reference time at which an ephemeris is useful, ms: 4 h.
const USEFUL_MS: i64 = 4 * 3_600_000;

/// Longest time from its reference time at which a capture's own ephemeris excludes another, ms: 2
/// h.
const LATELY_MS: u64 = 2 * 3_600_000;

/// Content of navigation files.
#[derive(Clone)]
pub struct Orbits {
    ephemerides: Vec<TimedEphemeris>,
    /// GPS coefficients of the ionosphere, `α0…α3, β0…β3`.
    pub klobuchar: Option<[f64; 8]>,
    selection: Selection,
}

impl Orbits {
    /// Reads the selected systems of the files.
    ///
    /// # Errors
    /// A file cannot be read or has no ephemeris; the message names it.
    pub fn load(files: &[PathBuf], selection: &Selection) -> Result<Self> {
        let recording = Recording::of_navigation(files)?;
        let Recording { ephemerides, klobuchar, .. } = recording;
        Ok(Self { ephemerides, klobuchar, selection: selection.clone() })
    }

    /// Returns the ephemerides, in the order of the files.
    pub fn ephemerides(&self) -> &[TimedEphemeris] {
        &self.ephemerides
    }

    /// Returns the satellites of the ephemerides.
    pub fn satellites(&self) -> BTreeSet<SatelliteId> {
        self.ephemerides.iter().map(|ephemeris| ephemeris.satellite).collect()
    }

    /// Returns one ephemeris, encoded, so that the week is known.
    pub(super) fn week(&self) -> Result<Vec<u8>> {
        let first = self.ephemerides.first().context("no ephemeris")?;
        Encoder::new(std::slice::from_ref(first), self.selection.clone()).epoch(&nothing(first.toe))
    }

    /// Checks that some ephemeris is of the time of the capture.
    pub(super) fn check(&self, first: GpsTime, last: GpsTime) -> Result<()> {
        let toes = || self.ephemerides.iter().map(|ephemeris| ephemeris.toe);
        let is_useful = |toe: GpsTime| toe.since_ms(first) > -USEFUL_MS && toe.since_ms(last) < USEFUL_MS;
        ensure!(
            toes().any(is_useful),
            "no ephemeris is of the time of the capture ({} to {}), all are for {} to {}; take the navigation file of that day",
            readable(first),
            readable(last),
            toes().min().map_or_else(String::new, readable),
            toes().max().map_or_else(String::new, readable),
        );
        Ok(())
    }

    /// Returns the feeder that sends the ephemerides in time.
    pub(super) fn feeder(&self) -> Feeder {
        let mut by_satellite: BTreeMap<SatelliteId, Vec<TimedEphemeris>> = BTreeMap::new();
        for ephemeris in &self.ephemerides {
            by_satellite.entry(ephemeris.satellite).or_default().push(ephemeris.clone());
        }
        let encoders = by_satellite
            .into_iter()
            .map(|(satellite, known)| (satellite, Encoder::new(&known, self.selection.clone())))
            .collect();
        Feeder { encoders, own: BTreeMap::new(), has_begun: false }
    }
}

/// Returns an epoch without measurements.
const fn nothing(time: GpsTime) -> MeasuredEpoch {
    MeasuredEpoch { time, satellites: Vec::new() }
}

/// Feeder of ephemerides in the order of time.
pub(super) struct Feeder {
    encoders: Vec<(SatelliteId, Encoder)>,
    /// Reference times of the capture's last own ephemerides.
    own: BTreeMap<SatelliteId, GpsTime>,
    has_begun: bool,
}

impl Feeder {
    /// Notes an ephemeris of the capture.
    pub(super) fn receive(&mut self, ephemeris: &Ephemeris) {
        self.own.insert(ephemeris.satellite(), ephemeris.toe());
    }

    /// Returns the ephemerides to send before an epoch. The first epoch gets all, because they
    /// state the week.
    pub(super) fn before(&mut self, time: GpsTime) -> Result<Vec<u8>> {
        let Self { encoders, own, has_begun } = self;
        let mut bytes = Vec::new();
        for (satellite, encoder) in encoders {
            let news = encoder.epoch(&nothing(time))?;
            let is_known =
                own.get(satellite).is_some_and(|toe| toe.since_ms(time).unsigned_abs() <= LATELY_MS);
            if !(*has_begun && is_known) {
                bytes.extend(news);
            }
        }
        *has_begun = true;
        Ok(bytes)
    }
}
