//! The transport layer: finds the frames of all wire formats in one stream of bytes, and checks
//! each once.
//!
//! Bytes may look like the header of a frame by chance. The length that they announce then covers
//! good frames. No byte is therefore dropped before it has been searched. If a candidate fails,
//! only its first byte is dropped, and the search restarts behind it. An incomplete candidate ends
//! as soon as a frame inside it is complete and passes its check ([`nested`]).
//!
//! In a stream that consists only of headers, every byte would be checked a thousand times. Each
//! received byte therefore adds credit for [`CREDIT_PER_BYTE`] bytes of checking. The credit is at
//! most [`CREDIT_MOST`], enough for a dozen of the longest RTCM frames that fail in a row, or for three
//! of the longest frames of any format. A
//! candidate that exceeds the credit is skipped and counted. Frames inside a candidate are checked
//! as long as [`CREDIT_RESERVE`] remains for the candidates themselves.

mod nested;

use heapless::Vec;

use self::nested::{Begun, Nested};
use super::protocol::{Extent, Frame};
use super::{Counters, Format};
use crate::counters::{count, count_many};

/// Room behind the longest frame, bytes, so that waiting bytes must rarely move to the front.
const SPARE: usize = if Format::LONGEST < 2048 { Format::LONGEST } else { 128 };

/// Size of the buffer, bytes.
const CAPACITY: usize = Format::LONGEST + SPARE;

/// Credit that each received byte adds, bytes of checking.
const CREDIT_PER_BYTE: usize = 4;
/// Largest credit, bytes of checking: for a false beginning of the longest frame, for the true one
/// behind it, and for whatever fills the buffer.
const CREDIT_MOST: usize =
    if Format::LONGEST > 6 * 1029 { 2 * Format::LONGEST + CAPACITY } else { 12 * 1029 };
/// Credit that frames inside a candidate leave for the candidates, bytes of checking.
const CREDIT_RESERVE: usize = CREDIT_MOST / 2;
const _: () = assert!(CREDIT_RESERVE >= Format::LONGEST);

/// Bytes that may be part of a frame.
#[derive(Debug)]
pub(super) struct Framer {
    buffer: Vec<u8, CAPACITY>,
    /// Position of the search in the buffer; the bytes before it are done.
    front: usize,
    /// Length of the frame that was returned last, still at the front.
    handed: usize,
    /// Position of the first byte that came at `fresh_ms`; bytes before it came at `old_ms` or
    /// later.
    fresh: usize,
    fresh_ms: u64,
    old_ms: u64,
    credit: usize,
    nested: Nested,
    /// Position of an incomplete candidate, and the length of the buffer that completes it.
    awaited: (usize, usize),
}

/// The candidate at the front of the buffer.
enum Front {
    /// It stays incomplete while the buffer is shorter than this.
    Incomplete(usize),
    Complete(Format, usize),
    NoFrame,
}

