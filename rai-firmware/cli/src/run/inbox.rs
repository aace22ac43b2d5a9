//! The queue between the threads that read and the epoch loop: bytes with their time of arrival.
//!
//! Two kinds of bytes come: those of the receiver, in order, and whole frames with orbits from a
//! caster, which wait until the module has no frame of the receiver in hand.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use raim_firmware::timed_ring::Taken;

use super::clock::Clock;

/// Bytes of the receiver that may wait: two seconds of the fastest line.
const MOST_BYTES: usize = 1 << 18;
/// Frames with orbits that may wait.
const MOST_ORBITS: usize = 256;
/// Bytes of commands that may wait. Only pseudo-terminals bring commands.
#[cfg(unix)]
const MOST_COMMANDS: usize = 4096;

/// The queue.
#[derive(Debug)]
pub(super) struct Inbox {
    clock: Arc<Clock>,
    /// True if the source waits: its bytes count as come when they are taken.
    waits: bool,
    state: Mutex<State>,
    arrival: Condvar,
    /// Signalled when bytes have been taken.
    room: Condvar,
}

#[derive(Debug, Default)]
struct State {
    bytes: VecDeque<u8>,
    /// The number of bytes that came at each instant, in ms, oldest first.
    arrivals: VecDeque<(usize, u64)>,
    last_ms: u64,
    orbits: VecDeque<Vec<u8>>,
    commands: VecDeque<u8>,
    is_broken: bool,
    dropped: u32,
    has_ended: bool,
}

impl Inbox {
    pub(super) fn new(clock: Arc<Clock>, waits: bool) -> Self {
        Self { clock, waits, state: Mutex::default(), arrival: Condvar::new(), room: Condvar::new() }
    }

    /// Milliseconds since the program started.
    pub(super) fn now_ms(&self) -> u64 {
        u64::try_from(self.clock.now().as_millis()).unwrap_or(u64::MAX)
    }

