//! Facts about the start.

/// Facts that the board knows at start.
#[derive(Clone, Debug)]
pub struct Boot {
    /// Commit that the image was built from.
    pub git: &'static str,
    /// Cause of the start, in the words of `PRAIV`.
    pub reset_cause: heapless::String<16>,
    /// Largest gain of the module's own clock on the right time, parts per million. An epoch
    /// delayed by less than this gain goes unnoticed.
    pub clock_error_ppm: u32,
}

impl Boot {
    /// Error of a clock with a crystal, parts per million: some 50 when new and over its
    /// temperatures, and a margin for ageing.
    pub const CRYSTAL_PPM: u32 = 250;
    /// Error of a clock without a crystal, parts per million: 1 % at room temperature. A larger
    /// error would break UART reception anyway.
    pub const WITHOUT_CRYSTAL_PPM: u32 = 40_000;

    /// Returns the facts for a program on a computer: no cause, and a crystal.
    pub const fn on_host(git: &'static str) -> Self {
        Self { git, reset_cause: heapless::String::new(), clock_error_ppm: Self::CRYSTAL_PPM }
    }
}
