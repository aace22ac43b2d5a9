//! Recordings: RINEX 2, 3 and 4 files of a receiver, plain or packed, as epochs of raw measurements.
//!
//! ```text
//! file (gzip, compact RINEX) ──► text ──► header ──► observations ──► MeasuredEpoch ┐
//!                                             └────► navigation ──► Ephemeris  ┴──► Recording ──► encode
//! ```
//!
//! Nothing is corrected and nothing is judged: a recording is what the receiver saw.
//!
//! The files are read by this module and not by the `rinex` crate: that one builds more than two hundred packages
//! (an ephemeris service with an HTTP client, tables for terminals) to parse text in fixed columns, which is most of
//! the time that a first build of the project would take.
//!
//! References: [RINEX-2.11], [RINEX-3.05], [RINEX-4.01], [Hatanaka2008].
//!
//! [RINEX-2.11]: crate#references
//! [RINEX-3.05]: crate#references
//! [RINEX-4.01]: crate#references
//! [Hatanaka2008]: crate#references

mod calendar;
mod file;
mod glonass;
mod hatanaka;
mod header;
mod navigation;
mod observations;
mod text;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use rai_core::frame::Ecef;
use rai_core::satellite::Constellation;

pub use self::calendar::readable;
use self::header::{Header, Kind};
use self::text::Lines;
use crate::measurement::{MeasuredEpoch, TimedEphemeris};

/// How far from its reference time any broadcast ephemeris is of use, ms: 4 h.
const USEFUL_MS: i64 = 4 * 3_600_000;

/// What a receiver saw, and what the satellites broadcast meanwhile.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// In the order of time, no time twice.
    pub epochs: Vec<MeasuredEpoch>,
    /// In the order of the files.
    pub ephemerides: Vec<TimedEphemeris>,
    /// GPS coefficients of the single-frequency ionosphere model, `α0…α3, β0…β3`, in the broadcast's units.
    pub klobuchar: Option<[f64; 8]>,
    /// Records of systems that nobody asked for and that could not be read.
    pub malformed: u64,
    /// What the header believes about the antenna; wrong by hundreds of metres in some files.
    pub approximate_position: Option<Ecef>,
}

impl Recording {
    /// Reads observation and navigation files; several are merged in time.
    ///
    /// # Errors
    /// A file that is missing, empty or not RINEX of the expected kind, a line that cannot be read, or a navigation
    /// file of another day: the message says what, where, and what would help.
    pub fn load(observations: &[PathBuf], navigation: &[PathBuf]) -> Result<Self> {
        Self::load_of(observations, navigation, &Constellation::ALL)
    }

    /// As [`Recording::load`], where only records of the `wanted` systems must be sound; of the others, those that
    /// cannot be read are counted in [`Recording::malformed`].
    ///
    /// # Errors
    /// As of [`Recording::load`].
    pub fn load_of(
        observations: &[PathBuf],
        navigation: &[PathBuf],
        wanted: &[Constellation],
    ) -> Result<Self> {
        let mut recording = Self::default();
        for path in observations {
            recording
                .read(path, Kind::Observations, wanted)
                .with_context(|| format!("observation file {}", path.display()))?;
        }
        recording.read_navigation(navigation, wanted)?;
        recording.epochs.sort_by_key(|epoch| epoch.time);
        recording.epochs.dedup_by_key(|epoch| epoch.time);
        recording.check(navigation)?;
        Ok(recording)
    }

    /// What navigation files say, where there is no receiver's file beside them: a recording without epochs.
    ///
    /// # Errors
    /// As of [`Recording::load_of`], but that no day is the wrong one.
    pub fn of_navigation(navigation: &[PathBuf], wanted: &[Constellation]) -> Result<Self> {
        let mut recording = Self::default();
        recording.read_navigation(navigation, wanted)?;
        recording.check_ephemerides(&names(navigation))?;
        Ok(recording)
    }

    fn read_navigation(&mut self, files: &[PathBuf], wanted: &[Constellation]) -> Result<()> {
        files.iter().try_for_each(|path| {
            let place = || format!("navigation file {}", path.display());
            self.read(path, Kind::Navigation, wanted).with_context(place)
        })
    }

    fn read(&mut self, path: &Path, expected: Kind, wanted: &[Constellation]) -> Result<()> {
        let text = file::open(path)?;
        let mut lines = Lines::of(&text);
        let header = Header::read(&mut lines)?;
        match (header.kind, expected) {
            (Kind::Observations, Kind::Observations) => {
                self.approximate_position = self.approximate_position.or(header.approximate_position);
                let (mut epochs, malformed) = observations::read(header, &mut lines, wanted)?;
                self.epochs.append(&mut epochs);
                self.malformed += malformed;
            }
            (Kind::Navigation, Kind::Navigation) => {
                let mut navigation = navigation::read(&header, &mut lines, wanted)?;
                self.ephemerides.append(&mut navigation.ephemerides);
                self.klobuchar = self.klobuchar.or(navigation.klobuchar);
                self.malformed += navigation.malformed;
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
        let names = names(navigation);
        self.check_ephemerides(&names)?;
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

    /// That there is an orbit at all.
    fn check_ephemerides(&self, names: &str) -> Result<()> {
        ensure!(!self.ephemerides.is_empty(), "{names}: no ephemeris of GPS, Galileo, BeiDou or GLONASS");
        Ok(())
    }
}

/// The names of files in a message.
fn names(files: &[PathBuf]) -> String {
    files.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
}
