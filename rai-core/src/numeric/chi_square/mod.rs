//! Non-central χ² beyond the tables: its quantile, its non-centrality, and the point where its
//! density crosses the central one.
//!
//! ```text
//! quantile        G(τ; ν, δ) = p            solved for τ
//! noncentrality   G(τ; ν, λ) = p            solved for λ
//! crossing        g(τ; ν, δ) = κ f(τ; ν)    solved for τ
//! ```
//!
//! All computations use the roots `r = √t` and `m = √δ`. In `r` the distribution is nearly normal
//! with unit variance for any `δ`. Everything follows from one function, the growth of Bessel's
//! series:
//!
//! ```text
//! L(z)    = ln ₀F₁(; ν/2; z²/4) = lnΓ(v+1) − v ln(z/2) + ln I_v(z),    v = ν/2 − 1
//! dL/dz   = I_{v+1}(z) / I_v(z)
//! h(r)    = (r^{ν−1} / (2^v Γ(v+1))) exp(−(r−m)²/2 + L(mr) − mr)        density of r
//! G       = ∫_0^r h                                                    by Gauss and Legendre, below r
//! g/f     = exp(L(√(δt)) − δ/2)
//! ```
//!
//! `L` is summed as a power series up to a moderate `z`, and computed by Debye's uniform expansion
//! above. `v ≤ 29` needs no other case, `v = −1/2` included. Only `L(z) − z` is integrated or
//! compared. So nothing overflows, and nothing cancels at `δ = 1e7`.
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | `ν` | `dof` | degrees of freedom, 1 to 60 |
//! | `τ`, `t` | `statistic` | dimensionless: a sum of squares in units of sigma² |
//! | `δ`, `λ` | `noncentrality` | dimensionless: a squared bias in units of sigma² |
//! | `r`, `m` | `root`, `mean` | square roots of `t` and `δ` |
//! | `p` | `tail` | probability |
//! | `ln κ` | `ln_weight` | dimensionless: logarithm of the cost of a false alarm over that of a missed detection |
//!
//! Limits: non-centralities are clamped to [`SMALLEST`] and [`LARGEST`], outside which thresholds
//! have no meaning. The lower tail is for `p < 1/2`, as is [`Probability`].
//!
//! References: [Yang2015] eq. 9–12, [Sankaran1963], [DLMF] 10.41, 25.4.30 of [Abramowitz1964].
//!
//! [Yang2015]: crate#references
//! [Sankaran1963]: crate#references
//! [DLMF]: crate#references
//! [Abramowitz1964]: crate#references

use crate::numeric::probability::Probability;
use crate::numeric::real::Real;

/// The largest number of degrees of freedom, here and in the tables.
pub const MAX_DOF: usize = 60;

/// Smallest non-centrality that differs from 0. It changes `τ` by less than 1e-9, relatively.
pub const SMALLEST: f64 = 1e-9;

/// Largest non-centrality: a bias of a million sigma.
pub const LARGEST: f64 = 1e12;

/// Smallest root of a statistic: `τ ≥ 1e-30`, within the range of `f32`.
const SMALLEST_ROOT: f64 = 1e-15;

/// Smallest probability, within the range of `f32`.
const SMALLEST_TAIL: f64 = 1e-37;

/// Largest number of terms of the power series; about `z/2 + 5√z + 10` are needed.
const MAX_TERMS: usize = 100;

/// Largest number of Newton steps; one to four are usual.
const MAX_STEPS: usize = 40;

/// Longest Newton step, in `ln r` and in `m`.
const LONGEST_STEP: f64 = 3.0;

const HALF_LN_2PI: f64 = 0.918_938_533_204_672_7;

/// χ² distributions, central or not, of one number of degrees of freedom.
#[derive(Clone, Copy, Debug)]
pub struct ChiSquare<T> {
    dof: T,
    /// `v = ν/2 − 1`.
    order: T,
    /// `lnΓ(ν/2)`.
    ln_gamma: T,
}

/// `L(z)` with its derivative and its difference to `z`.
struct Growth<T> {
    /// `L(z)`.
    value: T,
    /// `L(z) − z`, which does not cancel.
    excess: T,
    /// `dL/dz`. From the expansion it is accurate to 5e-4, which suffices for a Newton step.
    slope: T,
}

/// The lower tail at a root.
struct LowerTail<T> {
    /// `ln G`.
    ln_probability: T,
    /// `d ln G / dr`.
    by_root: T,
    /// `−d ln G / dm`.
    by_mean: T,
}

