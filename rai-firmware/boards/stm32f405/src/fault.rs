//! Reset cause of the chip, and the exception that only this chip has.
//!
//! References: [RM0090] §7.3.21 (flags of `RCC_CSR`).
//!
//! [RM0090]: raim_firmware#references

use raim_firmware::board::reset::ResetCause;

/// Returns the cause by the flags of `RCC_CSR`. The most specific flag wins, because power-on also
/// sets those of pin and brownout.
pub const fn cause(csr: u32) -> ResetCause {
    const BROWNOUT: u32 = 1 << 25;
    const PIN: u32 = 1 << 26;
    const POWER_ON: u32 = 1 << 27;
    const SOFTWARE: u32 = 1 << 28;
    const WATCHDOGS: u32 = 1 << 29 | 1 << 30;
    const LOW_POWER: u32 = 1 << 31;
    match csr {
        _ if csr & POWER_ON != 0 => ResetCause::PowerOn,
        _ if csr & BROWNOUT != 0 => ResetCause::Brownout,
        _ if csr & LOW_POWER != 0 => ResetCause::LowPower,
        _ if csr & WATCHDOGS != 0 => ResetCause::Watchdog,
        _ if csr & SOFTWARE != 0 => ResetCause::Software,
        _ if csr & PIN != 0 => ResetCause::Pin,
        _ => ResetCause::Unknown,
    }
}

#[cfg(target_os = "none")]
mod registers {
    use cortex_m_rt::exception;
    use raim_board_arm::fault::{give_up, take_record};
    use raim_firmware::board::reset::{Fault, ResetCause};
    use stm32f4::stm32f405::RCC;

    use crate::board::Stm32f405;

    /// Reads and clears the reset cause: the record of a fault if there is one, otherwise the
    /// chip's flags.
    pub fn reset_cause(rcc: &RCC) -> ResetCause {
        let flags = rcc.csr().read().bits();
        rcc.csr().modify(|_, w| w.rmvf().set_bit());
        take_record().map_or(super::cause(flags), ResetCause::Fault)
    }

    /// Handles the clock security system's exception: the crystal has stopped and the ports run at
    /// the wrong rate.
    #[exception]
    #[allow(unsafe_code)]
    unsafe fn NonMaskableInt() -> ! {
        give_up::<Stm32f405>(Fault::Clock)
    }

    /// Treats an interrupt that was not enabled as a fault.
    #[exception]
    #[allow(unsafe_code)]
    unsafe fn DefaultHandler(_number: i16) -> ! {
        give_up::<Stm32f405>(Fault::Hard { address: 0 })
    }
}

#[cfg(target_os = "none")]
pub use registers::reset_cause;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_of_the_reference_manual_name_the_cause() {
        // RM0090 §7.3.21; the first row is the register's documented value after power-on.
        let cases = [
            (0x0E00_0000, ResetCause::PowerOn),
            (0x0600_0000, ResetCause::Brownout),
            (0x0400_0000, ResetCause::Pin),
            (0x1400_0000, ResetCause::Software),
            (0x2400_0000, ResetCause::Watchdog),
            (0x4400_0000, ResetCause::Watchdog),
            (0x8400_0000, ResetCause::LowPower),
            (0x0000_0000, ResetCause::Unknown),
        ];
        for (csr, want) in cases {
            assert_eq!(cause(csr), want, "RCC_CSR {csr:#010x}");
        }
    }
}
