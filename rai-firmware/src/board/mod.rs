//! The door for a board: what the module needs of the hardware around it.
//!
//! [`crate::epoch_loop`] runs on whatever is a [`Board`]: a chip, an emulated one, or a model of the ports on the host
//! in which time is counted. What a new board takes is one folder here, with
//!
//! | what | in `stm32f405` | in `mps2_an500` |
//! |---|---|---|
//! | start: pin low first, then the clock, the ports, the watchdog | `mod.rs`, `clock.rs`, `pins.rs` | `mod.rs` |
//! | three ports through rings, in interrupts | `ports.rs` | `ports.rs` |
//! | faults: pin low, a record, a reset | `fault.rs` | `fault.rs` |
//! | the memory map | `memory.x` | `memory.x` |
//!
//! What all Cortex-M boards share is in `arm`: time from `SysTick`, the rings of the ports, the guarded stack, the log. These files are part
//! of the binary and not of this library; each board's crates come with the feature of its name.

use embedded_hal::digital::OutputPin;
use embedded_io::Write;
use rai_core::report::Verdict;

pub mod reset;

pub use crate::settings::SEALED_BYTES;

use crate::counters::counters;
use crate::timed_ring::Taken;
use reset::ResetCause;

/// Bytes of the ring to the host: the sentences of an epoch may still wait when those of the next come, 650 bytes each with all that
/// can be sent of 19 satellites. A long answer leaves room for an epoch of the most, and says as much as fits beside it.
pub const HOST_OUT_BYTES: usize = 2048;

counters! {
    /// What was lost at the ports since start.
    PortLosses {
        /// GNSS bytes that the port came too late for, or that found no room.
        gnss_bytes_lost,
        /// GNSS bytes that had come and were dropped with those, or because they were old.
        gnss_bytes_dropped,
        /// Command bytes that the port came too late for, or that found no room.
        command_bytes_lost,
        /// Sentences that found no room because the host reads too slowly.
        sentences_lost,
        /// Bytes of the log that nobody fetched.
        log_bytes_lost,
    }
}

/// The hardware around the module. No function of it waits, but for [`Board::sleep`].
pub trait Board {
    /// The integrity pin.
    type Pin: OutputPin;
    /// The way out to the host.
    type Host: Write;

    /// Takes bytes that have come at the GNSS port, with their time.
    fn gnss(&mut self, chunk: &mut [u8]) -> Taken;

    /// Takes one byte that has come at the host port.
    fn command(&mut self) -> Option<u8>;

    /// The way out to the host.
    fn host(&mut self) -> &mut Self::Host;

    /// Bytes that the way out to the host has room for.
    fn host_room(&self) -> usize;

    /// Milliseconds since start.
    fn now_ms(&self) -> u64;

    /// By how much this may be more than have passed, parts per million.
    fn clock_error_ppm(&self) -> u32;

    /// Ticks of the clock that epochs are measured with, since start.
    fn now_ticks(&self) -> u64;

    /// When the pin was last driven, in these ticks.
    fn driven_ticks(&self, pin: &Self::Pin) -> u64;

    /// What was lost at the ports since start.
    fn losses(&self) -> PortLosses;

    /// Says that the loop came round.
    fn feed_watchdog(&mut self);

    /// Sleeps until a millisecond begins, a byte of the host has come, or
    /// [`WORTH_A_PASS_BYTES`](crate::epoch_loop::WORTH_A_PASS_BYTES) of the GNSS port wait. Gives the tick at which anything
    /// first ended the sleep, where it slept.
    fn sleep(&mut self) -> Option<u64>;

    /// Why the module started.
    fn reset_cause(&self) -> ResetCause;

    /// Memory that a restart leaves as it is, and that after power-on holds anything.
    fn sealed(&mut self) -> &mut [u8; SEALED_BYTES];

    /// Sets the bit rate of the GNSS port.
    fn set_gnss_rate(&mut self, baud: u32);

    /// Notes what happened, for whoever watches.
    fn note(&mut self, note: Note);
}

/// What happened, for the log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Note {
    /// An epoch was judged: what was said, and ticks from its last byte to the pin.
    Judged(Option<Verdict>, u64),
    /// Something was said without a byte having come.
    Stale(Option<Verdict>),
    /// An epoch, its number since start, and the ticks that the module was busy since the last one.
    Epoch(u32, u64),
    /// Time to look at the stack and the rings.
    HighWater,
    /// Bytes were lost.
    Lost(PortLosses),
    /// The GNSS port listens at another rate, bits a second.
    GnssRate(u32),
}