/// A power of the statistic over its expectation, which nearly has this normal distribution.
struct NearlyNormal<T> {
    expectation: T,
    power: T,
    centre: T,
    deviation: T,
}

impl<T: Real> ChiSquare<T> {
    /// Returns the distributions, or `None` outside 1 to [`MAX_DOF`] degrees of freedom.
    pub fn new(dof: usize) -> Option<Self> {
        if dof == 0 || dof > MAX_DOF {
            return None;
        }
        let half = dof as f64 / 2.0;
        // The largest, Γ(60/2) = 8.8e30, fits a single.
        let (mut gamma, mut factor) = if dof.is_multiple_of(2) {
            (T::one(), T::one())
        } else {
            (T::pi().sqrt_approx(), T::narrow(0.5))
        };
        while factor < T::narrow(half) {
            gamma *= factor;
            factor += T::one();
        }
        Some(Self { dof: T::narrow(dof as f64), order: T::narrow(half - 1.0), ln_gamma: gamma.ln() })
    }

    /// Returns `τ`: under a bias of this non-centrality, the statistic is below it with the
    /// probability `tail`.
    ///
    /// The result increases with both arguments. Its relative error is below 3e-11 (`f64`), 3e-5
    /// (`f32`). One integral is usual in `f32`, three in `f64`: 4,200 and 970,000 instructions on a
    /// Cortex-M4F.
    pub fn quantile(&self, tail: Probability, noncentrality: f64) -> T {
        let ln_tail = ln(tail);
        let mean = T::narrow(bounded(noncentrality)).sqrt_approx();
        let longest = T::narrow(LONGEST_STEP);
        let mut root = self.root_guess(ln_tail, mean).max(T::narrow(SMALLEST_ROOT));
        for _ in 0..MAX_STEPS {
            let tail = self.lower_tail(root, mean);
            // As a function of ln r, `ln G` is concave, and a straight line for small r. Newton's
            // method therefore converges from any start.
            let step = ((ln_tail - tail.ln_probability) / (tail.by_root * root)).clamp(-longest, longest);
            root = (root * step.exp()).max(T::narrow(SMALLEST_ROOT));
            if step * step * root.max(T::one()) < T::CHI_SQUARE.settled {
                break;
            }
        }
        root * root
    }

    /// Returns the non-centrality of the bias under which SSE is below `statistic` with the
    /// probability `tail`. Returns 0 if this probability is smaller even without a bias.
    ///
    /// A NaN statistic counts as the largest, which is safe. The relative error is below 3e-11
    /// (`f64`), 3e-5 (`f32`). One integral is usual in `f32`, three in `f64`: 4,500 and 1,000,000
    /// instructions on a Cortex-M4F.
    pub fn noncentrality(&self, statistic: f64, tail: Probability) -> T {
        let ln_tail = ln(tail);
        let root =
            T::narrow(statistic.min(LARGEST)).max(T::zero()).sqrt_approx().max(T::narrow(SMALLEST_ROOT));
        let longest = T::narrow(LONGEST_STEP);
        let mut mean = self.mean_guess(ln_tail, root);
        for _ in 0..MAX_STEPS {
            let tail = self.lower_tail(root, mean);
            let step = ((tail.ln_probability - ln_tail) / tail.by_mean).clamp(-longest, longest);
            mean += step;
            // The tail is concave in m. If a step leads below 0, there is therefore no positive
            // root.
            if !(mean > T::zero()) {
                return T::zero();
            }
            if step * step < T::CHI_SQUARE.settled * mean {
                break;
            }
        }
        mean * mean
    }

    /// Returns the statistic at which a bias of this non-centrality is `κ` times as likely as none;
    /// `ln_weight` is `ln κ`.
    ///
    /// With `κ = 1` the densities cross there, and `P_F + P_M` is smallest. For small
    /// non-centralities the crossing approaches `ν`. If the densities do not cross, the bias is
    /// likelier everywhere, and the result is 0. The relative error is below 3e-11 (`f64`), 3e-5
    /// (`f32`). Two to four values of `L` and no integral are needed: 840 instructions on a
    /// Cortex-M4F in `f32`.
    pub fn crossing(&self, noncentrality: f64, ln_weight: f64) -> T {
        let noncentrality = bounded(noncentrality);
        let target = noncentrality / 2.0 + ln_weight;
        if !(target > 0.0) {
            return T::zero();
        }
        let (target, noncentrality) = (T::narrow(target), T::narrow(noncentrality));
        // The start is exact at both ends: τ → ν and τ → δ/4. L is convex, so that Newton's method
        // converges from any start.
        let mut argument = (target * (self.dof + self.dof + target)).sqrt_approx();
        for _ in 0..MAX_STEPS {
            let Growth { value, slope, .. } = self.growth(argument);
            let step = (target - value) / slope;
            argument += step;
            if step * step < T::CHI_SQUARE.settled * argument * argument {
                break;
            }
        }
        argument * (argument / noncentrality)
    }

