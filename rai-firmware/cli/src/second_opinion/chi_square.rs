//! Central and non-central chi-square distribution, with full relative accuracy in the tails.
//!
//! `Q(ν/2, t/2)` and `P(ν/2, t/2)` are the upper and the lower tail of χ²(ν); the non-central lower
//! tail is the Poisson mixture `G(t; ν, λ) = Σ_j e^(−λ/2) (λ/2)^j / j! · P(ν/2 + j, t/2)`.
//!
//! | symbol | argument | unit |
//! |---|---|---|
//! | `ν` | `dof` | degrees of freedom, a positive integer |
//! | `t` | `statistic` | a sum of squared, sigma-normalised residuals |
//! | `λ` | `noncentrality` | a sum of squared means |
//! | `a`, `x` | `ν/2`, `t/2` | |
//!
//! Accuracy: every sum below has positive terms only, so nothing cancels. The error that remains is
//! the rounding of one exponential: relative to a tail about 1e-14 and `x` times 2e-16 more, hence
//! a few 1e-15 in a quantile. A complement `1 − p` is taken only if `p` is below about one half, so
//! that nothing is lost. `statrs` loses half of the digits in quantiles of small tails, so these
//! functions are written out here.
//!
//! Every transcendental function comes from `libm`, so that the numbers are the same, bit for bit,
//! on every host.
//!
//! Limits: `dof` up to some thousands. References: [NIST DLMF] §8.4, §8.7, §8.8; [Johnson1995]
//! ch. 29.
//!
//! [Johnson1995]: crate#references

use libm::{ceil, erfc, exp, fabs, lgamma, log, sqrt};

/// Largest number of iterations of [`root`]: bisection alone halves any bracket of doubles to its
/// last bit within these.
const MAX_ITERATIONS: usize = 200;

/// Returns the upper tail of χ²(`dof`): the probability to exceed `statistic`.
pub fn upper_tail(statistic: f64, dof: usize) -> f64 {
    let (a, x) = (dof as f64 / 2.0, statistic / 2.0);
    if x < a { 1.0 - lower_series(a, x) } else { upper_sum(dof, x) }
}

/// Returns the lower tail of χ²(`dof`): the probability to stay below `statistic`.
pub fn lower_tail(statistic: f64, dof: usize) -> f64 {
    let (a, x) = (dof as f64 / 2.0, statistic / 2.0);
    if x < a { lower_series(a, x) } else { 1.0 - upper_sum(dof, x) }
}

/// Returns `e^(−x) x^a / Γ(a + 1)`: the common factor of all sums, and the step from `P(a, x)` to
/// `P(a + 1, x)`.
fn step(a: f64, x: f64) -> f64 {
    exp(a * log(x) - x - lgamma(a + 1.0))
}

/// Returns `P(a, x) = step · Σ x^k / ((a + 1) … (a + k))`.
fn lower_series(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    let (mut term, mut sum, mut k) = (1.0, 1.0, a);
    while term > sum * (f64::EPSILON / 4.0) {
        k += 1.0;
        term *= x / k;
        sum += term;
    }
    step(a, x) * sum
}

/// Returns `Q(ν/2, x)`, which is a finite sum for an integer `ν`:
/// `step(a − 1) · (1 + (a − 1)/x + …)`, down to the exponential for an even `ν` and to `erfc(√x)`
/// for an odd one.
fn upper_sum(dof: usize, x: f64) -> f64 {
    let base = if dof.is_multiple_of(2) { 0.0 } else { erfc(sqrt(x)) };
    let terms = dof / 2;
    if terms == 0 {
        return base;
    }
    let top = dof as f64 / 2.0 - 1.0;
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 0..terms - 1 {
        term *= (top - k as f64) / x;
        sum += term;
    }
    base + step(top, x) * sum
}

/// Returns the lower tail of the non-central χ²(`dof`, `noncentrality`), and its derivative by
/// `noncentrality`.
///
/// The mixture is summed from its top down, where `P(a, x) = P(a + 1, x) + step(a, x)` only adds.
/// The derivative is minus the density with two more degrees of freedom, which is the same mixture
/// of the same steps.
pub fn noncentral_lower_tail(statistic: f64, dof: usize, noncentrality: f64) -> (f64, f64) {
    let (a, x, mean) = (dof as f64 / 2.0, statistic / 2.0, noncentrality / 2.0);
    if mean <= 0.0 {
        return (lower_tail(statistic, dof), -step(a, x) / 2.0);
    }
    // Above this index both factors only fall: the omitted terms are below e^(−70) of the sum.
    let top = ceil(mean + 12.0 * sqrt(mean) + 60.0) as usize;
    let mut lower = lower_tail(statistic, dof + 2 * (top + 1));
    let (mut tail, mut slope) = (0.0, 0.0);
    for j in (0..=top).rev() {
        let gain = step(a + j as f64, x);
        let weight = step(j as f64, mean);
        lower += gain;
        tail += weight * lower;
        slope -= weight * gain / 2.0;
    }
    (tail, slope)
}

/// Returns the statistic that χ²(`dof`) exceeds with probability `tail`: `tau1`.
pub fn upper_quantile(tail: f64, dof: usize) -> f64 {
    let target = log(tail);
    let nu = dof as f64;
    // [Laurent2000] lemma 1 bounds the quantile.
    let bound = nu + 2.0 * sqrt(-nu * target) - 2.0 * target;
    let half = nu / 2.0 - 1.0;
    root(0.0, bound, |t| {
        let q = upper_tail(t, dof);
        let density = exp(half * log(t / 2.0) - t / 2.0 - lgamma(half + 1.0)) / 2.0;
        (log(q) - target, -density / q)
    })
}

