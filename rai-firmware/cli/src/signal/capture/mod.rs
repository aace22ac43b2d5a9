//! Captures of a receiver: the bytes of its serial port, as the module would have received them.
//!
//! ```text
//! file, standard input, TCP, serial ─► bytes ─► pieces ─► cuts ─► lumps (window, faults, orbits) ─► replay, monitor
//! ```
//!
//! | module | content |
//! |---|---|
//! | [`Bytes`] | bytes of a source, unpacked |
//! | `content` | content of a capture, and what is missing |
//! | `cuts` | bytes of each epoch |
//! | [`Lumps`] | lumps of a capture, read one by one |
//! | `foreign` | names of logs and files that are not read |
//! | `falsify` | faults in the frames |
//! | `week` | GPS week of the first epoch |
//! | `orbits` | ephemerides of navigation files, if the capture has none |
//!
//! A lump holds every byte from the end of one epoch to the end of the next, valid or not. Time
//! passes by the tags of the epochs, because a capture has no other. Epochs outside a window lose
//! their ranges and keep their ephemerides.

mod content;
mod cuts;
mod falsify;
mod foreign;
mod line;
mod lumps;
mod orbits;
mod week;

use std::io::{Cursor, Read as _};
use std::path::Path;

use anyhow::{Context as _, Result, ensure};

pub use content::{Content, has_frames};
pub use line::{Bytes, Cut};
pub use lumps::Lumps;
pub use orbits::Orbits;

use raim_firmware::time::GpsTime;

use crate::signal::fault::Fault;
use crate::signal::lump::Lump;
use crate::signal::lumps::Window;

/// Capture in memory.
pub struct Capture {
    bytes: Vec<u8>,
    content: Content,
    advice: Option<String>,
    orbits: Option<Orbits>,
    /// GPS week of the first epoch, if the module would take another.
    week: Option<u16>,
}

/// All lumps of a window.
#[derive(Clone, Debug, Default)]
pub struct Prepared {
    /// Lumps, epoch by epoch.
    pub lumps: Vec<Lump>,
    /// Ionospheric coefficients that the module does not receive: those of a navigation file, or
    /// from before the window.
    pub klobuchar: Option<[f64; 8]>,
    /// GPS week of the first epoch, which the module receives if it would take another.
    pub week: Option<u16>,
}

/// Reads all bytes of a source named as in [`Bytes::open`].
///
/// # Errors
/// As for [`Bytes::open`].
pub fn read(name: &str, limit_s: f64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    Bytes::open(name, limit_s)?.read_to_end(&mut bytes).context("cannot be read")?;
    Ok(bytes)
}

/// Returns true if a file is a capture, gzip or not; false if it cannot be read.
pub fn is_capture(path: &Path) -> bool {
    Bytes::open(&path.display().to_string(), f64::INFINITY).is_ok_and(|bytes| has_frames(bytes.head()))
}

/// Number of bytes of a file that determine its week: minutes to hours, in which every system sends
/// its sets.
const WEEK_BYTES: u64 = 4 << 20;

/// Returns the GPS week of the first epoch of a file, not rolled over. It is `None` if the module
/// takes that week by itself, or if the source is not a file, because it can be read only once.
///
/// # Errors
/// As for [`Bytes::open`].
pub fn week_of(name: &str, orbits: Option<&Orbits>) -> Result<Option<u16>> {
    if !Path::new(name).is_file() {
        return Ok(None);
    }
    Ok(agreed_week(Bytes::open(name, f64::INFINITY)?, orbits))
}

/// Returns files of one logger in the order of their first epochs.
///
/// # Errors
/// One is no file or has no epoch, or two begin with the same epoch.
pub fn in_order(names: &[String], orbits: Option<&Orbits>) -> Result<Vec<String>> {
    let mut dated = Vec::new();
    for name in names {
        ensure!(Path::new(name).is_file(), "several captures must be files, and {name} is none");
        dated.push((first_epoch(name, orbits).with_context(|| name.clone())?, name));
    }
    dated.sort();
    for pair in dated.windows(2) {
        if let [(time, one), (other, another)] = pair {
            ensure!(
                time != other,
                "{one} and {another} begin with the same epoch: copies, or captures of two receivers"
            );
        }
    }
    Ok(dated.into_iter().map(|(_, name)| name.clone()).collect())
}

