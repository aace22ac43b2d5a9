//! Bounds that dismiss most modes, because they have no effect.
//!
//! ```text
//! test         |x_E − x|² ≤ Cov_ss v_Eᵀ κ_EE⁻¹ v_E  on any axis       for one row exact, with the same factor on all axes
//! level        (T + u σ)² ≤ (1 + λ) K² σ_ss² + (1 + 1/λ) u² σ²       for any λ > 0
//! bias         b ≤ b_first + |c| s,   (m − b)² ≥ (m − b_first)² − 2 (m − b_first) |c| s
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `(1 + λ) K²`, `(1 + 1/λ) u²` | [`Bounds::separation`], [`Bounds::variance`] | – |
//! | `m` | [`Bounds::references_m`] | m |
//! | `c` | a row's column `A/B` | – |
//! | `s ≥ Σ \|M_ji\| b_i` | [`RowContribution::spread`] | m |
//!
//! If modes have all but one row in common, their variances differ by squares of that row's column.
//! The bound on a level is linear in both variances. It therefore takes a few operations for each
//! axis, and no root. If the bounds do not dismiss a mode, it is solved.

use nalgebra::Vector3;

use super::elimination::{FirstRow, KernelRow};
use super::kernel::hardly_left;
use super::{IntegrityRow, SubsetSolution, SubsetSolutions};
use crate::bit_set::bit;
use crate::integrity::araim::modes::{Hypothesis, RowSet};
use crate::least_squares::RowFit;
use crate::least_squares::equations::Row;
use crate::numeric::real::Real;
use crate::numeric::space::{diagonal, difference, dot, magnitudes, products, scaled, sum, zero};

/// Bounds below which a mode has no effect.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrity::araim) struct Bounds<T: Real> {
    /// Factors on the separation's variance, for east and north, and for up.
    pub(in crate::integrity::araim) separation: [T; 2],
    /// Factors on the variance, for east and north, and for up.
    pub(in crate::integrity::araim) variance: [T; 2],
    pub(in crate::integrity::araim) references_m: Vector3<T>,
    /// Largest `|x_k − x|²/σ_ss²` that is no worse than an earlier one.
    pub(in crate::integrity::araim) worst: T,
    /// Smallest over largest squared `K`: the ratio by which a row's tests on the axes differ.
    pub(in crate::integrity::araim) evenness: T,
    /// Largest vertical `σ_ss²` that cannot raise the effective monitor threshold, m².
    pub(in crate::integrity::araim) effective: T,
}

/// Common part of modes that differ in one row.
struct SharedMargins<T: Real> {
    /// Margins that remain for the squares of the differing row, m².
    margins: Vector3<T>,
    /// Decrease of the margins by a bias of the differing row, m² per m.
    slopes: Vector3<T>,
}

impl<T: Real> Bounds<T> {
    fn beyond(&self, common: &SubsetSolution<T>, bias_m: &Vector3<T>) -> SharedMargins<T> {
        let [horizontal, vertical] = self.separation;
        let separation = Vector3::new(horizontal, horizontal, vertical);
        let [horizontal, vertical] = self.variance;
        let variance = Vector3::new(horizontal, horizontal, vertical);
        let left_m = difference(&self.references_m, bias_m);
        let used = sum(&products(&separation, &common.separation), &products(&variance, &common.variance));
        // A negative margin stays negative with any bias of the row.
        let magnitude_m = magnitudes(&left_m);
        SharedMargins {
            margins: difference(&products(&left_m, &magnitude_m), &used),
            slopes: sum(&magnitude_m, &magnitude_m),
        }
    }
}

/// Contribution of a row to the variances of a mode.
struct RowContribution<T: Real> {
    column: Vector3<T>,
    /// Remainder of its `B_jj`, m².
    pivot: T,
    /// Remainder of its `κ_jj`, m².
    kappa: T,
    /// Twice `κ` with the earlier row, times that row's column.
    cross: Vector3<T>,
    /// Bound `s` on the biases, m.
    spread: T,
}

