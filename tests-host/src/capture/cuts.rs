//! Where a stream is cut: behind the frame that completes an epoch.
//!
//! The module's own input says when an epoch is complete. Bytes that look like the beginning of a long frame may hold it
//! back; on a line they do so until it falls silent, which it does between two epochs. Here the line counts as silent behind
//! a frame of ranges that says that it is the last, and the module is left as long to notice when the lump is replayed.

use rai_core::satellite::Constellation;
use rai_firmware::ephemeris::Ephemeris;
use rai_firmware::input::{Event, Input};
use rai_firmware::time::GpsTime;

use super::content::Content;
use super::falsify::tow_ms;
use crate::replay::pieces::{Kind, Piece, pieces};

/// The bytes of one epoch.
pub(super) struct Cut {
    /// Its time tag.
    pub(super) time: GpsTime,
    /// Bytes behind the last one, up to this.
    pub(super) end: usize,
    /// Ephemerides that became known with it.
    pub(super) ephemerides: Vec<Ephemeris>,
    /// Coefficients of the ionosphere that did.
    pub(super) ionosphere: Option<[f64; 8]>,
    /// Whether only the first message of the next epoch said that it was complete.
    pub(super) ends_with_next: bool,
}

/// Returns the content of a stream and its epochs. The input takes `week` before, and the bytes of
/// `before`.
pub(super) fn cut(bytes: &[u8], before: &[u8], week: Option<u16>) -> (Content, Vec<Cut>) {
    let mut cutter =
        Cutter { input: Input::new(), cuts: Vec::new(), content: Content::default(), open: Open::default() };
    if let Some(week) = week {
        cutter.input.assume(week);
    }
    cutter.input.feed(before, 0, |_| ());
    let mut end = 0;
    for piece in pieces(bytes) {
        end += piece.bytes.len();
        cutter.content.count(&piece);
        cutter.take(&piece, end);
    }
    cutter.content.without_week = cutter.input.counters().epochs_without_week;
    cutter.content.week_corrections = cutter.input.counters().week_corrections;
    (cutter.content, cutter.cuts)
}

/// What has become known since the last epoch.
#[derive(Default)]
struct Open {
    ephemerides: Vec<Ephemeris>,
    ionosphere: Option<[f64; 8]>,
}

struct Cutter {
    input: Input,
    cuts: Vec<Cut>,
    content: Content,
    open: Open,
}

impl Cutter {
    fn take(&mut self, piece: &Piece<'_>, end: usize) {
        let Self { input, cuts, content, open } = self;
        let before = cuts.len();
        let mut hear = |event: Event<'_>| match event {
            Event::Ephemeris(ephemeris) => {
                content.known.insert(ephemeris.satellite());
                open.ephemerides.push(ephemeris);
            }
            Event::Ionosphere(Constellation::Gps, coefficients) => open.ionosphere = Some(coefficients),
            Event::Ionosphere(..) | Event::Position(_) | Event::Jamming(_) | Event::Redated(_) => {}
            Event::Epoch(epoch, _) => {
                content.ranged.extend(epoch.satellites.iter().map(|satellite| satellite.satellite));
                let Open { ephemerides, ionosphere } = std::mem::take(open);
                let ends_with_next = tow_ms(piece).is_some_and(|tow_ms| is_other(tow_ms, epoch.time));
                cuts.push(Cut { time: epoch.time, end, ephemerides, ionosphere, ends_with_next });
            }
        };
        input.feed(piece.bytes, 0, &mut hear);
        if is_last_of_epoch(piece) {
            input.silence(&mut hear);
        }
        // Two that were held back together are judged together, and the last of them is what is said.
        if cuts.len() > before + 1 {
            cuts.drain(before..cuts.len() - 1);
        }
    }
}

/// Whether a time of week is not that of an epoch, to the tenth of a second that systems may be apart.
fn is_other(tow_ms: u32, epoch: GpsTime) -> bool {
    GpsTime::nearest(tow_ms, epoch).since_ms(epoch).abs() > 100
}

/// Whether a frame of ranges says that none of the same instant follows.
fn is_last_of_epoch(piece: &Piece<'_>) -> bool {
    /// The multiple message bit stands in the tenth byte of the frame, second from its low end.
    const MORE: (usize, u8) = (9, 0b10);
    match piece.kind {
        Kind::RAWX => true,
        Kind::Rtcm(1071..=1137) => piece.bytes.get(MORE.0).is_some_and(|byte| byte & MORE.1 == 0),
        _ => false,
    }
}
