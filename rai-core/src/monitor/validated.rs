//! Validated requirements.

use core::fmt;

use crate::integrity::raim::detection::threshold::{ThresholdError, Thresholds};
use crate::integrity::raim::levels::KFactors;
use crate::numeric::real::Real;
use crate::requirements::{Requirements, RequirementsError};

/// Reason why a monitor cannot be made.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum MonitorError {
    /// A requirement is out of its range.
    Requirements(RequirementsError),
    /// A probability is not in the committed tables.
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

/// Requirements that were validated, with their thresholds and factors.
#[derive(Clone, Copy, Debug)]
pub struct ValidatedRequirements<T, const N: usize> {
    pub(super) requirements: Requirements,
    pub(super) thresholds: Thresholds<'static>,
    pub(super) factors: KFactors<T>,
}

impl<T: Real, const N: usize> ValidatedRequirements<T, N> {
    /// Validates the requirements.
    ///
    /// # Errors
    /// [`MonitorError`] names the requirement that cannot be met.
    pub fn new(requirements: Requirements) -> Result<Self, MonitorError> {
        let requirements = requirements.validate().map_err(MonitorError::Requirements)?;
        let thresholds = Thresholds::up_to::<N>(requirements.false_alarm, requirements.missed_detection)
            .map_err(MonitorError::Threshold)?;
        let factors = KFactors::new(requirements.missed_detection, requirements.fault_free_risk);
        Ok(Self { requirements, thresholds, factors })
    }

    /// Returns the thresholds for the required probabilities.
    pub fn thresholds(&self) -> &Thresholds<'static> {
        &self.thresholds
    }

    /// Returns the factors of the protection levels for the required probabilities.
    pub fn factors(&self) -> &KFactors<T> {
        &self.factors
    }
}