    /// Nanoseconds since the program started.
    pub(super) fn now_ns(&self) -> u64 {
        u64::try_from(self.clock.now().as_nanos()).unwrap_or(u64::MAX)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes bytes that the receiver has just sent.
    pub(super) fn push(&self, bytes: &[u8]) {
        let now_ms = self.now_ms();
        let mut state = self.state();
        if state.bytes.len() + bytes.len() > MOST_BYTES {
            state.dropped = state.dropped.saturating_add(u32::try_from(bytes.len()).unwrap_or(u32::MAX));
            state.is_broken = true;
            return;
        }
        state.bytes.extend(bytes);
        state.arrivals.push_back((bytes.len(), now_ms));
        state.last_ms = now_ms;
        drop(state);
        self.arrival.notify_one();
        self.clock.receive(bytes.len(), 0);
    }

    /// Takes bytes of a source, which may have to wait until there is room for them.
    pub(super) fn push_in_turn(&self, bytes: &[u8]) {
        if !self.waits {
            return self.push(bytes);
        }
        let state = self.state();
        drop(self.room.wait_while(state, |state| state.bytes.len() + bytes.len() > MOST_BYTES));
        self.push(bytes);
    }

    /// Notes that bytes of the receiver are missing here: its line was connected anew.
    pub(super) fn interrupt(&self) {
        self.state().is_broken = true;
    }

    /// Takes a whole frame with an orbit. If there are too many, the oldest goes.
    pub(super) fn push_orbit(&self, frame: Vec<u8>) {
        let mut state = self.state();
        if state.orbits.len() == MOST_ORBITS {
            state.orbits.pop_front();
        }
        state.orbits.push_back(frame);
        drop(state);
        self.clock.receive(0, 1);
    }

    /// Hands out a frame with an orbit.
    pub(super) fn take_orbit(&self) -> Option<Vec<u8>> {
        self.state().orbits.pop_front()
    }

    /// Takes bytes of a host's commands.
    #[cfg(unix)]
    pub(super) fn push_commands(&self, bytes: &[u8]) {
        let mut state = self.state();
        let room = MOST_COMMANDS - state.commands.len().min(MOST_COMMANDS);
        state.commands.extend(bytes.iter().take(room));
        drop(state);
        self.arrival.notify_one();
        self.clock.receive(0, 0);
    }

    /// Notes that no more bytes come.
    pub(super) fn end(&self) {
        self.state().has_ended = true;
        self.arrival.notify_one();
        self.clock.receive(0, 0);
    }

    /// Returns true once no more bytes come and all have been taken.
    pub(super) fn has_ended(&self) -> bool {
        let state = self.state();
        state.has_ended && state.bytes.is_empty()
    }

    /// Bytes that found no room.
    pub(super) fn dropped(&self) -> u32 {
        self.state().dropped
    }

    /// Hands out the bytes of one instant, as many as the chunk holds.
    pub(super) fn take(&self, chunk: &mut [u8]) -> Taken {
        let now_ms = self.now_ms();
        let mut state = self.state();
        if std::mem::take(&mut state.is_broken) {
            return Taken::Lost;
        }
        let Some(&(many, came_ms)) = state.arrivals.front() else { return Taken::Nothing };
        let count = many.min(chunk.len());
        for (place, byte) in chunk.iter_mut().zip(state.bytes.drain(..count)) {
            *place = byte;
        }
        match state.arrivals.front_mut() {
            Some(front) if many > count => front.0 = many - count,
            _ => drop(state.arrivals.pop_front()),
        }
        drop(state);
        self.room.notify_one();
        Taken::Bytes { count, came_ms: if self.waits { now_ms } else { came_ms } }
    }

    /// Hands out one byte of a command.
    pub(super) fn take_command(&self) -> Option<u8> {
        self.state().commands.pop_front()
    }

    /// Returns the clock of the service.
    pub(super) fn clock(&self) -> &Clock {
        &self.clock
    }

    /// Returns the time since bytes of the receiver came last, ms.
    pub(super) fn silent_ms(&self) -> u64 {
        self.now_ms().saturating_sub(self.state().last_ms)
    }

    /// Waits until something arrives, at most so long.
    pub(super) fn wait(&self, longest: Duration) {
        let seen = self.clock.events();
        let state = self.state();
        if state.arrivals.is_empty() && state.commands.is_empty() && !state.has_ended {
            if let Some(seen) = seen {
                drop(state);
                return self.clock.rest(seen);
            }
            // Whether it arrived or the time is over, the caller looks.
            drop(self.arrival.wait_timeout(state, longest));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_come_out_in_order_with_their_time() {
        let inbox = Inbox::new(Clock::of_the_computer(), false);
        inbox.push(b"abc");
        inbox.push(b"de");
        let mut chunk = [0; 2];
        let mut have = Vec::new();
        while let Taken::Bytes { count, .. } = inbox.take(&mut chunk) {
            have.extend_from_slice(&chunk[..count]);
        }
        assert_eq!(have, b"abcde");
    }

    #[test]
    fn newest_orbits_stay() {
        let inbox = Inbox::new(Clock::of_the_computer(), false);
        (0..=MOST_ORBITS).for_each(|number| inbox.push_orbit(number.to_le_bytes().to_vec()));
        assert_eq!(inbox.take_orbit(), Some(1_usize.to_le_bytes().to_vec()));
        assert_eq!(std::iter::from_fn(|| inbox.take_orbit()).count(), MOST_ORBITS - 1);
    }

    #[test]
    fn bytes_of_a_source_that_waits_grow_no_older() {
        for (waits, want_ms) in [(false, 0), (true, 1000)] {
            let clock = Clock::led();
            let inbox = Inbox::new(Arc::clone(&clock), waits);
            inbox.push_in_turn(b"a");
            clock.set(Duration::from_secs(1));
            assert_eq!(inbox.take(&mut [0; 4]), Taken::Bytes { count: 1, came_ms: want_ms });
        }
    }

    #[test]
    fn flood_is_bounded_and_counted() {
        let inbox = Inbox::new(Clock::of_the_computer(), false);
        for _ in 0..2 * MOST_BYTES / 1024 {
            inbox.push(&[0; 1024]);
        }
        assert_eq!(inbox.dropped() as usize, MOST_BYTES);
        assert_eq!(inbox.take(&mut [0; 4]), Taken::Lost);
    }
}
