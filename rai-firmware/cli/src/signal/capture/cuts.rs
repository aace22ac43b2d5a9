//! Cuts of a stream, each behind the frame that completes an epoch.
//!
//! The module's own input decides when an epoch is complete. Bytes that look like the beginning of
//! a long frame may delay it. On a line they do so until it falls silent between two epochs. Here
//! the line counts as silent behind a frame of ranges that states that it is the last, before
//! ranges that are tagged more than [`SILENCE_MS`] later, and at the end. When the lump is
//! replayed, the module has as long a silence.

use std::collections::{BTreeMap, BTreeSet};

use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::ephemeris::Ephemeris;
use raim_firmware::input::{Event, Input};
use raim_firmware::time::{GpsTime, WEEK_MS};

use super::falsify::{bits, payload, sbf_satellite, tow_ms, ubx_satellite};
use crate::signal::pieces::{Kind, Piece};

/// An epoch that ends with a piece.
pub(super) struct Cut {
    /// Time tag of the epoch.
    pub(super) time: GpsTime,
    /// Ephemerides that became known with it.
    pub(super) ephemerides: Vec<Ephemeris>,
    /// GPS coefficients of the ionosphere that became known with it.
    pub(super) ionosphere: Option<[f64; 8]>,
    /// True if only the first message of the next epoch showed that this one was complete.
    pub(super) ends_with_next: bool,
}

/// Finder of the epochs of a stream, piece by piece.
#[derive(Default)]
pub(super) struct Cutter {
    input: Input,
    /// Satellites with ranges.
    pub(super) ranged: BTreeSet<SatelliteId>,
    /// Those of the last epoch, in its order.
    ranged_last: Vec<SatelliteId>,
    /// Satellites with an ephemeris.
    pub(super) known: BTreeSet<SatelliteId>,
    /// Satellites of which ephemerides were refused, with their number.
    pub(super) refused: BTreeMap<SatelliteId, u32>,
    ephemerides: Vec<Ephemeris>,
    ionosphere: Option<[f64; 8]>,
    /// Tag of the ranges that opened the epoch under way.
    opened: Option<Tag>,
}

/// Tag of a frame of ranges.
#[derive(Clone, Copy)]
struct Tag {
    kind: Kind,
    /// Bytes with the message number and the station.
    station: [u8; 3],
    /// Time of week, ms of GPS time.
    tow_ms: u32,
}

impl Tag {
    fn of(piece: &Piece<'_>) -> Option<Self> {
        // SBF has its CRC there, and no station.
        let station = match piece.kind {
            Kind::Sbf(_) => [0; 3],
            _ => *piece.bytes.get(3..)?.first_chunk()?,
        };
        Some(Self { kind: piece.kind, station, tow_ms: tow_ms(piece)? })
    }
}

/// Silence after which the module completes an open epoch, ms.
const SILENCE_MS: u32 = 500;

impl Cutter {
    /// Returns a cutter that takes the week of the first epoch as given.
    pub(super) fn in_week(week: u16) -> Self {
        let mut cutter = Self::default();
        cutter.input.assume(week);
        cutter
    }

    /// Returns a cutter that has read the frames in `week`, which state the week.
    pub(super) fn after(week: &[u8]) -> Self {
        let mut cutter = Self::default();
        cutter.input.feed(week, 0, |_| ());
        cutter
    }

    /// Returns the number of times that ephemerides have corrected the week.
    pub(super) fn week_corrections(&self) -> u32 {
        self.input.counters().week_corrections
    }

    /// Takes the next piece; returns the epoch that ends with it. If two epochs were delayed
    /// together, they are one here, because the module reports only the last verdict.
    pub(super) fn take(&mut self, piece: &Piece<'_>) -> Option<Cut> {
        let refused = self.input.counters().ephemerides_invalid;
        let time = self.receive(|input, receive| {
            input.feed(piece.bytes, 0, &mut *receive);
            if is_last_of_epoch(piece) {
                input.silence(receive);
            }
        });
        if self.input.counters().ephemerides_invalid != refused
            && let Some(satellite) = satellite_of(piece)
        {
            *self.refused.entry(satellite).or_default() += 1;
        }
        if !self.input.has_open_epoch() {
            self.opened = None;
        } else if time.is_some() || self.opened.is_none() {
            self.opened = Tag::of(piece);
        }
        Some(self.cut(time?, tow_ms(piece)))
    }

