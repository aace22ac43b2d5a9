//! Captures of a receiver: what it sent on its serial port, as the module would have heard it.
//!
//! ```text
//! file, standard input, TCP, serial ─► bytes ─► pieces ─► cuts ─► lumps (window, faults, orbits) ─► replay, monitor
//! ```
//!
//! | module | what |
//! |---|---|
//! | [`Bytes`] | the bytes of a source, unpacked |
//! | `content` | what a capture holds and lacks |
//! | `cuts` | which bytes belong to which epoch |
//! | [`Lumps`] | the bytes of each epoch, read one after the other |
//! | `falsify` | faults, put into the frames |
//! | `week` | the GPS week of the first epoch |
//! | `orbits` | ephemerides of navigation files, where the capture has none |
//!
//! A lump holds every byte from the end of one epoch to the end of the next, good or bad, as they
//! came. Time runs by the tags of the epochs: a capture has no other. What is left out by a window
//! loses its ranges and keeps its ephemerides.

mod content;
mod cuts;
mod falsify;
mod line;
mod lumps;
mod orbits;
mod week;

use std::io::{Cursor, Read as _};
use std::path::Path;

use anyhow::{Context as _, Result};

pub use content::{Content, has_frames};
pub use line::Bytes;
pub use lumps::Lumps;
pub use orbits::Orbits;

use crate::fault::Fault;
use crate::replay::{Lump, Window};

/// A capture in memory.
pub struct Capture {
    bytes: Vec<u8>,
    content: Content,
    missing: Option<String>,
    orbits: Option<Orbits>,
    /// The GPS week of the first epoch, where the module would take another.
    week: Option<u16>,
}

/// The lumps of a window, all of them.
#[derive(Clone, Debug, Default)]
pub struct Prepared {
    /// Epoch by epoch.
    pub lumps: Vec<Lump>,
    /// Coefficients of the ionosphere that the module cannot hear itself: of a navigation file, or
    /// from before the window.
    pub klobuchar: Option<[f64; 8]>,
    /// The GPS week of the first epoch, which the module is told where it would take another.
    pub week: Option<u16>,
}

/// Reads all bytes of a source, as [`Bytes::open`] names it.
///
/// # Errors
/// As of [`Bytes::open`].
pub fn read(name: &str, limit_s: f64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    Bytes::open(name, limit_s)?.read_to_end(&mut bytes).context("cannot be read")?;
    Ok(bytes)
}

/// Returns true where a file is a capture, gzip or not; false where it cannot be read.
pub fn is_capture(path: &Path) -> bool {
    Bytes::open(&path.display().to_string(), f64::INFINITY).is_ok_and(|bytes| has_frames(bytes.head()))
}

/// Bytes of a file by which its week is told: minutes to hours, in which every system sends its
/// sets.
const WEEK_BYTES: u64 = 16 << 20;

/// Returns the GPS week of the first epoch of a file, not rolled over; `None` if the module takes
/// it by itself, or if the source is no file, which can be read but once.
///
/// # Errors
/// As of [`Bytes::open`].
pub fn week_of(name: &str, orbits: Option<&Orbits>) -> Result<Option<u16>> {
    if !Path::new(name).is_file() {
        return Ok(None);
    }
    Ok(agreed_week(Bytes::open(name, f64::INFINITY)?, orbits))
}

/// Reads the beginning of a source for its week. Its errors come again where all of it is read.
fn agreed_week(source: impl std::io::Read, orbits: Option<&Orbits>) -> Option<u16> {
    let mut lumps = Lumps::of(source.take(WEEK_BYTES), orbits.cloned(), &[], &Window::ALL).ok()?;
    let _ = lumps.by_ref().try_for_each(|lump| lump.map(drop));
    lumps.agreed_week()
}

impl Capture {
    /// Reads what a receiver sent, with the orbits of navigation files beside its own.
    ///
    /// # Errors
    /// Bytes that are no capture or hold no epoch, two recordings in one, orbits of another day:
    /// what was found, and what would help.
    pub fn of(bytes: Vec<u8>, orbits: Option<Orbits>) -> Result<Self> {
        Self::of_week(bytes, orbits, None)
    }

    /// As [`Self::of`], with the GPS week of the first epoch, not rolled over, if it is known.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub fn of_week(bytes: Vec<u8>, orbits: Option<Orbits>, given: Option<u16>) -> Result<Self> {
        let week = given.or_else(|| agreed_week(bytes.as_slice(), orbits.as_ref()));
        let lumps = Lumps::of(Cursor::new(bytes.as_slice()), orbits.clone(), &[], &Window::ALL)?;
        let mut lumps = lumps.in_week(week);
        lumps.by_ref().try_for_each(|lump| lump.map(drop))?;
        let (content, missing) = (lumps.content().clone(), lumps.missing());
        Ok(Self { bytes, content, missing, orbits, week })
    }

    /// Returns what the capture holds.
    pub fn content(&self) -> &Content {
        &self.content
    }

    /// Returns in words what the capture lacks for a position.
    pub fn missing(&self) -> Option<String> {
        self.missing.clone()
    }

    /// Returns the lumps of a window. Faults are timed from the first epoch of the capture,
    /// whatever the window is.
    ///
    /// # Errors
    /// A fault of a satellite that is not in the capture or that a message has no room for, a
    /// window that is empty or that cannot be thinned.
    pub fn lumps(&self, faults: &[Fault], window: &Window) -> Result<Prepared> {
        let source = Lumps::of(self.bytes.as_slice(), self.orbits.clone(), faults, window)?;
        let mut source = source.in_week(self.week);
        let lumps = source.by_ref().collect::<Result<_>>()?;
        Ok(Prepared { lumps, klobuchar: source.klobuchar(), week: source.week() })
    }
}
