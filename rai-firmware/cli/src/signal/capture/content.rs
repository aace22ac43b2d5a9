//! Content of a capture, and what is missing in it.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use anyhow::{Result, bail};
use raim_core::satellite::{Constellation, SatelliteId};

use crate::signal::pieces::{Kind, Piece, pieces};

/// Messages that a receiver must send, in words.
const NEEDED: &str = "the module needs ranges and orbits: RXM-RAWX and RXM-SFRBX of a u-blox receiver, or RTCM 3 with MSM4 to \
     MSM7 (1077, 1097, 1127) and ephemerides (1019, 1045 or 1046, 1042)";

/// Content of a capture.
#[derive(Clone, Debug, Default)]
pub struct Content {
    /// Number of frames of each kind.
    frames: BTreeMap<Kind, usize>,
    /// Number of lines of text.
    lines: usize,
    /// Bytes in these lines.
    line_bytes: usize,
    /// Bytes outside frames and lines.
    rest_bytes: usize,
    /// All bytes.
    bytes: u64,
    /// Satellites with ranges.
    pub(super) ranged: BTreeSet<SatelliteId>,
    /// Satellites with an ephemeris.
    pub(super) known: BTreeSet<SatelliteId>,
    /// Epochs of ranges whose week is unknown.
    pub(super) without_week: u32,
}

impl Content {
    /// Counts a piece.
    pub(super) fn count(&mut self, piece: &Piece<'_>) {
        self.bytes += piece.bytes.len() as u64;
        match piece.kind {
            Kind::Line => {
                self.lines += 1;
                self.line_bytes += piece.bytes.len();
            }
            Kind::Rest => self.rest_bytes += piece.bytes.len(),
            kind => *self.frames.entry(kind).or_default() += 1,
        }
    }

    /// Returns the number of bytes.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Returns the satellites with ranges.
    pub fn satellites(&self) -> Vec<SatelliteId> {
        self.ranged.iter().copied().collect()
    }

    /// Checks that the bytes are a capture of ranges. They begin with `head`.
    ///
    /// # Errors
    /// The bytes are something else; the message names it.
    pub(super) fn check(&self, head: &[u8]) -> Result<()> {
        if head.is_empty() {
            bail!("is empty");
        }
        if self.frames.is_empty() && self.lines > 0 && self.rest_bytes < self.line_bytes {
            bail!(
                "holds {} lines of NMEA and no ranges, and positions cannot be checked: {NEEDED}",
                self.lines
            );
        }
        if self.frames.is_empty() {
            bail!("holds no frame of UBX or RTCM 3; it is {}", foreign(head));
        }
        if self.frames.keys().any(|kind| kind.has_whole_ranges()) {
            return Ok(());
        }
        let has = |is: fn(&Kind) -> bool| self.frames.keys().any(is);
        if has(|kind| kind.has_ranges()) {
            bail!("holds {self}: MSM1 to MSM3 have no whole ranges; {NEEDED}");
        }
        if has(|kind| matches!(kind, Kind::Rtcm(1001..=1004 | 1009..=1012))) {
            bail!("holds {self}: the ranges of 1001 to 1012 are not read; {NEEDED}");
        }
        if has(|kind| *kind == Kind::Ubx([0x02, 0x10])) {
            bail!(
                "holds {self}: the ranges of RXM-RAW, before the eighth generation, are not read; {NEEDED}"
            );
        }
        bail!("holds {self}, and no ranges: {NEEDED}")
    }

    /// Returns the reason for which ranges gave no epoch.
    pub(super) fn no_epoch(&self) -> String {
        if self.frames.contains_key(&Kind::RAWX) && self.without_week > 0 {
            format!("holds {self}: in none of them the receiver knows the week; let it find the time first")
        } else if self.without_week > 0 {
            format!("holds {self}: {}", self.without_orbits(true))
        } else {
            format!("holds {self}: no epoch with a range in it")
        }
    }

    /// Returns the advice for ranges without orbits.
    fn without_orbits(&self, says_week: bool) -> String {
        let week = if says_week { ", and nothing else says the week" } else { "" };
        let switch = if self.frames.contains_key(&Kind::RAWX) {
            "switch RXM-SFRBX on at the receiver"
        } else {
            "switch the ephemerides on at the receiver (1019 for GPS, 1045 or 1046 for Galileo, 1042 for BeiDou), or take \
             one that sends them"
        };
        format!(
            "ranges without ephemerides give no position{week}: {switch}, or give the RINEX navigation file of that day with \
             --nav"
        )
    }