impl<T: Real> RowContribution<T> {
    /// Returns true if the term of the mode is clear on all axes.
    #[inline]
    fn is_clear(&self, bounds: &Bounds<T>, base: &SharedMargins<T>) -> bool {
        let [of_separation, vertical_of_separation] = bounds.separation;
        let [of_variance, vertical_of_variance] = bounds.variance;
        let horizontal = self.kappa * of_separation + self.pivot * of_variance;
        let vertical = self.kappa * vertical_of_separation + self.pivot * vertical_of_variance;
        let Self { column, cross, .. } = self;
        let is_clear = |column: T, square: T, cross: T, slope: T, margin: T| {
            column * (column * square + cross) + column.abs() * (slope * self.spread) <= margin
        };
        is_clear(column.z, vertical, cross.z * vertical_of_separation, base.slopes.z, base.margins.z)
            && is_clear(column.x, horizontal, cross.x * of_separation, base.slopes.x, base.margins.x)
            && is_clear(column.y, horizontal, cross.y * of_separation, base.slopes.y, base.margins.y)
    }
}

impl<T: Real, const N: usize> SubsetSolutions<'_, T, N> {
    /// Screens modes that take the common rows and one more row each. Returns the further rows of
    /// those that may have an effect.
    #[inline(never)]
    pub(in crate::integrity::araim) fn screen(
        &mut self,
        common: Hypothesis,
        rows: RowSet,
        bounds: &Bounds<T>,
    ) -> RowSet {
        if common.constellations != 0 {
            return rows;
        }
        if common == Hypothesis::NONE {
            return self.screen_singles(rows, bounds);
        }
        // The thresholds of likely pairs must be computed, because they may raise the effective
        // monitor threshold.
        if bounds.effective.is_finite() {
            return rows;
        }
        self.enter_first(common);
        match &self.first {
            Some(first) => self.screen_pairs(first, rows, bounds),
            None => rows,
        }
    }

    /// Screens single rows.
    fn screen_singles(&self, rows: RowSet, bounds: &Bounds<T>) -> RowSet {
        let nothing = zero();
        let whole =
            SubsetSolution { variance: diagonal(self.view.covariance), separation: nothing, shift: nothing };
        let base = bounds.beyond(&whole, &self.whole_bias);
        let mut worst = bounds.worst;
        self.left_of(rows, |row, fit, own| {
            let squared = fit.residual * fit.residual;
            if !(squared <= worst * own.kappa) {
                // Later rows are compared with this one, if visiting it changes `worst`.
                if own.kappa > T::zero() && dot(&fit.gain, &fit.gain) > T::zero() {
                    worst = squared / own.kappa * bounds.evenness;
                }
                return false;
            }
            let part = RowContribution {
                column: scaled(own.pivot.recip(), &fit.gain),
                pivot: own.pivot,
                kappa: own.kappa,
                cross: nothing,
                spread: own.spread,
            };
            own.pivot * row.weight >= hardly_left()
                && part.column.z * part.column.z * own.kappa <= bounds.effective
                && part.is_clear(bounds, &base)
        })
    }

    /// Screens pairs with the same first row.
    fn screen_pairs(&self, first: &FirstRow<T>, rows: RowSet, bounds: &Bounds<T>) -> RowSet {
        let base = bounds.beyond(&first.solution, &first.bias);
        let inverse = first.point.kappa.recip();
        let left = bounds.worst - first.point.residual * first.point.residual * inverse;
        let twice = sum(&first.column, &first.column);
        self.left_of(rows, |row, fit, own| {
            let point = KernelRow::of(row, fit, own);
            let Some(beside) = Self::beside(first, &point, zero()) else { return false };
            let share = beside.kappa_first * inverse;
            let residual = beside.residual - share * first.point.residual;
            let part = RowContribution {
                column: beside.column,
                pivot: beside.pivot,
                kappa: beside.kappa,
                cross: scaled(beside.kappa_first, &twice),
                spread: own.spread + beside.factor.abs() * first.point.spread,
            };
            residual * residual <= left * (beside.kappa - share * beside.kappa_first)
                && part.is_clear(bounds, &base)
        })
    }

    /// Returns the rows that are not dismissed.
    #[inline]
    fn left_of(
        &self,
        rows: RowSet,
        mut is_dismissed: impl FnMut(&Row<T>, &RowFit<T>, &IntegrityRow<T>) -> bool,
    ) -> RowSet {
        let start = rows.trailing_zeros() as usize;
        let (mut left, mut rest) = (0, rows.unbounded_shr(start as u32));
        let from_start =
            self.view.rows.get(start..).zip(self.view.fits.get(start..)).zip(self.own.get(start..));
        let Some(((equations, fits), owns)) = from_start else { return rows };
        for (index, ((row, fit), own)) in (start..).zip(equations.iter().zip(fits).zip(owns)) {
            if rest == 0 {
                break;
            }
            if rest & 1 != 0 && !is_dismissed(row, fit, own) {
                left |= bit(index);
            }
            rest >>= 1;
        }
        left
    }
}
