//! Protection levels of ARAIM: the distance that the error exceeds, under all fault modes together,
//! with the permitted risk.
//!
//! ```text
//! 2 Q((L − b_0)/σ_0) + Σ_k p_k Q((L − T_k − b_k)/σ_k) = R          Q of 0 and below counts as 1
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `R` | [`Axis::risk`] | – |
//! | `T_k + b_k` | [`Term::offset_m`] | m |
//! | `1/σ_k` | [`Term::inverse_sigma`] | 1/m |
//! | `p_k` | [`Term::probability`] | – |
//!
//! [`root`] solves this for `L`. At the resulting distance the sum is at most `R`. The distance
//! exceeds the root by at most 0.1 mm.
//!
//! A few dozen of hundreds of modes matter. Terms are classified at a distance below the root, the
//! *reference*:
//!
//! - A term is *clear* if its bound `½ p exp(−u²/2)` is far below `R`. It is not evaluated. All
//!   clear terms together are charged a fixed share of `R`.
//! - A small term is *frozen*: its value at the reference is charged.
//! - The others stay in the sum.
//!
//! All of this is safe, because `Q` decreases with the distance. If the frozen terms may increase
//! the level by too much, the modes are evaluated once more with a better reference.
//!
//! References: [Blanch2015], [MAAST] `compute_protection_level`.
//!
//! [Blanch2015]: crate#references
//! [MAAST]: crate#references

mod root;
mod screen;

use heapless::Vec;

pub(super) use screen::Screen;

use super::modes::{Hypothesis, Mode};
use crate::least_squares::infinity;
use crate::numeric::normal::{quantile, tail};
use crate::numeric::real::Real;

/// Largest number of terms that stay. If there are more, the smallest are frozen.
const TERMS: usize = 48;

/// Returns the share of `R` that is charged for all clear terms together. In single precision it is
/// larger by 2e-4, which increases a level by 0.1 mm for a `σ` of 2 m.
fn clear<T: Real>() -> T {
    T::narrow(1e-6) + T::narrow(1.7e3) * T::default_epsilon()
}

/// Share of `R` below which a term is frozen.
const FROZEN: f64 = 1e-5;

/// Tolerated increase of a level by the frozen terms, m. In single precision it is larger by 2.4 mm
/// and 4e-5 of the level.
const TOLERANCE_M: f64 = 3e-4;

/// Term of one mode in the sum.
#[derive(Clone, Copy, Debug)]
pub(super) struct Term<T> {
    probability: T,
    offset_m: T,
    inverse_sigma: T,
    hypothesis: Hypothesis,
}

/// A mode on one axis, before it is classified.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisMode<T> {
    pub(super) probability: T,
    /// `ln p_k`.
    pub(super) ln_probability: T,
    /// `T_k²`, m².
    pub(super) threshold: T,
    pub(super) variance: T,
    pub(super) hypothesis: Hypothesis,
}

impl<T: Real> AxisMode<T> {
    #[inline]
    pub(super) fn of(mode: &Mode<T>, threshold: T, variance: T) -> Self {
        let Mode { hypothesis, probability, ln_probability, .. } = *mode;
        Self { probability, ln_probability, threshold, variance, hypothesis }
    }
}

/// The risk of an axis, and the bound below which its terms are clear.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisRisk<T> {
    risk: T,
    /// Clear bound, as [`Axis::clear`].
    clear: T,
}

impl<T: Real> AxisRisk<T> {
    /// Returns the risk for a number of modes that share it.
    pub(super) fn of(risk: T, modes: T) -> Self {
        let two = T::one() + T::one();
        let each = risk * clear::<T>() / modes;
        let clear = if risk > T::zero() { -two * (two * each).ln() } else { T::zero() };
        Self { risk, clear }
    }
}

/// The sum on one axis.
#[derive(Clone, Debug)]
pub(super) struct Axis<T> {
    risk: T,
    terms: Vec<Term<T>, TERMS>,
    frozen: T,
    /// Value below which a term is frozen.
    bar: T,
    /// `−2 ln(2 q)`, where terms of at most `q` are clear.
    clear: T,
    /// Distance below the root, m.
    reference_m: T,
}