    /// Returns what is missing, system by system; `others` are satellites whose ephemerides come
    /// from elsewhere.
    pub fn missing(&self, others: &BTreeSet<SatelliteId>) -> Option<String> {
        let has_orbit =
            |satellite: &SatelliteId| self.known.contains(satellite) || others.contains(satellite);
        if !self.ranged.iter().any(has_orbit) {
            return Some(self.without_orbits(false));
        }
        let without = |system: &Constellation| {
            let mut of_system =
                self.ranged.iter().filter(|satellite| satellite.constellation() == *system).peekable();
            of_system.peek().is_some() && !of_system.any(has_orbit)
        };
        // GLONASS takes no part unless it is selected.
        let used = [Constellation::Gps, Constellation::Galileo, Constellation::Beidou];
        let systems: Vec<&str> =
            used.iter().filter(|system| without(system)).map(|system| name(*system)).collect();
        (!systems.is_empty()).then(|| {
            format!(
                "satellites of {} have no ephemerides and are not used: enable RXM-SFRBX or the ephemerides of RTCM, or give --nav",
                systems.join(" and ")
            )
        })
    }
}

const fn name(system: Constellation) -> &'static str {
    match system {
        Constellation::Gps => "GPS",
        Constellation::Glonass => "GLONASS",
        Constellation::Galileo => "Galileo",
        Constellation::Beidou => "BeiDou",
    }
}

impl fmt::Display for Content {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts: Vec<String> =
            self.frames.iter().map(|(kind, count)| format!("{count} {}", frame_name(*kind))).collect();
        if self.lines > 0 {
            parts.push(format!("{} lines of text", self.lines));
        }
        if self.rest_bytes > 0 {
            parts.push(format!("{} bytes of neither", self.rest_bytes));
        }
        formatter.write_str(&parts.join(", "))
    }
}

/// Returns the name of a frame in its maker's documents.
fn frame_name(kind: Kind) -> String {
    match kind {
        Kind::Rtcm(number) => format!("RTCM {number}"),
        Kind::Ubx([class, id]) => match (class, id) {
            (0x01, 0x03) => "NAV-STATUS".to_owned(),
            (0x01, 0x07) => "NAV-PVT".to_owned(),
            (0x01, 0x35) => "NAV-SAT".to_owned(),
            (0x02, 0x10) => "RXM-RAW".to_owned(),
            (0x02, 0x11) => "RXM-SFRB".to_owned(),
            (0x02, 0x13) => "RXM-SFRBX".to_owned(),
            (0x02, 0x14) => "RXM-MEASX".to_owned(),
            (0x02, 0x15) => "RXM-RAWX".to_owned(),
            (0x27, 0x09) => "SEC-SIG".to_owned(),
            _ => format!("UBX {class:02X} {id:02X}"),
        },
        Kind::Line | Kind::Rest => String::new(),
    }
}

/// Returns true if the first bytes contain a frame of UBX or RTCM 3.
pub fn has_frames(bytes: &[u8]) -> bool {
    const EARLY: usize = 65_536;
    let early = bytes.get(..bytes.len().min(EARLY)).unwrap_or_default();
    pieces(early).any(|piece| matches!(piece.kind, Kind::Ubx(_) | Kind::Rtcm(_)))
}

/// Returns the kind of a file that is not a capture, from its first bytes.
fn foreign(bytes: &[u8]) -> String {
    let start = bytes.get(..bytes.len().min(4096)).unwrap_or_default();
    let text = String::from_utf8_lossy(start);
    let line = text.lines().next().unwrap_or("");
    let is = |magic: &[u8]| start.starts_with(magic);
    let is_text = !text.chars().any(|letter| letter.is_control() && !"\t\r\n".contains(letter));
    if line.contains("RINEX VERSION") || line.contains("CRINEX VERS") {
        let kind = match (line.contains("CRINEX"), line.get(20..21)) {
            (true, _) | (_, Some("O")) => {
                "a RINEX observation file: give it with --obs, and a navigation file with --nav"
            }
            _ => "a RINEX navigation file: give it with --nav, beside a capture or observations",
        };
        return kind.to_owned();
    }
    let kind = match () {
        () if is(b"\x89PNG") || is(b"\xff\xd8\xff") || is(b"GIF8") || is(b"BM") => "a picture",
        () if is(b"%PDF") => "a PDF",
        () if is(b"\x7fELF") => "a program",
        () if is(b"<") => "a page or XML",
        () if is(b"{") || is(b"[") => "JSON",
        () if is(b"$@") => "Septentrio SBF, which is not read: let the receiver send RTCM 3",
        () if text.contains("$PRAI") => "what a module said: monitor --file shows it",
        () if is_text => "text",
        () => "nothing that is known",
    };
    kind.to_owned()
}
