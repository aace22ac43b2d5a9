//! A byte ring between an interrupt and the main loop.
//!
//! One side writes and one side reads; neither waits. If a byte finds no room, it is dropped and
//! counted, and the byte before the gap becomes NUL: a checksum of text, which is a sum modulo 2,
//! does not notice that two equal characters are missing. `written` and `read` run freely and wrap
//! with the machine word, so that their difference is the fill level and no slot is wasted.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `N` | capacity, a power of two | bytes |
//! | `written − read` | fill level | bytes |
//! | `peak` | highest fill level seen by a read | bytes |
//! | `dropped` | bytes lost because the ring was full | bytes |
//!
//! Assumes one writer and one reader. The bytes are atomics: a second writer by mistake would
//! garble the stream, but could not corrupt memory. The module therefore needs no `unsafe`.

use core::sync::atomic::{AtomicU8, AtomicU32, AtomicUsize, Ordering};

/// A ring of `N` bytes for one writer and one reader in different contexts.
pub struct Ring<const N: usize> {
    bytes: [AtomicU8; N],
    written: AtomicUsize,
    read: AtomicUsize,
    peak: AtomicUsize,
    dropped: AtomicU32,
}

impl<const N: usize> Ring<N> {
    /// Returns an empty ring.
    pub const fn new() -> Self {
        const { assert!(N.is_power_of_two(), "the free-running positions wrap only over a power of two") };
        Self {
            bytes: [const { AtomicU8::new(0) }; N],
            written: AtomicUsize::new(0),
            read: AtomicUsize::new(0),
            peak: AtomicUsize::new(0),
            dropped: AtomicU32::new(0),
        }
    }

    /// Returns the number of bytes to read.
    pub fn len(&self) -> usize {
        self.written.load(Ordering::Acquire).wrapping_sub(self.read.load(Ordering::Acquire))
    }

    /// Returns true if no byte waits.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the number of bytes lost because the ring was full; it saturates.
    pub fn dropped(&self) -> u32 {
        self.dropped.load(Ordering::Relaxed)
    }

    /// Returns the largest number of bytes that have waited at once. Only a read lowers the level,
    /// so that measuring before each read misses no peak.
    pub fn high_water(&self) -> usize {
        self.peak.load(Ordering::Relaxed).max(self.len())
    }

    /// Appends one byte (writer's side), or counts it as dropped and replaces the last one by NUL, so
    /// that no line is read across the gap. Returns true if it fitted.
    pub fn push(&self, byte: u8) -> bool {
        let written = self.written.load(Ordering::Relaxed);
        let has_room = written.wrapping_sub(self.read.load(Ordering::Acquire)) < N;
        let (next, byte) = if has_room { (written.wrapping_add(1), byte) } else { (written, 0) };
        if let Some(slot) = self.slot(next.wrapping_sub(1)) {
            slot.store(byte, Ordering::Relaxed);
        }
        self.written.store(next, Ordering::Release);
        if !has_room {
            self.drop_whole(1);
        }
        has_room
    }

    /// Appends all of `bytes` or none (writer's side), so that a reader never sees half a sentence.
    ///
    /// Counts nothing, because the caller may try again. A caller that gives up calls
    /// [`Ring::drop_whole`], which counts.
    pub fn offer(&self, bytes: &[u8]) -> bool {
        let written = self.written.load(Ordering::Relaxed);
        let fill = written.wrapping_sub(self.read.load(Ordering::Acquire));
        if bytes.len() > N.saturating_sub(fill) {
            return false;
        }
        for (offset, &byte) in bytes.iter().enumerate() {
            if let Some(slot) = self.slot(written.wrapping_add(offset)) {
                slot.store(byte, Ordering::Relaxed);
            }
        }
        self.written.store(written.wrapping_add(bytes.len()), Ordering::Release);
        true
    }

    /// Appends like [`Ring::offer`] (writer's side), and counts `bytes` as dropped if there was no
    /// room.
    pub fn push_whole(&self, bytes: &[u8]) -> bool {
        let fitted = self.offer(bytes);
        if !fitted {
            self.drop_whole(bytes.len());
        }
        fitted
    }

    /// Counts `count` bytes as lost (writer's side).
    pub fn drop_whole(&self, count: usize) {
        let before = self.dropped.load(Ordering::Relaxed);
        let count = u32::try_from(count).unwrap_or(u32::MAX);
        self.dropped.store(before.saturating_add(count), Ordering::Relaxed);
    }

    /// Takes the oldest byte (reader's side).
    pub fn pop(&self) -> Option<u8> {
        let mut byte = [0];
        (self.read_into(&mut byte) == 1).then_some(byte[0])
    }

    /// Moves the oldest bytes into `chunk` (reader's side) and returns their number.
    pub fn read_into(&self, chunk: &mut [u8]) -> usize {
        let (read, fill) = self.waiting();
        let count = fill.min(chunk.len());
        for (offset, byte) in chunk.iter_mut().take(count).enumerate() {
            if let Some(slot) = self.slot(read.wrapping_add(offset)) {
                *byte = slot.load(Ordering::Relaxed);
            }
        }
        self.read.store(read.wrapping_add(count), Ordering::Release);
        count
    }

