//! Lumps of a capture, cut from its source one by one.

use std::io::Read;

use anyhow::{Context as _, Result, bail, ensure};
use raim_firmware::time::GpsTime;

use super::content::Content;
use super::cuts::{Cut, Cutter};
use super::falsify;
use super::orbits::{Feeder, Orbits};
use super::week;
use crate::signal::calendar::readable;
use crate::signal::fault::Fault;
use crate::signal::lump::Lump;
use crate::signal::lumps::Window;
use crate::signal::pieces::{Kind, Piece, Stream, pieces};

/// Longest gap between two epochs of one recording, ms: half a week, by which an epoch is dated. A
/// service that records goes on behind what its file has.
const LONGEST_GAP_MS: i64 = 302_400_000;

/// Most bytes of one lump: a thousand times those that a receiver sends in an epoch, or those that
/// satellites broadcast in an hour. If more come, the oldest are dropped.
const LUMP_BYTES: usize = 4 << 20;

/// Systems that take part unless others are selected.
const SYSTEMS: &str = "GCE";

/// Number of bytes that identify something that is not a capture.
const HEAD: usize = 4096;

/// Lumps of a capture. Only the bytes of one epoch are in memory, so that the length of the source
/// does not matter. Errors of the whole source come at its end.
pub struct Lumps<R> {
    stream: Stream<R>,
    cutter: Cutter,
    /// An ephemeris of the navigation files, until the week is taken from it.
    week: Option<Vec<u8>>,
    /// GPS week of the first epoch, if it is given.
    given: Option<u16>,
    /// Week of the first ranges that state one.
    stated: Option<u16>,
    content: Content,
    /// Letters of the systems that take part.
    systems: String,
    orbits: Option<Orbits>,
    feeder: Option<Feeder>,
    faults: Vec<Fault>,
    window: Window,
    head: Vec<u8>,
    /// Bytes since the end of the last epoch.
    open: Vec<u8>,
    /// Remaining bytes of epochs outside the window.
    pending: Vec<u8>,
    span: Option<Span>,
    /// Time from the first epoch to the last one of the window, s.
    last_used_s: Option<f64>,
    /// First epoch of the window.
    first_used: Option<GpsTime>,
    klobuchar: Option<[f64; 8]>,
    has_ended: bool,
}

/// The epochs so far.
struct Span {
    first: GpsTime,
    last: GpsTime,
    /// Bytes up to the end of the last epoch.
    end: u64,
}

impl<R: Read> Lumps<R> {
    /// Returns the lumps of a window of `source`, with faults, and with the orbits of navigation
    /// files beside its own. Faults are timed from the first epoch of the capture, whatever the
    /// window.
    ///
    /// # Errors
    /// A fault needs the directions of satellites, or an ephemeris does not fit its message.
    pub fn of(source: R, orbits: Option<Orbits>, faults: &[Fault], window: &Window) -> Result<Self> {
        ensure!(
            !faults.iter().any(Fault::needs_directions),
            "a shift needs to know where the satellites stand, which a capture is not asked for: use a recording, --obs and \
             --nav"
        );
        let week = orbits.as_ref().map(Orbits::week).transpose()?;
        Ok(Self {
            stream: Stream::of(source),
            cutter: Cutter::default(),
            week,
            given: None,
            stated: None,
            content: Content::default(),
            systems: SYSTEMS.to_owned(),
            feeder: orbits.as_ref().map(Orbits::feeder),
            orbits,
            faults: faults.to_vec(),
            window: *window,
            head: Vec::new(),
            open: Vec::new(),
            pending: Vec::new(),
            span: None,
            last_used_s: None,
            first_used: None,
            klobuchar: None,
            has_ended: false,
        })
    }

    /// Takes the GPS week of the first epoch as given, not rolled over.
    #[must_use]
    pub fn in_week(mut self, week: Option<u16>) -> Self {
        self.given = week;
        self.cutter = week.map_or_else(Cutter::default, Cutter::in_week);
        self
    }

