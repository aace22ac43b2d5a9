//! The independent watchdog: resets the module if the epoch loop stops.
//!
//! `T = 32 · RLR / f_LSI`. The watchdog has its own oscillator, so that it works without the
//! crystal. It cannot be stopped.
//!
//! | symbol | value | unit |
//! |---|---|---|
//! | `f_LSI` | 17 000 to 47 000 | Hz |
//! | `RLR` | 2000 | – |
//! | `T` | 1.4 to 3.8 | s |
//!
//! References: [RM0090] §21, [DS8626] table 35.
//!
//! [RM0090]: raim_firmware#references
//! [DS8626]: raim_firmware#references

use stm32f4::stm32f405::IWDG;

/// Counts until the reset.
const RELOAD: u16 = 2000;

/// The running watchdog. Only the epoch loop has it, so that nothing else can feed it.
pub struct Watchdog {
    registers: IWDG,
}

impl Watchdog {
    /// Starts the watchdog. The hardware takes the new period within a few of its own clocks. Until
    /// then the default of half a second runs, so that no wait is needed.
    pub fn start(registers: IWDG) -> Self {
        registers.kr().write(|w| w.key().start());
        registers.kr().write(|w| w.key().unlock());
        registers.pr().write(|w| w.pr().divide_by32());
        registers.rlr().write(|w| w.rl().set(RELOAD));
        let mut watchdog = Self { registers };
        watchdog.feed();
        watchdog
    }

    /// Feeds the watchdog.
    pub fn feed(&mut self) {
        self.registers.kr().write(|w| w.key().feed());
    }
}
