//! The configuration of the monitoring.

use super::{Levels, Method, Policy};

/// Configuration of the monitoring: threshold, method, levels and aiding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(not(feature = "unstable"), non_exhaustive)]
pub struct Strategy {
    /// Threshold policy of the global test.
    pub policy: Policy,
    /// Method that finds the faulty satellites.
    pub method: Method,
    /// Quantity that a protection level bounds.
    pub levels: Levels,
    /// True if the predicted receiver clock is one more row. Without the feature `aiding` it has no
    /// effect.
    pub clock_aid: bool,
    /// True if the residuals of the last minutes scale the sigmas
    /// ([`crate::weighting::adaptation`]). Without the feature `aiding` it has no effect.
    pub sigma_adapt: bool,
}

impl Strategy {
    /// The classic threshold, the best exclusion within the work budget, levels that bound fault
    /// and noise, no aiding.
    pub const DEFAULT: Self = Self { method: Method::Auto, ..Self::CLASSIC };

    /// The classic threshold, sequential exclusion, levels that bound fault and noise, no aiding.
    pub const CLASSIC: Self = Self {
        policy: Policy::T1,
        method: Method::Baarda,
        levels: Levels::Bound,
        clock_aid: false,
        sigma_adapt: false,
    };

    /// Returns true if a predicted clock is one more row, which needs the feature `aiding`.
    pub(super) const fn aids_with_clock(self) -> bool {
        cfg!(feature = "aiding") && self.clock_aid
    }

    /// Returns true if residuals scale the sigmas, which needs the feature `aiding`.
    pub(super) const fn scales_sigmas(self) -> bool {
        cfg!(feature = "aiding") && self.sigma_adapt
    }
}