/// Returns the non-centrality at which χ²(`dof`, ·) stays below `statistic` only with probability
/// `tail`: `lambda`.
pub fn noncentrality(statistic: f64, dof: usize, tail: f64) -> f64 {
    let target = log(tail);
    let excess = |noncentrality: f64| {
        let (lower, slope) = noncentral_lower_tail(statistic, dof, noncentrality);
        (log(lower) - target, slope / lower)
    };
    let mut bound = statistic.max(1.0);
    while excess(bound).0 > 0.0 && bound < 1e9 {
        bound *= 2.0;
    }
    root(0.0, bound, excess)
}

/// Returns the value that `|N(0, 1)|` exceeds with probability `tail`: the square root of χ²(1).
pub fn two_sided_normal_quantile(tail: f64) -> f64 {
    sqrt(upper_quantile(tail, 1))
}

/// Finds the root of a decreasing function between `low` and `high` by Newton's method, safeguarded
/// by bisection.
fn root(mut low: f64, mut high: f64, function: impl Fn(f64) -> (f64, f64)) -> f64 {
    let mut x = high;
    for _ in 0..MAX_ITERATIONS {
        let (value, slope) = function(x);
        if value > 0.0 {
            low = x;
        } else {
            high = x;
        }
        let newton = x - value / slope;
        let next = if newton > low && newton < high { newton } else { f64::midpoint(low, high) };
        // Two ulp: below that, the rounding of `function` decides, not its root.
        if fabs(next - x) <= 2.0 * f64::EPSILON * next {
            return next;
        }
        x = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(have: f64, want: f64, relative: f64) {
        assert!(fabs(have / want - 1.0) <= relative, "have {have:e}, want {want:e}");
    }

    #[test]
    fn two_degrees_of_freedom_are_an_exponential() {
        for statistic in [0.1, 1.0, 10.0, 100.0, 1000.0] {
            close(upper_tail(statistic, 2), exp(-statistic / 2.0), 1e-13);
            close(lower_tail(statistic, 2), -libm::expm1(-statistic / 2.0), 1e-14);
        }
        close(upper_quantile(1e-300, 2), -2.0 * log(1e-300), 1e-14);
    }

    #[test]
    fn one_degree_of_freedom_is_a_squared_normal() {
        for deviation in [0.01, 0.5, 2.0, 6.0, 20.0] {
            close(upper_tail(deviation * deviation, 1), erfc(deviation / sqrt(2.0)), 1e-13);
            close(lower_tail(deviation * deviation, 1), libm::erf(deviation / sqrt(2.0)), 1e-14);
        }
    }

    #[test]
    fn tails_add_up_to_one_though_computed_apart() {
        for dof in 1..=60 {
            for statistic in [0.2, 1.0, 5.0, 20.0, 60.0, 90.0] {
                let (a, x) = (dof as f64 / 2.0, statistic / 2.0);
                close(lower_series(a, x) + upper_sum(dof, x), 1.0, 3e-14);
            }
        }
    }

    #[test]
    fn quantile_gives_its_tail_back() {
        for dof in [1, 2, 3, 7, 40, 61, 200] {
            for tail in [0.4, 1e-3, 3.33e-7, 1e-12, 1e-100] {
                close(upper_tail(upper_quantile(tail, dof), dof), tail, 1e-13 * (2.0 - log(tail)));
            }
        }
    }

    /// Computes `G = ∫ φ(z − √λ) · F(t − z²; ν − 1) dz` by the trapezium rule in `z = √t sin θ`.
    /// There the integrand of an even `ν` is smooth and periodic, so that the rule converges to the
    /// last digit.
    fn noncentral_by_quadrature(statistic: f64, dof: usize, noncentrality: f64) -> f64 {
        let points = 2000;
        let width = core::f64::consts::PI / points as f64;
        let radius = sqrt(statistic);
        let integrand = |angle: f64| {
            let deviation = radius * libm::sin(angle) - sqrt(noncentrality);
            let rest = statistic * libm::cos(angle) * libm::cos(angle);
            exp(-deviation * deviation / 2.0) * lower_tail(rest, dof - 1) * radius * libm::cos(angle)
        };
        let sum: f64 = (1..points).map(|k| integrand(-core::f64::consts::FRAC_PI_2 + k as f64 * width)).sum();
        sum * width / sqrt(2.0 * core::f64::consts::PI)
    }

    #[test]
    fn mixture_equals_the_integral_over_the_shifted_normal() {
        for (statistic, dof, noncentrality) in [(30.0, 4, 80.0), (90.0, 42, 120.0), (140.0, 60, 190.0)] {
            let want = noncentral_by_quadrature(statistic, dof, noncentrality);
            close(noncentral_lower_tail(statistic, dof, noncentrality).0, want, 1e-12);
        }
    }

    #[test]
    fn derivative_of_the_mixture_equals_a_difference_quotient() {
        let tail = |noncentrality| noncentral_lower_tail(35.7, 4, noncentrality);
        let want = (tail(78.5 + 1e-3).0 - tail(78.5 - 1e-3).0) / 2e-3;
        close(tail(78.5).1, want, 1e-7);
    }

    #[test]
    fn missed_detection_beyond_any_sky_still_has_a_root() {
        let statistic = upper_quantile(1e-8, 4);
        let noncentrality = noncentrality(statistic, 4, 1e-100);
        close(log(noncentral_lower_tail(statistic, 4, noncentrality).0), log(1e-100), 1e-13);
    }
}
