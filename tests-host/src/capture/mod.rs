//! Captures of a receiver: what it sent on its serial port, as the module would have heard it.
//!
//! ```text
//! file, standard input, TCP, serial ─► bytes ─► pieces ─► cuts ─► lumps (window, faults, orbits) ─► replay
//! ```
//!
//! | module | what |
//! |---|---|
//! | `line` | where the bytes come from |
//! | `content` | what a capture holds and lacks |
//! | `cuts` | which bytes belong to which epoch |
//! | `falsify` | faults, put into the frames |
//! | `week` | the GPS week of the first epoch |
//! | `orbits` | ephemerides of navigation files, where the capture has none |
//!
//! A lump holds every byte from the end of one epoch to the end of the next, good or bad, as they came. Time runs by the tags
//! of the epochs: a capture has no other. What is left out by a window loses its ranges and keeps its ephemerides.

mod content;
mod cuts;
mod falsify;
mod line;
mod orbits;
mod week;

use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use rai_firmware::time::GpsTime;

pub use content::{Content, has_frames};
pub use orbits::Orbits;

use self::cuts::Cut;
use crate::fault::Fault;
use crate::recording::readable;
use crate::replay::pieces::{Kind, Piece, pieces};
use crate::replay::{Lump, Window};

/// The longest gap between two epochs of one recording, ms: a day.
const LONGEST_GAP_MS: i64 = 86_400_000;

/// Bytes of a receiver, and where its epochs end.
pub struct Capture {
    bytes: Vec<u8>,
    cuts: Vec<Cut>,
    content: Content,
    orbits: Option<Orbits>,
    /// The GPS week of the first epoch, where the module would take another.
    week: Option<u16>,
}

/// What of a capture is replayed.
#[derive(Clone, Debug, Default)]
pub struct Prepared {
    /// Epoch by epoch.
    pub lumps: Vec<Lump>,
    /// Coefficients of the ionosphere, where the module cannot hear them itself: from a navigation file, or from before the
    /// window.
    pub klobuchar: Option<[f64; 8]>,
    /// The GPS week of the first epoch, which the module is told where it would take another.
    pub week: Option<u16>,
}

/// Reads the bytes of a source: a path, `-` for standard input, `tcp://host:port`, `serial:path`. What has no end of its
/// own is read for `limit_s` seconds; gzip is unpacked.
///
/// # Errors
/// What cannot be opened or read, by name.
pub fn read(name: &str, limit_s: f64) -> Result<Vec<u8>> {
    line::read(name, limit_s)
}

/// Whether a file is a capture, gzip or not; false where it cannot be read.
pub fn is_capture(path: &Path) -> bool {
    let bytes = std::fs::read(path).ok().and_then(|bytes| line::unpack(bytes).ok());
    bytes.is_some_and(|bytes| has_frames(&bytes))
}

impl Capture {
    /// Finds the epochs in what a receiver sent, with the orbits of navigation files beside its own.
    ///
    /// # Errors
    /// Bytes that are no capture or hold no epoch, two recordings in one, orbits of another day: what was found, and what
    /// would help.
    pub fn of(bytes: Vec<u8>, orbits: Option<Orbits>) -> Result<Self> {
        Self::of_week(bytes, orbits, None)
    }

