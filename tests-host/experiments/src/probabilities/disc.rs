//! Probability of a horizontal error beyond a distance: the normal distribution outside a disc.
//!
//! ```text
//! P(|m + x| > R) = 1 − ∫ φ((u − m₁)/a)/a [Φ((h − m₂)/b) − Φ((−h − m₂)/b)] du      h = √(R² − u²)
//! ```
//!
//! The integral is over `|u| < R`, along the principal axes of the covariance of `x`, whose
//! deviations are `a` and `b`, and not farther from `m₁` than chance reaches.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI, TAU};

use nalgebra::{Matrix2, Vector2};

/// Number of points of the midpoint rule in `t`, with `u` a sine of it from end to end, which is
/// smooth to the rim.
const POINTS: u32 = 400;

/// Number of deviations beyond which the probability is negligible: 1e-19.
const FAR: f64 = 9.0;

/// Returns the probability of an error beyond the radius, accurate to 1e-9 if neither deviation is
/// below a fiftieth of the other.
pub(super) fn beyond(radius_m: f64, mean_m: Vector2<f64>, covariance_m2: Matrix2<f64>) -> f64 {
    let axes = covariance_m2.symmetric_eigen();
    let mean = axes.eigenvectors.transpose() * mean_m;
    let deviation = axes.eigenvalues.map(|variance| variance.max(0.0).sqrt());
    let low = (mean.x - FAR * deviation.x).max(-radius_m);
    let high = (mean.x + FAR * deviation.x).min(radius_m);
    if low >= high {
        return 1.0;
    }
    let (middle, half, step) = (f64::midpoint(low, high), (high - low) / 2.0, PI / f64::from(POINTS));
    let strip = |point: u32| {
        let (sin, cos) = (-FRAC_PI_2 + (f64::from(point) + 0.5) * step).sin_cos();
        let u = middle + half * sin;
        let rim = (radius_m * radius_m - u * u).max(0.0).sqrt();
        let across = (u - mean.x) / deviation.x;
        let along = |end_m: f64| lower_tail((end_m - mean.y) / deviation.y);
        let density = (-across * across / 2.0).exp() / (deviation.x * TAU.sqrt());
        density * (along(rim) - along(-rim)) * half * cos * step
    };
    (1.0 - (0..POINTS).map(strip).sum::<f64>()).max(0.0)
}

fn lower_tail(x: f64) -> f64 {
    libm::erfc(-x * FRAC_1_SQRT_2) / 2.0
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix2, Vector2};

    use super::beyond;
    use raim::second_opinion::chi_square::noncentral_lower_tail;

    #[test]
    fn round_distribution_is_a_non_central_chi_square() {
        for (radius_m, mean_m) in
            [(3.0, 0.0), (10.0, 7.0), (10.0, 10.0), (25.0, 4.0), (556.0, 12.0), (10.0, 60.0)]
        {
            let have = beyond(radius_m, Vector2::new(0.6, 0.8) * mean_m, Matrix2::from_diagonal_element(4.0));
            let want = 1.0 - noncentral_lower_tail(radius_m * radius_m / 4.0, 2, mean_m * mean_m / 4.0).0;
            assert!((have - want).abs() < 1e-9, "radius {radius_m}, mean {mean_m}: have {have}, want {want}");
        }
    }

    #[test]
    fn thin_distribution_is_a_line() {
        // The deviation is 2 along the diagonal and almost zero across: P(|N(0, 2)| > 4) =
        // erfc(√2).
        let covariance_m2 = Matrix2::new(2.0 + 0.01, 2.0 - 0.01, 2.0 - 0.01, 2.0 + 0.01);
        let have = beyond(4.0, Vector2::zeros(), covariance_m2);
        assert!((have - 0.045_500).abs() < 3e-4, "have {have}");
    }
}
