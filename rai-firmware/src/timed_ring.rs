//! Bytes between an interrupt and the loop, each with its arrival time.
//!
//! The loop may be late, so that the age of a byte must count from its arrival and not from its
//! reading. The writer notes the time whenever [`GRAIN_MS`] have passed since its last note. A byte
//! takes the time of the note before it. It never counts as younger than it is. It may count as
//! older, by less than [`GRAIN_MS`] while notes are free.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `N` | capacity, a power of two | bytes |
//! | `M` | notes, a power of two; while none is free, bytes take the time of the last note | – |
//!
//! Bytes that have waited for longer than [`OLDEST_MS`] are useless, and after a lost byte the
//! waiting ones are fragments. In both cases [`TimedRing::take`] drops all waiting bytes and
//! returns [`Taken::Lost`].

use core::sync::atomic::{AtomicU32, AtomicUsize, Ordering};

use crate::ring::Ring;

/// Resolution of the arrival time of a byte, ms.
pub const GRAIN_MS: u32 = 4;

/// Longest wait of a byte, ms: less than the second between two epochs.
pub const OLDEST_MS: u64 = 500;

/// A note: bytes from this position on came at this time or later.
struct Note {
    position: AtomicUsize,
    ms: AtomicU32,
}

/// A ring of `N` bytes and `M` notes, for one writer (an interrupt) and one reader (the loop).
pub struct TimedRing<const N: usize, const M: usize> {
    bytes: Ring<N>,
    notes: [Note; M],
    noted: AtomicUsize,
    passed: AtomicUsize,
    /// Time of the last note, ms (writer's side).
    last_ms: AtomicU32,
    /// Time of the note that applies to the next byte, ms (reader's side).
    now_ms: AtomicU32,
    /// Lost bytes that the reader has handled.
    known_lost: AtomicU32,
    /// Bytes that were dropped after a lost one, or because they were old.
    given_up: AtomicU32,
}

/// Result of a read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// No byte waits.
    Nothing,
    /// Bytes that came at this time or later: by less than [`GRAIN_MS`] while notes are free.
    Bytes {
        /// Number of bytes.
        count: usize,
        /// Arrival time, ms since start.
        came_ms: u64,
    },
    /// Bytes are missing before the next ones.
    Lost,
}

impl<const N: usize, const M: usize> TimedRing<N, M> {
    /// Returns an empty ring.
    pub const fn new() -> Self {
        const { assert!(M.is_power_of_two(), "positions wrap only over a power of two") };
        Self {
            bytes: Ring::new(),
            notes: [const { Note { position: AtomicUsize::new(0), ms: AtomicU32::new(0) } }; M],
            noted: AtomicUsize::new(0),
            passed: AtomicUsize::new(0),
            last_ms: AtomicU32::new(0),
            now_ms: AtomicU32::new(0),
            known_lost: AtomicU32::new(0),
            given_up: AtomicU32::new(0),
        }
    }

    /// Appends a byte (writer's side) that came at `now_ms`, the low word of the time since start,
    /// or counts it as lost.
    pub fn push(&self, byte: u8, now_ms: u32) {
        self.note(now_ms);
        self.bytes.push(byte);
    }

    /// Counts a byte (writer's side) that came but could not be taken.
    pub fn lose(&self) {
        self.bytes.drop_whole(1);
    }

    fn note(&self, now_ms: u32) {
        let noted = self.noted.load(Ordering::Relaxed);
        let waiting = noted.wrapping_sub(self.passed.load(Ordering::Acquire));
        let is_fresh = now_ms.wrapping_sub(self.last_ms.load(Ordering::Relaxed)) < GRAIN_MS;
        if (is_fresh && noted != 0) || waiting >= M {
            return;
        }
        if let Some(note) = self.notes.get(noted & (M - 1)) {
            note.position.store(self.bytes.written(), Ordering::Relaxed);
            note.ms.store(now_ms, Ordering::Relaxed);
            self.last_ms.store(now_ms, Ordering::Relaxed);
            self.noted.store(noted.wrapping_add(1), Ordering::Release);
        }
    }

    /// Returns the number of bytes to read.
    pub fn len(&self) -> usize {
        self.bytes.len()
    }

    /// Returns true if no byte waits.
    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Returns the number of bytes lost because the ring was full or the writer came too late; it
    /// saturates.
    pub fn lost(&self) -> u32 {
        self.bytes.dropped()
    }

    /// Returns the number of bytes that came and were dropped, after a lost byte or because of
    /// their age; it saturates.
    pub fn given_up(&self) -> u32 {
        self.given_up.load(Ordering::Relaxed)
    }

    /// Returns the largest number of bytes that have waited at once.
    pub fn high_water(&self) -> usize {
        self.bytes.high_water()
    }

