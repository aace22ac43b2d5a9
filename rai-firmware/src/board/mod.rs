//! The STM32F405 board: the only place that knows registers.
//!
//! | what | where |
//! |---|---|
//! | GNSS port | USART2, PA3 in, PA2 out |
//! | host port | USART1, PA10 in, PA9 out |
//! | log port | USART3, PB10 out; RTT for a debug probe |
//! | integrity pin, LED | PC6, PC7, both low until the receiver raises them |
//! | time | `SysTick`, one interrupt per millisecond |
//! | watchdog | IWDG, fed by the epoch loop alone |
//!
//! There is no switch between silicon and emulator. Every wait is bounded, every fallback has a name ([`Source`]), and
//! a peripheral that does not answer is a fact to report and not a reason to stop.
//!
//! References: [RM0090] reference manual of the family, [DS8626] data sheet of the chip.

pub mod clock;
#[cfg(target_os = "none")]
pub mod fault;
#[cfg(target_os = "none")]
pub mod pins;
#[cfg(target_os = "none")]
pub mod ports;
#[cfg(target_os = "none")]
pub mod stack;
#[cfg(target_os = "none")]
pub mod time;
#[cfg(target_os = "none")]
pub mod watchdog;

#[cfg(target_os = "none")]
pub use hardware::{Board, sleep_unless};

#[cfg(target_os = "none")]
mod hardware {
    use rai_firmware::reset::ResetCause;
    use stm32f4::stm32f405::Peripherals;

    use super::{
        clock::Clock, fault, pins, pins::IntegrityPin, ports, ports::HostPort, stack, time,
        watchdog::Watchdog,
    };

    /// The board after start-up: what the epoch loop needs, and why the module started.
    pub struct Board {
        /// The clock that really runs.
        pub clock: Clock,
        /// Why the module started.
        pub reset_cause: ResetCause,
        /// The output that says that the position may be used.
        pub pin: IntegrityPin,
        /// The sentences' way out.
        pub host: HostPort,
        /// Resets the module if the epoch loop stops.
        pub watchdog: Watchdog,
    }

    impl Board {
        /// Brings the board up; `None` if it was taken before.
        ///
        /// The pin comes first, so that it is driven low before anything can go wrong.
        pub fn take() -> Option<Self> {
            let mut core = cortex_m::Peripherals::take()?;
            let chip = Peripherals::take()?;
            let pin = IntegrityPin::take(&chip.RCC, chip.GPIOC);
            stack::guard(&core.MPU, &mut core.SCB);
            let reset_cause = fault::reset_cause(&chip.RCC);
            let clock = Clock::start(&chip.RCC, &chip.FLASH);
            time::start(core.SYST, clock);
            pins::route_ports(&chip.RCC, &chip.GPIOA, &chip.GPIOB);
            let host = ports::start(&chip.RCC, &chip.USART1, &chip.USART2, &chip.USART3, clock);
            Some(Self { clock, reset_cause, pin, host, watchdog: Watchdog::start(chip.IWDG) })
        }
    }

    /// Sleeps until the next interrupt, unless there is `work`; gives the tick at which an interrupt ended the sleep.
    ///
    /// Asked and slept with interrupts held back: one that comes between the question and the sleep ends the sleep at
    /// once, and is served after it.
    pub fn sleep_unless(work: impl FnOnce() -> bool) -> Option<u64> {
        cortex_m::interrupt::free(|_| {
            if work() {
                return None;
            }
            cortex_m::asm::wfi();
            Some(time::now_ticks())
        })
    }
}
