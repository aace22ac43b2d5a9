//! Beginnings of frames inside a candidate that is incomplete.
//!
//! The beginning of a frame may be an accident whose length reaches over the good frames behind it.
//! The pin must not wait for that length to come. So every byte that comes is searched once for the
//! beginning of a frame. When the last byte of one has come, its check decides.
//!
//! [`MOST`] beginnings are remembered. If there are more, the one that ends last is dropped: it
//! holds nothing back, and is found again if the search gets there.

use heapless::Vec;

use crate::input::Format;
use crate::input::protocol::Extent;

/// How many beginnings are remembered.
const MOST: usize = 8;

/// A frame that may have begun.
#[derive(Clone, Copy, Debug)]
pub(super) struct Begun {
    /// Position of its first byte in the buffer.
    pub(super) start: usize,
    /// Position behind its last byte, if it is a frame.
    end: usize,
    /// Time at or before which its first byte came, ms.
    pub(super) came_ms: u64,
}

/// The beginnings behind the front of the buffer.
#[derive(Debug)]
pub(super) struct Nested {
    begun: Vec<Begun, MOST>,
    /// Position up to which the buffer has been searched.
    searched: usize,
    /// Time at which the byte at `searched` came, ms, if it begins something of which more is
    /// needed to tell.
    unknown_ms: Option<u64>,
}

impl Nested {
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self { begun: Vec::new(), searched: 0, unknown_ms: None }
    }

    /// Searches the bytes behind the front that have not been searched. `came_ms` returns when the
    /// byte at a position came.
    pub(super) fn search(&mut self, buffer: &[u8], front: usize, came_ms: impl Fn(usize) -> u64) {
        if self.searched <= front {
            (self.searched, self.unknown_ms) = (front + 1, None);
        }
        while let Some(rest) = buffer.get(self.searched..) {
            let Some(offset) = rest.iter().position(|&byte| Format::may_begin_with(byte)) else {
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

    /// Returns true if the last byte of one behind the front has come.
    pub(super) fn has_complete(&self, buffer: &[u8], front: usize) -> bool {
        self.begun.iter().any(|begun| begun.start > front && begun.end <= buffer.len())
    }

    /// Takes the one behind the front that was complete first, if the last byte of one has come.
    pub(super) fn take_complete(&mut self, buffer: &[u8], front: usize) -> Option<Begun> {
        let complete = self.begun.iter().filter(|begun| begun.start > front && begun.end <= buffer.len());
        let begun = *complete.min_by_key(|begun| begun.end)?;
        self.begun.retain(|other| other.start > front && other.start != begun.start);
        Some(begun)
    }

    /// Follows the buffer, of which so many bytes were removed at the beginning.
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

    /// Forgets all, because the buffer is empty.
    pub(super) fn clear(&mut self) {
        self.begun.clear();
        (self.searched, self.unknown_ms) = (0, None);
    }
}
