//! Facts about the start.

/// Facts that the board knows at start.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Boot {
    /// Commit that the image was built from.
    pub git: &'static str,
    /// Cause of the start, in the words of `PRAIV`.
    pub reset_cause: heapless::String<16>,
    /// Largest rate at which the module's own clock may run fast, parts per million. A delay that
    /// grows more slowly is not detected.
    pub clock_error_ppm: u32,
}

impl Boot {
    /// Error of a clock with a crystal, parts per million: about 50 when new over its range of
    /// temperatures, and a margin for ageing.
    pub const CRYSTAL_PPM: u32 = 250;
    /// Error of a clock without a crystal, parts per million: 4 % from −10 to 85 °C by the data
    /// sheet of the STM32F405, 1 % at 25 °C. A larger error would break the reception of the UART.
    pub const WITHOUT_CRYSTAL_PPM: u32 = 40_000;

    /// Returns the facts for a program on a computer: no reset cause, and the clock error of a
    /// crystal. A board sets the fields that differ.
    pub const fn on_host(git: &'static str) -> Self {
        Self { git, reset_cause: heapless::String::new(), clock_error_ppm: Self::CRYSTAL_PPM }
    }
}
