//! The board of the module, on the emulated MPS2.

use core::convert::Infallible;
use core::mem::MaybeUninit;
use core::ops::Range;

use cortex_m::singleton;
use cortex_m_rt::entry;
use embedded_hal::digital::{ErrorType, OutputPin};
use raim_board_arm::board::CortexBoard;
use raim_board_arm::pin::IntegrityPin;
use raim_board_arm::{Chip, fault, handlers, log, stack, start, time};
use raim_firmware::board::reset::ResetCause;
use raim_firmware::receiver::Boot;

use crate::ports;
use crate::registers::{LED, WATCHDOG};

/// Frequency of the core, Hz.
pub const CORE_HZ: u32 = 25_000_000;

/// Ticks until the watchdog's interrupt, two seconds, and again until its reset.
const WATCHDOG_TICKS: u32 = 2 * CORE_HZ;

/// The chip.
pub struct Mps2An500;

/// Output of the integrity pin: the LED.
pub struct PinOfLed;

handlers!(Mps2An500);

impl Chip for Mps2An500 {
    type Output = PinOfLed;

    const RAM: Range<usize> = 0x2000_0000..0x2040_0000;

    fn drop_integrity_pin() {
        LED.set(0);
    }

    fn send_log(frame: &[u8]) {
        ports::send_log(frame);
    }

    fn clock_error_ppm(&self) -> u32 {
        Boot::CRYSTAL_PPM
    }

    fn feed_watchdog(&mut self) {
        WATCHDOG.feed(WATCHDOG_TICKS);
    }

    fn set_gnss_rate(&mut self, baud: u32) {
        ports::set_gnss_rate(baud);
    }
}

#[entry]
fn main() -> ! {
    let place = singleton!(: start::Place<Mps2An500> = MaybeUninit::uninit());
    let (Some(board), Some(place)) = (take(), place) else { fault::reset_on_request::<Mps2An500>() };
    log::start();
    log!(info, "clock: {=str}, core at {=u32} Hz", "Board", CORE_HZ);
    start::run(board, place, IntegrityPin::new(PinOfLed))
}

/// Starts the board, the pin first; `None` if it was taken before.
fn take() -> Option<CortexBoard<Mps2An500>> {
    let mut core = cortex_m::Peripherals::take()?;
    Mps2An500::drop_integrity_pin();
    stack::guard(&core.MPU, &mut core.SCB);
    let reset_cause = fault::take_record().map_or(ResetCause::Unknown, ResetCause::Fault);
    time::start(core.SYST, CORE_HZ);
    let host = ports::start();
    WATCHDOG.start(WATCHDOG_TICKS);
    CortexBoard::new(Mps2An500, reset_cause, host)
}

impl ErrorType for PinOfLed {
    type Error = Infallible;
}

impl OutputPin for PinOfLed {
    fn set_low(&mut self) -> Result<(), Infallible> {
        LED.set(0);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        LED.set(1);
        Ok(())
    }
}