    /// Takes the letters of the systems that take part, which are those at start by default.
    #[must_use]
    pub fn selecting(mut self, systems: &str) -> Self {
        systems.clone_into(&mut self.systems);
        self
    }

    /// Returns the GPS week of the window's first epoch if the module needs it from a command,
    /// after that epoch was read.
    pub fn week(&self) -> Option<u16> {
        self.given.and(self.first_used).map(|first| first.week)
    }

    /// Returns the GPS week of the first epoch on which all ephemerides read so far agree; `None`
    /// if the module takes that week by itself.
    pub(super) fn agreed_week(&self) -> Option<u16> {
        let span = self.span.as_ref()?;
        week::of(span.first, span.last, self.cutter.week_corrections(), self.stated)
    }

    /// Returns the content of the capture, after all of it was read.
    pub fn content(&self) -> &Content {
        &self.content
    }

    /// Returns in words what came, what of it is not read, and what is missing, after all of it was
    /// read; `None` if there is neither of the last two.
    pub fn advice(&self) -> Option<String> {
        self.content.advice(&self.systems, &self.orbits.as_ref().map(Orbits::satellites).unwrap_or_default())
    }

    /// Returns the ionospheric coefficients that the module does not receive: those of a navigation
    /// file, or from before the first returned lump.
    pub fn klobuchar(&self) -> Option<[f64; 8]> {
        self.orbits.as_ref().and_then(|orbits| orbits.klobuchar).or(self.klobuchar)
    }

    /// Returns the next lump of the window, or `None` at the end.
    fn advance(&mut self) -> Result<Option<Lump>> {
        while let Some(cut) = self.cut()? {
            let bytes = std::mem::take(&mut self.open);
            let lump = self.lump(&cut, &bytes)?;
            if lump.is_some() {
                return Ok(lump);
            }
        }
        self.check()?;
        Ok(None)
    }

    /// Reads up to the end of an epoch.
    fn cut(&mut self) -> Result<Option<Cut>> {
        let Self { stream, cutter, week, stated, content, head, open, span, .. } = self;
        while let Some(piece) = stream.advance().context("cannot be read")? {
            if let Some(cut) = cutter.silence_before(&piece) {
                let length = piece.bytes.len();
                stream.put_back(length);
                return extended(span, cut, content.bytes()).map(Some);
            }
            if head.len() < HEAD {
                head.extend(piece.bytes.iter().take(HEAD - head.len()));
            }
            content.count(&piece);
            *stated = stated.or_else(|| week::stated(&piece));
            open.extend_from_slice(piece.bytes);
            drop_oldest(open);
            let mut cut = cutter.take(&piece);
            if cutter.without_week() > 0
                && let Some(week) = week.take()
            {
                // RTCM ranges have no week, and these came before an ephemeris with the week.
                *cutter = Cutter::after(&week);
                cut = pieces(open).filter_map(|piece| cutter.take(&piece)).last();
            }
            if let Some(cut) = cut {
                return extended(span, cut, content.bytes()).map(Some);
            }
        }
        cutter.silence().map(|cut| extended(span, cut, content.bytes())).transpose()
    }

    /// Makes the lump of an epoch, if the window holds it.
    fn lump(&mut self, cut: &Cut, bytes: &[u8]) -> Result<Option<Lump>> {
        ensure!(
            self.window.every_s == 0.0 || !cut.ends_with_next,
            "--every: epochs of this capture end only with the first message of the next one, and cannot be left out; leave \
             --every away"
        );
        let elapsed_s = self.span.as_ref().map_or(0.0, |span| cut.time.since_ms(span.first) as f64 * 1e-3);
        if let Some(feeder) = &mut self.feeder {
            cut.ephemerides.iter().for_each(|ephemeris| feeder.receive(ephemeris));
        }
        if !self.window.holds(elapsed_s, self.last_used_s) {
            if self.last_used_s.is_none() {
                self.klobuchar = cut.ionosphere.or(self.klobuchar);
            }
            // Bytes after the window are not replayed.
            if elapsed_s < self.window.to_s {
                self.pending.extend(without_ranges(bytes, cut.time));
                drop_oldest(&mut self.pending);
            }
            return Ok(None);
        }
        self.last_used_s = Some(elapsed_s);
        self.first_used.get_or_insert(cut.time);
        let mut lump = self.feeder.as_mut().map_or(Ok(Vec::new()), |feeder| feeder.before(cut.time))?;
        lump.append(&mut self.pending);
        lump.extend(falsified(bytes, (cut.time, elapsed_s), &self.faults)?);
        Ok(Some(Lump { time: cut.time, elapsed_s, bytes: lump }))
    }