    /// As [`Self::of`], with the GPS week of the first epoch, not rolled over, if it is known.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub fn of_week(bytes: Vec<u8>, orbits: Option<Orbits>, given: Option<u16>) -> Result<Self> {
        let (mut content, mut cuts) = cuts::cut(&bytes, &[], given);
        content.check(&bytes)?;
        if let Some(orbits) = orbits.as_ref().filter(|_| content.without_week > 0) {
            // Ranges of RTCM have no week; some or all of them came before an ephemeris that says it.
            (content, cuts) = cuts::cut(&bytes, &orbits.week()?, given);
        }
        let week = given.or_else(|| week::of(&bytes, &cuts, &content));
        if given.is_none() && week.is_some() {
            (content, cuts) = cuts::cut(&bytes, &[], week);
        }
        let (Some(first), Some(last)) = (cuts.first(), cuts.last()) else { bail!(content.no_epoch()) };
        check_order(&cuts)?;
        if let Some(orbits) = &orbits {
            orbits.check(first.time, last.time).context("--nav")?;
        }
        Ok(Self { bytes, cuts, content, orbits, week })
    }

    /// What it holds.
    pub fn content(&self) -> &Content {
        &self.content
    }

    /// What it lacks for a position, in words, if anything.
    pub fn missing(&self) -> Option<String> {
        self.content.missing(&self.orbits.as_ref().map(Orbits::satellites).unwrap_or_default())
    }

    /// The lumps of a window. Faults are timed from the first epoch of the capture, whatever the window is.
    ///
    /// # Errors
    /// A fault of a satellite that is not in the capture or that a message has no room for, a window that is empty or that
    /// cannot be thinned.
    pub fn lumps(&self, faults: &[Fault], window: &Window) -> Result<Prepared> {
        for fault in faults {
            fault.check_against(&self.content.satellites())?;
        }
        ensure!(
            !faults.iter().any(Fault::needs_directions),
            "a shift needs to know where the satellites stand, which a capture is not asked for: use a recording, --obs and \
             --nav"
        );
        ensure!(
            window.every_s == 0.0 || !self.cuts.iter().any(|cut| cut.ends_with_next),
            "--every: epochs of this capture end only with the first message of the next one, and cannot be left out; leave \
             --every away"
        );
        let mut prepared = Prepared::default();
        let mut feeder = self.orbits.as_ref().map(Orbits::feeder);
        let (mut pending, mut from) = (Vec::new(), 0);
        for cut in &self.cuts {
            let bytes = self.bytes.get(from..cut.end).unwrap_or_default();
            from = cut.end;
            let elapsed_s = self.elapsed_s(cut);
            if let Some(feeder) = &mut feeder {
                cut.ephemerides.iter().for_each(|ephemeris| feeder.hear(ephemeris));
            }
            if !is_in(window, elapsed_s, prepared.lumps.last()) {
                if prepared.lumps.is_empty() {
                    prepared.klobuchar = cut.ionosphere.or(prepared.klobuchar);
                }
                pending.extend(without_ranges(bytes, cut.time));
                continue;
            }
            let mut lump = feeder.as_mut().map_or(Ok(Vec::new()), |feeder| feeder.before(cut.time))?;
            lump.append(&mut pending);
            lump.extend(falsified(bytes, (cut.time, elapsed_s), faults)?);
            prepared.lumps.push(Lump { time: cut.time, elapsed_s, bytes: lump });
        }
        ensure!(
            !prepared.lumps.is_empty(),
            "no epoch between {} s and {} s of the capture, which is {} s long",
            window.from_s,
            window.to_s,
            self.cuts.last().map_or(0.0, |cut| self.elapsed_s(cut))
        );
        // A window may begin weeks later than the capture.
        prepared.week = self.week.and(prepared.lumps.first()).map(|first| first.time.week);
        let of_files = self.orbits.as_ref().and_then(|orbits| orbits.klobuchar);
        prepared.klobuchar = of_files.or(prepared.klobuchar);
        Ok(prepared)
    }

    /// Seconds after the first epoch.
    fn elapsed_s(&self, cut: &Cut) -> f64 {
        let first = self.cuts.first().map_or(cut.time, |first| first.time);
        cut.time.since_ms(first) as f64 * 1e-3
    }
}

/// Whether an epoch is one of the window, after the last that was.
fn is_in(window: &Window, elapsed_s: f64, last: Option<&Lump>) -> bool {
    // Half a millisecond of grace, as for recordings.
    let is_next = last.is_none_or(|last| elapsed_s - last.elapsed_s >= window.every_s - 5e-4);
    elapsed_s >= window.from_s && elapsed_s < window.to_s && is_next
}

/// That time goes forward, and not by days.
fn check_order(cuts: &[Cut]) -> Result<()> {
    for pair in cuts.windows(2) {
        let [before, after] = pair else { continue };
        let gap_ms = after.time.since_ms(before.time);
        ensure!(
            (1..=LONGEST_GAP_MS).contains(&gap_ms),
            "goes from {} to {} at byte {}: two recordings in one, or a receiver that did not know the time yet; cut it there \
             and give one part",
            readable(before.time),
            readable(after.time),
            before.end
        );
    }
    Ok(())
}

/// The bytes with the faults in them.
fn falsified(bytes: &[u8], epoch: (GpsTime, f64), faults: &[Fault]) -> Result<Vec<u8>> {
    if faults.is_empty() {
        return Ok(bytes.to_vec());
    }
    let mut altered = Vec::with_capacity(bytes.len());
    for piece in pieces(bytes) {
        let frame = falsify::falsify(&piece, epoch, faults)?;
        altered.extend(frame.as_deref().unwrap_or(piece.bytes));
    }
    Ok(altered)
}

/// What is left of an epoch that is not replayed: everything but its ranges. Those of the next one may have come with it.
fn without_ranges(bytes: &[u8], epoch: GpsTime) -> Vec<u8> {
    let is_kept = |piece: &Piece<'_>| {
        let of_next = || {
            falsify::tow_ms(piece).is_some_and(|tow_ms| GpsTime::nearest(tow_ms, epoch).since_ms(epoch) > 100)
        };
        matches!(piece.kind, Kind::Ubx(_) | Kind::Rtcm(_)) && (!piece.kind.has_ranges() || of_next())
    };
    pieces(bytes).filter(is_kept).flat_map(|piece| piece.bytes).copied().collect()
}
