//! Cuts of a stream, each behind the frame that completes an epoch.
//!
//! The module's own input decides when an epoch is complete. Bytes that look like the beginning of
//! a long frame may delay it. On a line they do so until it falls silent between two epochs. Here
//! the line counts as silent behind a frame of ranges that states that it is the last. When the
//! lump is replayed, the module has as long a silence.

use std::collections::BTreeSet;

use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::ephemeris::Ephemeris;
use raim_firmware::input::{Event, Input};
use raim_firmware::time::GpsTime;

use super::falsify::tow_ms;
use crate::replay::pieces::{Kind, Piece};

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
    /// Satellites with an ephemeris.
    pub(super) known: BTreeSet<SatelliteId>,
    ephemerides: Vec<Ephemeris>,
    ionosphere: Option<[f64; 8]>,
}

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
        let Self { input, ranged, known, ephemerides, ionosphere } = self;
        let mut ended = None;
        let mut hear = |event: Event<'_>| match event {
            Event::Ephemeris(ephemeris) => {
                known.insert(ephemeris.satellite());
                ephemerides.push(ephemeris);
            }
            Event::Ionosphere(Constellation::Gps, coefficients) => *ionosphere = Some(coefficients),
            Event::Ionosphere(..)
            | Event::Position(_)
            | Event::Jamming(_)
            | Event::Redated(_)
            | Event::Rivalry(_) => {}
            Event::Epoch(epoch, _) => {
                ranged.extend(epoch.satellites.iter().map(|satellite| satellite.satellite));
                ended = Some(epoch.time);
            }
        };
        input.feed(piece.bytes, 0, &mut hear);
        if is_last_of_epoch(piece) {
            input.silence(&mut hear);
        }
        let time = ended?;
        let ends_with_next = tow_ms(piece).is_some_and(|tow_ms| is_other(tow_ms, time));
        Some(Cut {
            time,
            ephemerides: std::mem::take(&mut self.ephemerides),
            ionosphere: self.ionosphere.take(),
            ends_with_next,
        })
    }

    /// Returns the number of epochs that were refused because the week was unknown.
    pub(super) fn without_week(&self) -> u32 {
        self.input.counters().epochs_without_week
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
        Kind::RAWX => true,
        Kind::Rtcm(1071..=1137) => piece.bytes.get(MORE.0).is_some_and(|byte| byte & MORE.1 == 0),
        _ => false,
    }
}
