//! The chip as a board of the module.

use core::mem::MaybeUninit;
use core::ops::Range;

use cortex_m::singleton;
use cortex_m_rt::entry;
use raim_board_arm::rings::{self, HostPort};
use raim_board_arm::{Chip, fault, handlers, log, sealed, stack, start, time};
use raim_firmware::board::reset::ResetCause;
use raim_firmware::board::{Board, Note, PortLosses, SEALED_BYTES};
use raim_firmware::timed_ring::Taken;
use stm32f4::stm32f405::Peripherals;

use crate::clock::Clock;
use crate::pins::{self, IntegrityPin};
use crate::ports;
use crate::watchdog::Watchdog;

/// The board after start-up.
pub struct Stm32f405 {
    clock: Clock,
    reset_cause: ResetCause,
    host: HostPort,
    watchdog: Watchdog,
    sealed: &'static mut [u8; SEALED_BYTES],
}

handlers!(Stm32f405);

impl Chip for Stm32f405 {
    const RAM: Range<usize> = 0x2000_0000..0x2002_0000;

    fn drop_integrity_pin() {
        pins::drop_integrity_pin();
    }

    fn send_log(frame: &[u8]) {
        ports::send_log(frame);
    }
}

#[entry]
fn main() -> ! {
    let place = singleton!(: start::Place<IntegrityPin> = MaybeUninit::uninit());
    let (Some((mut board, pin)), Some(place)) = (Stm32f405::take(), place) else {
        fault::reset_on_request::<Stm32f405>()
    };
    log::start();
    log!(info, "clock: {}, core at {=u32} Hz", board.clock.source, board.clock.core_hz);
    start::run(&mut board, place, pin)
}

impl Stm32f405 {
    /// Starts the board; `None` if it was taken before.
    ///
    /// The pin comes first, so that it is low before any other step can fail.
    fn take() -> Option<(Self, IntegrityPin)> {
        let mut core = cortex_m::Peripherals::take()?;
        let chip = Peripherals::take()?;
        let pin = IntegrityPin::take(&chip.RCC, chip.GPIOC);
        stack::guard(&core.MPU, &mut core.SCB);
        let reset_cause = crate::fault::reset_cause(&chip.RCC);
        let clock = Clock::start(&chip.RCC, &chip.FLASH);
        time::start(core.SYST, clock.core_hz);
        pins::route_ports(&chip.RCC, &chip.GPIOA, &chip.GPIOB);
        let host = ports::start(&chip.RCC, &chip.USART1, &chip.USART2, &chip.USART3, clock);
        let (watchdog, sealed) = (Watchdog::start(chip.IWDG), sealed::take()?);
        Some((Self { clock, reset_cause, host, watchdog, sealed }, pin))
    }
}

impl Board for Stm32f405 {
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
        self.clock.source.error_ppm()
    }

    fn now_ticks(&self) -> u64 {
        time::now_ticks()
    }

    fn driven_ticks(&self, pin: &IntegrityPin) -> u64 {
        pin.driven_ticks()
    }

    fn losses(&self) -> PortLosses {
        rings::losses(&self.host)
    }

    fn feed_watchdog(&mut self) {
        self.watchdog.feed();
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
        ports::set_gnss_rate(self.clock, baud);
    }

    fn note(&mut self, note: Note) {
        log::note(note);
    }
}