    /// Drops all waiting bytes and returns their number (reader's side).
    pub(crate) fn discard(&self) -> usize {
        let (read, fill) = self.waiting();
        self.read.store(read.wrapping_add(fill), Ordering::Release);
        fill
    }

    /// Returns the position of the oldest byte and the number of bytes that wait, and notes the
    /// largest number (reader's side).
    fn waiting(&self) -> (usize, usize) {
        let read = self.read.load(Ordering::Relaxed);
        let fill = self.written.load(Ordering::Acquire).wrapping_sub(read);
        if fill > self.peak.load(Ordering::Relaxed) {
            self.peak.store(fill, Ordering::Relaxed);
        }
        (read, fill)
    }

    /// Returns the position of the next byte written (writer's side).
    pub(crate) fn written(&self) -> usize {
        self.written.load(Ordering::Relaxed)
    }

    /// Returns the position of the next byte read (reader's side).
    pub(crate) fn read_position(&self) -> usize {
        self.read.load(Ordering::Relaxed)
    }

    /// Returns the number of free bytes.
    pub fn room(&self) -> usize {
        N.saturating_sub(self.len())
    }

    fn slot(&self, position: usize) -> Option<&AtomicU8> {
        self.bytes.get(position & (N - 1))
    }
}

impl<const N: usize> Default for Ring<N> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;

    #[test]
    fn bytes_leave_in_the_order_they_came_across_the_seam() {
        let ring = Ring::<8>::new();
        let mut have = Vec::new();
        for round in 0..5_u8 {
            for byte in 0..5 {
                assert!(ring.push(round * 5 + byte));
            }
            let mut chunk = [0; 8];
            let count = ring.read_into(&mut chunk);
            have.extend_from_slice(&chunk[..count]);
        }
        let want: Vec<u8> = (0..25).collect();
        assert_eq!(have, want);
    }

    #[test]
    fn full_ring_drops_the_new_byte_counts_it_and_marks_the_gap() {
        let ring = Ring::<4>::new();
        let have: Vec<bool> = b"abcdef".iter().map(|byte| ring.push(*byte)).collect();
        assert_eq!(have, [true, true, true, true, false, false]);
        assert_eq!(ring.dropped(), 2);
        let have: Vec<u8> = std::iter::from_fn(|| ring.pop()).collect();
        assert_eq!(have, b"abc\0", "what was stored first must survive the overrun");
    }

    #[test]
    fn sentence_that_does_not_fit_leaves_no_fragment() {
        let ring = Ring::<16>::new();
        assert!(ring.push_whole(b"0123456789"));
        assert!(!ring.push_whole(b"abcdefgh"));
        assert!(ring.push_whole(b"ABCDEF"));
        let mut chunk = [0; 32];
        let count = ring.read_into(&mut chunk);
        assert_eq!(&chunk[..count], b"0123456789ABCDEF");
        assert_eq!(ring.dropped(), 8);
    }

    #[test]
    fn highest_fill_is_remembered_and_the_present_one_counts() {
        let ring = Ring::<8>::new();
        for (bytes, taken, want) in [(3, 3, 3), (5, 2, 5), (1, 0, 5), (3, 0, 7)] {
            (0..bytes).for_each(|byte| assert!(ring.push(byte)));
            ring.read_into(&mut [0; 8][..taken]);
            assert_eq!(ring.high_water(), want, "after {bytes} more");
        }
    }

    #[test]
    fn offer_that_failed_is_not_yet_a_loss() {
        let ring = Ring::<2>::new();
        assert!(!ring.offer(b"abc"));
        assert_eq!((ring.dropped(), ring.len()), (0, 0));
    }

    #[test]
    fn positions_survive_the_wrap_of_the_machine_word() {
        let ring = Ring::<8>::new();
        ring.written.store(usize::MAX - 2, Ordering::Relaxed);
        ring.read.store(usize::MAX - 2, Ordering::Relaxed);
        assert!(ring.push_whole(b"wrapped"));
        assert_eq!(ring.len(), 7);
        let mut chunk = [0; 7];
        assert_eq!(ring.read_into(&mut chunk), 7);
        assert_eq!(&chunk, b"wrapped");
    }

    #[test]
    fn two_threads_lose_nothing_that_was_accepted() {
        const COUNT: u32 = if cfg!(miri) { 500 } else { 200_000 };
        static RING: Ring<64> = Ring::new();
        let writer = std::thread::spawn(|| {
            for number in 0..COUNT {
                while !RING.offer(&[number as u8]) {
                    std::thread::yield_now();
                }
            }
        });
        for number in 0..COUNT {
            let byte = loop {
                match RING.pop() {
                    Some(byte) => break byte,
                    None => std::thread::yield_now(),
                }
            };
            assert_eq!(byte, number as u8, "at byte {number}");
        }
        writer.join().expect("the writer ends");
    }
}
