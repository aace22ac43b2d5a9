//! Chips: their memory, and which of them an image can be written to.
//!
//! | quantity | field | unit |
//! |---|---|---|
//! | flash | `flash_kib` | KiB |
//! | consecutive RAM from `0x2000_0000` on, which holds statics and stack | `ram_kib` | KiB |
//!
//! Memory beside that RAM, as the core-coupled memory of the STM32F405, is not used. The project
//! has a board for the chips of [`SUPPORTED`]. Those of [`OTHERS`] have the memory for some image,
//! and a board must be written for them: pins, clock, ports, watchdog and faults.
//!
//! References: [DS8626] §4 (memory map of the STM32F405). The memory of the other chips is that of
//! the target descriptions of probe-rs 0.32.
//!
//! [DS8626]: crate#references

use std::fmt;
use std::ops::Range;

use anyhow::bail;

/// A chip whose memory is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chip {
    /// Name in probe-rs.
    pub name: &'static str,
    /// Size of the flash, KiB.
    pub flash_kib: u64,
    /// Size of the RAM that holds statics and stack, KiB.
    pub ram_kib: u64,
}

const fn chip(name: &'static str, flash_kib: u64, ram_kib: u64) -> Chip {
    Chip { name, flash_kib, ram_kib }
}

/// Chips of the board `stm32f405`: one family member in its packages and sizes.
pub(super) const SUPPORTED: [Chip; 4] = [
    chip("STM32F405RGTx", 1024, 128),
    chip("STM32F405VGTx", 1024, 128),
    chip("STM32F405ZGTx", 1024, 128),
    chip("STM32F405OEYx", 512, 128),
];

/// Chips with the same processor, a Cortex-M4F, and without a board, from large to small.
pub(super) const OTHERS: [Chip; 10] = [
    chip("STM32F411CE", 512, 128),
    chip("nRF52832_xxAA", 512, 64),
    chip("STM32F446RC", 256, 128),
    chip("STM32F401CC", 256, 64),
    chip("STM32L432KC", 256, 64),
    chip("STM32F303CC", 256, 40),
    chip("STM32F302CC", 256, 40),
    chip("STM32F373CC", 256, 32),
    chip("STM32L412KB", 128, 40),
    chip("STM32G431KB", 128, 32),
];

impl Chip {
    /// Returns the supported chip of that name.
    ///
    /// # Errors
    /// If the name is unknown or its chip has no board; the message lists the supported ones.
    pub fn named(name: &str) -> anyhow::Result<Self> {
        if let Some(found) = SUPPORTED.iter().find(|chip| chip.name.eq_ignore_ascii_case(name)) {
            return Ok(*found);
        }
        let supported: Vec<&str> = SUPPORTED.iter().map(|chip| chip.name).collect();
        bail!("chip `{name}` is not one of {}", supported.join(", "));
    }

    /// Returns the addresses of the flash of a supported chip.
    pub const fn flash(&self) -> Range<u64> {
        0x0800_0000..0x0800_0000 + self.flash_kib * 1024
    }

    /// Returns the addresses of the RAM of a supported chip.
    pub const fn ram(&self) -> Range<u64> {
        0x2000_0000..0x2000_0000 + self.ram_kib * 1024
    }

    /// Returns true if the chip has that much flash and RAM, bytes.
    pub const fn holds(&self, flash_bytes: u64, ram_bytes: u64) -> bool {
        flash_bytes <= self.flash_kib * 1024 && ram_bytes <= self.ram_kib * 1024
    }
}

impl fmt::Display for Chip {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} ({} KiB of flash, {} KiB of RAM)", self.name, self.flash_kib, self.ram_kib)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smaller_flash_of_a_sister_chip_is_known() {
        let chip = Chip::named("stm32f405oeyx").expect("a known chip");
        assert_eq!(chip.flash(), 0x0800_0000..0x0808_0000);
        let error = Chip::named("STM32F103C8").expect_err("another family").to_string();
        assert!(error.contains("STM32F405RGTx"), "{error}");
    }

    #[test]
    fn chip_holds_what_fills_it_and_no_byte_more() {
        let chip = chip("of 128 and 32 KiB", 128, 32);
        assert!(chip.holds(0x2_0000, 0x8000));
        assert!(!chip.holds(0x2_0001, 0x8000) && !chip.holds(0x2_0000, 0x8001));
    }
}
