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
//! Without fault the direction of `p` is uniform on the sphere in `ν` dimensions, so a cosine to
//! any line follows a transformed Student distribution with `ν − 1` degrees of freedom. With
//! `ρ_T = sin θ` its tail is a finite sum in `θ` ([Abramowitz1964] 26.7.3, 26.7.4), and no table is
//! needed:
//!
//! ```text
//! m = ν − 1 odd    1 − α = 2/π (θ + sin θ (cos θ + 2/3 cos³θ + … ))     (m − 1)/2 terms
//! m even           1 − α = sin θ (1 + 1/2 cos²θ + (1·3)/(2·4) cos⁴θ + …)  m/2 terms
//! ```
//!
//! Accuracy: in `f64` relative 1e-9 for `α ≥ 1e-6`, in `f32` 5e-5 for `α ≥ 1e-3`. It is computed
//! once a fault was detected, not before; in some ten Newton steps of `ν/2` terms.
//!
//! [Parity] leaves the threshold's form open; Student's is the exact one under equal sigmas and any
//! geometry.
//!
//! [Abramowitz1964]: crate#references
//! [Parity]: crate#references

use crate::least_squares::{RowFit, Snapshot};
use crate::numeric::probability::Probability;
use crate::numeric::real::Real;

/// Most Newton steps: from the left of a convex falling function each divides the tail by about e.
const MAX_STEPS: usize = 64;

/// Returns `ρ_i` of one row, dimensionless; 0 if the row is untestable or no residual is left to
/// explain.
pub fn correlation<T: Real, const N: usize>(snapshot: &Snapshot<'_, T, N>, fit: &RowFit<T>) -> T {
    let length = snapshot.sse().sqrt();
    if length > T::zero() { fit.w_test() / length } else { T::zero() }
}

/// Returns `ρ_T` for a confidence and a number of degrees of freedom, or `None` below two, where
/// every |ρ| is 1.
pub fn correlation_threshold<T: Real>(alpha: Probability, dof: usize) -> Option<T> {
    let student_dof = dof.checked_sub(1).filter(|&student_dof| student_dof > 0)?;
    let (alpha, mut angle) = (T::narrow(alpha.get()), T::zero());
    for _ in 0..MAX_STEPS {
        let (tail, slope) = student_tail(angle, student_dof);
        let next = angle + (tail - alpha) / slope;
        // From the left the angle only grows, until rounding decides. NaN leaves here too.
        if !(next > angle) {
            break;
        }
        angle = next;
    }
    let (threshold, _) = angle.sine_and_cosine();
    Some(threshold)
}

/// Returns the two-sided tail of Student's distribution beyond `√m tan(angle)`, and minus its
/// derivative by the angle.
fn student_tail<T: Real>(angle: T, m: usize) -> (T, T) {
    let (sin, cos) = angle.sine_and_cosine();
    let odd = m % 2 == 1;
    let (unit, base, mut term) =
        if odd { (T::frac_2_pi(), angle, cos) } else { (T::one(), T::zero(), T::one()) };
    let (mut sum, mut numerator) = (T::zero(), if odd { T::narrow(2.0) } else { T::one() });
    for _ in 0..m / 2 {
        sum += term;
        term *= numerator / (numerator + T::one()) * cos * cos;
        numerator += T::narrow(2.0);
    }
    (T::one() - unit * (base + sin * sum), unit * T::narrow(m as f64) * term / cos)
}
