//! The integrity pin of a module in process: a level in memory.

use std::convert::Infallible;

use embedded_hal::digital::{ErrorType, OutputPin};

/// A pin that is low until it is set.
#[derive(Debug, Default)]
pub struct Pin {
    /// Level of the pin.
    pub high: bool,
}

impl ErrorType for Pin {
    type Error = Infallible;
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.high = false;
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.high = true;
        Ok(())
    }
}
