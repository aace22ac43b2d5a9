//! Requirements of the user's operation: alert limits, probabilities, time to alert.
//!
//! [`Requirements`] has no `Default`, so that every user chooses them. The presets are those of the
//! phases of flight. Limits and times are from [ICAO-A10] table 3.7.2.4-1, probabilities per sample
//! from [Yang2015] and [DO-229].
//!
//! [ICAO-A10]: crate#references
//! [Yang2015]: crate#references
//! [DO-229]: crate#references

use core::fmt;

pub use crate::allocation::{Allocation, AllocationError};
pub use crate::numeric::probability::Probability;

/// Requirements of an operation.
///
/// ```
/// use raim_core::Requirements;
/// use raim_core::requirements::RequirementsError;
///
/// let requirements = Requirements::lpv200().with_time_to_alert_s(2.0);
/// assert_eq!((requirements.hal_m, requirements.val_m), (40.0, Some(35.0)));
/// let refused = requirements.with_hal_m(-1.0).validate();
/// assert_eq!(refused, Err(RequirementsError::HorizontalAlertLimit(-1.0)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Requirements {
    /// Horizontal alert limit, m.
    pub hal_m: f64,
    /// Vertical alert limit, m; `None` if only the horizontal position matters.
    pub val_m: Option<f64>,
    /// Probability of a false alarm per epoch.
    pub false_alarm: Probability,
    /// Probability that a relevant fault is missed.
    pub missed_detection: Probability,
    /// Probability that the error exceeds a protection level without any fault.
    pub fault_free_risk: Probability,
    /// Longest time without a judged epoch until the alert, s. Every other alert is reported at
    /// once.
    pub time_to_alert_s: f64,
    /// Fraction of the alert limit below which a protection level must be, in (0, 1] ([Yang2015]:
    /// 0.95). ARAIM does not use it, because its levels account for all of the risk.
    ///
    /// [Yang2015]: crate#references
    pub guard_fraction: f64,
    /// Allocation of the risk for ARAIM.
    pub allocation: Allocation,
}

/// False-alarm probability per sample of non-precision approach ([Yang2015], [DO-229]: 1/3 of
/// 1e-6).
///
/// [Yang2015]: crate#references
/// [DO-229]: crate#references
pub(crate) const FALSE_ALARM: Probability = match Probability::new(3.33e-7) {
    Some(probability) => probability,
    None => unreachable!(),
};

/// Missed-detection probability ([DO-229]).
///
/// [DO-229]: crate#references
pub(crate) const MISSED_DETECTION: Probability = match Probability::new(1e-3) {
    Some(probability) => probability,
    None => unreachable!(),
};

/// Probability per sample that the error exceeds a level without a fault. It makes `K` 5.68
/// horizontally and 5.33 vertically ([`crate::integrity::raim::levels`]).
const FAULT_FREE_RISK: Probability = match Probability::new(1e-7) {
    Some(probability) => probability,
    None => unreachable!(),
};

impl Requirements {
    // Not inlined, so that the phases share one copy.
    #[inline(never)]
    const fn horizontal(hal_m: f64, time_to_alert_s: f64) -> Self {
        Self {
            hal_m,
            val_m: None,
            false_alarm: FALSE_ALARM,
            missed_detection: MISSED_DETECTION,
            fault_free_risk: FAULT_FREE_RISK,
            time_to_alert_s,
            guard_fraction: 0.95,
            allocation: Allocation::horizontal(),
        }
    }

    /// Returns the requirements en route, oceanic and continental low density: HAL 3,704 m, 300 s.
    pub const fn en_route() -> Self {
        Self::horizontal(3704.0, 300.0)
    }

    /// Returns the requirements of the terminal area: HAL 1,852 m, 15 s.
    pub const fn terminal() -> Self {
        Self::horizontal(1852.0, 15.0)
    }

    /// Returns the requirements of a non-precision approach: HAL 556 m, 10 s.
    pub const fn non_precision_approach() -> Self {
        Self::horizontal(556.0, 10.0)
    }

    /// Returns the requirements of localiser performance with vertical guidance down to 200 ft: HAL
    /// 40 m, VAL 35 m, 6 s.
    pub const fn lpv200() -> Self {
        let mut requirements = Self::horizontal(40.0, 6.0);
        requirements.val_m = Some(35.0);
        requirements.allocation = Allocation::vertical_guidance();
        requirements
    }

    setters! {
        with_hal_m(hal_m: f64)
        with_val_m(val_m: Option<f64>)
        with_false_alarm(false_alarm: Probability)
        with_missed_detection(missed_detection: Probability)
        with_fault_free_risk(fault_free_risk: Probability)
        with_time_to_alert_s(time_to_alert_s: f64)
        with_guard_fraction(guard_fraction: f64)
        with_allocation(allocation: Allocation)
    }

    /// Checks every field once.
    ///
    /// # Errors
    /// [`RequirementsError`] names the first field that is out of its range, with its value.
    pub fn validate(self) -> Result<Self, RequirementsError> {
        let limit = |limit_m: f64| limit_m > 0.0 && limit_m <= 1e6;
        if !limit(self.hal_m) {
            return Err(RequirementsError::HorizontalAlertLimit(self.hal_m));
        }
        if let Some(val_m) = self.val_m.filter(|&val_m| !limit(val_m)) {
            return Err(RequirementsError::VerticalAlertLimit(val_m));
        }
        if !(self.time_to_alert_s > 0.0 && self.time_to_alert_s <= 3600.0) {
            return Err(RequirementsError::TimeToAlert(self.time_to_alert_s));
        }
        if !(self.guard_fraction > 0.0 && self.guard_fraction <= 1.0) {
            return Err(RequirementsError::GuardFraction(self.guard_fraction));
        }
        self.allocation.validate().map_err(RequirementsError::Allocation)?;
        Ok(self)
    }
}

/// The requirement that is out of its range, with its value.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum RequirementsError {
    /// `hal_m` is outside (0, 1e6].
    HorizontalAlertLimit(f64),
    /// `val_m` is outside (0, 1e6].
    VerticalAlertLimit(f64),
    /// `time_to_alert_s` is outside (0, 3600].
    TimeToAlert(f64),
    /// `guard_fraction` is outside (0, 1].
    GuardFraction(f64),
    /// A field of `allocation` is outside its range.
    Allocation(AllocationError),
}

impl fmt::Display for RequirementsError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Without the value: code that prints doubles can panic, and takes 10 KB.
        formatter.write_str(match self {
            Self::HorizontalAlertLimit(_) => "horizontal alert limit must be above 0 and at most 1e6 m",
            Self::VerticalAlertLimit(_) => "vertical alert limit must be above 0 and at most 1e6 m",
            Self::TimeToAlert(_) => "time to alert must be above 0 and at most 3600 s",
            Self::GuardFraction(_) => "guard fraction must be above 0 and at most 1",
            Self::Allocation(error) => return error.fmt(formatter),
        })
    }
}

impl core::error::Error for RequirementsError {}