/// The two latest quantiles. Both horizontal axes need the same ones.
#[derive(Clone, Copy, Debug)]
pub(super) struct QuantileCache<T> {
    latest: (T, T),
    before: (T, T),
}

impl<T: Real> QuantileCache<T> {
    /// Returns the cache with the median only.
    pub(super) fn none() -> Self {
        let median = (T::narrow(0.5), T::zero());
        Self { latest: median, before: median }
    }

    fn of(&mut self, probability: T) -> T {
        if self.latest.0 != probability {
            core::mem::swap(&mut self.latest, &mut self.before);
        }
        if self.latest.0 != probability {
            self.latest = (probability, quantile(probability));
        }
        self.latest.1
    }
}

/// Value of a term at a distance.
struct TermValue<T> {
    value: T,
    slope: T,
}

/// A level, and a distance below the root of its sum.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisLevel<T> {
    /// Distance at which the sum is at most the risk, m.
    pub(super) distance_m: T,
    /// A distance below the root, m.
    pub(super) below_m: T,
    /// Mode with the largest term; [`Hypothesis::NONE`] if the noise of all satellites is the
    /// largest term.
    pub(super) dominant: Hypothesis,
}

impl<T: Real> AxisLevel<T> {
    /// Returns the level of an axis without risk, which is infinite.
    pub(super) fn none() -> Self {
        Self { distance_m: infinity(), below_m: T::zero(), dominant: Hypothesis::NONE }
    }
}

impl<T: Real> Axis<T> {
    /// Returns an axis without risk and without terms.
    #[allow(clippy::inline_always, reason = "made where it stays: it is large")]
    #[inline(always)]
    pub(super) fn closed() -> Self {
        // If all fields were zero, the compiler would also clear the capacity for the terms.
        Self {
            risk: T::zero(),
            terms: Vec::new(),
            frozen: infinity(),
            bar: infinity(),
            clear: infinity(),
            reference_m: infinity(),
        }
    }

    /// Resets the axis, in place.
    fn close(&mut self) {
        self.terms.clear();
        (self.risk, self.frozen, self.bar, self.clear) = (T::zero(), T::zero(), T::zero(), T::zero());
        self.reference_m = infinity();
    }

    /// Starts an axis with the risk of its modes and the all-in-view solution as the first term.
    /// Without risk there is no level.
    #[inline(never)]
    pub(super) fn open(&mut self, budget: &AxisRisk<T>, variance: T, bias_m: T) {
        self.close();
        (self.risk, self.clear) = (budget.risk, budget.clear);
        if !self.is_open() {
            return;
        }
        // Never full, because the list is empty.
        let _ = self.terms.push(Term {
            probability: T::one() + T::one(),
            offset_m: bias_m,
            inverse_sigma: variance.inverse_sqrt_approx(),
            hypothesis: Hypothesis::NONE,
        });
        self.restart(T::zero());
    }

    /// Returns true if the axis has risk to allot.
    pub(super) fn is_open(&self) -> bool {
        self.risk > T::zero()
    }

    /// Returns true if the term of a mode with at most this bias is clear at the reference.
    ///
    /// The condition is `T + √C ≤ m` with `C = u²σ²`. Without a root it is `m² − T² − C ≥ 0`, with
    /// a square of at least `4 T² C`.
    #[inline]
    pub(super) fn is_clear(&self, mode: &AxisMode<T>, bias_m: T) -> bool {
        let margin = self.reference_m - bias_m;
        let needed = self.clear + mode.ln_probability + mode.ln_probability;
        let spread = if needed > T::zero() { needed * mode.variance } else { T::zero() };
        let rest = margin * margin - mode.threshold - spread;
        margin > T::zero() && rest >= T::zero() && rest * rest >= T::narrow(4.0) * mode.threshold * spread
    }

    /// Adds a mode to the sum, unless it is clear.
    #[inline]
    pub(super) fn add(&mut self, mode: &AxisMode<T>, bias_m: T) {
        if !self.is_clear(mode, bias_m) {
            self.add_term(mode, bias_m);
        }
    }

