//! Adaptive sigmas: one scale on all of them, from the residuals of the last ten minutes.
//!
//! ```text
//! s² = Σ SSE / χ²_α(Σ dof)         upper bound of the variance factor: it is larger with the probability α only
//! scale = s, held within 0.5 and 3; 1 while Σ dof < 600
//! scale ≥ 1 unless SSE_m ≤ s² χ²_{1−α}(dof_m) in every minute m
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `SSE` | weighted sum of squared residuals of one epoch, with the weights of its own sigmas | – |
//! | `dof` | its degrees of freedom | – |
//! | `χ²_α(ν)` | Wilson and Hilferty's cube of a normal one, accurate to 1e-4 from 600 degrees of freedom on | – |
//! | `scale` | [`Adaptation::scale`] | – |
//!
//! Sums are kept for each of ten minutes. Only epochs that passed their test are learned: if sigmas
//! are so small that no epoch passes, nothing is learned and the verdict stays an alert. If time
//! goes back, or after a gap of ten minutes, the sums begin anew.
//!
//! No scaled sigma is below that of the satellite's broadcast orbit and clock together with the
//! residual error of the ionosphere model ([`Adaptation::sigma_m`]), because an error that stays
//! for minutes leaves residuals that look like others. For the same reason the monitor allows no
//! scale below 1 on sigmas of an integrity support message.
//!
//! A scale below 1 is a promise of quiet. It holds only while each of the ten minutes agrees with
//! it, so that one noisy minute is not averaged away; and the monitor begins anew
//! ([`Adaptation::restart`]) once an epoch with such sigmas does not pass its test.
//!
//! Assumes that the errors of ten minutes are independent. Multipath that repeats from epoch to
//! epoch counts each time, and the bound is then tighter than its probability says; therefore the
//! least scale is 0.5.

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

/// `Q⁻¹(α)` for `α` = 1e-3: the variance factor is larger than its bound in one of a thousand
/// windows.
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
        // A minute without residuals contradicts no scale.
        let contradicts =
            |minute: Residuals| minute.dof > 0 && minute.ratio() > factor * minute.ratio_at(CONFIDENCE);
        let is_quiet = factor < 1.0 && !self.minutes.at(time_s).any(contradicts);
        let least = if is_quiet { *SCALES.start() } else { 1.0 };
        f64::from(sqrt(factor)).clamp(least, *SCALES.end())
    }

    /// Returns a scaled sigma, m.
    ///
    /// It is never below that of the satellite's orbit and clock together with `common_m`, the
    /// shared part of the error, unless the sigma was below already.
    pub fn sigma_m(scale: f64, satellite: SatelliteId, sigma_m: f64, common_m: f32) -> f64 {
        let orbit_m = ephemeris_sigma_m(satellite, 0.0);
        let floor_m = f64::from(sqrt(orbit_m * orbit_m + common_m * common_m)).min(sigma_m);
        (scale * sigma_m).max(floor_m)
    }
}
