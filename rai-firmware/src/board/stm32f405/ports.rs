//! The three serial ports, driven by interrupts through byte rings.
//!
//! A port's interrupt moves what has come into its ring and what waits out of the other. Who puts bytes into a ring
//! pends the interrupt once; from there the transmitter's own interrupt goes on. So sending starts the same way on a
//! transmitter that interrupts when it is empty and on one that never is busy.
//!
//! | ring | bytes | holds |
//! |---|---|---|
//! | GNSS in | 4096 | more than the longest epoch (64 satellites with four signals: under 4 KB), a third of a second at 115,200 baud |
//! | host in | 256 | three commands |
//! | host out | 4096 | three epochs of sentences |
//! | log out | 2048 | a burst of forty frames |
//!
//! GNSS bytes go in with the time at which they came. Bytes for which the ring had no room and bytes that were taken too
//! late from the receiver (the hardware's overrun) are lost, and counted together.
//!
//! References: [RM0090] §30.
//!
//! [RM0090]: rai_firmware#references

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::NVIC;
use rai_firmware::board::PortLosses;
use rai_firmware::outlet::Outlet;
use rai_firmware::ring::Ring;
use rai_firmware::timed_ring::{Taken, TimedRing};
use stm32f4::stm32f405::{Interrupt, RCC, USART1, USART2, USART3, interrupt, usart1::RegisterBlock};

use super::clock::{Clock, divider};
use crate::arm::time;

/// Rate of all three ports.
const BAUD: u32 = 115_200;

/// Bytes that one interrupt may take in: bounds the time in the handler, whatever the peripheral says.
const BYTES_PER_INTERRUPT: usize = 64;

static GNSS_IN: TimedRing<4096, 64> = TimedRing::new();
static HOST_IN: Ring<256> = Ring::new();
static HOST_OUT: Ring<4096> = Ring::new();
static LOG_OUT: Ring<2048> = Ring::new();
/// Nothing is sent to the GNSS receiver; its transmitter has an empty ring.
static GNSS_OUT: Ring<1> = Ring::new();
/// Nothing is expected on the log port.
static LOG_IN: Ring<1> = Ring::new();

static HOST_OVERRUNS: AtomicU32 = AtomicU32::new(0);
/// Noise on a line that is not connected is no loss; it is counted and not reported.
static LOG_OVERRUNS: AtomicU32 = AtomicU32::new(0);

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
    /// GNSS bytes for the epoch loop.
    pub gnss_in: usize,
    /// Command bytes for the epoch loop.
    pub host_in: usize,
    /// Sentences for the host.
    pub host_out: usize,
    /// Frames for the log port.
    pub log_out: usize,
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

/// Starts the ports and their interrupts; returns the way out to the host.
pub fn start(rcc: &RCC, host: &USART1, gnss: &USART2, log: &USART3, clock: Clock) -> HostPort {
    rcc.apb1enr().modify(|_, w| w.usart2en().enabled().usart3en().enabled());
    rcc.apb2enr().modify(|_, w| w.usart1en().enabled());
    enable(host, divider(clock.bus2_hz, BAUD));
    enable(gnss, divider(clock.bus1_hz, BAUD));
    enable(log, divider(clock.bus1_hz, BAUD));
    unmask();
    Outlet::new(&HOST_OUT, || NVIC::pend(Interrupt::USART1))
}

#[allow(unsafe_code)]
fn enable(port: &RegisterBlock, divider: u16) {
    // SAFETY: any 16-bit value is a legal divider.
    port.brr().write(|w| unsafe { w.bits(divider) });
    port.cr1().write(|w| w.ue().enabled().te().enabled().re().enabled().rxneie().enabled());
}

#[allow(unsafe_code)]
fn unmask() {
    // SAFETY: the handlers below touch only their rings and registers, which are ready; no critical section that
    // works by masking single interrupts exists.
    unsafe {
        NVIC::unmask(Interrupt::USART1);
        NVIC::unmask(Interrupt::USART2);
        NVIC::unmask(Interrupt::USART3);
    }
}

