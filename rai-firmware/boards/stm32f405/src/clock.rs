//! The clock: 168 MHz from the 8 MHz crystal, or a named fallback.
//!
//! `f_core = f_crystal / M · N / P`, and a baud rate divides the clock of the port's bus:
//! `BRR = f_bus / baud`, rounded.
//!
//! | symbol | value | unit |
//! |---|---|---|
//! | `f_crystal` | 8 000 000 | Hz |
//! | `M`, `N`, `P` | 8, 336, 2 | – |
//! | bus 1 (USART2, USART3) | core / 4 | Hz |
//! | bus 2 (USART1) | core / 2 | Hz |
//! | flash wait states at 168 MHz | 5 | – |
//!
//! Assumes 2.7 V to 3.6 V, where five wait states suffice. References: [RM0090] §3.5.1, §7.2,
//! §30.3.4.
//!
//! [RM0090]: raim_firmware#references

use raim_firmware::receiver::Boot;

/// Frequency of the crystal, Hz.
const CRYSTAL_HZ: u32 = 8_000_000;
/// Divider in front of the PLL, so that its input is 1 MHz.
const PLL_M: u32 = 8;
/// Multiplier of the PLL.
const PLL_N: u32 = 336;
/// Divider behind the PLL.
const PLL_P: u32 = 2;
/// Frequency of the internal oscillator, Hz.
const INTERNAL_HZ: u32 = 16_000_000;
/// Core frequency from the crystal, Hz.
const FULL_HZ: u32 = CRYSTAL_HZ / PLL_M * PLL_N / PLL_P;

const _: () = assert!(FULL_HZ == 168_000_000, "the highest frequency that the chip allows");

/// Oscillator of the module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
#[cfg_attr(not(target_os = "none"), allow(dead_code))] // A host has no oscillator to choose.
pub enum Source {
    /// The crystal, through the PLL: 168 MHz.
    Crystal,
    /// The crystal or the PLL did not start: the internal oscillator, 16 MHz, within 1 %.
    Internal,
    /// No oscillator reports ready although the program runs, so that the clock cannot be set. It
    /// counts as full speed, as on an emulated core. If the clock is slower, time-outs are then
    /// late and never early.
    Unreported,
}

impl Source {
    /// Returns the largest rate at which this clock may run fast, parts per million.
    #[cfg_attr(not(target_os = "none"), allow(dead_code))] // As above.
    pub const fn error_ppm(self) -> u32 {
        match self {
            Self::Crystal | Self::Unreported => Boot::CRYSTAL_PPM,
            Self::Internal => Boot::WITHOUT_CRYSTAL_PPM,
        }
    }
}

/// The clock that runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clock {
    /// Oscillator.
    pub source: Source,
    /// Core frequency, Hz.
    pub core_hz: u32,
    /// Frequency of the bus of USART2 and USART3, Hz.
    pub bus1_hz: u32,
    /// Frequency of the bus of USART1, Hz.
    pub bus2_hz: u32,
}

impl Clock {
    /// Returns the frequencies that follow from the source.
    pub const fn from(source: Source) -> Self {
        match source {
            Source::Internal => {
                Self { source, core_hz: INTERNAL_HZ, bus1_hz: INTERNAL_HZ, bus2_hz: INTERNAL_HZ }
            }
            Source::Crystal | Source::Unreported => {
                Self { source, core_hz: FULL_HZ, bus1_hz: FULL_HZ / 4, bus2_hz: FULL_HZ / 2 }
            }
        }
    }
}

/// Returns the divider of a port's bus clock for `baud`, rounded to the nearest, with mantissa and
/// fraction as in `BRR`. A rate beyond the range gives the slowest.
pub const fn divider(bus_hz: u32, baud: u32) -> u16 {
    match bus_hz.saturating_add(baud / 2).checked_div(baud) {
        Some(divider) if divider <= u16::MAX as u32 => divider as u16,
        _ => u16::MAX,
    }
}

#[cfg(target_os = "none")]
mod registers {
    use stm32f4::stm32f405::{FLASH, RCC};

    use super::{Clock, PLL_M, PLL_N, Source};

