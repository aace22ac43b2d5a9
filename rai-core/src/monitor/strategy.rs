//! The configuration of the monitoring.

use super::{Levels, Method, Policy};

/// Configuration of the monitoring: threshold, method, levels and aiding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
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
    /// Noise of the receiver.
    pub noise: Noise,
}

/// Noise and multipath of a receiver and its antenna: the least factor on the receiver's part of
/// each variance. Larger residuals raise it whatever the choice.
///
/// The numbers are those of one frequency at the zenith, for a strong signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Noise {
    /// 0.4 m, and down to a third of it once the receiver has been quiet at rest
    /// ([`crate::weighting::adaptation`]). Without the feature `aiding` it is
    /// [`Self::Geodetic`].
    Auto,
    /// 0.4 m: an antenna that suppresses reflections.
    Geodetic,
    /// 1.5 m: a patch antenna.
    Consumer,
    /// 5 m: the antenna of a telephone.
    Phone,
}

impl Noise {
    /// Returns the least factor on the receiver's part of a variance, if nothing was learned.
    pub(super) const fn least(self) -> f32 {
        /// Variance of noise and multipath in [`crate::weighting`], m².
        const MODEL_M2: f32 = 0.3 * 0.3 + 0.3 * 0.3;
        match self {
            Self::Auto | Self::Geodetic => 1.0,
            Self::Consumer => 1.5 * 1.5 / MODEL_M2,
            Self::Phone => 5.0 * 5.0 / MODEL_M2,
        }
    }
}

impl Strategy {
    /// The classic threshold, the best exclusion within the work budget, levels that bound fault
    /// and noise, no aiding, noise that is learned.
    pub const DEFAULT: Self = Self { method: Method::Auto, noise: Noise::Auto, ..Self::CLASSIC };

    /// The classic threshold, sequential exclusion, levels that bound fault and noise, no aiding.
    #[doc(hidden)]
    pub const CLASSIC: Self = Self {
        policy: Policy::T1,
        method: Method::Baarda,
        levels: Levels::Bound,
        clock_aid: false,
        noise: Noise::Geodetic,
    };

    setters! {
        with_policy(policy: Policy)
        with_method(method: Method)
        with_levels(levels: Levels)
        with_clock_aid(clock_aid: bool)
        with_noise(noise: Noise)
    }

    /// Returns true if a predicted clock is one more row, which needs the feature `aiding`.
    pub(super) const fn aids_with_clock(self) -> bool {
        cfg!(feature = "aiding") && self.clock_aid
    }

    /// Returns true if quiet minutes lower the noise.
    ///
    /// They do not for sigmas of an integrity support message, because small residuals prove
    /// nothing about rare faults and constant errors.
    pub(super) fn lowers_noise(self) -> bool {
        cfg!(all(feature = "aiding", feature = "past"))
            && matches!(self.noise, Noise::Auto)
            && !self.method.uses_ism()
    }
}
