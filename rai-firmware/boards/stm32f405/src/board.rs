//! The chip as a board of the module.

use core::mem::MaybeUninit;
use core::ops::Range;

use cortex_m::singleton;
use cortex_m_rt::entry;
use raim_board_arm::board::CortexBoard;
use raim_board_arm::pin::IntegrityPin;
use raim_board_arm::{Chip, fault, handlers, log, stack, start, time};
use stm32f4::stm32f405::Peripherals;

use crate::clock::Clock;
use crate::pins::{self, PinAndLed};
use crate::ports;
use crate::watchdog::Watchdog;

/// The chip after start-up.
pub struct Stm32f405 {
    clock: Clock,
    watchdog: Watchdog,
}

handlers!(Stm32f405);

impl Chip for Stm32f405 {
    type Output = PinAndLed;

    const RAM: Range<usize> = 0x2000_0000..0x2002_0000;

    fn drop_integrity_pin() {
        pins::drop_integrity_pin();
    }

    fn send_log(frame: &[u8]) {
        ports::send_log(frame);
    }

    fn clock_error_ppm(&self) -> u32 {
        self.clock.source.error_ppm()
    }

    fn feed_watchdog(&mut self) {
        self.watchdog.feed();
    }

    fn set_gnss_rate(&mut self, baud: u32) {
        ports::set_gnss_rate(self.clock, baud);
    }
}

#[entry]
fn main() -> ! {
    let place = singleton!(: start::Place<Stm32f405> = MaybeUninit::uninit());
    let (Some((board, clock, pin)), Some(place)) = (take(), place) else {
        fault::reset_on_request::<Stm32f405>()
    };
    log::start();
    log!(info, "clock: {}, core at {=u32} Hz", clock.source, clock.core_hz);
    start::run(board, place, pin)
}

/// Starts the board; `None` if it was taken before.
///
/// The pin comes first, so that it is low before any other step can fail.
fn take() -> Option<(CortexBoard<Stm32f405>, Clock, IntegrityPin<PinAndLed>)> {
    let mut core = cortex_m::Peripherals::take()?;
    let chip = Peripherals::take()?;
    let pin = IntegrityPin::new(PinAndLed::take(&chip.RCC, chip.GPIOC));
    stack::guard(&core.MPU, &mut core.SCB);
    let reset_cause = crate::fault::reset_cause(&chip.RCC);
    let clock = Clock::start(&chip.RCC, &chip.FLASH);
    time::start(core.SYST, clock.core_hz);
    pins::route_ports(&chip.RCC, &chip.GPIOA, &chip.GPIOB);
    let host = ports::start(&chip.RCC, &chip.USART1, &chip.USART2, &chip.USART3, clock);
    let chip = Stm32f405 { clock, watchdog: Watchdog::start(chip.IWDG) };
    Some((CortexBoard::new(chip, reset_cause, host)?, clock, pin))
}