fn first_epoch(name: &str, orbits: Option<&Orbits>) -> Result<GpsTime> {
    let week = week_of(name, orbits)?;
    let source = Bytes::open(name, f64::INFINITY)?.take(WEEK_BYTES);
    let mut lumps = Lumps::of(source, None, &[], &Window::ALL)?.in_week(week);
    Ok(lumps.next().context("has no epoch")??.time)
}

/// Returns all lumps of a source, and the commands that the module needs before the first one.
///
/// # Errors
/// There is no epoch. As for [`Bytes::open`].
pub fn for_the_module(name: &str, bytes: Bytes) -> Result<(impl Iterator<Item = Result<Lump>>, Vec<String>)> {
    let mut lumps = Lumps::of(bytes, None, &[], &Window::ALL)?.in_week(week_of(name, None)?);
    let first = lumps.next().context("there is no epoch")??;
    let setup = lumps.week().map(|week| format!("WEEK,{week}")).into_iter().collect();
    Ok((std::iter::once(Ok(first)).chain(lumps), setup))
}

/// Reads the beginning of a source for its week. Its errors recur when all of it is read.
fn agreed_week(source: impl std::io::Read, orbits: Option<&Orbits>) -> Option<u16> {
    let mut lumps = Lumps::of(source.take(WEEK_BYTES), orbits.cloned(), &[], &Window::ALL).ok()?;
    let _ = lumps.by_ref().try_for_each(|lump| lump.map(drop));
    lumps.agreed_week()
}

impl Capture {
    /// Reads the bytes of a receiver, with the orbits of navigation files beside its own.
    ///
    /// # Errors
    /// The bytes are not a capture or have no epoch, are two recordings in one, or the orbits are
    /// of another day. The message states what was found, and what would help.
    pub fn of(bytes: Vec<u8>, orbits: Option<Orbits>) -> Result<Self> {
        Self::of_week(bytes, orbits, None)
    }

    /// Reads the same as [`Self::of`], with the GPS week of the first epoch, not rolled over, if it
    /// is known.
    ///
    /// # Errors
    /// As for [`Self::of`].
    pub fn of_week(bytes: Vec<u8>, orbits: Option<Orbits>, given: Option<u16>) -> Result<Self> {
        let week = given.or_else(|| agreed_week(bytes.as_slice(), orbits.as_ref()));
        let lumps = Lumps::of(Cursor::new(bytes.as_slice()), orbits.clone(), &[], &Window::ALL)?;
        let mut lumps = lumps.in_week(week);
        lumps.by_ref().try_for_each(|lump| lump.map(drop))?;
        let (content, advice) = (lumps.content().clone(), lumps.advice());
        Ok(Self { bytes, content, advice, orbits, week })
    }

    /// Returns the content of the capture.
    pub fn content(&self) -> &Content {
        &self.content
    }

    /// Returns in words what came, what of it is not read, and what is missing; `None` if there is
    /// neither of the last two.
    pub fn advice(&self) -> Option<String> {
        self.advice.clone()
    }

    /// Returns the lumps of a window. Faults are timed from the first epoch of the capture,
    /// whatever the window.
    ///
    /// # Errors
    /// A fault is of a satellite outside the capture or does not fit a message, or the window is
    /// empty or cannot be thinned.
    pub fn lumps(&self, faults: &[Fault], window: &Window) -> Result<Prepared> {
        let source = Lumps::of(self.bytes.as_slice(), self.orbits.clone(), faults, window)?;
        let mut source = source.in_week(self.week);
        let lumps = source.by_ref().collect::<Result<_>>()?;
        Ok(Prepared { lumps, klobuchar: source.klobuchar(), week: source.week() })
    }
}
