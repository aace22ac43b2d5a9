//! Satellites of RINEX navigation files, located by the module's own orbits.
//!
//! At each instant the usable ephemeris nearest in time is taken. A sky's `t = 0` is the first full
//! hour to which any ephemeris refers.

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::{Context as _, Result, ensure};
use raim_core::frame::Ecef;
use raim_core::satellite::SatelliteId;
use raim_firmware::ephemeris::Ephemeris;
use raim_firmware::input::{Event, Input};
use raim_firmware::time::GpsTime;

use crate::signal::capture::Orbits;
use crate::signal::encode::{Encoder, Frequency, Selection};
use crate::signal::measurement::MeasuredEpoch;

/// Milliseconds of an hour.
const HOUR_MS: u64 = 3_600_000;

/// Range assumed before a position is known, m: the signal left about 75 ms earlier.
const RANGE_M: f64 = 2.25e7;

/// Ephemerides of each satellite in the files.
pub struct Broadcast {
    ephemerides: BTreeMap<SatelliteId, Vec<Ephemeris>>,
    origin: GpsTime,
}

impl Broadcast {
    /// Reads the systems with these letters from files.
    ///
    /// # Errors
    /// If a letter is unknown, a file cannot be read, or there is no ephemeris; the error names it.
    pub fn load(files: &[PathBuf], systems: &str) -> Result<Self> {
        let selection = Selection::new(systems, Frequency::Dual).context("skies.systems")?;
        let orbits = Orbits::load(files, &selection)?;
        let mut ephemerides: BTreeMap<SatelliteId, Vec<Ephemeris>> = BTreeMap::new();
        for timed in orbits.ephemerides() {
            let mut encoder = Encoder::new(std::slice::from_ref(timed), selection.clone());
            let bytes = encoder.epoch(&MeasuredEpoch { time: timed.toe, satellites: Vec::new() })?;
            Input::new().feed(&bytes, 0, |event| {
                if let Event::Ephemeris(ephemeris) = event {
                    ephemerides.entry(ephemeris.satellite()).or_default().push(ephemeris);
                }
            });
        }
        let first = ephemerides.values().flatten().map(Ephemeris::toe).min();
        let first = first.context("the navigation files have no ephemeris of these systems")?;
        ensure!(
            ephemerides.len() >= 4,
            "the navigation files have {} satellites; at least 4 are needed",
            ephemerides.len()
        );
        Ok(Self { ephemerides, origin: GpsTime::from_ms(first.to_ms() / HOUR_MS * HOUR_MS) })
    }

    /// Returns the position of each satellite, `t_s` seconds after the start of the sky.
    pub fn positions(&self, t_s: f64) -> Vec<(SatelliteId, Ecef)> {
        let time = GpsTime::from_ms(self.origin.to_ms() + (t_s * 1e3).round() as u64);
        let located = |(&satellite, known): (&SatelliteId, &Vec<Ephemeris>)| {
            let usable = known.iter().filter(|ephemeris| ephemeris.usable_at(time).is_ok());
            let nearest = usable.min_by_key(|ephemeris| ephemeris.toe().since_ms(time).abs())?;
            Some((satellite, nearest.at(time, RANGE_M).ok()?.position))
        };
        self.ephemerides.iter().filter_map(located).collect()
    }
}
