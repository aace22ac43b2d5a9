//! Correlation of the parity vector with the line of each row, and its threshold.
//!
//! ```text
//! ρ_i = p·p_i / (|p| |p_i|) = w_i / √SSE        |ρ_i| ≤ 1, = 1 where row i alone explains everything
//! P(|ρ_i| ≥ ρ_T) = α                            ρ_T = t / √(ν − 1 + t²),  t = t_(1−α/2)(ν − 1)
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `p` | parity vector, `p·p = SSE` | – |
//! | `p_i` | its direction under a bias of row `i`, `p_i·p_j = S_ij` | – |
//! | `α` | probability that the correlation of a healthy row exceeds `ρ_T` | – |
//! | `ν` | degrees of freedom, the dimension of parity space | – |
//! | `t` | quantile of Student's distribution | – |
//!
//! Without fault the direction of `p` is uniform on the sphere in `ν` dimensions, so a cosine to any line follows a
//! transformed Student distribution with `ν − 1` degrees of freedom. With `ρ_T = sin θ` its tail is a finite sum in
//! `θ` ([Abramowitz1964] 26.7.3, 26.7.4), and no table is needed:
//!
//! ```text
//! m = ν − 1 odd    1 − α = 2/π (θ + sin θ (cos θ + 2/3 cos³θ + … ))     (m − 1)/2 terms
//! m even           1 − α = sin θ (1 + 1/2 cos²θ + (1·3)/(2·4) cos⁴θ + …)  m/2 terms
//! ```
//!
//! Accuracy: relative 1e-9 for `α ≥ 1e-6`. Cost: it is computed once a fault was detected, not before; about
//! six Newton steps of `ν/2` terms in `f64`.
//!
//! [Parity] leaves the threshold's form open; Student's is the exact one under equal sigmas and any geometry.

use crate::probability::Probability;
use crate::real::Real;
use crate::snapshot::{Fit, Snapshot};
use crate::{identification::baarda::w_test, linear::Row};

/// Newton steps at most: from the left of a convex falling function each divides the tail by about e.
const MAX_STEPS: usize = 64;

/// `ρ_i` of one row, dimensionless; 0 where the row is untestable or nothing is left to explain.
pub fn correlation<T: Real, const N: usize>(snapshot: &Snapshot<T, N>, row: &Row<T>, fit: &Fit<T>) -> T {
    let length = snapshot.sse().sqrt();
    if length > T::zero() { w_test(row, fit) / length } else { T::zero() }
}

/// `ρ_T` for a confidence and a number of degrees of freedom; `None` below two, where every |ρ| is 1.
pub fn correlation_threshold(alpha: Probability, dof: usize) -> Option<f64> {
    let student_dof = dof.checked_sub(1).filter(|&student_dof| student_dof > 0)?;
    let mut angle = 0.0;
    for _ in 0..MAX_STEPS {
        let (tail, slope) = student_tail(angle, student_dof);
        let step = (tail - alpha.get()) / slope;
        angle += step;
        if !(step > 1e-15) {
            break;
        }
    }
    Some(libm::sin(angle))
}

/// Two-sided tail of Student's distribution beyond `√m tan(angle)`, and minus its derivative by the angle.
fn student_tail(angle: f64, m: usize) -> (f64, f64) {
    let (sin, cos) = (libm::sin(angle), libm::cos(angle));
    let odd = m % 2 == 1;
    let (unit, base, mut term) =
        if odd { (core::f64::consts::FRAC_2_PI, angle, cos) } else { (1.0, 0.0, 1.0) };
    let mut sum = 0.0;
    for k in 1..=m / 2 {
        sum += term;
        let numerator = if odd { 2 * k } else { 2 * k - 1 };
        term *= numerator as f64 / (numerator + 1) as f64 * cos * cos;
    }
    (1.0 - unit * (base + sin * sum), unit * m as f64 * term / cos)
}
