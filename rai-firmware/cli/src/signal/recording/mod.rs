//! Recordings: RINEX 2, 3 and 4 files of a receiver, plain or packed, as epochs of raw
//! measurements.
//!
//! ```text
//! file (gzip, compact RINEX) ──► lines ──► header ──► observations ──► MeasuredEpoch ┐
//!                                             └────► navigation ──► Ephemeris  ┴──► Recording ──► encode
//! ```
//!
//! Measurements are neither corrected nor judged: a recording is the input of the receiver.
//! Observations are read one epoch at a time ([`Epochs`]); unreadable records are skipped and
//! counted ([`Skipped`]).
//!
//! This module reads the files and not the `rinex` crate, because that crate builds more than two
//! hundred packages (an ephemeris service with an HTTP client, tables for terminals). That would be
//! most of the time of the project's first build, for text in fixed columns.
//!
//! References: [RINEX-2.11], [RINEX-3.05], [RINEX-4.01], [Hatanaka2008].
//!
//! [RINEX-2.11]: crate#references
//! [RINEX-3.05]: crate#references
//! [RINEX-4.01]: crate#references
//! [Hatanaka2008]: crate#references

mod arcs;
mod epochs;
mod file;
mod glonass;
mod hatanaka;
mod header;
mod kepler;
mod navigation;
mod observations;
mod one_receiver;
mod signals;
mod text;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use raim_firmware::time::GpsTime;

pub use self::epochs::Epochs;
pub use self::file::packed_by;
use self::header::{Header, Kind};
pub use self::observations::Observations;
use crate::signal::calendar::readable;
pub use crate::signal::measurement::Recording;
use crate::signal::measurement::TimedEphemeris;
use crate::signal::skipped::Skipped;

/// Longest time from its reference time at which a broadcast ephemeris is useful, ms: 4 h.
const USEFUL_MS: i64 = 4 * 3_600_000;

impl Recording {
    /// Reads observation and navigation files; several are merged in time.
    ///
    /// Unreadable records are skipped and counted.
    ///
    /// # Errors
    /// A file is missing, empty or not RINEX of the expected kind, more than a tenth of a file is
    /// unreadable, or a navigation file is of another day. The message states the problem, its
    /// place, and a remedy.
    pub fn load(observations: &[PathBuf], navigation: &[PathBuf]) -> Result<Self> {
        let mut epochs = Epochs::open(observations)?;
        let mut recording = Self { approximate_position: epochs.approximate_position(), ..Self::default() };
        recording.epochs = epochs.by_ref().collect::<Result<_>>()?;
        recording.skipped = epochs.skipped();
        recording.read_navigation(navigation)?;
        recording.check(navigation)?;
        Ok(recording)
    }

    /// Reads navigation files alone: a recording without epochs.
    ///
    /// # Errors
    /// As for [`Recording::load`], except that no day is the wrong one.
    pub fn of_navigation(navigation: &[PathBuf]) -> Result<Self> {
        let mut recording = Self::default();
        recording.read_navigation(navigation)?;
        recording.check_ephemerides(&names(navigation))?;
        Ok(recording)
    }

    fn read_navigation(&mut self, files: &[PathBuf]) -> Result<()> {
        files.iter().try_for_each(|path| {
            let place = || format!("navigation file {}", path.display());
            self.read_navigation_of(path).with_context(place)
        })
    }

    fn read_navigation_of(&mut self, path: &Path) -> Result<()> {
        let mut lines = file::open(path)?;
        let mut skipped = Skipped::default();
        let header = Header::read(&mut lines, &mut skipped)?;
        if header.kind == Kind::Observations {
            bail!("holds observations: give it as observation file");
        }
        self.leap_s = self.leap_s.or(header.leap_s);
        skipped.add(&lines.skipped());
        let mut navigation = navigation::read(&header, &mut lines, skipped)?;
        self.ephemerides.append(&mut navigation.ephemerides);
        self.klobuchar = self.klobuchar.or(navigation.klobuchar);
        self.skipped.add(&navigation.skipped.named(&path.display().to_string()));
        Ok(())
    }

    /// Checks that the recording suffices for a position.
    fn check(&self, navigation: &[PathBuf]) -> Result<()> {
        let (Some(first), Some(last)) = (self.epochs.first(), self.epochs.last()) else {
            bail!("the observation files hold no epoch");
        };
        self.check_time(navigation, first.time, last.time)
    }

    /// Checks that some ephemeris of the navigation files is of the time between two epochs.
    ///
    /// # Errors
    /// There is no ephemeris, or all are of another day.
    pub fn check_time(&self, navigation: &[PathBuf], first: GpsTime, last: GpsTime) -> Result<()> {
        let names = names(navigation);
        self.check_ephemerides(&names)?;
        let applicable = |ephemeris: &TimedEphemeris| {
            ephemeris.toe.since_ms(first) > -USEFUL_MS && ephemeris.toe.since_ms(last) < USEFUL_MS
        };
        let toes = || self.ephemerides.iter().map(|ephemeris| ephemeris.toe);
        ensure!(
            self.ephemerides.iter().any(applicable),
            "{names}: no ephemeris is of the time of the observations ({} to {}), all are for {} to {}; \
             take the navigation file of that day",
            readable(first),
            readable(last),
            toes().min().map_or_else(String::new, readable),
            toes().max().map_or_else(String::new, readable),
        );
        Ok(())
    }

    /// Checks that there is an orbit.
    fn check_ephemerides(&self, names: &str) -> Result<()> {
        ensure!(
            !self.ephemerides.is_empty(),
            "{names}: no ephemeris of GPS, Galileo, BeiDou, GLONASS or QZSS"
        );
        Ok(())
    }
}

/// Returns true for a RINEX file of ephemerides, false for one of observations, and `None` for any
/// other file.
pub fn is_navigation(path: &Path) -> Option<bool> {
    let mut lines = file::open(path).ok()?;
    let header = Header::read(&mut lines, &mut Skipped::default()).ok()?;
    Some(header.kind == Kind::Navigation)
}

/// Returns the names of files for a message.
fn names(files: &[PathBuf]) -> String {
    files.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
}
