//! Comparison of a receiver clock with its past, for receivers without range rates.
//!
//! ```text
//! i = b_k − b_j − ḋ Δt, minus whole milliseconds       j: the last epoch that was 0.9 s or more after the one before
//! ḋ ← ḋ + ½ i/Δt                                       Δt ≥ 0.9 s
//! a leap     |i| > L_k + L_j + min(8 s g, m)          Δt up to a minute
//!            |i| > L_k + L_{k−1} + 30 m/s Δt          Δt up to 15 minutes
//! m = max(150 m, 1.2 m (Δt/1 s)^1.5)                  g = max(1, Δt over its mean)
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `b` | receiver clock times the speed of light, of one constellation | m |
//! | `ḋ` | drift, learned from the clock | m/s |
//! | `i` | innovation: the change of the clock that the drift does not explain | m |
//! | `L` | `HPL + VPL` of an epoch | m |
//! | `s` | mean of `|i|/g` over the epochs so far; each counts as at most `3 s` | m |
//!
//! A drift is as uncertain as the noise of a range over a second, and the error of a prediction grows
//! with the time. The bound therefore grows too, by `g`, if epochs are missing.
//!
//! With a second receiver, a repeater or most counterfeit signals, the clock changes by more than
//! an oscillator can. A poor oscillator, or a receiver that steers its clock, increases `s` and so
//! its bound. The limit `m` prevents an attacker from increasing it until a leap passes. The second
//! part of `m` is six times the random walk of an ordinary quartz (`h₋₂ = 2e-20/s`). Steps by whole
//! milliseconds are ignored, because receivers make them on purpose.
//!
//! After a leap the comparison begins anew at the new clock, so that one leap causes one alert. An
//! agreement is then required.
//!
//! In epochs with a velocity, clock and drift are learned only, and [`super::path`] judges.
//!
//! **Limits.** Nothing is compared before [`LEARNED`] innovations. If an attack draws the clock off
//! slowly, the drift follows, and nothing is detected without range rates.

use crate::frame::SPEED_OF_LIGHT_M_S;
use crate::numeric::sqrt;

/// Longest step for which the learned drift is used, s.
const LONGEST_STEP_S: f32 = 60.0;

/// Shortest step from which drift and spread are learned, s. The noise of a range divided by a
/// shorter one would be a drift that no gap survives.
const SHORTEST_STEP_S: f32 = 0.9;

/// Longest gap across which a clock is compared, s.
const LONGEST_GAP_S: f32 = 900.0;

/// Largest departure of a quartz from its last drift, m/s: 0.1 ppm.
const WANDER_M_S: f32 = 30.0;

/// Share of an innovation by which the drift changes. In some seconds, the random walk of an
/// ordinary oscillator is as large as the noise of a range.
const GAIN: f32 = 0.5;

/// Number of innovations after which the spread is known.
const LEARNED: u16 = 24;

/// Number of innovations over which the spread is averaged.
const MEMORY: u16 = 120;

/// Ratio to the mean at which a new innovation is cut off, dimensionless.
const TEACHING_BOUND: f32 = 3.0;

/// Ratio of the bound to the mean, dimensionless.
const SPREADS: f32 = 8.0;

/// Largest learned part of the bound if the time between epochs is short, m.
const MOST_LEARNED_M: f32 = 150.0;

/// Six times the random walk of a quartz in one second, m.
const WALK_M: f32 = 1.2;

/// A millisecond of the receiver clock, m.
const MILLISECOND_M: f64 = SPEED_OF_LIGHT_M_S * 1e-3;

/// Clock of an epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Reading {
    time_s: f64,
    clock_m: f64,
    level_m: f32,
}

/// State of the comparison of a receiver clock with its past.
#[derive(Clone, Debug)]
pub(super) struct Oscillator {
    last: Option<Reading>,
    drift_m_s: Option<f32>,
    /// Mean of the absolute innovations, m.
    spread_m: f32,
    /// Number of innovations, up to [`MEMORY`].
    count: u16,
    /// Mean time between the compared epochs, s.
    step_s: f32,
}