/// Sets the rate of the GNSS port.
#[allow(unsafe_code)]
pub fn set_gnss_rate(clock: Clock, baud: u32) {
    // SAFETY: the register is written by nobody else after start-up, and any 16-bit value is a legal divider.
    unsafe {
        let port = USART2::steal();
        port.brr().write(|w| w.bits(divider(clock.bus1_hz, baud)));
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

/// Whether bytes wait for the epoch loop.
pub fn input_waits() -> bool {
    !GNSS_IN.is_empty() || !HOST_IN.is_empty()
}

/// Queues one frame of the log, whole or not at all; never waits. To be called with interrupts held back, since every
/// context logs and a ring has one writer.
pub fn send_log(frame: &[u8]) {
    LOG_OUT.push_whole(frame);
    NVIC::pend(Interrupt::USART3);
}

/// The way out to the host.
pub type HostPort = Outlet<'static, 4096, fn()>;

/// Waits until all has left the chip, a second at most: before a reset that was asked for.
pub fn drain() {
    let deadline_ms = time::now_ms() + 1000;
    while !(HOST_OUT.is_empty() && LOG_OUT.is_empty()) && time::now_ms() < deadline_ms {}
    // The last two bytes are still in the transmitter, where a character takes 87 µs.
    let last_ms = time::now_ms() + 2;
    while time::now_ms() < last_ms {}
}

/// Takes in what has come; tells of a hardware overrun, which reading the data register also clears.
fn receive(port: &RegisterBlock, mut push: impl FnMut(u8), mut overrun: impl FnMut()) {
    for _ in 0..BYTES_PER_INTERRUPT {
        let status = port.sr().read();
        if status.ore().bit_is_set() {
            overrun();
        }
        if status.rxne().bit_is_clear() && status.ore().bit_is_clear() {
            return;
        }
        let byte = port.dr().read().dr().bits() as u8;
        if status.rxne().bit_is_set() {
            push(byte);
        }
    }
}

fn count(counter: &AtomicU32) {
    counter.store(counter.load(Ordering::Relaxed).saturating_add(1), Ordering::Relaxed);
}

/// Sends while the transmitter takes bytes, then asks to be called again, or not if nothing is left.
#[allow(unsafe_code)]
fn transmit<const N: usize>(port: &RegisterBlock, ring: &Ring<N>) {
    for _ in 0..N {
        if port.sr().read().txe().bit_is_clear() {
            break;
        }
        let Some(byte) = ring.pop() else { break };
        // SAFETY: any byte may be sent.
        port.dr().write(|w| unsafe { w.dr().bits(u16::from(byte)) });
    }
    port.cr1().modify(|_, w| w.txeie().bit(!ring.is_empty()));
}

#[interrupt]
#[allow(unsafe_code)]
fn USART1() {
    // SAFETY: after start-up only this handler touches the port's registers.
    let port = unsafe { USART1::steal() };
    receive(&port, |byte| _ = HOST_IN.push(byte), || count(&HOST_OVERRUNS));
    transmit(&port, &HOST_OUT);
}

#[interrupt]
#[allow(unsafe_code)]
fn USART2() {
    // SAFETY: after start-up only this handler touches the port's registers.
    let port = unsafe { USART2::steal() };
    let now_ms = time::now_ms_low();
    receive(&port, |byte| GNSS_IN.push(byte, now_ms), || GNSS_IN.lose());
    transmit(&port, &GNSS_OUT);
}

#[interrupt]
#[allow(unsafe_code)]
fn USART3() {
    // SAFETY: after start-up only this handler touches the port's registers.
    let port = unsafe { USART3::steal() };
    receive(&port, |byte| _ = LOG_IN.push(byte), || count(&LOG_OVERRUNS));
    transmit(&port, &LOG_OUT);
}
