//! The integrity pin as a level in memory, for hosts, libraries and tests.

use core::convert::Infallible;

use embedded_hal::digital::{ErrorType, OutputPin};

/// A pin that is low until it is set.
///
/// ```
/// use embedded_hal::digital::OutputPin as _;
/// use raim_firmware::pin::MemoryPin;
///
/// let mut pin = MemoryPin::default();
/// assert!(!pin.high);
/// pin.set_high().unwrap();
/// assert!(pin.high);
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct MemoryPin {
    /// True if the position is protected.
    pub high: bool,
}

impl ErrorType for MemoryPin {
    type Error = Infallible;
}

impl OutputPin for MemoryPin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.high = false;
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.high = true;
        Ok(())
    }
}