    /// Checks that depend on the whole capture.
    fn check(&mut self) -> Result<()> {
        self.content.without_week = self.cutter.without_week();
        self.content.ranged = self.cutter.ranged.clone();
        self.content.known = self.cutter.known.clone();
        self.content.refused = self.cutter.refused.clone();
        self.content.lacks_leap = self.cutter.lacks_leap();
        let Some(span) = &self.span else {
            bail!(self.content.no_epoch(&self.head));
        };
        if let Some(orbits) = &self.orbits {
            orbits.check(span.first, span.last).context("--nav")?;
        }
        for fault in &self.faults {
            fault.check_against(&self.content.satellites())?;
        }
        ensure!(
            self.last_used_s.is_some(),
            "no epoch between {} s and {} s of the capture, which is {} s long",
            self.window.from_s,
            self.window.to_s,
            span.last.since_ms(span.first) as f64 * 1e-3
        );
        Ok(())
    }
}

impl<R: Read> Iterator for Lumps<R> {
    type Item = Result<Lump>;

    fn next(&mut self) -> Option<Result<Lump>> {
        if self.has_ended {
            return None;
        }
        let lump = self.advance().transpose();
        self.has_ended = !matches!(lump, Some(Ok(_)));
        lump
    }
}

impl Span {
    /// Takes the next epoch.
    ///
    /// # Errors
    /// Time does not advance, or advances by more than half a week.
    fn extend(&mut self, time: GpsTime, end: u64) -> Result<()> {
        let gap_ms = time.since_ms(self.last);
        ensure!(
            (1..=LONGEST_GAP_MS).contains(&gap_ms),
            "goes from {} to {} at byte {}: two recordings in one, or a receiver that did not know the time yet; cut it there \
             and give one part",
            readable(self.last),
            readable(time),
            self.end
        );
        (self.last, self.end) = (time, end);
        Ok(())
    }
}

/// Returns the cut of the next epoch, which ends after `end` bytes and extends the span.
fn extended(span: &mut Option<Span>, cut: Cut, end: u64) -> Result<Cut> {
    match span {
        None => *span = Some(Span { first: cut.time, last: cut.time, end }),
        Some(span) => span.extend(cut.time, end)?,
    }
    Ok(cut)
}

/// Drops the older half if a lump is too large.
fn drop_oldest(bytes: &mut Vec<u8>) {
    if bytes.len() > LUMP_BYTES {
        bytes.drain(..bytes.len() / 2);
    }
}

/// Returns the bytes with the faults.
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

/// Returns the frames of an epoch without its ranges. Frames of the next one, which may have come
/// with it, stay.
fn without_ranges(bytes: &[u8], epoch: GpsTime) -> Vec<u8> {
    let is_kept = |piece: &Piece<'_>| {
        let of_next = || {
            falsify::tow_ms(piece).is_some_and(|tow_ms| GpsTime::nearest(tow_ms, epoch).since_ms(epoch) > 100)
        };
        matches!(piece.kind, Kind::Ubx(_) | Kind::Rtcm(_) | Kind::Sbf(_))
            && (!piece.kind.has_ranges() || of_next())
    };
    pieces(bytes).filter(is_kept).flat_map(|piece| piece.bytes).copied().collect()
}
