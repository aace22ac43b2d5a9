//! Direct solution, row by row, of a mode that leaves a poor geometry.
//!
//! Elimination subtracts from 1: at a redundancy of 1 % single precision retains five digits, at
//! 1e-5 two. Instead, the remaining rows are rotated into a triangle, one after another (Givens).
//! This loses as many digits as the dilution of precision has, not as many as its square:
//!
//! ```text
//! R from rows √w_i (d_i − d̄_c)        U = R⁻¹       P_E = U Uᵀ      x_E − x = U Qᵀ√w v
//! S_E,i = w_i U (Uᵀ d'_i)             Cov_ss = Σ (S_E,i − S_i)² σ_acc,i²      b = Σ |S_E,i| b_i
//! ```
//!
//! It takes about 120 instructions for each satellite.

use nalgebra::{Matrix3, Vector3};

use super::super::modes::{Hypothesis, RowSet, row};
use super::{GROUPS, SubsetSolution, SubsetSolutions, group_of};
use crate::numeric::real::Real;
use crate::numeric::space::{
    columns, difference, divided, magnitudes, plus_scaled, product, products, scaled, sum,
    transposed_product, zero,
};
use crate::satellite::Constellation;

/// Largest weight times trace of the covariance above which a geometry counts as singular. The
/// smallest eigenvalue of its normal matrix is then about 1e-8.
const SINGULAR: f64 = 1e8;

/// Rows rotated into a triangle, with their residuals.
struct Triangle<T: Real> {
    rows: [Vector3<T>; 3],
    right: [T; 3],
}

/// A row with its residual.
type Turned<T> = (Vector3<T>, T);

impl<T: Real> Triangle<T> {
    fn add(&mut self, mut row: Vector3<T>, mut residual: T) {
        for (column, (top, right)) in self.rows.iter_mut().zip(self.right.iter_mut()).enumerate() {
            [(*top, *right), (row, residual)] = turn(column, &(*top, *right), &(row, residual));
        }
    }

    /// Returns `R⁻¹`; the caller checks that it is finite.
    fn inverse(&self) -> Matrix3<T> {
        let [first, second, third] = &self.rows;
        let (u11, u22, u33) = (first.x.recip(), second.y.recip(), third.z.recip());
        let (u12, u23) = (-(u11 * first.y * u22), -(u22 * second.z * u33));
        let u13 = -(u11 * (first.y * u23 + first.z * u33));
        let zero = T::zero();
        Matrix3::new(u11, u12, u13, zero, u22, u23, zero, zero, u33)
    }
}

/// Rotates two rows so that the second one becomes zero in a column.
#[inline(never)]
fn turn<T: Real>(column: usize, top: &Turned<T>, below: &Turned<T>) -> [Turned<T>; 2] {
    let [(top, right), (row, residual)] = [*top, *below];
    let [&diagonal, &rest] = [top.get(column), row.get(column)].map(|entry| entry.unwrap_or(&top.x));
    let length = (diagonal * diagonal + rest * rest).sqrt_approx();
    if !(length > T::zero()) {
        return [(top, right), (row, residual)];
    }
    let (cosine, sine) = (diagonal / length, rest / length);
    [
        (plus_scaled(&scaled(cosine, &top), sine, &row), right * cosine + residual * sine),
        (difference(&scaled(cosine, &row), &scaled(sine, &top)), residual * cosine - right * sine),
    ]
}

/// Returns the solution without a mode and its bias, or `None` if the remaining rows do not
/// determine it.
#[cold]
#[inline(never)]
pub(super) fn solve<T: Real, const N: usize>(
    solutions: &SubsetSolutions<'_, T, N>,
    hypothesis: Hypothesis,
) -> Option<(SubsetSolution<T>, Vector3<T>)> {
    let chosen = hypothesis.rows().fold(0, |set: RowSet, index| set | row(index));
    let is_left = |index: usize, group: usize| {
        let is_lost = group < Constellation::COUNT && hypothesis.constellations >> group & 1 != 0;
        !is_lost && chosen & row(index) == 0
    };
    let means = means(solutions, &is_left);
    let mean_of = |group: usize| means.get(group).copied().unwrap_or_else(zero);
    let mut triangle = Triangle { rows: [zero(); 3], right: [T::zero(); 3] };
    for (index, (row, fit, _)) in solutions.rows().enumerate() {
        let group = group_of(row);
        if is_left(index, group) && row.weight > T::zero() {
            let root = row.weight.sqrt_approx();
            triangle.add(scaled(root, &difference(&fit.centred, &mean_of(group))), fit.residual * root);
        }
    }
    let inverse = triangle.inverse();
    let [first, second, third] = columns(&inverse).map(|column| products(&column, &column));
    let variance = sum(&sum(&first, &second), &third);
    // A NaN sum fails this comparison.
    if !(solutions.largest_weight() * (variance.x + variance.y + variance.z) < T::narrow(SINGULAR)) {
        return None;
    }
    let (mut separation, mut bias) = (zero(), zero());
    for (index, (row, fit, own)) in solutions.rows().enumerate() {
        let group = group_of(row);
        let gain = if is_left(index, group) {
            product(&inverse, &transposed_product(&inverse, &difference(&fit.centred, &mean_of(group))))
        } else {
            zero()
        };
        let moved = difference(&gain, &fit.gain);
        separation = plus_scaled(&separation, row.weight * own.share, &products(&moved, &moved));
        bias = plus_scaled(&bias, own.weighted_bias, &magnitudes(&gain));
    }
    Some((SubsetSolution { variance, separation, shift: product(&inverse, &triangle.right.into()) }, bias))
}

/// Returns the weighted means of the remaining rows of each constellation.
fn means<T: Real, const N: usize>(
    solutions: &SubsetSolutions<'_, T, N>,
    is_left: &impl Fn(usize, usize) -> bool,
) -> [Vector3<T>; GROUPS] {
    let mut sums = [(zero(), T::zero()); GROUPS];
    for (index, (row, fit, _)) in solutions.rows().enumerate() {
        let group = group_of(row);
        if let Some((sum, weight)) = sums.get_mut(group).filter(|_| is_left(index, group)) {
            *sum = plus_scaled(sum, row.weight, &fit.centred);
            *weight += row.weight;
        }
    }
    let mut means = sums.map(|(sum, weight)| if weight > T::zero() { divided(&sum, weight) } else { zero() });
    // Rows without a clock are not centred.
    if let Some(mean) = means.last_mut() {
        *mean = zero();
    }
    means
}
