//! Root of the sum `f`: Newton's method on `ln f`, within a bracket.
//!
//! The sum never increases with the distance, so that each evaluation moves one end of the bracket.
//! A *plateau* is a range of distances over which the sum hardly decreases. It occurs if the
//! geometry of some modes is far poorer than that of the others. There the slope predicts nothing,
//! so that there are further rules:
//!
//! | point | rule |
//! |---|---|
//! | below the root, no upper end yet | the step at most doubles the distance |
//! | below the root | the step is at least a length that doubles with each step |
//! | the step leads out of the bracket | bisection |
//! | step 12 and every second one after it | bisection |

use super::{Axis, AxisLevel, Hypothesis, TermValue};
use crate::numeric::real::Real;

/// Largest number of steps to the root; three to six are usual.
const MAX_STEPS: usize = 120;

/// Step from which every second step bisects, so that the bracket is halved.
const BISECTED: usize = 12;

/// Share of a level by which frozen terms may increase it. If they do so by more, the root without
/// them is computed too.
const LARGE_SLACK: f64 = 1e-2;

/// Returns the step below which the iteration ends, m: 0.1 mm, in single precision 0.6 mm.
fn settled_m<T: Real>() -> T {
    T::narrow(1e-4) + T::narrow(4e3) * T::default_epsilon()
}

/// Value of the sum at a distance.
struct RiskSum<T> {
    value: T,
    /// Rate at which the sum decreases, 1/m.
    slope: T,
    /// Mode of the largest term.
    dominant: Hypothesis,
}

/// A distance at which the sum is at most the risk.
struct Root<T> {
    distance_m: T,
    /// Rate at which the sum decreases there, 1/m.
    slope: T,
    dominant: Hypothesis,
}

/// Distances around the root, m; the upper one is unknown at first.
#[derive(Clone, Copy)]
struct Bracket<T> {
    low_m: T,
    high_m: Option<T>,
}

impl<T: Real> Axis<T> {
    /// Returns the level, and a distance below the root that all terms would have with their true
    /// values.
    #[inline(never)]
    pub(super) fn level(&self) -> AxisLevel<T> {
        let root = self.root(self.frozen);
        if let Some(Root { distance_m, slope, dominant }) = root {
            // Beyond every offset the sum is convex. Without the frozen terms its root would
            // therefore be no smaller than `distance_m − slack_m`.
            let slack_m = self.frozen / slope;
            if slack_m <= T::narrow(LARGE_SLACK) * distance_m {
                return AxisLevel { distance_m, below_m: before(distance_m - slack_m), dominant };
            }
        }
        // On a plateau the slope does not show the effect of the frozen terms.
        let below_m = self.root(T::zero()).map_or(T::zero(), |root| before(root.distance_m));
        match root {
            Some(Root { distance_m, dominant, .. }) => AxisLevel { distance_m, below_m, dominant },
            None => AxisLevel { below_m, ..AxisLevel::none() },
        }
    }

    /// Returns the root with a charge for the terms outside the sum, starting at the reference.
    /// Returns `None` if the charge uses up the risk.
    #[inline(never)]
    fn root(&self, charge: T) -> Option<Root<T>> {
        if charge >= self.risk {
            return None;
        }
        let mut at_m = self.reference_m;
        let mut bracket = Bracket { low_m: at_m, high_m: None };
        let mut root = None;
        let mut least_m = settled_m::<T>();
        for count in 0..MAX_STEPS {
            let RiskSum { value, slope, dominant } = self.sum(charge, at_m);
            let step_m = (value / self.risk).ln() * value / slope;
            let settled = settled_m::<T>() + T::narrow(16.0) * T::default_epsilon() * at_m;
            if value <= self.risk {
                root = Some(Root { distance_m: at_m, slope, dominant });
                bracket.high_m = Some(at_m);
                // If the sum does not decrease, the step is infinite or NaN.
                if step_m.abs() <= settled || at_m - bracket.low_m <= settled {
                    break;
                }
            } else {
                bracket.low_m = at_m;
            }
            if settled > least_m {
                least_m = settled;
            }
            at_m = if count >= BISECTED && count % 2 == 0 {
                bracket.middle(least_m)
            } else {
                bracket.next(at_m, step_m, least_m)
            };
            least_m += least_m;
        }
        root
    }

    fn sum(&self, charge: T, level_m: T) -> RiskSum<T> {
        let mut sum = RiskSum { value: charge, slope: T::zero(), dominant: Hypothesis::NONE };
        let mut largest = T::zero();
        for term in &self.terms {
            let TermValue { value, slope } = term.at(level_m);
            sum.value += value;
            sum.slope += slope;
            if value > largest {
                (largest, sum.dominant) = (value, term.hypothesis);
            }
        }
        sum
    }
}

/// Returns a distance below the root by more than the iteration's accuracy, m, but not negative.
fn before<T: Real>(root_m: T) -> T {
    let below_m = root_m - T::narrow(2.0) * settled_m::<T>();
    if below_m > T::zero() { below_m } else { T::zero() }
}

impl<T: Real> Bracket<T> {
    /// Returns the middle, or twice the lower end if the upper one is unknown.
    fn middle(&self, least_m: T) -> T {
        match self.high_m {
            Some(high_m) => (self.low_m + high_m) / T::narrow(2.0),
            None => self.low_m + self.low_m + least_m,
        }
    }

    /// Returns the end of Newton's step if the rules permit it, otherwise the middle.
    fn next(&self, at_m: T, step_m: T, least_m: T) -> T {
        // From below, a step ends before the root if `ln f` is convex.
        let is_short = step_m >= T::zero() && step_m < least_m;
        let wanted_m = at_m + if is_short { least_m } else { step_m };
        let middle_m = self.middle(least_m);
        let limit_m = self.high_m.unwrap_or(middle_m);
        // NaN fails this comparison.
        if wanted_m > self.low_m && wanted_m < limit_m { wanted_m } else { middle_m }
    }
}
