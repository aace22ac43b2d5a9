//! Allocation of the integrity risk: its division among the axes, and the share of unmonitored
//! faults.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `PHMI_V`, `PHMI_H` | [`Allocation::integrity_vertical`], [`Allocation::integrity_horizontal`] | per sample |
//! | `P_FA_V`, `P_FA_H` | [`Allocation::alarm_vertical`], [`Allocation::alarm_horizontal`] | per sample |
//! | `P_THRES` | [`Allocation::unmonitored_probability`] | per sample |
//! | `FC_THRES` | [`Allocation::consolidation`] | – |
//! | `P_EMT` | [`Allocation::emt_prior`] | – |
//!
//! The numbers are those of [MAAST], for one effective sample over the exposure. Before they are
//! used for certification, they must be compared with the text of the working group.
//!
//! [MAAST]: crate#references

use core::fmt;

/// Risks that an operation permits.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Allocation {
    /// Probability of hazardously misleading information that is allotted to the vertical level.
    pub integrity_vertical: f64,
    /// Probability of hazardously misleading information that is allotted to the horizontal level.
    pub integrity_horizontal: f64,
    /// Probability of a false alarm of the vertical tests.
    pub alarm_vertical: f64,
    /// Probability of a false alarm of the horizontal tests.
    pub alarm_horizontal: f64,
    /// Probability of faults that may be unmonitored.
    pub unmonitored_probability: f64,
    /// Share of the probability of a constellation's loss. Faults within it that are less likely
    /// are counted with that loss.
    pub consolidation: f64,
    /// Least prior probability of a mode that counts in the effective monitor threshold (EMT).
    pub emt_prior: f64,
    /// Largest effective monitor threshold of a usable position, m.
    pub emt_limit_m: Option<f64>,
    /// Largest standard deviation of the height for accuracy of a usable position, m.
    pub accuracy_limit_m: Option<f64>,
    /// True if satellites may be left out after an alarm. This option takes its share of the risk
    /// even without an alarm.
    pub exclusion: bool,
}

impl Allocation {
    /// Returns the allocation of approaches with vertical guidance (LPV-200).
    pub const fn vertical_guidance() -> Self {
        Self {
            integrity_vertical: 9.8e-8,
            integrity_horizontal: 2e-9,
            alarm_vertical: 3.9e-6,
            alarm_horizontal: 9e-8,
            unmonitored_probability: 6e-8,
            consolidation: 0.01,
            emt_prior: 1e-5,
            emt_limit_m: Some(15.0),
            accuracy_limit_m: Some(1.87),
            exclusion: true,
        }
    }

    /// Returns the allocation of any other operation with a vertical limit: the same risk without
    /// the EMT and accuracy limits.
    pub const fn vertical() -> Self {
        Self { emt_limit_m: None, accuracy_limit_m: None, ..Self::vertical_guidance() }
    }

    /// Returns the allocation of phases of flight without vertical guidance (H-ARAIM).
    pub const fn horizontal() -> Self {
        Self {
            integrity_vertical: 1e-9,
            integrity_horizontal: 9.9e-8,
            alarm_vertical: 1e-9,
            alarm_horizontal: 5e-7,
            unmonitored_probability: 9e-8,
            consolidation: 0.05,
            emt_prior: 1e-5,
            emt_limit_m: None,
            accuracy_limit_m: None,
            exclusion: true,
        }
    }

    /// Returns `PHMI`, that of both levels together.
    #[doc(hidden)]
    pub const fn integrity(&self) -> f64 {
        self.integrity_vertical + self.integrity_horizontal
    }

    /// Checks every field once: probabilities in (0, 0.5), consolidation in [0, 1].
    ///
    /// # Errors
    /// [`AllocationError`] names the first field that is out of its range, with its value.
    #[doc(hidden)]
    pub fn validate(self) -> Result<Self, AllocationError> {
        if !cfg!(feature = "araim") {
            return Ok(self);
        }
        let probabilities = [
            (self.integrity_vertical, "vertical integrity risk"),
            (self.integrity_horizontal, "horizontal integrity risk"),
            (self.alarm_vertical, "vertical false-alarm probability"),
            (self.alarm_horizontal, "horizontal false-alarm probability"),
            (self.unmonitored_probability, "unmonitored probability"),
            (self.emt_prior, "prior of the monitor threshold"),
        ];
        // NaN fails these comparisons.
        let refused = probabilities.iter().find(|(value, _)| !(*value > 0.0 && *value < 0.5));
        match refused {
            Some(&(value, rule)) => Err(AllocationError { rule, value }),
            None if (0.0..=1.0).contains(&self.consolidation) => Ok(self),
            None => Err(AllocationError { rule: CONSOLIDATION, value: self.consolidation }),
        }
    }
}

/// Name of the field that is a share and not a probability.
const CONSOLIDATION: &str = "consolidation share";

/// The field of an allocation that is out of its range.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct AllocationError {
    /// Name of the field.
    pub rule: &'static str,
    /// The value that was given.
    pub value: f64,
}

impl fmt::Display for AllocationError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_share = self.rule == CONSOLIDATION;
        let range = if is_share { "within 0 to 1" } else { "above 0 and below 0.5" };
        write!(formatter, "{} must be {range}", self.rule)
    }
}

impl core::error::Error for AllocationError {}
