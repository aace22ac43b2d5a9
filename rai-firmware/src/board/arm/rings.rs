//! The rings between the ports' interrupts and the epoch loop: the same on every board.
//!
//! | ring | bytes | holds |
//! |---|---|---|
//! | GNSS in | 4096 | more than the longest epoch (64 satellites with four signals: under 4 KB), a third of a second at 115,200 baud |
//! | host in | 256 | three commands |
//! | host out | 2048 | three epochs of sentences |
//! | log out | 1024 | a burst of twenty frames: a tenth of a second at 115,200 baud |
//!
//! GNSS bytes go in with the time at which they came. Bytes for which a ring had no room and bytes that were taken too
//! late from the port (the hardware's overrun) are lost, and counted together.

use core::sync::atomic::{AtomicU32, Ordering};

use rai_firmware::board::{HOST_OUT_BYTES, PortLosses};
use rai_firmware::epoch_loop::WORTH_A_PASS_BYTES;
use rai_firmware::outlet::Outlet;
use rai_firmware::ring::Ring;
use rai_firmware::timed_ring::{Taken, TimedRing};

use super::time;

/// From the GNSS receiver.
pub static GNSS_IN: TimedRing<4096, 64> = TimedRing::new();
/// From the host.
pub static HOST_IN: Ring<256> = Ring::new();
/// To the host.
pub static HOST_OUT: Ring<HOST_OUT_BYTES> = Ring::new();
/// To whoever reads the log.
pub static LOG_OUT: Ring<1024> = Ring::new();

static HOST_OVERRUNS: AtomicU32 = AtomicU32::new(0);

/// The way out to the host.
pub type HostPort = Outlet<'static, HOST_OUT_BYTES, fn()>;

/// The host's port came too late for a byte.
pub fn note_host_overrun() {
    HOST_OVERRUNS.store(HOST_OVERRUNS.load(Ordering::Relaxed).saturating_add(1), Ordering::Relaxed);
}

/// What was lost since start; the way out to the host counts its own.
pub fn losses(host: &HostPort) -> PortLosses {
    PortLosses {
        gnss_bytes_lost: GNSS_IN.lost(),
        gnss_bytes_dropped: GNSS_IN.given_up(),
        command_bytes_lost: HOST_IN.dropped().saturating_add(HOST_OVERRUNS.load(Ordering::Relaxed)),
        sentences_lost: host.lost(),
        log_bytes_lost: LOG_OUT.dropped(),
    }
}

/// Most bytes that ever waited in each ring since start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, defmt::Format)]
pub struct HighWater {
    gnss_in: usize,
    host_in: usize,
    host_out: usize,
    log_out: usize,
}

/// How full the rings have been.
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

/// Whether so many bytes wait for the epoch loop that it should go round.
pub fn input_waits() -> bool {
    GNSS_IN.len() >= WORTH_A_PASS_BYTES || !HOST_IN.is_empty()
}

/// Waits until all has left the chip, a second at most: before a reset that was asked for.
pub fn drain() {
    let deadline_ms = time::now_ms() + 1000;
    while !(HOST_OUT.is_empty() && LOG_OUT.is_empty()) && time::now_ms() < deadline_ms {}
    // The last two bytes are still in the transmitter, where a character takes 87 µs.
    let last_ms = time::now_ms() + 2;
    while time::now_ms() < last_ms {}
}
