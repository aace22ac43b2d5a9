//! Content of a capture, and what is missing in it.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use raim_core::satellite::SatelliteId;

use super::foreign;
use crate::signal::advice::{Form, Found};
use crate::signal::pieces::{Kind, Piece, pieces};

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
    /// Satellites of which ephemerides were refused, with their number.
    pub(super) refused: BTreeMap<SatelliteId, u32>,
    /// True if GLONASS came without leap seconds.
    pub(super) lacks_leap: bool,
    /// Native log among the bytes that are neither frame nor line.
    native: Option<String>,
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
            Kind::Rest => {
                self.rest_bytes += piece.bytes.len();
                self.look(piece.bytes);
            }
            kind => *self.frames.entry(kind).or_default() += 1,
        }
    }

    /// Returns the number of bytes.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Returns the satellites of which ephemerides were refused, with their number.
    pub fn refused(&self) -> &BTreeMap<SatelliteId, u32> {
        &self.refused
    }

    /// Returns the satellites with ranges.
    pub fn satellites(&self) -> Vec<SatelliteId> {
        self.ranged.iter().copied().collect()
    }

    /// Takes bytes outside frames and lines, which may name a native log.
    pub(super) fn look(&mut self, bytes: &[u8]) {
        if self.native.is_none() {
            self.native = foreign::native(bytes);
        }
    }

    /// Returns the reason for which the bytes, which begin with `head`, have no epoch with ranges.
    pub(super) fn no_epoch(&self, head: &[u8]) -> String {
        if head.is_empty() {
            return format!("is empty: {}", foreign::GIVE);
        }
        if self.frames.is_empty() && !self.is_text() {
            return format!("holds no frame of UBX, SBF or RTCM 3; it is {}", foreign::foreign(head));
        }
        let found = self.found("GRECJ", &BTreeSet::new());
        found.advice().unwrap_or_else(|| format!("holds {self}: no epoch with a range in it"))
    }

    /// Returns true if the capture is mostly lines of text.
    fn is_text(&self) -> bool {
        self.lines > 0 && self.rest_bytes < self.line_bytes
    }

    /// Returns what the capture lacks with these systems, and what of it is not read; `others` are
    /// satellites whose ephemerides come from elsewhere.
    pub fn advice(&self, systems: &str, others: &BTreeSet<SatelliteId>) -> Option<String> {
        self.found(systems, others).advice()
    }

    fn found(&self, systems: &str, others: &BTreeSet<SatelliteId>) -> Found {
        let has = |is: &dyn Fn(&Kind) -> bool| self.frames.keys().any(is);
        let is_ubx = has(&|kind| matches!(kind, Kind::Ubx([0x02, 0x10 | 0x11 | 0x13 | 0x14 | 0x15])));
        let form = match () {
            () if is_ubx => Form::Ubx,
            () if has(&|kind| matches!(kind, Kind::Sbf(_))) => Form::Sbf,
            () if has(&|kind| matches!(kind, Kind::Rtcm(_))) => Form::Rtcm,
            () => Form::Unknown,
        };
        let is_blind = self.without_week > 0 && self.ranged.is_empty();
        let mut found = Found {
            form,
            came: if self.frames.is_empty() {
                format!("{} lines of NMEA", self.lines)
            } else {
                self.to_string()
            },
            unread: self.unread(),
            systems: systems.to_owned(),
            ranged: self.ranged.clone(),
            known: self.known.union(others).copied().collect(),
            sent: SENT
                .iter()
                .filter(|(_, kind)| self.frames.contains_key(kind))
                .map(|(letter, _)| *letter)
                .collect(),
            lacks_leap: self.lacks_leap,
            refused: self.refused.clone(),
            ..Found::default()
        };
        let ranges = [(Kind::RAWX, "RXM-RAWX"), (Kind::MEAS_EPOCH, "MeasEpoch")];
        let undated = ranges.iter().find(|(kind, _)| is_blind && self.frames.contains_key(kind));
        if let Some((_, name)) = undated {
            found.others.push(format!(
                "the week: in none of the {name} the receiver knows it, let it find the time first"
            ));
        } else if is_blind {
            found.lacks_week = true;
            found.others.push(
                "ephemerides (1019 for GPS, 1045 or 1046 for Galileo, 1042 for BeiDou), or a RINEX navigation file of that day by \
                 --nav"
                    .to_owned(),
            );
        }
        found
    }

    /// Returns what of the capture is not read, with what to send in its place.
    fn unread(&self) -> Vec<String> {
        let of = |is: &dyn Fn(&Kind) -> bool| -> Vec<String> {
            self.frames
                .iter()
                .filter(|(kind, _)| is(kind))
                .map(|(kind, count)| format!("{count} {}", frame_name(*kind)))
                .collect()
        };
        let mut unread = Vec::new();
        let mut say = |frames: Vec<String>, remedy: &str| {
            if !frames.is_empty() {
                unread.push(format!("{}: {remedy}", frames.join(", ")));
            }
        };
        say(
            of(&|kind| matches!(kind, Kind::Rtcm(1001..=1004))),
            "ranges of GPS in the old form, choose 1074 to 1077",
        );
        say(
            of(&|kind| matches!(kind, Kind::Rtcm(1009..=1012))),
            "ranges of GLONASS in the old form, choose 1084 to 1087",
        );
        say(
            of(&|kind| {
                kind.has_ranges() && matches!(kind, Kind::Rtcm(number) if (1..=3).contains(&(number % 10)))
            }),
            "no whole ranges, choose MSM4 to MSM7",
        );
        say(
            of(&|kind| matches!(kind, Kind::Ubx([0x02, 0x10 | 0x11]))),
            "of receivers before the eighth generation, which have no RXM-RAWX",
        );
        say(
            of(&|kind| *kind == Kind::Ubx([0x02, 0x14])),
            "ranges without whole milliseconds, choose RXM-RAWX",
        );
        if !self.frames.contains_key(&Kind::MEAS_EPOCH) {
            say(of(&|kind| *kind == MEAS3_RANGES), "compressed ranges, add MeasEpoch");
        }
        unread.extend(self.native.clone());
        unread
    }
}

