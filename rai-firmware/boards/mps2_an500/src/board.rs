//! The board of the module, on the emulated MPS2.

use core::convert::Infallible;
use core::mem::MaybeUninit;
use core::ops::Range;

use cortex_m::singleton;
use cortex_m_rt::entry;
use embedded_hal::digital::{ErrorType, OutputPin};
use raim_board_arm::rings::{self, HostPort};
use raim_board_arm::{Chip, fault, handlers, log, sealed, stack, start, time};
use raim_firmware::board::reset::ResetCause;
use raim_firmware::board::{Board, Note, PortLosses, SEALED_BYTES};
use raim_firmware::receiver::Boot;
use raim_firmware::timed_ring::Taken;

use crate::ports;
use crate::registers::{LED, WATCHDOG};

/// Frequency of the core, Hz.
pub const CORE_HZ: u32 = 25_000_000;

/// Ticks until the watchdog's interrupt, two seconds, and again until its reset.
const WATCHDOG_TICKS: u32 = 2 * CORE_HZ;

/// The board after start-up.
pub struct Mps2An500 {
    reset_cause: ResetCause,
    host: HostPort,
    sealed: &'static mut [u8; SEALED_BYTES],
}

/// Output that is high while the position may be used.
pub struct IntegrityPin {
    high: bool,
    driven_ticks: u64,
}

handlers!(Mps2An500);

impl Chip for Mps2An500 {
    const RAM: Range<usize> = 0x2000_0000..0x2040_0000;

    fn drop_integrity_pin() {
        LED.set(0);
    }

    fn send_log(frame: &[u8]) {
        ports::send_log(frame);
    }
}

#[entry]
fn main() -> ! {
    let place = singleton!(: start::Place<IntegrityPin> = MaybeUninit::uninit());
    let (Some((mut board, pin)), Some(place)) = (Mps2An500::take(), place) else {
        fault::reset_on_request::<Mps2An500>()
    };
    log::start();
    log!(info, "clock: {=str}, core at {=u32} Hz", "Board", CORE_HZ);
    start::run(&mut board, place, pin)
}

impl Mps2An500 {
    /// Starts the board, the pin first; `None` if it was taken before.
    fn take() -> Option<(Self, IntegrityPin)> {
        let mut core = cortex_m::Peripherals::take()?;
        Self::drop_integrity_pin();
        let pin = IntegrityPin { high: false, driven_ticks: 0 };
        stack::guard(&core.MPU, &mut core.SCB);
        let reset_cause = fault::take_record().map_or(ResetCause::Unknown, ResetCause::Fault);
        time::start(core.SYST, CORE_HZ);
        let host = ports::start();
        WATCHDOG.start(WATCHDOG_TICKS);
        Some((Self { reset_cause, host, sealed: sealed::take()? }, pin))
    }
}

impl IntegrityPin {
    /// Drives the LED, and logs a change, because an emulator shows a pin only in a log.
    fn drive(&mut self, high: bool) {
        LED.set(u32::from(high));
        self.driven_ticks = time::now_ticks();
        if core::mem::replace(&mut self.high, high) != high {
            log!(info, "integrity pin {=str}", if high { "high" } else { "low" });
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
