//! Adaptive sigmas: one scale for all sigmas, from the residuals of the last ten minutes.
//!
//! ```text
//! s² = Σ SSE / χ²_α(Σ dof)         upper bound of the variance factor, which is larger with the probability α only
//! scale = s, limited to 0.5 … 3; 1 as long as Σ dof < 600
//! scale ≥ 1 unless SSE_m ≤ s² χ²_{1−α}(dof_m) in every minute m
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `SSE` | sum of squared residuals of one epoch, weighted by its sigmas before scaling | – |
//! | `dof` | its degrees of freedom | – |
//! | `χ²_α(ν)` | quantile by Wilson and Hilferty, accurate to 1e-4 for at least 600 degrees of freedom | – |
//! | `scale` | [`Adaptation::scale`] | – |
//!
//! There is one sum for each of ten minutes. Only epochs that passed their test are learned: if the
//! sigmas are so small that no epoch passes, nothing is learned and the verdict remains an alert.
//! If the time goes back, or after a gap of ten minutes, the sums begin anew.
//!
//! Residuals cannot show an error that stays constant for minutes. Therefore no scaled sigma is
//! below that of the satellite's broadcast orbit and clock, together with the residual error of the
//! ionosphere model ([`Adaptation::sigma_m`]). For the same reason the monitor permits no scale
//! below 1 for sigmas of an integrity support message.
//!
//! A scale below 1 assumes that errors are unusually small. Each of the ten minutes must agree with
//! it, so that one noisy minute is not averaged away. If an epoch with such sigmas does not pass
//! its test, the monitor begins anew ([`Adaptation::restart`]).
//!
//! Assumes that the errors of ten minutes are independent. Multipath that repeats from epoch to
//! epoch counts each time. The bound is then exceeded more often than with the probability `α`;
//! therefore the least scale is 0.5.

use super::ephemeris_sigma_m;
use super::residuals::RecentResiduals;
use crate::numeric::sqrt;
use crate::satellite::SatelliteId;

pub use super::residuals::Residuals;

/// Length of one sum, s.
const MINUTE_S: f32 = 60.0;

/// Least degrees of freedom for a scale.
pub const LEAST_DOF: u32 = 600;

/// Bounds of the scale, dimensionless.
pub const SCALES: core::ops::RangeInclusive<f64> = 0.5..=3.0;

/// `Q⁻¹(α)` for `α` = 1e-3: the variance factor exceeds its bound in one of a thousand windows.
const CONFIDENCE: f32 = 3.090_232;

/// Residuals of the last ten minutes.
#[derive(Clone, Debug)]
pub struct Adaptation {
    minutes: RecentResiduals,
}

impl Default for Adaptation {
    fn default() -> Self {
        Self::new()
    }
}

impl Adaptation {
    /// Returns an adaptation without residuals.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub const fn new() -> Self {
        Self { minutes: RecentResiduals::of(MINUTE_S) }
    }

    /// Forgets everything.
    pub fn restart(&mut self) {
        self.minutes.restart();
    }

    /// Learns from an epoch that passed its test.
    pub fn learn(&mut self, time_s: f64, residuals: Residuals) {
        self.minutes.add(time_s, residuals);
    }

    /// Returns the scale on all sigmas at a time; 1 with too few residuals.
    #[inline(never)]
    pub fn scale(&self, time_s: f64) -> f64 {
        let all = self.minutes.sum_at(time_s, Residuals::NONE);
        if all.dof < LEAST_DOF {
            return 1.0;
        }
        let factor = all.ratio() / all.ratio_at(-CONFIDENCE);
        // A minute without residuals does not contradict a scale.
        let contradicts =
            |minute: Residuals| minute.dof > 0 && minute.ratio() > factor * minute.ratio_at(CONFIDENCE);
        let is_quiet = factor < 1.0 && !self.minutes.at(time_s).any(contradicts);
        let least = if is_quiet { *SCALES.start() as f32 } else { 1.0 };
        f64::from(sqrt(factor).clamp(least, *SCALES.end() as f32))
    }

    /// Returns a scaled sigma, m.
    ///
    /// It is never below that of the satellite's orbit and clock together with `common_m`, the
    /// shared part of the error. If `sigma_m` is already smaller, it is not reduced.
    pub fn sigma_m(scale: f64, satellite: SatelliteId, sigma_m: f64, common_m: f32) -> f64 {
        let orbit_m = ephemeris_sigma_m(satellite, 0.0);
        let floor_m = f64::from(sqrt(orbit_m * orbit_m + common_m * common_m)).min(sigma_m);
        (scale * sigma_m).max(floor_m)
    }
}