/// Compressed ranges of Septentrio receivers.
const MEAS3_RANGES: Kind = Kind::Sbf(4109);

/// Messages with ephemerides, by the letter of their system.
const SENT: [(char, Kind); 10] = [
    ('G', Kind::Rtcm(1019)),
    ('R', Kind::Rtcm(1020)),
    ('C', Kind::Rtcm(1042)),
    ('J', Kind::Rtcm(1044)),
    ('E', Kind::Rtcm(1045)),
    ('E', Kind::Rtcm(1046)),
    ('G', Kind::Sbf(5891)),
    ('R', Kind::Sbf(4004)),
    ('E', Kind::Sbf(4002)),
    ('C', Kind::Sbf(4081)),
];

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
        Kind::Sbf(number) => match number {
            4002 => "GALNav".to_owned(),
            4004 => "GLONav".to_owned(),
            4017 => "GPSRawCA".to_owned(),
            4022 => "GALRawFNAV".to_owned(),
            4023 => "GALRawINAV".to_owned(),
            4026 => "GLORawCA".to_owned(),
            4027 => "MeasEpoch".to_owned(),
            4047 => "BDSRaw".to_owned(),
            4066 => "QZSRawL1CA".to_owned(),
            4081 => "BDSNav".to_owned(),
            4092 => "RFStatus".to_owned(),
            4109 => "Meas3Ranges".to_owned(),
            4245 => "GALAuthStatus".to_owned(),
            5891 => "GPSNav".to_owned(),
            5922 => "EndOfMeas".to_owned(),
            _ => format!("SBF {number}"),
        },
        Kind::Line | Kind::Rest => String::new(),
    }
}

/// Returns true if the first bytes contain a frame of UBX, SBF or RTCM 3.
pub fn has_frames(bytes: &[u8]) -> bool {
    const EARLY: usize = 65_536;
    let early = bytes.get(..bytes.len().min(EARLY)).unwrap_or_default();
    pieces(early).any(|piece| matches!(piece.kind, Kind::Ubx(_) | Kind::Rtcm(_) | Kind::Sbf(_)))
}
