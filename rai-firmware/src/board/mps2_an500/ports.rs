//! The three serial ports, driven by interrupts through byte rings. The rings are those of the other board.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use cortex_m_rt::exception;
use rai_firmware::board::PortLosses;
use rai_firmware::outlet::Outlet;
use rai_firmware::ring::Ring;
use rai_firmware::timed_ring::{Taken, TimedRing};

use super::CORE_HZ;
use super::registers::{GNSS, HOST, LOG, Uart};
use crate::arm::time;

/// Rate of all ports at start.
const BAUD: u32 = 115_200;

/// Bytes that one interrupt may take in.
const BYTES_PER_INTERRUPT: usize = 64;

static GNSS_IN: TimedRing<4096, 64> = TimedRing::new();
static HOST_IN: Ring<256> = Ring::new();
static HOST_OUT: Ring<4096> = Ring::new();
static LOG_OUT: Ring<2048> = Ring::new();

static HOST_OVERRUNS: AtomicU32 = AtomicU32::new(0);

/// An interrupt by its number.
#[derive(Clone, Copy)]
struct Line(u16);

// SAFETY: the number is that of a line of this board.
#[allow(unsafe_code)]
unsafe impl InterruptNumber for Line {
    fn number(self) -> u16 {
        self.0
    }
}

/// Received, transmitted: UART 0, 1, 2.
const HOST_LINES: [Line; 2] = [Line(0), Line(1)];
const GNSS_LINES: [Line; 2] = [Line(2), Line(3)];
const LOG_LINES: [Line; 2] = [Line(4), Line(5)];

/// The way out to the host.
pub type HostPort = Outlet<'static, 4096, fn()>;

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

/// Starts the ports and their interrupts; returns the way out to the host.
#[allow(unsafe_code)]
pub fn start() -> HostPort {
    for port in [HOST, GNSS, LOG] {
        port.start(CORE_HZ / BAUD);
    }
    for line in [HOST_LINES, GNSS_LINES, LOG_LINES].into_iter().flatten() {
        // SAFETY: the handler below touches only the rings and registers of the ports, which are ready.
        unsafe { NVIC::unmask(line) };
    }
    Outlet::new(&HOST_OUT, || NVIC::pend(HOST_LINES[1]))
}

/// Sets the rate of the GNSS port.
pub fn set_gnss_rate(baud: u32) {
    GNSS.set_divider(CORE_HZ / baud.max(1));
}

/// Takes GNSS bytes that have come.
pub fn take_gnss(chunk: &mut [u8]) -> Taken {
    GNSS_IN.take(chunk, time::now_ms())
}

/// Takes one command byte that has come.
pub fn take_command() -> Option<u8> {
    HOST_IN.pop()
}

/// Whether bytes wait for the epoch loop.
pub fn input_waits() -> bool {
    !GNSS_IN.is_empty() || !HOST_IN.is_empty()
}

/// Queues one frame of the log, whole or not at all. To be called with interrupts held back.
pub fn send_log(frame: &[u8]) {
    LOG_OUT.push_whole(frame);
    NVIC::pend(LOG_LINES[1]);
}

/// Waits until all has left, a second at most: before a reset that was asked for.
pub fn drain() {
    let deadline_ms = time::now_ms() + 1000;
    while !(HOST_OUT.is_empty() && LOG_OUT.is_empty()) && time::now_ms() < deadline_ms {}
    let last_ms = time::now_ms() + 2;
    while time::now_ms() < last_ms {}
}

fn receive(port: Uart, mut push: impl FnMut(u8), mut overrun: impl FnMut()) {
    for _ in 0..BYTES_PER_INTERRUPT {
        if port.take_overrun() {
            overrun();
        }
        let Some(byte) = port.take() else { return };
        push(byte);
    }
}

/// Sends while the port takes bytes; its interrupt goes on when it takes the next.
fn transmit<const N: usize>(port: Uart, ring: &Ring<N>) {
    for _ in 0..N {
        if !port.is_ready() {
            return;
        }
        let Some(byte) = ring.pop() else { return };
        port.send(byte);
    }
}

/// All interrupts come here: this board's are used by number.
#[exception]
#[allow(unsafe_code)]
unsafe fn DefaultHandler(number: i16) {
    match number {
        0 | 1 => {
            HOST.clear_interrupts();
            let overrun =
                || HOST_OVERRUNS.store(HOST_OVERRUNS.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
            receive(HOST, |byte| _ = HOST_IN.push(byte), overrun);
            transmit(HOST, &HOST_OUT);
        }
        2 | 3 => {
            GNSS.clear_interrupts();
            let now_ms = time::now_ms_low();
            receive(GNSS, |byte| GNSS_IN.push(byte, now_ms), || GNSS_IN.lose());
        }
        4 | 5 => {
            LOG.clear_interrupts();
            receive(LOG, |_| (), || ());
            transmit(LOG, &LOG_OUT);
        }
        _ => crate::arm::fault::give_up(rai_firmware::board::reset::Fault::Hard { address: 0 }),
    }
}
