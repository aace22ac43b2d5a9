//! Quiet receivers: how small may the receiver's part of the variances be, by the last hour at rest?
//!
//! ```text
//! κ = Σ SSE / χ²_α(Σ dof)     limited to 1/9 … 1
//! κ = 1                       unless SSE_m ≤ κ χ²_{1−α}(dof_m) in every span m of six minutes
//! κ = 1                       as long as Σ dof < 300, or less than ten minutes have been learned
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `κ` | [`Adaptation::noise`]: factor on the receiver's part of each variance | – |
//! | `SSE` | sum of squared residuals of one epoch, weighted by the sigmas of the model | – |
//! | `dof` | its degrees of freedom | – |
//! | `χ²_α(ν)` | quantile by Wilson and Hilferty, accurate to 3e-4 for at least 300 degrees of freedom | – |
//!
//! Only epochs that passed their test are learned. If the time goes back, or after a gap of an hour,
//! the sums begin anew.
//!
//! Orbit, clock and atmosphere keep their sigmas, because residuals cannot show an error that stays
//! constant for minutes. They are a part of `SSE`, so that the noise is smaller than `κ` says.
//!
//! A factor below 1 assumes that errors are unusually small, and stay so. Each span must agree with
//! it, so that noisy minutes are not averaged away. The monitor uses it at rest only, and takes it
//! back in the epoch that contradicts it ([`crate::monitor`]).
//!
//! Assumes that the errors of an hour are independent. Multipath that repeats from epoch to epoch
//! counts each time. The bound is then exceeded more often than with the probability `α`; therefore
//! the least factor is 1/9.

use super::residuals::RecentResiduals;

pub use super::residuals::Residuals;

/// Length of one sum, s: a tenth of an hour.
const SPAN_S: f32 = 360.0;

/// Least degrees of freedom for a factor below 1. At 1 Hz ten minutes have more in any sky that can be
/// tested. Half a minute apart, five in each epoch make them in half an hour, and these epochs are
/// less alike than those of a second.
pub const LEAST_DOF: u32 = 300;

/// Least time of rest for a factor below 1, s.
pub const LEAST_REST_S: f64 = 600.0;

/// Least factor: a third of the sigma.
pub const LEAST_NOISE: f32 = 1.0 / 9.0;

/// `Q⁻¹(α)` for `α` = 1e-3: the variance factor exceeds its bound in one of a thousand windows.
const CONFIDENCE: f32 = 3.090_232;

/// Residuals of the last hour at rest.
#[derive(Clone, Debug)]
pub struct Adaptation {
    spans: RecentResiduals,
    /// Time of the first epoch; NaN before it.
    since_s: f64,
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
        Self { spans: RecentResiduals::of(SPAN_S), since_s: f64::NAN }
    }

    /// Forgets everything.
    pub fn restart(&mut self) {
        self.spans.restart();
        self.since_s = f64::NAN;
    }

    /// Learns from an epoch that passed its test.
    pub fn learn(&mut self, time_s: f64, residuals: Residuals) {
        self.spans.add(time_s, residuals);
        // A time that goes back begins anew. A NaN is none.
        if self.since_s.is_nan() || time_s < self.since_s {
            self.since_s = time_s;
        }
    }

    /// Returns true if something was learned, and nothing before the other began.
    pub fn is_within(&self, other: &Self) -> bool {
        // A NaN fails this comparison.
        self.since_s >= other.since_s
    }

    /// Dates the first epoch no earlier than that of another adaptation to the same rest, so that
    /// the end of the rest shows by [`Self::is_within`]. If the other has learned nothing, this one
    /// forgets everything.
    pub fn follow(&mut self, other: &Self) {
        if other.since_s.is_nan() {
            self.restart();
        } else {
            self.since_s = self.since_s.max(other.since_s);
        }
    }

    /// Returns the factor on the receiver's part of each variance, [`LEAST_NOISE`] to 1.
    #[inline(never)]
    pub fn noise(&self, time_s: f64) -> f32 {
        // A NaN fails this comparison.
        if !(time_s - self.since_s >= LEAST_REST_S) {
            return 1.0;
        }
        let spans = self.spans.at(time_s);
        let all = spans.into_iter().fold(Residuals::NONE, Residuals::plus);
        if all.dof < LEAST_DOF {
            return 1.0;
        }
        let noise = (all.ratio() / all.ratio_at(-CONFIDENCE)).max(LEAST_NOISE);
        // A span without residuals does not contradict.
        let contradicts = |span: Residuals| span.dof > 0 && span.ratio() > noise * span.ratio_at(CONFIDENCE);
        // A NaN fails this comparison.
        if noise < 1.0 && !spans.into_iter().any(contradicts) { noise } else { 1.0 }
    }
}
