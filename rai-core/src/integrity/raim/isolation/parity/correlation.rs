//! Correlation of the parity vector with the line of each row, and its threshold.
//!
//! ```text
//! ρ_i = p·p_i / (|p| |p_i|) = w_i / √SSE        |ρ_i| ≤ 1, = 1 if row i alone explains everything
//! P(|ρ_i| ≥ ρ_T) = α                            ρ_T = t / √(ν − 1 + t²),  t = t_(1−α/2)(ν − 1)
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `p` | parity vector, `p·p = SSE` | – |
//! | `p_i` | direction in which a bias of row `i` moves `p`, `p_i·p_j = S_ij` | – |
//! | `α` | probability that the correlation of a healthy row exceeds `ρ_T` | – |
//! | `ν` | degrees of freedom, the dimension of parity space | – |
//! | `t` | quantile of Student's distribution | – |
//!
//! Without a fault the direction of `p` is uniform on the sphere in `ν` dimensions. Its cosine to
//! any line then follows a transformed Student distribution with `ν − 1` degrees of freedom. With
//! `ρ_T = sin θ` the tail of this distribution is a finite sum in `θ` ([Abramowitz1964] 26.7.3,
//! 26.7.4), so that no table is needed:
//!
//! ```text
//! m = ν − 1 odd    1 − α = 2/π (θ + sin θ (cos θ + 2/3 cos³θ + … ))     (m − 1)/2 terms
//! m even           1 − α = sin θ (1 + 1/2 cos²θ + (1·3)/(2·4) cos⁴θ + …)  m/2 terms
//! ```
//!
//! Relative accuracy: 1e-9 in `f64` for `α ≥ 1e-6`, 5e-5 in `f32` for `α ≥ 1e-3`. The threshold is
//! computed only after a detected fault, by some ten Newton steps of `ν/2` terms.
//!
//! [Parity] does not define the threshold. Student's distribution is exact for equal sigmas and any
//! geometry.
//!
//! [Abramowitz1964]: crate#references
//! [Parity]: crate#references

use crate::least_squares::{RowFit, Snapshot};
use crate::numeric::probability::Probability;
use crate::numeric::real::Real;

/// Largest number of Newton steps. They start at the left of a convex falling function, and each
/// divides the tail by about e.
const MAX_STEPS: usize = 64;

/// Returns `ρ_i` of one row, dimensionless; 0 if the row is untestable or all residuals are 0.
pub fn correlation<T: Real, const N: usize>(snapshot: &Snapshot<'_, T, N>, fit: &RowFit<T>) -> T {
    let length = snapshot.sse().sqrt_approx();
    if length > T::zero() { fit.w_test() / length } else { T::zero() }
}

/// Returns `ρ_T` for a probability `α`, or `None` for fewer than two degrees of freedom, where
/// every |ρ| is 1.
pub fn correlation_threshold<T: Real>(alpha: Probability, dof: usize) -> Option<T> {
    let student_dof = dof.checked_sub(1).filter(|&student_dof| student_dof > 0)?;
    let (alpha, mut angle) = (T::narrow(alpha.get()), T::zero());
    for _ in 0..MAX_STEPS {
        let (tail, slope) = student_tail(angle, student_dof);
        let next = angle + (tail - alpha) / slope;
        // From the left the angle increases until rounding stops it. NaN also ends the loop.
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
