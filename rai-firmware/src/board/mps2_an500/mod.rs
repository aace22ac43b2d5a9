//! The emulated MPS2 board with the image AN500, a Cortex-M7 with doubles in hardware, as an
//! example of a port.
//!
//! | part | peripheral |
//! |---|---|
//! | host, GNSS, log port | UART 0, 1, 2 (CMSDK) |
//! | integrity pin | user LED 0 of the board's registers |
//! | time | `SysTick`, one interrupt per millisecond |
//! | watchdog | CMSDK watchdog, fed by the epoch loop alone |
//!
//! The emulator keeps no reset flags, so that a start without the record of a fault reports
//! `UNKNOWN`. The LED register is written but not emulated; the log shows the pin.
//!
//! References: [AN500]; [CMSDK] (UART, watchdog).
//!
//! [AN500]: raim_firmware#references
//! [CMSDK]: raim_firmware#references

mod ports;
mod registers;

use core::convert::Infallible;
use core::mem::MaybeUninit;
use core::ops::Range;

use cortex_m::singleton;
use cortex_m_rt::entry;
use embedded_hal::digital::{ErrorType, OutputPin};
use raim_firmware::board::reset::ResetCause;
use raim_firmware::board::{Board, Note, PortLosses, SEALED_BYTES};
use raim_firmware::receiver::Boot;
use raim_firmware::timed_ring::Taken;

use crate::arm::rings::{self, HostPort};
use crate::arm::{fault, log, sealed, stack, start, time};
use registers::{LED, WATCHDOG};

pub use ports::send_log;

/// Address range of the stack.
pub const RAM: Range<usize> = 0x2000_0000..0x2040_0000;

/// Frequency of the core, Hz.
const CORE_HZ: u32 = 25_000_000;

/// Ticks until the watchdog's interrupt, two seconds, and again until its reset.
const WATCHDOG_TICKS: u32 = 2 * CORE_HZ;

/// The board after start-up.
struct Mps2An500 {
    reset_cause: ResetCause,
    host: HostPort,
    sealed: &'static mut [u8; SEALED_BYTES],
}

/// Output that is high while the position may be used.
pub struct IntegrityPin {
    high: bool,
    driven_ticks: u64,
}

#[entry]
fn main() -> ! {
    let place = singleton!(: start::Place<IntegrityPin> = MaybeUninit::uninit());
    let (Some((mut board, pin)), Some(place)) = (Mps2An500::take(), place) else { fault::reset_on_request() };
    log::start();
    log!(info, "clock: {=str}, core at {=u32} Hz", "Board", CORE_HZ);
    start::run(&mut board, place, pin)
}

impl Mps2An500 {
    /// Starts the board, the pin first; `None` if it was taken before.
    fn take() -> Option<(Self, IntegrityPin)> {
        let mut core = cortex_m::Peripherals::take()?;
        drop_integrity_pin();
        let pin = IntegrityPin { high: false, driven_ticks: 0 };
        stack::guard(&core.MPU, &mut core.SCB);
        let reset_cause = fault::take_record().map_or(ResetCause::Unknown, ResetCause::Fault);
        time::start(core.SYST, CORE_HZ);
        let host = ports::start();
        WATCHDOG.start(WATCHDOG_TICKS);
        Some((Self { reset_cause, host, sealed: sealed::take()? }, pin))
    }
}

/// Drives the pin low, whatever owns it.
pub fn drop_integrity_pin() {
    LED.set(0);
}

impl IntegrityPin {
    /// Drives the LED, and logs a change, because an emulator shows a pin only in a log.
    fn drive(&mut self, high: bool) {
        LED.set(u32::from(high));
        self.driven_ticks = time::now_ticks();
        if core::mem::replace(&mut self.high, high) != high {
            if high {
                log!(info, "integrity pin high");
            } else {
                log!(info, "integrity pin low");
            }
        }
    }
}

impl ErrorType for IntegrityPin {
    type Error = Infallible;
}

impl OutputPin for IntegrityPin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.drive(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.drive(true);
        Ok(())
    }
}

impl Board for Mps2An500 {
    type Pin = IntegrityPin;
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
        Boot::CRYSTAL_PPM
    }

    fn now_ticks(&self) -> u64 {
        time::now_ticks()
    }

    fn driven_ticks(&self, pin: &IntegrityPin) -> u64 {
        pin.driven_ticks
    }

    fn losses(&self) -> PortLosses {
        rings::losses(&self.host)
    }

    fn feed_watchdog(&mut self) {
        WATCHDOG.feed(WATCHDOG_TICKS);
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
        ports::set_gnss_rate(baud);
    }

    fn note(&mut self, note: Note) {
        log::note(note);
    }
}
