//! Limits of the receiver's motion, and how long epochs must agree after a contradiction.

use super::doubt::SETTLED_S;

/// Required agreement if one of its epochs has only one degree of freedom.
pub const WEAK: Recovery = Recovery { epochs: 10, seconds: 10.0 };

/// Required agreement after rates contradicted position or clock. It is longer than a drift needs
/// to be detected again.
pub const DOUBTED: Recovery = Recovery { epochs: 10, seconds: SETTLED_S };

/// Required length of an agreement, in epochs and in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Recovery {
    /// Number of consecutive epochs.
    pub epochs: u16,
    /// Time from the first epoch to the last, s. By the caller's clock it may be shorter by up to
    /// [`DELAY_S`](super::DELAY_S).
    pub seconds: f64,
}

impl Recovery {
    pub(super) fn at_least(self, other: Self) -> Self {
        Self { epochs: self.epochs.max(other.epochs), seconds: self.seconds.max(other.seconds) }
    }

    /// Returns true if an agreement of this length suffices; [`WEAK`] applies if one of its
    /// epochs had one degree of freedom.
    #[doc(hidden)]
    pub fn is_met(self, epochs: u16, seconds: f64, is_weak: bool) -> bool {
        let wanted = if is_weak { self.at_least(WEAK) } else { self };
        epochs >= wanted.epochs && seconds >= wanted.seconds
    }
}

/// Limits of the receiver's motion, and the required agreement.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct ContinuitySettings {
    /// Highest speed, m/s.
    pub max_speed_m_s: f64,
    /// Least height above the ellipsoid, m.
    pub min_height_m: f64,
    /// Greatest height above the ellipsoid, m.
    pub max_height_m: f64,
    /// Required agreement after an alert.
    pub recovery: Recovery,
}

impl ContinuitySettings {
    /// Returns limits for the ground, the sea and the air: 515 m/s (1000 knots), −500 to 20,000 m,
    /// 3 epochs and 3 s.
    pub const fn anywhere() -> Self {
        Self {
            max_speed_m_s: 515.0,
            min_height_m: -500.0,
            max_height_m: 20_000.0,
            recovery: Recovery { epochs: 3, seconds: 3.0 },
        }
    }

    setters! {
        with_max_speed_m_s(max_speed_m_s: f64)
        with_min_height_m(min_height_m: f64)
        with_max_height_m(max_height_m: f64)
        with_recovery(recovery: Recovery)
    }

    /// Checks every field once.
    ///
    /// # Errors
    /// [`ContinuityError`] names the first field that is out of its range, with its value.
    #[doc(hidden)]
    pub fn validate(self) -> Result<Self, ContinuityError> {
        // NaN fails each of these comparisons.
        if !(0.0..=1e5).contains(&self.max_speed_m_s) {
            return Err(ContinuityError::Speed(self.max_speed_m_s));
        }
        let heights = -1.2e4..=1e8;
        if !heights.contains(&self.min_height_m)
            || !heights.contains(&self.max_height_m)
            || self.min_height_m >= self.max_height_m
        {
            let Self { min_height_m, max_height_m, .. } = self;
            return Err(ContinuityError::Height { min_height_m, max_height_m });
        }
        if self.recovery.epochs == 0 || !(0.0..=3600.0).contains(&self.recovery.seconds) {
            return Err(ContinuityError::Recovery(self.recovery));
        }
        Ok(self)
    }
}

/// The setting that is out of its range.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ContinuityError {
    /// `max_speed_m_s` is outside [0, 1e5].
    Speed(f64),
    /// A height is outside [−1.2e4, 1e8], or the least height is not below the greatest.
    Height {
        /// Least height, m.
        min_height_m: f64,
        /// Greatest height, m.
        max_height_m: f64,
    },
    /// The recovery has no epoch, or seconds outside [0, 3600].
    Recovery(Recovery),
}

impl core::fmt::Display for ContinuityError {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        formatter.write_str(match self {
            Self::Speed(_) => "highest speed must be within 0 to 1e5 m/s",
            Self::Height { .. } => "height limits must be within -12000 to 1e8 m, minimum below maximum",
            Self::Recovery(_) => "recovery needs at least 1 epoch and 0 to 3600 s",
        })
    }
}

impl core::error::Error for ContinuityError {}