    /// Returns `G` at a root, with its derivatives: `∂G/∂r = h`, `∂G/∂m = −h I_{v+1}/I_v`.
    fn lower_tail(&self, root: T, mean: T) -> LowerTail<T> {
        let growth = self.growth(mean * root);
        let height = self.ln_density(root, mean, growth.excess);
        let steepness = (self.dof - T::one()) / root + mean * growth.slope - root;
        // Below the root, the logarithmic density decreases at least by `steepness u + u²/2` over
        // `u`.
        let fall = T::CHI_SQUARE.drop + T::CHI_SQUARE.drop;
        let reach = (steepness * steepness + fall).sqrt_approx();
        let width = if steepness > T::zero() { fall / (reach + steepness) } else { reach - steepness };
        let width = width.min(root);
        let mut mean_height = T::zero();
        for &(node, weight) in T::CHI_SQUARE.rule {
            for node in [node, -node] {
                let below = root - width * (T::one() + node) / (T::one() + T::one());
                let excess = self.growth(mean * below).excess;
                mean_height += weight * (self.ln_density(below, mean, excess) - height).exp();
            }
        }
        let integral = width * mean_height / (T::one() + T::one());
        LowerTail {
            ln_probability: height + integral.ln(),
            by_root: T::one() / integral,
            by_mean: growth.slope / integral,
        }
    }

    /// Returns `ln h(r)`.
    fn ln_density(&self, root: T, mean: T, excess: T) -> T {
        let distance = root - mean;
        let half = T::narrow(0.5);
        (self.dof - T::one()) * root.ln()
            - self.order * T::ln_2()
            - self.ln_gamma
            - half * distance * distance
            + excess
    }

    /// Returns `L(z)`. In `f64` the relative error of the series is 1e-15, the absolute error of
    /// the expansion below 3e-10.
    fn growth(&self, argument: T) -> Growth<T> {
        if argument > T::CHI_SQUARE.asymptotic { self.expanded(argument) } else { self.summed(argument) }
    }

    /// Sums `₀F₁ − 1 = Σ_{k≥1} (z²/4)^k / (k! (ν/2)_k)`, which has positive terms only.
    fn summed(&self, argument: T) -> Growth<T> {
        let quarter = argument * argument * T::narrow(0.25);
        let (mut number, mut term) = (T::one(), T::one());
        let (mut sum, mut moment) = (T::zero(), T::zero());
        for _ in 0..MAX_TERMS {
            term *= quarter / (number * (self.order + number));
            sum += term;
            moment += term * number;
            if term <= sum * T::CHI_SQUARE.rounding {
                break;
            }
            number += T::one();
        }
        let value = sum.ln_1p();
        let slope = (moment + moment) / (argument * (T::one() + sum));
        Growth { value, excess: value - argument, slope }
    }

    /// Evaluates Debye's expansion with four terms, [DLMF] 10.41.3, in `s = √(v² + z²)` and
    /// `w = v²/s²`.
    ///
    /// It is even in `v`, so that it is also valid for `v = −1/2`.
    ///
    /// [DLMF]: crate#references
    fn expanded(&self, argument: T) -> Growth<T> {
        let (order, half) = (self.order, T::narrow(0.5));
        let squared = order * order;
        let scale = (squared + argument * argument).sqrt_approx();
        let (inverse, w) = (T::one() / scale, squared / (scale * scale));
        let terms = polynomial(&DEBYE_4, w) * inverse;
        let terms = (terms + polynomial(&DEBYE_3, w)) * inverse;
        let terms = (terms + polynomial(&DEBYE_2, w)) * inverse;
        let terms = (terms + polynomial(&DEBYE_1, w)) * inverse;
        let correction = T::one() + terms;
        let excess = squared / (scale + argument) + self.ln_gamma - T::narrow(HALF_LN_2PI)
            + order * (T::narrow(2.0) / (order + scale)).ln()
            + half * (correction * correction * inverse).ln();
        let slope = argument / (scale + order) - half * argument * inverse * inverse;
        Growth { value: excess + argument, excess, slope }
    }

