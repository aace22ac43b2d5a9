//! Beginnings of frames inside a candidate that is incomplete.
//!
//! Bytes may look like the header of a frame by chance. The length that they announce then covers
//! the good frames behind them, and the pin must not wait for that many bytes. Every received byte
//! is therefore searched once for the beginning of a frame. When the last byte of such a frame has
//! come, its check decides.
//!
//! [`MOST`] beginnings are stored. If there are more, the one that ends last is dropped. This
//! delays no other frame, and the search finds the dropped one again if it arrives there.

use heapless::Vec;

use crate::input::Format;
use crate::input::protocol::Extent;

/// Number of stored beginnings.
const MOST: usize = 8;

/// A frame that may have begun.
#[derive(Clone, Copy, Debug)]
pub(super) struct Begun {
    /// Position of its first byte in the buffer.
    pub(super) start: usize,
    /// Position behind its last byte, if it is a frame.
    end: usize,
    /// Time no later than the arrival of its first byte, ms.
    pub(super) came_ms: u64,
}

/// Beginnings behind the front of the buffer.
#[derive(Debug)]
pub(super) struct Nested {
    begun: Vec<Begun, MOST>,
    /// Position up to which the buffer has been searched.
    searched: usize,
    /// Arrival of the byte at `searched`, ms, if it may begin a frame and the next bytes decide.
    unknown_ms: Option<u64>,
}

impl Nested {
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self { begun: Vec::new(), searched: 0, unknown_ms: None }
    }

    /// Searches the new bytes behind the front. `came_ms` returns the arrival of the byte at a
    /// position.
    pub(super) fn search(&mut self, buffer: &[u8], front: usize, came_ms: impl Fn(usize) -> u64) {
        if self.searched <= front {
            (self.searched, self.unknown_ms) = (front + 1, None);
        }
        while let Some(rest) = buffer.get(self.searched..) {
            let Some(offset) = beginning_in(rest) else {
                (self.searched, self.unknown_ms) = (buffer.len(), None);
                return;
            };
            let start = self.searched + offset;
            let known_ms = self.unknown_ms.take().filter(|_| offset == 0);
            let came_ms = known_ms.unwrap_or_else(|| came_ms(start));
            match Format::at(rest.get(offset..).unwrap_or_default()) {
                Some((_, Extent::Unknown)) => {
                    (self.searched, self.unknown_ms) = (start, Some(came_ms));
                    return;
                }
                Some((_, Extent::Bytes(length))) => {
                    self.remember(Begun { start, end: start + length, came_ms }, front);
                }
                Some((_, Extent::NoFrame)) | None => {}
            }
            self.searched = start + 1;
        }
    }

    fn remember(&mut self, begun: Begun, front: usize) {
        self.begun.retain(|known| known.start > front);
        let Err(begun) = self.begun.push(begun) else { return };
        if let Some(last) = self.begun.iter_mut().max_by_key(|known| known.end)
            && begun.end < last.end
        {
            *last = begun;
        }
    }

    /// Returns true if a frame that begins behind the front is complete.
    pub(super) fn has_complete(&self, buffer: &[u8], front: usize) -> bool {
        self.begun.iter().any(|begun| begun.start > front && begun.end <= buffer.len())
    }

    /// Takes the frame behind the front that was complete first, if one is complete.
    pub(super) fn take_complete(&mut self, buffer: &[u8], front: usize) -> Option<Begun> {
        let complete = self.begun.iter().filter(|begun| begun.start > front && begun.end <= buffer.len());
        let begun = *complete.min_by_key(|begun| begun.end)?;
        self.begun.retain(|other| other.start > front && other.start != begun.start);
        Some(begun)
    }

    /// Adjusts positions after this number of bytes was removed at the beginning of the buffer.
    pub(super) fn shift(&mut self, removed: usize) {
        self.begun.retain(|begun| begun.start >= removed);
        for begun in &mut self.begun {
            (begun.start, begun.end) = (begun.start - removed, begun.end - removed);
        }
        if self.searched < removed {
            self.unknown_ms = None;
        }
        self.searched = self.searched.saturating_sub(removed);
    }

    /// Discards all beginnings, because the buffer is empty.
    pub(super) fn clear(&mut self) {
        self.begun.clear();
        (self.searched, self.unknown_ms) = (0, None);
    }
}

/// Returns the position of the first byte with which a frame may begin, four bytes at a time.
fn beginning_in(bytes: &[u8]) -> Option<usize> {
    let (words, _) = bytes.as_chunks::<4>();
    let has_none = |word: &&[u8; 4]| !Format::may_begin_within(u32::from_le_bytes(**word));
    let before = 4 * words.iter().take_while(has_none).count();
    // The last bytes once more with those before them, as a word.
    if before == words.as_flattened().len() && bytes.last_chunk().as_ref().is_some_and(has_none) {
        return None;
    }
    let rest = bytes.get(before..).unwrap_or_default();
    rest.iter().position(|&byte| Format::may_begin_with(byte)).map(|position| before + position)
}
