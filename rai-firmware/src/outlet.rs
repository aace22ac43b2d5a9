//! Writer of whole sentences into a ring, for a host that may read too slowly.
//!
//! The bytes of one call of `write` are a sentence or a binary message. All of them go into the
//! ring, or, without room, all are dropped and counted. The host may thus miss sentences, but never
//! receives half of one. Nothing waits for the host.

use core::convert::Infallible;

use crate::ring::Ring;

/// Writer in front of the ring.
pub struct Outlet<'r, const N: usize, S> {
    ring: &'r Ring<N>,
    start_sending: S,
    lost: u32,
}

impl<'r, const N: usize, S: FnMut()> Outlet<'r, N, S> {
    /// Returns a writer that calls `start_sending` after every write, so that the ring is emptied.
    pub const fn new(ring: &'r Ring<N>, start_sending: S) -> Self {
        Self { ring, start_sending, lost: 0 }
    }

    /// Returns the number of writes dropped since start; saturates.
    pub fn lost(&self) -> u32 {
        self.lost
    }

    /// Returns the free room, bytes.
    pub fn room(&self) -> usize {
        self.ring.room()
    }
}

impl<const N: usize, S> embedded_io::ErrorType for Outlet<'_, N, S> {
    type Error = Infallible;
}

impl<const N: usize, S: FnMut()> embedded_io::Write for Outlet<'_, N, S> {
    // Not inlined, because it has many callers and flash is scarcer than time here.
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