    /// Returns the power of the statistic that is nearly normal ([Sankaran1963]).
    ///
    /// [Sankaran1963]: crate#references
    fn nearly_normal(&self, mean: T) -> NearlyNormal<T> {
        let [one, two, three] = [1.0, 2.0, 3.0].map(T::narrow);
        let noncentrality = mean * mean;
        let expectation = self.dof + noncentrality;
        let (double, triple) = (expectation + noncentrality, expectation + two * noncentrality);
        let h = one - two * expectation * triple / (three * double * double);
        let p = double / (expectation * expectation);
        let q = (h - one) * (one - three * h) * p;
        NearlyNormal {
            expectation,
            power: h,
            centre: one + h * p * (h - one - (one - h / two) * q),
            deviation: h * (two * p).sqrt_approx() * (one + q / two),
        }
    }

    /// Returns an approximate root of the quantile: from the power that is nearly normal, or if
    /// this fails, from the leading term of the tail at 0.
    fn root_guess(&self, ln_tail: T, mean: T) -> T {
        let normal = self.nearly_normal(mean);
        let powered = normal.centre - normal_quantile(ln_tail) * normal.deviation;
        if powered > T::narrow(0.1) {
            return (normal.expectation * power(powered, T::one() / normal.power)).sqrt_approx();
        }
        let half = self.dof * T::narrow(0.5);
        let leading = ln_tail + mean * mean * T::narrow(0.5) + half * T::ln_2() + self.ln_gamma + half.ln();
        (leading / self.dof).exp().min(normal.expectation.sqrt_approx())
    }

    /// Returns an approximate root of the non-centrality. It assumes a normal distribution of unit
    /// variance, and is twice corrected by the power that is nearly normal.
    fn mean_guess(&self, ln_tail: T, root: T) -> T {
        let quantile = normal_quantile(ln_tail);
        let shifted = root + quantile;
        let mut mean = (shifted * shifted - self.dof).max(T::one()).sqrt_approx();
        for _ in 0..2 {
            let normal = self.nearly_normal(mean);
            let powered = power(root * root / normal.expectation, normal.power);
            let excess = quantile - (normal.centre - powered) / normal.deviation;
            let per_sigma = ((normal.expectation + mean * mean) * T::narrow(0.5)).sqrt_approx() / mean;
            mean = (mean + excess * per_sigma).max(T::one());
        }
        mean
    }
}

// Numerators of u_k(t)/t^k in t², k = 1 to 4 ([DLMF] 10.41.10).
const DEBYE_1: [f64; 2] = [1.0 / 8.0, -5.0 / 24.0];
const DEBYE_2: [f64; 3] = [9.0 / 128.0, -77.0 / 192.0, 385.0 / 1152.0];
const DEBYE_3: [f64; 4] = [75.0 / 1024.0, -4563.0 / 5120.0, 17017.0 / 9216.0, -85085.0 / 82944.0];
const DEBYE_4: [f64; 5] =
    [3675.0 / 32768.0, -96833.0 / 40960.0, 144001.0 / 16384.0, -7436429.0 / 663552.0, 37182145.0 / 7962624.0];

fn polynomial<T: Real, const N: usize>(coefficients: &[f64; N], argument: T) -> T {
    coefficients.iter().rev().fold(T::zero(), |sum, &next| sum * argument + T::narrow(next))
}

/// Returns `base` to an exponent, for starting values. The two functions are linked anyway; the
/// library's power would take another 1.4 KiB.
fn power<T: Real>(base: T, exponent: T) -> T {
    (exponent * base.ln()).exp()
}

/// Clamps to [`SMALLEST`] and [`LARGEST`]; NaN becomes the smallest.
fn bounded(noncentrality: f64) -> f64 {
    if noncentrality > SMALLEST { noncentrality.min(LARGEST) } else { SMALLEST }
}

/// Returns `ln p`, within the range of a single.
fn ln<T: Real>(tail: Probability) -> T {
    T::narrow(tail.get().max(SMALLEST_TAIL)).ln()
}

/// Returns the upper quantile of the normal distribution, for starting values, accurate to 4.5e-4
/// ([Abramowitz1964] 26.2.23).
///
/// [Abramowitz1964]: crate#references
fn normal_quantile<T: Real>(ln_tail: T) -> T {
    let t = (-(ln_tail + ln_tail)).sqrt_approx();
    let [a, b, c, d, e, f] = [2.515517, 0.802853, 0.010328, 1.432788, 0.189269, 0.001308].map(T::narrow);
    t - (a + t * (b + t * c)) / (T::one() + t * (d + t * (e + t * f)))
}

#[cfg(test)]
#[allow(clippy::expect_used)]
mod tests;
