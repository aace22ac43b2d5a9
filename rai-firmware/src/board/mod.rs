//! The interface of a board: the hardware functions that the module needs.
//!
//! [`crate::epoch_loop`] runs on any [`Board`]: a chip, an emulated chip, or a model of the ports
//! on the host with simulated time. A new board is a package beside `boards/stm32f405`, with
//!
//! | part | in `stm32f405` | in `mps2_an500` |
//! |---|---|---|
//! | start: pin low first, then the clock, the ports, the watchdog | `board.rs`, `clock.rs`, `pins.rs` | `board.rs` |
//! | three ports through rings, in interrupts | `ports.rs` | `ports.rs` |
//! | causes of a reset | `fault.rs` | – |
//! | the memory map | `regions.x`, for `memory.x` at the top level | `regions.x` |
//!
//! `boards/arm` holds the parts that all Cortex-M boards share: time from `SysTick`, the rings of
//! the ports, the guarded stack, faults, the log.

use embedded_hal::digital::OutputPin;
use embedded_io::Write;
use raim_core::report::Verdict;

pub mod reset;

pub use crate::settings::SEALED_BYTES;

use crate::counters::counters;
use crate::timed_ring::Taken;
use reset::ResetCause;

/// True if a board has a log.
pub const HAS_LOG: bool = cfg!(feature = "log");

/// Bytes of the ring to the host.
///
/// The sentences of an epoch may still wait when those of the next epoch come. With 19 satellites
/// all sentences take 650 bytes. A long answer uses only the room that the sentences of the largest
/// epoch do not need.
pub const HOST_OUT_BYTES: usize = 2048;

counters! {
    /// Losses at the ports since start.
    PortLosses {
        /// GNSS bytes that were lost in the port (overrun) or for lack of room.
        gnss_bytes_lost,
        /// GNSS bytes that were dropped after a lost byte, or because they were old.
        gnss_bytes_dropped,
        /// Command bytes that were lost in the port (overrun) or for lack of room.
        command_bytes_lost,
        /// Sentences that found no room because the host reads too slowly.
        sentences_lost,
        /// Bytes of the log that found no room because no reader fetched it.
        log_bytes_lost,
    }
}

/// The hardware around the module. Except [`Board::sleep`], none of its functions waits.
pub trait Board {
    /// Type of the integrity pin.
    type Pin: OutputPin;
    /// Type of the writer to the host.
    type Host: Write;

    /// Takes bytes that have come at the GNSS port, with their arrival time.
    fn gnss(&mut self, chunk: &mut [u8]) -> Taken;

    /// Takes one byte that has come at the host port.
    fn command(&mut self) -> Option<u8>;

    /// Returns the writer to the host.
    fn host(&mut self) -> &mut Self::Host;

    /// Returns the free bytes of the writer to the host.
    fn host_room(&self) -> usize;

    /// Returns the milliseconds since start.
    fn now_ms(&self) -> u64;

    /// Returns the largest rate at which this clock may run fast, parts per million.
    fn clock_error_ppm(&self) -> u32;

    /// Returns the ticks since start, of the clock that measures epochs.
    fn now_ticks(&self) -> u64;

    /// Returns the tick at which the pin was last driven.
    fn driven_ticks(&self, pin: &Self::Pin) -> u64;

    /// Returns the losses at the ports since start.
    fn losses(&self) -> PortLosses;

    /// Feeds the watchdog, because the loop has completed a pass.
    fn feed_watchdog(&mut self);

    /// Sleeps until a millisecond begins, a byte of the host has come, or
    /// [`WORTH_A_PASS_BYTES`](crate::epoch_loop::WORTH_A_PASS_BYTES) of the GNSS port wait. Returns
    /// the tick at which an interrupt first ended the sleep, or `None` if it did not sleep.
    fn sleep(&mut self) -> Option<u64>;

    /// Returns the cause of the last reset.
    fn reset_cause(&self) -> ResetCause;

    /// Returns memory that a restart leaves unchanged, with unspecified contents after power-on.
    fn sealed(&mut self) -> &mut [u8; SEALED_BYTES];

    /// Sets the bit rate of the GNSS port.
    fn set_gnss_rate(&mut self, baud: u32);

    /// Logs an event.
    fn note(&mut self, note: Note);
}

/// An event for the log.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// An epoch was judged: its verdict, and ticks from its last byte to the pin.
    Judged(Option<Verdict>, u64),
    /// The receiver reported because time had passed, without a byte from the GNSS port: its
    /// verdict.
    Stale(Option<Verdict>),
    /// An epoch: its number since start, and ticks that the module was busy since the last one.
    Epoch(u32, u64),
    /// The high-water marks of stack and rings are due.
    HighWater,
    /// Bytes were lost.
    Lost(PortLosses),
    /// The GNSS port changed its rate, bit/s.
    GnssRate(u32),
}
