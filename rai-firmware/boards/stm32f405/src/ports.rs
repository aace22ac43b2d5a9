//! The three serial ports, driven by interrupts through byte rings.
//!
//! A port's interrupt moves received bytes into one ring and waiting bytes out of the other. Code
//! that puts bytes into a ring requests the interrupt once; then the transmitter's interrupt
//! continues. Sending therefore works if the transmitter interrupts when it is empty, and also if
//! it is never busy. The rings are in `raim_board_arm::rings`.
//!
//! References: [RM0090] §30.
//!
//! [RM0090]: raim_firmware#references

use cortex_m::peripheral::NVIC;
use raim_firmware::outlet::Outlet;
use raim_firmware::ring::Ring;
use stm32f4::stm32f405::{Interrupt, RCC, USART1, USART2, USART3, interrupt, usart1::RegisterBlock};

use super::clock::{Clock, divider};
use raim_board_arm::HAS_LOG;
use raim_board_arm::rings::{GNSS_IN, HOST_IN, HOST_OUT, HostPort, LOG_OUT, note_host_overrun};
use raim_board_arm::time;

/// Rate of all three ports at start, bit/s.
const BAUD: u32 = 115_200;

/// Largest number of bytes that one interrupt receives. It bounds the time in the handler for any
/// state of the peripheral.
const BYTES_PER_INTERRUPT: usize = 64;

/// Starts the ports and their interrupts; returns the writer to the host.
pub fn start(rcc: &RCC, host: &USART1, gnss: &USART2, log: &USART3, clock: Clock) -> HostPort {
    rcc.apb1enr().modify(|_, w| w.usart2en().enabled().usart3en().enabled());
    rcc.apb2enr().modify(|_, w| w.usart1en().enabled());
    enable(host, divider(clock.bus2_hz, BAUD));
    enable(gnss, divider(clock.bus1_hz, BAUD));
    if HAS_LOG {
        enable(log, divider(clock.bus1_hz, BAUD));
    }
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
    // SAFETY: the handlers below touch only their rings and registers, which are ready; no critical
    // section that works by masking single interrupts exists.
    unsafe {
        NVIC::unmask(Interrupt::USART1);
        NVIC::unmask(Interrupt::USART2);
        if HAS_LOG {
            NVIC::unmask(Interrupt::USART3);
        }
    }
}

/// Sets the rate of the GNSS port, bit/s.
#[allow(unsafe_code)]
pub fn set_gnss_rate(clock: Clock, baud: u32) {
    // SAFETY: no other code writes the register after start-up, and any 16-bit value is a legal
    // divider.
    unsafe {
        let port = USART2::steal();
        port.brr().write(|w| w.bits(divider(clock.bus1_hz, baud)));
    }
}

/// Queues one frame of the log, whole or not at all; never waits.
///
/// Call it with interrupts held back, because every context logs and a ring has one writer.
pub fn send_log(frame: &[u8]) {
    LOG_OUT.push_whole(frame);
    NVIC::pend(Interrupt::USART3);
}

/// Takes received bytes, and reports a hardware overrun, which reading the data register also
/// clears.
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

/// Sends while the transmitter takes bytes; leaves its interrupt enabled if bytes remain.
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
    receive(&port, |byte| _ = HOST_IN.push(byte), note_host_overrun);
    transmit(&port, &HOST_OUT);
}

#[interrupt]
#[allow(unsafe_code)]
fn USART2() {
    // SAFETY: after start-up only this handler touches the port's registers.
    let port = unsafe { USART2::steal() };
    let now_ms = time::now_ms_low();
    // The module sends nothing to the GNSS receiver.
    receive(&port, |byte| GNSS_IN.push(byte, now_ms), || GNSS_IN.lose());
}

#[interrupt]
#[allow(unsafe_code)]
fn USART3() {
    if !HAS_LOG {
        return;
    }
    // SAFETY: after start-up only this handler touches the port's registers.
    let port = unsafe { USART3::steal() };
    // No input is expected here, and noise on an open line is no loss.
    receive(&port, |_| (), || ());
    transmit(&port, &LOG_OUT);
}