    #[inline(never)]
    fn add_term(&mut self, mode: &AxisMode<T>, bias_m: T) {
        // Rounding can make a zero variance slightly negative.
        let is_spread = mode.threshold > T::zero();
        let threshold_m =
            if is_spread { mode.threshold * mode.threshold.inverse_sqrt_approx() } else { T::zero() };
        let term = Term {
            probability: mode.probability,
            offset_m: threshold_m + bias_m,
            inverse_sigma: mode.variance.inverse_sqrt_approx(),
            hypothesis: mode.hypothesis,
        };
        self.take(term);
    }

    fn take(&mut self, term: Term<T>) {
        let charge = term.at(self.reference_m).value;
        if charge < self.bar {
            self.frozen += charge;
            return;
        }
        while self.terms.is_full() {
            self.bar *= T::narrow(4.0);
            self.freeze_small_terms();
        }
        // Never full, because the loop above freed a place.
        let _ = self.terms.push(term);
    }

    /// Freezes the terms below the bar, except for the first one.
    fn freeze_small_terms(&mut self) {
        let (mut frozen, mut is_first) = (self.frozen, true);
        let (reference_m, bar) = (self.reference_m, self.bar);
        self.terms.retain(|term| {
            let charge = term.at(reference_m).value;
            let stays = core::mem::take(&mut is_first) || !(charge < bar);
            if !stays {
                frozen += charge;
            }
            stays
        });
        self.frozen = frozen;
    }

    /// Raises the reference to the distance at which one mode alone uses up the risk, and freezes
    /// small terms.
    pub(super) fn raise_reference(&mut self, quantiles: &mut QuantileCache<T>) {
        let lowest_m = self.lowest(quantiles);
        self.refer(lowest_m);
    }

    /// Raises the reference to the level of the modes so far, because further modes only raise the
    /// root.
    pub(super) fn refine_reference(&mut self) {
        let below_m = self.level().below_m;
        self.refer(below_m);
    }

    /// Restarts with a better reference.
    pub(super) fn restart(&mut self, below_m: T) {
        if !self.is_open() {
            return;
        }
        self.terms.truncate(1);
        self.frozen = self.risk * clear::<T>();
        self.bar = self.risk * T::narrow(FROZEN);
        self.reference_m = below_m;
    }

    fn refer(&mut self, below_m: T) {
        if below_m > self.reference_m {
            self.reference_m = below_m;
            self.freeze_small_terms();
        }
    }

    /// Returns a distance below which one term alone exceeds the risk, m.
    fn lowest(&self, quantiles: &mut QuantileCache<T>) -> T {
        let mut lowest = self.reference_m;
        for term in &self.terms {
            let share = self.risk / term.probability;
            if !(share < T::one()) {
                continue;
            }
            let distance = term.offset_m + quantiles.of(share) / term.inverse_sigma;
            if distance > lowest {
                lowest = distance;
            }
        }
        lowest
    }

    /// Returns the level with all modes.
    pub(super) fn finish(&self) -> AxisLevel<T> {
        let level = self.level();
        let below_m = if level.below_m > self.reference_m { level.below_m } else { self.reference_m };
        AxisLevel { below_m, ..level }
    }

    /// Returns true if the frozen terms may increase a level by more than the tolerance, so that
    /// another pass with a better reference is worthwhile.
    pub(super) fn exceeds_tolerance(level: &AxisLevel<T>) -> bool {
        if !level.distance_m.is_finite() {
            // The frozen terms alone use up the risk, or the axis has no risk. In the latter case
            // nothing is known about the root.
            return level.below_m > T::zero();
        }
        let single = T::default_epsilon() * (T::narrow(2e4) + T::narrow(300.0) * level.distance_m);
        let limit = T::narrow(TOLERANCE_M) + single;
        level.distance_m - level.below_m > limit
    }
}

impl<T: Real> Term<T> {
    fn at(&self, level_m: T) -> TermValue<T> {
        let distance = (level_m - self.offset_m) * self.inverse_sigma;
        if distance > T::zero() {
            let tail = tail(distance);
            TermValue {
                value: self.probability * tail.probability,
                slope: self.probability * tail.density * self.inverse_sigma,
            }
        } else {
            TermValue { value: self.probability, slope: T::zero() }
        }
    }
}
