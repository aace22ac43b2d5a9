//! The integrity pin, with the tick at which it was last driven.

use embedded_hal::digital::{ErrorType, OutputPin};

use crate::{log, time};

/// A chip's output that is high while the position may be used.
pub struct IntegrityPin<P> {
    output: P,
    high: bool,
    driven_ticks: u64,
}

impl<P> IntegrityPin<P> {
    /// Takes an output that is low.
    pub const fn new(output: P) -> Self {
        Self { output, high: false, driven_ticks: 0 }
    }

    /// Returns the tick at which the pin was last driven, to the same level or another; ticks of
    /// the core clock since start.
    pub(crate) const fn driven_ticks(&self) -> u64 {
        self.driven_ticks
    }

    /// Notes the tick, and returns true if the level changes.
    fn changed(&mut self, high: bool) -> bool {
        self.driven_ticks = time::now_ticks();
        core::mem::replace(&mut self.high, high) != high
    }
}

impl<P: OutputPin> ErrorType for IntegrityPin<P> {
    type Error = P::Error;
}

impl<P: OutputPin> OutputPin for IntegrityPin<P> {
    fn set_low(&mut self) -> Result<(), P::Error> {
        self.output.set_low()?;
        if self.changed(false) {
            log!(info, "integrity pin low");
        }
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), P::Error> {
        self.output.set_high()?;
        if self.changed(true) {
            log!(info, "integrity pin high");
        }
        Ok(())
    }
}