    /// Returns the epoch that the silence before the next piece completes, by the tags of both.
    pub(super) fn silence_before(&mut self, piece: &Piece<'_>) -> Option<Cut> {
        let opened = self.opened?;
        let tag = Tag::of(piece).filter(|tag| (tag.kind, tag.station) == (opened.kind, opened.station))?;
        let passed_ms = (tag.tow_ms + WEEK_MS - opened.tow_ms) % WEEK_MS;
        if passed_ms > SILENCE_MS { self.silence() } else { None }
    }

    /// Returns the epoch that a silence completes.
    pub(super) fn silence(&mut self) -> Option<Cut> {
        self.opened = None;
        let time = self.receive(|input, receive| {
            input.silence(&mut *receive);
            input.end_epoch(receive);
        });
        Some(self.cut(time?, None))
    }

    /// Collects what the input tells; returns the time of the last epoch that it completes.
    fn receive(&mut self, act: impl FnOnce(&mut Input, &mut dyn FnMut(Event<'_>))) -> Option<GpsTime> {
        let Self { input, ranged, ranged_last, known, ephemerides, ionosphere, .. } = self;
        let mut ended = None;
        act(input, &mut |event| match event {
            Event::Ephemeris(ephemeris) => {
                known.insert(ephemeris.satellite());
                ephemerides.push(ephemeris);
            }
            Event::Ionosphere(Constellation::Gps, coefficients) => *ionosphere = Some(coefficients),
            Event::Epoch(epoch, _) => {
                let now = epoch.satellites.iter().map(|satellite| satellite.satellite);
                // Few epochs bring another satellite.
                if !now.clone().eq(ranged_last.iter().copied()) {
                    ranged.extend(now.clone());
                    ranged_last.clear();
                    ranged_last.extend(now);
                }
                ended = Some(epoch.time);
            }
            _ => {}
        });
        ended
    }

    /// Returns the cut of an epoch that was complete with ranges of this time of week.
    fn cut(&mut self, time: GpsTime, tow_ms: Option<u32>) -> Cut {
        Cut {
            time,
            ephemerides: std::mem::take(&mut self.ephemerides),
            ionosphere: self.ionosphere.take(),
            ends_with_next: tow_ms.is_some_and(|tow_ms| is_other(tow_ms, time)),
        }
    }

    /// Returns true if messages of GLONASS came and the leap seconds are not known.
    pub(super) fn lacks_leap(&self) -> bool {
        self.input.leap_second().is_none() && self.input.counters().leap_unknown > 0
    }

    /// Returns the number of epochs that were refused because the week was unknown.
    pub(super) fn without_week(&self) -> u32 {
        self.input.counters().epochs_without_week
    }
}

/// Returns the satellite of a frame with an ephemeris, or with navigation bits.
fn satellite_of(piece: &Piece<'_>) -> Option<SatelliteId> {
    let payload = payload(piece);
    match piece.kind {
        Kind::SFRBX => ubx_satellite(*payload.first()?, *payload.get(1)?),
        Kind::Rtcm(number) => {
            let (letter, width) = match number {
                1019 => ('G', 6),
                1020 => ('R', 6),
                1042 => ('C', 6),
                1044 => ('J', 4),
                1045 | 1046 => ('E', 6),
                _ => return None,
            };
            SatelliteId::from_name(letter, bits(payload, 12, width)? as u8)
        }
        Kind::Sbf(5891 | 4002 | 4004 | 4081 | 4017 | 4022 | 4023 | 4026 | 4047 | 4066) => {
            sbf_satellite(*payload.first()?)
        }
        Kind::Ubx(_) | Kind::Sbf(_) | Kind::Line | Kind::Rest => None,
    }
}

/// Returns true if a time of week is not that of an epoch, to the tenth of a second by which
/// systems may differ.
fn is_other(tow_ms: u32, epoch: GpsTime) -> bool {
    GpsTime::nearest(tow_ms, epoch).since_ms(epoch).abs() > 100
}

/// Returns true if a frame of ranges states that none of the same instant follows.
fn is_last_of_epoch(piece: &Piece<'_>) -> bool {
    /// The multiple message bit is in the tenth byte of the frame, second from its low end.
    const MORE: (usize, u8) = (9, 0b10);
    match piece.kind {
        Kind::RAWX | Kind::MEAS_EPOCH => true,
        Kind::Rtcm(1071..=1137) => piece.bytes.get(MORE.0).is_some_and(|byte| byte & MORE.1 == 0),
        _ => false,
    }
}
