//! Recordings: RINEX 2, 3 and 4 files of a receiver, plain or packed, as epochs of raw measurements.
//!
//! ```text
//! file ──► text (gzip, compact RINEX) ──► header ──► observations ──► RawEpoch ┐
//!                                             └────► navigation ──► Ephemeris  ┴──► Recording ──► encode
//! ```
//!
//! | quantity | field | unit |
//! |---|---|---|
//! | code pseudorange as measured, receiver clock and atmosphere left in | `pseudorange_m` | m |
//! | carrier phase | `carrier_cycles` | cycles |
//! | carrier-to-noise density | `cn0_dbhz` | dBHz |
//! | receiver's time tag | `time` | GPS time, whole ms |
//!
//! Nothing is corrected and nothing is judged: a recording is what the receiver saw.
//!
//! The files are read by this module and not by the `rinex` crate: that one builds more than two hundred packages
//! (an ephemeris service with an HTTP client, tables for terminals) to parse text in fixed columns, which is most of
//! the time that a first build of the project would take.
//!
//! References: [RINEX-2.11], [RINEX-3.05], [RINEX-4.01], [Hatanaka2008].

mod calendar;
mod hatanaka;
mod header;
mod navigation;
mod observations;
mod text;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use rai_core::frame::Ecef;
use rai_core::satellite::SatelliteId;
use rai_firmware::time::GpsTime;

pub use self::calendar::readable;
use self::header::{Header, Kind};
use self::text::Lines;
use crate::encode::TimedEphemeris;

/// How far from its reference time any broadcast ephemeris is of use, ms: 4 h.
const USEFUL_MS: i64 = 4 * 3_600_000;

/// What a receiver saw, and what the satellites broadcast meanwhile.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// In the order of time, no time twice.
    pub epochs: Vec<RawEpoch>,
    /// In the order of the files.
    pub ephemerides: Vec<TimedEphemeris>,
    /// GPS coefficients of the single-frequency ionosphere model, `α0…α3, β0…β3`, in the broadcast's units.
    pub klobuchar: Option<[f64; 8]>,
    /// What the header believes about the antenna; wrong by hundreds of metres in some files.
    pub approximate_position: Option<Ecef>,
}

/// All measurements of one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct RawEpoch {
    /// The receiver's time tag.
    pub time: GpsTime,
    /// In the order of the file.
    pub satellites: Vec<RawSatellite>,
}

/// One satellite's signals, each with a pseudorange.
#[derive(Clone, Debug, PartialEq)]
pub struct RawSatellite {
    /// Which satellite.
    pub satellite: SatelliteId,
    /// In the order of the file.
    pub signals: Vec<RawSignal>,
}

/// One signal's measurements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawSignal {
    /// Frequency band as RINEX 3.05 numbers it; `BeiDou`'s B1I is 2.
    pub band: u8,
    /// Component of the signal, the third letter of the RINEX code.
    pub attribute: char,
    /// Code pseudorange, m.
    pub pseudorange_m: f64,
    /// Carrier phase, cycles.
    pub carrier_cycles: Option<f64>,
    /// Carrier-to-noise density, dBHz.
    pub cn0_dbhz: Option<f64>,
}

impl Recording {
    /// Reads observation and navigation files; several are merged in time.
    ///
    /// # Errors
    /// A file that is missing, empty or not RINEX of the expected kind, a line that cannot be read, or a navigation
    /// file of another day: the message says what, where, and what would help.
    pub fn load(observations: &[PathBuf], navigation: &[PathBuf]) -> Result<Self> {
        let mut recording = Self::default();
        for path in observations {
            recording
                .read(path, Kind::Observations)
                .with_context(|| format!("observation file {}", path.display()))?;
        }
        for path in navigation {
            recording
                .read(path, Kind::Navigation)
                .with_context(|| format!("navigation file {}", path.display()))?;
        }
        recording.epochs.sort_by_key(|epoch| epoch.time);
        recording.epochs.dedup_by_key(|epoch| epoch.time);
        recording.check(navigation)?;
        Ok(recording)
    }

    fn read(&mut self, path: &Path, expected: Kind) -> Result<()> {
        let text = text::open(path)?;
        let mut lines = Lines::of(&text);
        let header = Header::read(&mut lines)?;
        match (header.kind, expected) {
            (Kind::Observations, Kind::Observations) => {
                self.approximate_position = self.approximate_position.or(header.approximate_position);
                self.epochs.append(&mut observations::read(header, &mut lines)?);
            }
            (Kind::Navigation, Kind::Navigation) => {
                let mut navigation = navigation::read(&header, &mut lines)?;
                self.ephemerides.append(&mut navigation.ephemerides);
                self.klobuchar = self.klobuchar.or(navigation.klobuchar);
            }
            (Kind::Observations, Kind::Navigation) => {
                bail!("holds observations: give it as observation file")
            }
            (Kind::Navigation, Kind::Observations) => bail!("holds ephemerides: give it as navigation file"),
        }
        Ok(())
    }

    /// That there is something to compute a position from.
    fn check(&self, navigation: &[PathBuf]) -> Result<()> {
        let (Some(first), Some(last)) = (self.epochs.first(), self.epochs.last()) else {
            bail!("the observation files hold no epoch");
        };
        let names = navigation.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
        ensure!(!self.ephemerides.is_empty(), "{names}: no GPS, Galileo or BeiDou ephemeris");
        let applicable = |ephemeris: &TimedEphemeris| {
            ephemeris.toe.since_ms(first.time) > -USEFUL_MS && ephemeris.toe.since_ms(last.time) < USEFUL_MS
        };
        let toes = || self.ephemerides.iter().map(|ephemeris| ephemeris.toe);
        ensure!(
            self.ephemerides.iter().any(applicable),
            "{names}: no ephemeris is of the time of the observations ({} to {}), all are for {} to {}; \
             take the navigation file of that day",
            readable(first.time),
            readable(last.time),
            toes().min().map_or_else(String::new, readable),
            toes().max().map_or_else(String::new, readable),
        );
        Ok(())
    }
}
