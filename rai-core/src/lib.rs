//! Receiver autonomous integrity monitoring for microcontrollers.
#![no_std]

pub mod epoch;
pub mod frame;
pub mod probability;
pub mod report;
pub mod requirements;
pub mod satellite;
pub mod threshold;

/// One epoch's ranges to a report: see the module's documentation.
pub use report::{Report, Verdict};
