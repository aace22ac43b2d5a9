//! Requirements that a monitor can meet.

use core::fmt;

use crate::integrity::raim::detection::threshold::{ThresholdError, Thresholds};
use crate::integrity::raim::levels::Factors;
use crate::numeric::real::Real;
use crate::requirements::{Requirements, RequirementsError};

/// Why a monitor cannot be made.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MonitorError {
    /// A requirement is out of its range.
    Requirements(RequirementsError),
    /// A probability is not among the committed tables.
    Threshold(ThresholdError),
}

impl fmt::Display for MonitorError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Requirements(error) => error.fmt(formatter),
            Self::Threshold(error) => error.fmt(formatter),
        }
    }
}

impl core::error::Error for MonitorError {}

/// Requirements that can be met, and what follows from them.
#[derive(Clone, Copy, Debug)]
pub struct Accepted<T> {
    pub(super) requirements: Requirements,
    pub(super) thresholds: Thresholds<'static>,
    pub(super) factors: Factors<T>,
}

impl<T: Real> Accepted<T> {
    /// Looks whether they can be met.
    ///
    /// # Errors
    /// [`MonitorError`] names the requirement that cannot.
    pub fn new(requirements: Requirements) -> Result<Self, MonitorError> {
        let requirements = requirements.validate().map_err(MonitorError::Requirements)?;
        let thresholds = Thresholds::from_tables(requirements.false_alarm, requirements.missed_detection)
            .map_err(MonitorError::Threshold)?;
        let factors = Factors::new(requirements.missed_detection, requirements.fault_free_risk);
        Ok(Self { requirements, thresholds, factors })
    }

    /// Thresholds for their probabilities.
    pub fn thresholds(&self) -> &Thresholds<'static> {
        &self.thresholds
    }

    /// Factors of the protection levels for their probabilities.
    pub fn factors(&self) -> &Factors<T> {
        &self.factors
    }
}
