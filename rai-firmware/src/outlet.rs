//! Sentences into a ring, whole or not at all, for a host that may read too slowly.
//!
//! A line goes into the ring when it is complete. Where there is no room it waits for at most [`PATIENCE_MS`], and is
//! then dropped and counted: the host misses sentences, and never gets half of one. An epoch is therefore held up for
//! no longer than its sentences times the patience, with the pin set before.

use core::convert::Infallible;

use crate::nmea::MAX_LENGTH;
use crate::ring::Ring;

/// How long a sentence may wait for room, ms: twice what the longest takes on the wire.
pub const PATIENCE_MS: u64 = 15;

/// The way out: a writer in front of the ring.
pub struct Outlet<'r, const N: usize, C, S> {
    ring: &'r Ring<N>,
    now_ms: C,
    start_sending: S,
    line: heapless::Vec<u8, MAX_LENGTH>,
    lines: u32,
}

impl<'r, const N: usize, C: FnMut() -> u64, S: FnMut()> Outlet<'r, N, C, S> {
    /// A way out that looks at the clock with `now_ms`, and wakes whoever empties the ring with `start_sending`.
    pub const fn new(ring: &'r Ring<N>, now_ms: C, start_sending: S) -> Self {
        Self { ring, now_ms, start_sending, line: heapless::Vec::new(), lines: 0 }
    }

    /// Lines that were sent or dropped since start; wraps.
    pub fn lines(&self) -> u32 {
        self.lines
    }

    fn append(&mut self, byte: u8) {
        if self.line.push(byte).is_err() {
            self.send();
            // There is room now: `send` leaves the line empty.
            let _ = self.line.push(byte);
        }
        if byte == b'\n' {
            self.send();
        }
    }

    // Not inlined, nor is `write`: both are called in many places, and flash is dearer than the calls.
    #[inline(never)]
    fn send(&mut self) {
        let deadline_ms = (self.now_ms)() + PATIENCE_MS;
        while !self.ring.offer(&self.line) {
            if (self.now_ms)() > deadline_ms {
                self.ring.drop_whole(self.line.len());
                break;
            }
        }
        self.line.clear();
        self.lines = self.lines.wrapping_add(1);
        (self.start_sending)();
    }
}

impl<const N: usize, C, S> embedded_io::ErrorType for Outlet<'_, N, C, S> {
    type Error = Infallible;
}

impl<const N: usize, C: FnMut() -> u64, S: FnMut()> embedded_io::Write for Outlet<'_, N, C, S> {
    #[inline(never)]
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        for &byte in bytes {
            self.append(byte);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        if !self.line.is_empty() {
            self.send();
        }
        Ok(())
    }
}
