//! The rings between the ports' interrupts and the epoch loop, the same on every board.
//!
//! | ring | bytes | room for |
//! |---|---|---|
//! | GNSS in | 4096 | more than the longest epoch (64 satellites with four signals: under 4 KB): a third of a second at 115,200 baud. An image for 32 satellites in a message has half the bytes |
//! | host in | 256 | three commands |
//! | host out | 2048 | three epochs of sentences |
//! | log out | 1024 | a burst of twenty frames: a tenth of a second at 115,200 baud. The same image has half the bytes |
//!
//! GNSS bytes enter with their arrival time. Bytes that find no room in a ring, and bytes that were
//! overrun in the port, are lost and counted together.

use raim_firmware::board::{HOST_OUT_BYTES, PortLosses};
use raim_firmware::epoch_loop::WORTH_A_PASS_BYTES;
use raim_firmware::outlet::Outlet;
use raim_firmware::raw::EPOCH_CAPACITY;
use raim_firmware::ring::Ring;
use raim_firmware::timed_ring::{Taken, TimedRing};

use crate::{HAS_LOG, time};

/// Divisor of the rings that grow with an epoch.
const SHARE: usize = if EPOCH_CAPACITY > 32 { 1 } else { 2 };

/// Bytes of the log that may wait.
const LOG_BYTES: usize = if HAS_LOG { 1024 / SHARE } else { 1 };

/// Ring from the GNSS receiver.
pub static GNSS_IN: TimedRing<{ 4096 / SHARE }, 64> = TimedRing::new();
/// Ring from the host.
pub static HOST_IN: Ring<256> = Ring::new();
/// Ring to the host.
pub static HOST_OUT: Ring<HOST_OUT_BYTES> = Ring::new();
/// Ring to the reader of the log.
pub static LOG_OUT: Ring<LOG_BYTES> = Ring::new();

/// The writer to the host.
pub type HostPort = Outlet<'static, HOST_OUT_BYTES, fn()>;

/// Counts an overrun of the host's port, and ends the line in which bytes are missing.
pub fn note_host_overrun() {
    // Without room it counts itself.
    if HOST_IN.push(0) {
        HOST_IN.drop_whole(1);
    }
}

/// Returns the losses since start; the writer to the host has its own counters.
pub fn losses(host: &HostPort) -> PortLosses {
    let mut losses = PortLosses::NONE;
    losses.gnss_bytes_lost = GNSS_IN.lost();
    losses.gnss_bytes_dropped = GNSS_IN.given_up();
    losses.command_bytes_lost = HOST_IN.dropped();
    losses.sentences_lost = host.lost();
    losses.log_bytes_lost = LOG_OUT.dropped();
    losses
}

/// Largest number of bytes that have waited in each ring since start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, defmt::Format)]
pub struct HighWater {
    gnss_in: usize,
    host_in: usize,
    host_out: usize,
    log_out: usize,
}

/// Returns the high-water marks of the rings.
pub fn high_water() -> HighWater {
    HighWater {
        gnss_in: GNSS_IN.high_water(),
        host_in: HOST_IN.high_water(),
        host_out: HOST_OUT.high_water(),
        log_out: LOG_OUT.high_water(),
    }
}

/// Takes GNSS bytes that have come.
pub fn take_gnss(chunk: &mut [u8]) -> Taken {
    GNSS_IN.take(chunk, time::now_ms())
}

/// Takes one command byte that has come.
pub fn take_command() -> Option<u8> {
    HOST_IN.pop()
}

/// Returns true if enough bytes wait for a pass of the epoch loop.
pub fn input_waits() -> bool {
    GNSS_IN.len() >= WORTH_A_PASS_BYTES || !HOST_IN.is_empty()
}

/// Waits at most a second until all bytes have left the chip, before a requested reset.
pub fn drain() {
    let deadline_ms = time::now_ms() + 1000;
    while !(HOST_OUT.is_empty() && LOG_OUT.is_empty()) && time::now_ms() < deadline_ms {}
    // The last two bytes are still in the transmitter, where a character takes 87 µs.
    let last_ms = time::now_ms() + 2;
    while time::now_ms() < last_ms {}
}