impl Framer {
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self {
            buffer: Vec::new(),
            front: 0,
            handed: 0,
            fresh: 0,
            fresh_ms: 0,
            old_ms: 0,
            credit: CREDIT_MOST,
            nested: Nested::new(),
            awaited: (0, 0),
        }
    }

    /// Takes as many bytes as fit, which came at one instant, and returns the others. At least one
    /// fits if [`Framer::next`] has been called until it returned `None`.
    pub(super) fn take<'b>(&mut self, bytes: &'b [u8], came_ms: u64, counters: &mut Counters) -> &'b [u8] {
        self.make_room(bytes.len(), counters);
        let room = self.buffer.capacity() - self.buffer.len();
        let (now, later) = bytes.split_at_checked(room).unwrap_or((bytes, &[]));
        // If every waiting byte came at `fresh_ms`, that time becomes `old_ms`.
        if self.front >= self.fresh {
            self.old_ms = self.fresh_ms;
        }
        self.fresh = self.buffer.len();
        if self.front == self.fresh {
            self.old_ms = came_ms;
        }
        self.fresh_ms = came_ms;
        // The length is at most the room.
        let _ = self.buffer.extend_from_slice(now);
        self.credit = CREDIT_MOST.min(self.credit + CREDIT_PER_BYTE * now.len());
        later
    }

    /// Moves the waiting bytes to the beginning of the buffer if the new ones would not fit behind
    /// them.
    fn make_room(&mut self, wanted: usize, counters: &mut Counters) {
        if self.buffer.len() + wanted <= self.buffer.capacity() {
            return;
        }
        if self.front == 0 && self.buffer.is_full() {
            // No candidate fills the buffer, so that this happens only if the caller never takes
            // frames.
            count(&mut counters.bytes_skipped);
            self.front = 1;
        }
        let left = self.buffer.len().saturating_sub(self.front);
        let from = self.front.min(self.buffer.len());
        self.buffer.copy_within(from.., 0);
        self.buffer.truncate(left);
        self.fresh = self.fresh.saturating_sub(self.front);
        self.nested.shift(self.front);
        self.front = 0;
    }

    /// Returns true if [`Framer::next`] would find more than before. Bytes come a few at a time. To
    /// call [`Framer::next`] after every few bytes would cost half as much as reading the message.
    pub(super) fn is_worth_a_look(&mut self) -> bool {
        if self.handed > 0 {
            return true;
        }
        // The length of a candidate is computed only once, and not for every few bytes.
        if self.awaited.0 != self.front || self.buffer.len() >= self.awaited.1 {
            let Front::Incomplete(length) = self.candidate() else { return true };
            self.awaited = (self.front, length);
        }
        self.search();
        self.nested.has_complete(&self.buffer, self.front)
    }

    /// Returns the next frame that passes its check, with its format. The frame before it is
    /// released.
    ///
    /// With `is_silent` no more bytes will come to complete a candidate: an incomplete one is
    /// counted as cut, and its bytes are searched.
    pub(super) fn next(&mut self, is_silent: bool, counters: &mut Counters) -> Option<(Format, Frame<'_>)> {
        self.front += core::mem::take(&mut self.handed);
        let (format, length) = loop {
            match self.candidate() {
                Front::Complete(format, length) => {
                    if self.passes(format, length, counters) {
                        break (format, length);
                    }
                }
                Front::Incomplete(_) if self.is_empty() || !is_silent => {
                    if let Some(found) = self.inner(counters) {
                        break found;
                    }
                    self.settle();
                    return None;
                }
                Front::Incomplete(_) => count(&mut counters.frames_cut),
                Front::NoFrame => {}
            }
            self.resynchronise(counters);
        };
        count(&mut counters.frames);
        self.handed = length;
        let came_ms = self.came_ms(self.front);
        let bytes = self.buffer.get(self.front..self.front + length)?;
        Some((format, Frame { bytes, came_ms }))
    }

    /// Returns a time no later than the arrival of the byte at a position, ms. The byte may have
    /// come later, but not earlier.
    fn came_ms(&self, position: usize) -> u64 {
        if position >= self.fresh { self.fresh_ms } else { self.old_ms }
    }

    /// Searches an incomplete candidate for the beginnings of frames.
    fn search(&mut self) {
        let Self { buffer, front, fresh, fresh_ms, old_ms, nested, .. } = self;
        nested.search(buffer, *front, |at| if at >= *fresh { *fresh_ms } else { *old_ms });
    }

    /// Ends an incomplete candidate in which a frame is complete and passes its check, and moves
    /// the front to that frame.
    fn inner(&mut self, counters: &mut Counters) -> Option<(Format, usize)> {
        self.search();
        while let Some(Begun { start, came_ms, .. }) = self.nested.take_complete(&self.buffer, self.front) {
            let bytes = self.buffer.get(start..).unwrap_or_default();
            let Some((format, Extent::Bytes(length))) = Format::at(bytes) else { continue };
            // A frame that exceeds the credit becomes a candidate itself if the search arrives
            // there.
            let credit = self.credit.saturating_sub(length);
            let Some(frame) = bytes.get(..length).filter(|_| credit >= CREDIT_RESERVE) else { continue };
            self.credit = credit;
            if format.check(frame) {
                count(&mut counters.frames_cut);
                count_many(&mut counters.bytes_skipped, start - self.front);
                (self.front, self.old_ms) = (start, came_ms);
                return Some((format, length));
            }
        }
        None
    }

    /// Discards all waiting bytes.
    pub(super) fn forget(&mut self, counters: &mut Counters) {
        count_many(&mut counters.bytes_skipped, self.waiting().len().saturating_sub(self.handed));
        (self.front, self.handed, self.fresh) = (0, 0, 0);
        self.awaited = (0, 0);
        self.buffer.clear();
        self.nested.clear();
    }

    fn waiting(&self) -> &[u8] {
        self.buffer.get(self.front..).unwrap_or_default()
    }

    /// Returns true if no byte may belong to a frame that is not complete.
    pub(super) fn is_empty(&self) -> bool {
        self.front >= self.buffer.len()
    }

    /// Restarts an empty buffer.
    fn settle(&mut self) {
        if self.is_empty() {
            self.buffer.clear();
            self.nested.clear();
            (self.front, self.fresh) = (0, 0);
            self.awaited = (0, 0);
        }
    }

    fn candidate(&self) -> Front {
        let waiting = self.waiting();
        match Format::at(waiting) {
            Some((format, Extent::Bytes(length))) if length <= waiting.len() => {
                Front::Complete(format, length)
            }
            Some((_, Extent::Bytes(length))) => Front::Incomplete(self.front + length),
            Some((_, Extent::Unknown)) => Front::Incomplete(self.buffer.len() + 1),
            Some((_, Extent::NoFrame)) | None => Front::NoFrame,
        }
    }

    /// Checks a complete candidate, if the credit suffices.
    fn passes(&mut self, format: Format, length: usize, counters: &mut Counters) -> bool {
        let Some(credit) = self.credit.checked_sub(length) else {
            count(&mut counters.frames_unchecked);
            return false;
        };
        self.credit = credit;
        let holds = format.check(self.waiting().get(..length).unwrap_or_default());
        if !holds {
            count(&mut counters.crc_failures);
        }
        holds
    }

    /// Drops the first byte and all up to the next one that may begin a frame.
    fn resynchronise(&mut self, counters: &mut Counters) {
        let waiting = self.waiting();
        let next = waiting.iter().skip(1).position(|&byte| Format::may_begin_with(byte));
        let skipped = next.map_or(waiting.len(), |position| position + 1);
        count_many(&mut counters.bytes_skipped, skipped);
        self.front += skipped;
    }
}

#[cfg(test)]
mod tests;