    /// Number of polls after which the crystal counts as failed: more than 50 ms at 16 MHz, where
    /// data sheets give 2 ms.
    const CRYSTAL_POLLS: u32 = 100_000;
    /// Number of polls after which any other wait ends: more than 5 ms at 16 MHz; the PLL locks
    /// within 0.3 ms.
    const POLLS: u32 = 10_000;

    impl Clock {
        /// Starts the fastest available clock and returns it.
        pub fn start(rcc: &RCC, flash: &FLASH) -> Self {
            if !within(POLLS, || rcc.cr().read().hsirdy().is_ready()) {
                return Self::from(Source::Unreported);
            }
            if crystal(rcc) && pll(rcc) && switch(rcc, flash) {
                return Self::from(Source::Crystal);
            }
            retreat(rcc);
            Self::from(Source::Internal)
        }
    }

    fn crystal(rcc: &RCC) -> bool {
        rcc.cr().modify(|_, w| w.hseon().on());
        within(CRYSTAL_POLLS, || rcc.cr().read().hserdy().is_ready())
    }

    #[allow(unsafe_code)]
    fn pll(rcc: &RCC) -> bool {
        // SAFETY: 8 and 336 are legal for M (2..=63) and N (50..=432); 7 for Q gives the 48 MHz
        // that USB would want.
        rcc.pllcfgr().write(|w| unsafe {
            w.pllsrc().hse().pllm().bits(PLL_M as u8).plln().bits(PLL_N as u16).pllp().div2().pllq().bits(7)
        });
        rcc.cr().modify(|_, w| w.pllon().on());
        within(POLLS, || rcc.cr().read().pllrdy().is_ready())
    }

    /// Slows the flash before the core speeds up. The clock security system then watches the
    /// crystal. If it stops, the chip falls back to the internal oscillator and the fault handler
    /// of `fault.rs` runs.
    fn switch(rcc: &RCC, flash: &FLASH) -> bool {
        flash.acr().modify(|_, w| w.latency().ws5().prften().set_bit().icen().set_bit().dcen().set_bit());
        if !within(POLLS, || flash.acr().read().latency().is_ws5()) {
            return false;
        }
        rcc.cfgr().modify(|_, w| w.ppre1().div4().ppre2().div2());
        rcc.cfgr().modify(|_, w| w.sw().pll());
        let switched = within(POLLS, || rcc.cfgr().read().sws().is_pll());
        if switched {
            rcc.cr().modify(|_, w| w.csson().on());
        }
        switched
    }

    fn retreat(rcc: &RCC) {
        rcc.cfgr().modify(|_, w| w.sw().hsi().ppre1().div1().ppre2().div1());
        // The chip refuses to switch off an oscillator that still drives the core, so that no wait
        // is needed.
        rcc.cr().modify(|_, w| w.pllon().off().hseon().off());
    }

    /// Polls `done` at most `polls` times; returns true if it was done.
    fn within(polls: u32, mut done: impl FnMut() -> bool) -> bool {
        (0..polls).any(|_| done())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn divider_is_that_of_the_reference_manual() {
        // RM0090 table 136: 115200 baud from 42 MHz wants 22.8125 (×16 = 365), table 135 from 16
        // MHz 8.6875 (139).
        assert_eq!(divider(Clock::from(Source::Crystal).bus1_hz, 115_200), 365);
        assert_eq!(divider(Clock::from(Source::Internal).bus1_hz, 115_200), 139);
    }

    #[test]
    fn baud_rate_is_within_half_a_percent_on_every_clock() {
        for source in [Source::Crystal, Source::Internal] {
            let clock = Clock::from(source);
            for bus_hz in [clock.bus1_hz, clock.bus2_hz] {
                let have = f64::from(bus_hz) / f64::from(divider(bus_hz, 115_200));
                assert!((have / 115_200.0 - 1.0).abs() < 5e-3, "{source:?}: {have} baud");
            }
        }
    }

    #[test]
    fn buses_stay_below_their_limits() {
        // DS8626 table 14: bus 1 up to 42 MHz, bus 2 up to 84 MHz.
        let clock = Clock::from(Source::Crystal);
        assert_eq!((clock.core_hz, clock.bus1_hz, clock.bus2_hz), (168_000_000, 42_000_000, 84_000_000));
    }
}
