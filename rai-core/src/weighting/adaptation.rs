//! Adaptive sigmas: one scale on all of them, from the residuals of the last ten minutes.
//!
//! ```text
//! s² = Σ SSE / χ²_α(Σ dof)         upper bound of the variance factor: it is larger with the probability α only
//! scale = s, held within 0.5 and 3; 1 while Σ dof < 600
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
//! Assumes that the errors of ten minutes are independent. Multipath that repeats from epoch to
//! epoch counts each time, and the bound is then tighter than its probability says; therefore the
//! least scale is 0.5.

use heapless::Deque;

use super::ephemeris_sigma_m;
use crate::satellite::SatelliteId;

/// Number of minutes that are kept.
const MINUTES: usize = 10;

/// Length of one sum, s.
const MINUTE_S: f64 = 60.0;

/// Least degrees of freedom for a scale.
pub const LEAST_DOF: u32 = 600;

/// Bounds of the scale, dimensionless.
pub const SCALES: core::ops::RangeInclusive<f64> = 0.5..=3.0;

/// `Q⁻¹(α)` for `α` = 1e-3: the variance factor is larger than its bound in one of a thousand
/// windows.
const CONFIDENCE: f64 = 3.090_232_306_167_813;

/// Sums of one minute.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Minute {
    number: f64,
    sse: f64,
    dof: u32,
}

/// Residuals of an epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residuals {
    /// Weighted sum of squared residuals, by the sigmas of the epoch.
    pub sse: f64,
    /// Degrees of freedom.
    pub dof: u32,
}

/// Residuals of the last ten minutes.
#[derive(Clone, Debug, Default)]
pub struct Adaptation {
    minutes: Deque<Minute, MINUTES>,
}

impl Adaptation {
    /// Returns an adaptation without residuals.
    pub const fn new() -> Self {
        Self { minutes: Deque::new() }
    }

    /// Forgets everything.
    pub fn restart(&mut self) {
        self.minutes.clear();
    }

    /// Learns from an epoch that passed its test.
    pub fn learn(&mut self, time_s: f64, residuals: Residuals) {
        let number = libm::floor(time_s / MINUTE_S);
        // NaN fails this comparison, so that it is not learned.
        if !(residuals.sse >= 0.0 && residuals.sse.is_finite() && number.is_finite()) {
            return;
        }
        self.forget_before(number);
        match self.minutes.back_mut() {
            Some(minute) if minute.number >= number => {
                minute.sse += residuals.sse;
                minute.dof = minute.dof.saturating_add(residuals.dof);
            }
            _ => {
                // Never full, because at most ten minutes are kept above, this one included.
                let _ = self.minutes.push_back(Minute { number, sse: residuals.sse, dof: residuals.dof });
            }
        }
    }

    /// Drops minutes older than ten, and later ones, which exist only if time went back.
    fn forget_before(&mut self, number: f64) {
        if self.minutes.back().is_some_and(|latest| latest.number > number) {
            self.restart();
        }
        while self.minutes.front().is_some_and(|oldest| oldest.number + MINUTES as f64 <= number) {
            self.minutes.pop_front();
        }
    }

    /// Returns the scale on all sigmas at a time; 1 with too few residuals.
    #[inline(never)]
    pub fn scale(&self, time_s: f64) -> f64 {
        let now = libm::floor(time_s / MINUTE_S);
        let is_recent = |minute: &&Minute| minute.number <= now && minute.number + MINUTES as f64 > now;
        let recent = || self.minutes.iter().filter(is_recent);
        let dof = recent().fold(0_u32, |sum, minute| sum.saturating_add(minute.dof));
        if dof < LEAST_DOF {
            return 1.0;
        }
        let sse: f64 = recent().map(|minute| minute.sse).sum();
        libm::sqrt(sse / lower_quantile(dof)).clamp(*SCALES.start(), *SCALES.end())
    }

    /// Returns a scaled sigma, m.
    ///
    /// It is never below that of the satellite's orbit and clock together with `common_m`, the
    /// shared part of the error, unless the sigma was below already.
    pub fn sigma_m(scale: f64, satellite: SatelliteId, sigma_m: f64, common_m: f32) -> f64 {
        let orbit_m = ephemeris_sigma_m(satellite, 0.0);
        let floor_m = f64::from(libm::sqrtf(orbit_m * orbit_m + common_m * common_m)).min(sigma_m);
        (scale * sigma_m).max(floor_m)
    }
}

/// Returns `χ²_α(ν)`: `ν (1 − 2/(9ν) − z √(2/(9ν)))³`, `z = Q⁻¹(α)`.
fn lower_quantile(dof: u32) -> f64 {
    let dof = f64::from(dof);
    let spread = 2.0 / (9.0 * dof);
    let root = 1.0 - spread - CONFIDENCE * libm::sqrt(spread);
    dof * root * root * root
}