impl Oscillator {
    /// Returns the state before the first epoch.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self { last: None, drift_m_s: None, spread_m: 0.0, count: 0, step_s: SHORTEST_STEP_S }
    }

    /// Forgets the clock and its drift, but not the spread.
    pub(super) fn restart(&mut self) {
        (self.last, self.drift_m_s) = (None, None);
    }

    /// Returns true if a clock leaps from the prediction by its past. `level_m` is `HPL + VPL`. For a
    /// receiver that steers, no limit holds for what is learned.
    #[inline(never)]
    pub(super) fn leaps(&mut self, time_s: f64, clock_m: f64, level_m: f32, is_steered: bool) -> bool {
        let now = Reading { time_s, clock_m, level_m };
        let last = *self.last.get_or_insert(now);
        let elapsed_s = (time_s - last.time_s) as f32;
        // NaN fails this comparison too.
        if !(elapsed_s > 0.0 && elapsed_s <= LONGEST_GAP_S) {
            (self.last, self.drift_m_s) = (Some(now), None);
            return false;
        }
        let is_learned = elapsed_s >= SHORTEST_STEP_S;
        if is_learned {
            self.last = Some(now);
        }
        let step_m = within_a_millisecond(clock_m - last.clock_m);
        let Some(drift_m_s) = self.drift_m_s else {
            self.drift_m_s = is_learned.then_some(step_m / elapsed_s);
            return false;
        };
        let innovation_m = within_a_millisecond(f64::from(step_m - drift_m_s * elapsed_s));
        let is_step = elapsed_s <= LONGEST_STEP_S;
        let limit_m = if is_steered { f32::INFINITY } else { MOST_LEARNED_M };
        let most_m = (WALK_M * elapsed_s * sqrt(elapsed_s)).max(limit_m);
        let growth = (elapsed_s / self.step_s).max(1.0);
        let learned_m = (SPREADS * growth * self.spread_m).min(most_m);
        let explained_m = if is_step { learned_m } else { WANDER_M_S * elapsed_s };
        // NaN fails this comparison, so that it counts as a leap.
        let is_explained = innovation_m.abs() <= explained_m + last.level_m + level_m;
        if !is_explained && self.count >= LEARNED {
            (self.last, self.drift_m_s) = (Some(now), None);
            return true;
        }
        // A clock that is set back once a second departs from its drift between two such steps.
        if is_step && (is_learned || is_steered) {
            self.learn(innovation_m.abs() / growth, most_m);
        }
        if is_step && is_learned {
            self.drift_m_s = Some(drift_m_s + GAIN * innovation_m / elapsed_s);
            self.step_s += (elapsed_s - self.step_s) / f32::from(self.count.max(1));
        }
        false
    }

    /// Adds an innovation to the spread, m, unless it is infinite or NaN. Before the spread is
    /// known, it counts as at most `most_m`.
    fn learn(&mut self, innovation_m: f32, most_m: f32) {
        let is_known = self.count >= LEARNED;
        let most_m = if is_known { TEACHING_BOUND * self.spread_m } else { most_m };
        let value_m = innovation_m.min(most_m);
        if value_m.is_finite() {
            self.count = (self.count + 1).min(MEMORY);
            self.spread_m += (value_m - self.spread_m) / f32::from(self.count);
        }
    }
}

/// Returns a step of the clock minus its whole milliseconds, m.
fn within_a_millisecond(step_m: f64) -> f32 {
    let is_short = step_m.abs() <= 0.5 * MILLISECOND_M;
    (if is_short { step_m } else { step_m - whole_milliseconds_m(step_m) }) as f32
}

/// Returns the whole milliseconds of a step of the clock, m.
pub(super) fn whole_milliseconds_m(step_m: f64) -> f64 {
    // Their number is exact in single precision up to hours.
    MILLISECOND_M * f64::from(libm::roundf((step_m / MILLISECOND_M) as f32))
}
