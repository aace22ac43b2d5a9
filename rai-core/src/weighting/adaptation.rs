//! Sigmas that learn: a scale on all of them, by what the residuals of the last ten minutes say.
//!
//! ```text
//! s² = Σ SSE / χ²_α(Σ dof)         upper bound of the variance factor: it is larger with the probability α only
//! scale = s, held within 0.5 and 3; 1 while Σ dof < 600
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `SSE` | weighted sum of squared residuals of one epoch, the weights those of the sigmas as they came | – |
//! | `dof` | its degrees of freedom | – |
//! | `χ²_α(ν)` | Wilson and Hilferty's cube of a normal one, good to 1e-4 from 600 degrees of freedom on | – |
//! | `scale` | [`Adaptation::scale`] | – |
//!
//! Sums are kept by the minute, ten of them. Only epochs that passed their test are learned: where sigmas are so small that
//! nothing passes, nothing is learned, and what is said stays an alert. Time that goes back, and a gap of ten minutes, begin
//! anew.
//!
//! No scaled sigma is below what is assumed of the satellite's broadcast orbit and clock, together with what the model of
//! the ionosphere misses ([`Adaptation::sigma_m`]): an error that is the same for minutes leaves residuals that others explain.
//! For the same reason the monitor lets no scale below 1 on sigmas that an integrity support message promises.
//!
//! Assumes that ten minutes see errors of their own. What multipath repeats from epoch to epoch counts as often as it is
//! seen, and the bound is then tighter than its probability says: hence the least scale of 0.5.

use heapless::Deque;

use super::ephemeris_sigma_m;
use crate::satellite::SatelliteId;

/// Minutes that are remembered.
const MINUTES: usize = 10;

/// Length of what is summed up together, s.
const MINUTE_S: f64 = 60.0;

/// Degrees of freedom below which nothing is known.
pub const LEAST_DOF: u32 = 600;

/// Bounds of the scale, dimensionless.
pub const SCALES: core::ops::RangeInclusive<f64> = 0.5..=3.0;

/// `Q⁻¹(α)` for `α` = 1e-3: the variance factor is larger than its bound once in a thousand windows.
const CONFIDENCE: f64 = 3.090_232_306_167_813;

/// What one minute adds.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Minute {
    number: f64,
    sse: f64,
    dof: u32,
}

/// What an epoch says of its sigmas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residuals {
    /// Weighted sum of squared residuals, by the sigmas as they came.
    pub sse: f64,
    /// Degrees of freedom.
    pub dof: u32,
}

/// The last ten minutes' residuals.
#[derive(Clone, Debug, Default)]
pub struct Adaptation {
    minutes: Deque<Minute, MINUTES>,
}

impl Adaptation {
    /// Nothing learned yet.
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
        // Written so that what is not a number is not learned.
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
                // Ten minutes at most are left above, this one included.
                let _ = self.minutes.push_back(Minute { number, sse: residuals.sse, dof: residuals.dof });
            }
        }
    }

    /// Drops what is older than ten minutes, and all that comes after: time went back.
    fn forget_before(&mut self, number: f64) {
        if self.minutes.back().is_some_and(|latest| latest.number > number) {
            self.restart();
        }
        while self.minutes.front().is_some_and(|oldest| oldest.number + MINUTES as f64 <= number) {
            self.minutes.pop_front();
        }
    }

    /// What all sigmas are to be multiplied by at a time; 1 while too little is known.
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

    /// A scaled sigma, m: never below what is assumed of the satellite's orbit and clock, together with `common_m`, what ranges
    /// share of the error, unless it was below already.
    pub fn sigma_m(scale: f64, satellite: SatelliteId, sigma_m: f64, common_m: f32) -> f64 {
        let orbit_m = ephemeris_sigma_m(satellite, 0.0);
        let floor_m = f64::from(libm::sqrtf(orbit_m * orbit_m + common_m * common_m)).min(sigma_m);
        (scale * sigma_m).max(floor_m)
    }
}

/// `χ²_α(ν)`: `ν (1 − 2/(9ν) − z √(2/(9ν)))³`, `z = Q⁻¹(α)`.
fn lower_quantile(dof: u32) -> f64 {
    let dof = f64::from(dof);
    let spread = 2.0 / (9.0 * dof);
    let root = 1.0 - spread - CONFIDENCE * libm::sqrt(spread);
    dof * root * root * root
}