    /// Moves the oldest bytes with the same arrival time into `chunk` (reader's side).
    pub fn take(&self, chunk: &mut [u8], now_ms: u64) -> Taken {
        let lost = self.lost();
        if lost != self.known_lost.load(Ordering::Relaxed) {
            self.known_lost.store(lost, Ordering::Relaxed);
            self.give_up();
            return Taken::Lost;
        }
        if self.bytes.is_empty() {
            return Taken::Nothing;
        }
        let together = self.pass_notes();
        let age_ms = (now_ms as u32).wrapping_sub(self.now_ms.load(Ordering::Relaxed));
        if u64::from(age_ms) > OLDEST_MS {
            self.give_up();
            return Taken::Lost;
        }
        let most = together.min(chunk.len());
        let count = self.bytes.read_into(chunk.get_mut(..most).unwrap_or_default());
        Taken::Bytes { count, came_ms: now_ms.saturating_sub(u64::from(age_ms)) }
    }

    /// Advances to the note of the next byte; returns the number of bytes that belong to it.
    fn pass_notes(&self) -> usize {
        let position = self.bytes.read_position();
        let noted = self.noted.load(Ordering::Acquire);
        let mut passed = self.passed.load(Ordering::Relaxed);
        while passed != noted {
            let Some(note) = self.notes.get(passed & (M - 1)) else { break };
            let ahead = note.position.load(Ordering::Relaxed).wrapping_sub(position);
            // Positions wrap. A difference beyond the size of the ring means that the note is
            // behind `position`.
            if (1..=N).contains(&ahead) {
                self.passed.store(passed, Ordering::Release);
                return ahead;
            }
            self.now_ms.store(note.ms.load(Ordering::Relaxed), Ordering::Relaxed);
            passed = passed.wrapping_add(1);
        }
        self.passed.store(passed, Ordering::Release);
        N
    }

    /// Drops all waiting bytes.
    fn give_up(&self) {
        let count = u32::try_from(self.bytes.discard()).unwrap_or(u32::MAX);
        self.given_up.store(self.given_up().saturating_add(count), Ordering::Relaxed);
        self.pass_notes();
    }
}

impl<const N: usize, const M: usize> Default for TimedRing<N, M> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn take<const N: usize, const M: usize>(ring: &TimedRing<N, M>, now_ms: u64) -> Taken {
        ring.take(&mut [0; 64], now_ms)
    }

    #[test]
    fn bytes_keep_the_time_at_which_they_came() {
        let ring = TimedRing::<64, 8>::new();
        for (byte, now_ms) in [(1, 100), (2, 101), (3, 103), (4, 104), (5, 109)] {
            ring.push(byte, now_ms);
        }
        assert_eq!(take(&ring, 200), Taken::Bytes { count: 3, came_ms: 100 });
        assert_eq!(take(&ring, 200), Taken::Bytes { count: 1, came_ms: 104 });
        assert_eq!(take(&ring, 200), Taken::Bytes { count: 1, came_ms: 109 });
        assert_eq!(take(&ring, 200), Taken::Nothing);
    }

    #[test]
    fn without_room_for_a_note_a_byte_counts_as_older_and_never_as_younger() {
        let ring = TimedRing::<64, 2>::new();
        (0..10).for_each(|n| ring.push(n, 100 + 10 * u32::from(n)));
        assert_eq!(take(&ring, 300), Taken::Bytes { count: 1, came_ms: 100 });
        assert_eq!(take(&ring, 300), Taken::Bytes { count: 9, came_ms: 110 });
        ring.push(10, 290);
        assert_eq!(take(&ring, 300), Taken::Bytes { count: 1, came_ms: 290 });
    }

    #[test]
    fn what_has_waited_too_long_is_dropped_whole_and_counted() {
        let ring = TimedRing::<64, 8>::new();
        ring.push(1, 100);
        ring.push(2, 590);
        assert_eq!(take(&ring, 601), Taken::Lost);
        assert_eq!((take(&ring, 601), ring.given_up()), (Taken::Nothing, 2));
        ring.push(3, 602);
        assert_eq!(take(&ring, 603), Taken::Bytes { count: 1, came_ms: 602 });
    }

    #[test]
    fn a_lost_byte_drops_the_others_once() {
        let ring = TimedRing::<4, 4>::new();
        (0..6).for_each(|byte| ring.push(byte, 10));
        assert_eq!(take(&ring, 11), Taken::Lost);
        assert_eq!((take(&ring, 11), ring.lost(), ring.given_up()), (Taken::Nothing, 2, 4));
        ring.lose();
        assert_eq!(take(&ring, 12), Taken::Lost);
        assert_eq!(take(&ring, 12), Taken::Nothing);
    }

    #[test]
    fn time_survives_the_wrap_of_the_low_word() {
        let ring = TimedRing::<64, 8>::new();
        let now_ms = (1_u64 << 32) + 5;
        ring.push(1, u32::MAX - 4);
        ring.push(2, 3);
        assert_eq!(take(&ring, now_ms), Taken::Bytes { count: 1, came_ms: (1 << 32) - 5 });
        assert_eq!(take(&ring, now_ms), Taken::Bytes { count: 1, came_ms: (1 << 32) + 3 });
    }
}
