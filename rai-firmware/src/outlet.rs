//! Sentences into a ring, whole or not at all, for a host that may read too slowly.
//!
//! What one call of `write` brings, a sentence or a binary message, goes into the ring whole. Where
//! there is no room it is dropped and counted: the host misses sentences, and never gets half of
//! one. Nothing waits for it.

use core::convert::Infallible;

use crate::ring::Ring;

/// The way out: a writer in front of the ring.
pub struct Outlet<'r, const N: usize, S> {
    ring: &'r Ring<N>,
    start_sending: S,
    lost: u32,
}

impl<'r, const N: usize, S: FnMut()> Outlet<'r, N, S> {
    /// A way out that wakes whoever empties the ring with `start_sending`.
    pub const fn new(ring: &'r Ring<N>, start_sending: S) -> Self {
        Self { ring, start_sending, lost: 0 }
    }

    /// Sentences that found no room since start; saturates.
    pub fn lost(&self) -> u32 {
        self.lost
    }

    /// Bytes that there is room for.
    pub fn room(&self) -> usize {
        self.ring.room()
    }
}

impl<const N: usize, S> embedded_io::ErrorType for Outlet<'_, N, S> {
    type Error = Infallible;
}

impl<const N: usize, S: FnMut()> embedded_io::Write for Outlet<'_, N, S> {
    // Not inlined: it is called in many places, and flash is dearer than the calls.
    #[inline(never)]
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        if !self.ring.push_whole(bytes) {
            self.lost = self.lost.saturating_add(1);
        }
        (self.start_sending)();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
