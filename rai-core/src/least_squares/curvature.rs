//! Misfit by curvature: far away from their linearisation point, linearised ranges are wrong.
//!
//! ```text
//! SSE ≤ noise + 32 Σw (d²/2ρ)²
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `SSE` | weighted sum of squares about the present point | – |
//! | `noise` | upper bound on the contribution of noise to `SSE` | – |
//! | `w` | weights of the rows | m⁻² |
//! | `d` | correction from the present point | m |
//! | `ρ` | distance of the nearest satellite | m |
//!
//! Suppose that the rows agree about another point, at a distance `D`. Linearised about the present
//! point, their ranges are then wrong by at most `D²/2ρ`, and `D` is at most `2d`. This gives
//! `SSE ≤ 16 Σw (d²/2ρ)²` plus noise; the equation allows twice as much. A larger SSE proves that
//! the rows contradict each other everywhere.

use nalgebra::Vector3;

use super::equations::Row;
use crate::numeric::real::Real;
use crate::numeric::space::dot;

/// Distance of the nearest satellite of any system, m.
const NEAREST_M: f64 = 1.9e7;

/// Returns true if rows with this sum of squares may agree about another point.
pub(crate) fn may_explain<T: Real>(sse: T, noise: f64, rows: &[Row<T>], correction_m: &Vector3<T>) -> bool {
    let weights = rows.iter().fold(T::zero(), |sum, row| sum + row.weight);
    let bent_m = dot(correction_m, correction_m) * T::narrow(0.5 / NEAREST_M);
    // NaN fails this comparison and returns true.
    !(sse > T::narrow(noise) + T::narrow(32.0) * weights * bent_m * bent_m)
}
