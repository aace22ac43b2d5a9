//! A chip as a board of the module: the chip's own parts, and those that all share.

use raim_firmware::board::reset::ResetCause;
use raim_firmware::board::{Board, Note, PortLosses, SEALED_BYTES};
use raim_firmware::timed_ring::Taken;

use crate::pin::IntegrityPin;
use crate::rings::{self, HostPort};
use crate::{Chip, log, sealed, time};

/// The board after start-up.
pub struct CortexBoard<C> {
    chip: C,
    reset_cause: ResetCause,
    host: HostPort,
    sealed: &'static mut [u8; SEALED_BYTES],
}

impl<C: Chip> CortexBoard<C> {
    /// Returns the board of a chip whose ports run; `None` if there is one already.
    pub fn new(chip: C, reset_cause: ResetCause, host: HostPort) -> Option<Self> {
        Some(Self { chip, reset_cause, host, sealed: sealed::take()? })
    }
}

impl<C: Chip> Board for CortexBoard<C> {
    type Pin = IntegrityPin<C::Output>;
    type Host = HostPort;

    fn gnss(&mut self, chunk: &mut [u8]) -> Taken {
        rings::take_gnss(chunk)
    }

    fn command(&mut self) -> Option<u8> {
        rings::take_command()
    }

    fn host(&mut self) -> &mut HostPort {
        &mut self.host
    }

    fn host_room(&self) -> usize {
        self.host.room()
    }

    fn now_ms(&self) -> u64 {
        time::now_ms()
    }

    fn clock_error_ppm(&self) -> u32 {
        self.chip.clock_error_ppm()
    }

    fn now_ticks(&self) -> u64 {
        time::now_ticks()
    }

    fn driven_ticks(&self, pin: &Self::Pin) -> u64 {
        pin.driven_ticks()
    }

    fn losses(&self) -> PortLosses {
        rings::losses(&self.host)
    }

    fn feed_watchdog(&mut self) {
        self.chip.feed_watchdog();
    }

    fn sleep(&mut self) -> Option<u64> {
        time::sleep_unless(rings::input_waits)
    }

    fn reset_cause(&self) -> ResetCause {
        self.reset_cause
    }

    fn sealed(&mut self) -> &mut [u8; SEALED_BYTES] {
        self.sealed
    }

    fn set_gnss_rate(&mut self, baud: u32) {
        self.chip.set_gnss_rate(baud);
    }

    fn note(&mut self, note: Note) {
        log::note(note);
    }
}
