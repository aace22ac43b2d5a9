//! Nominal biases: the largest effect that they can have together. It is computed exactly only if a
//! bound does not suffice.

use nalgebra::{Matrix3, Vector3};

use super::super::Prior;
use super::super::modes::ROWS;
use super::elimination::{KernelRow, LastRow};
use super::kernel::{GROUPS, group_of};
use super::{IntegrityRow, SubsetSolutions};
use crate::least_squares::RowFit;
use crate::least_squares::equations::Row;
use crate::numeric::four::Four;
use crate::numeric::real::Real;
use crate::numeric::space::{
    add_whole_outer_product, columns, difference, identity, magnitudes, matrix_product, plus_scaled, scaled,
    sum, zero,
};
use crate::satellite::Constellation;

impl<T: Real, const N: usize> SubsetSolutions<'_, T, N> {
    /// Sets a bound on each row's `Σ |M_ji| b_i`. It uses `Σ w_i b_ji² = b_jj`, because `w_i b_ji`
    /// is a projection.
    pub(super) fn spread_biases(&mut self, priors: &[Prior<T>]) {
        let rows = self.view.rows.iter().zip(priors);
        let squared = |(row, prior): (&Row<T>, &Prior<T>)| row.weight * prior.bias_m * prior.bias_m;
        let total = rows.clone().fold(T::zero(), |sum, row| sum + squared(row));
        for ((row, prior), own) in rows.zip(self.own.iter_mut()) {
            let redundancy = row.weight * own.pivot;
            let others = (total - squared((row, prior))) * (T::one() - redundancy) * own.pivot;
            // Rounding can make the remainder slightly negative.
            let root = if others > T::zero() { others * others.inverse_sqrt_approx() } else { T::zero() };
            own.spread = redundancy * prior.bias_m + root;
        }
    }

    /// Returns the bias of the all-in-view solution, m.
    pub(super) fn summed_bias_of_whole(&self) -> Vector3<T> {
        self.summed_bias(&NOTHING, &identity(), &[zero(); GROUPS])
    }

    /// Returns the bias without one row if no constellation is lost, m.
    pub(super) fn bias_without(&self, index: usize, column: &Vector3<T>, point: &KernelRow<T>) -> Vector3<T> {
        let mut steps = [zero(); GROUPS];
        if let Some(step) = steps.get_mut(point.group) {
            *step = scaled(self.level(point.group), column);
        }
        let mut turn = identity();
        add_whole_outer_product(&mut turn, column, &point.design);
        self.summed_bias(&[index, NONE, NONE], &turn, &steps)
    }

    /// Returns a bound on the bias of the mode solved last, or `None` if a bound would be
    /// expensive: for triples and lost constellations.
    #[inline]
    pub(in crate::integrity::araim) fn bias_bound(&self) -> Option<Vector3<T>> {
        if let Some((_, bias)) = &self.direct {
            return Some(*bias);
        }
        let [_, second, third] = self.at.slots();
        let LastRow { column, factor, spread } = &self.last;
        if self.at.constellations != 0 || third < ROWS {
            return None;
        }
        if second >= ROWS {
            return Some(plus_scaled(&self.whole_bias, *spread, &magnitudes(column)));
        }
        let first = self.first.as_ref()?;
        let spread = *spread + factor.abs() * first.point.spread;
        Some(plus_scaled(&first.bias, spread, &magnitudes(column)))
    }

    /// Returns the bias of the mode solved last, m.
    #[inline(never)]
    pub(in crate::integrity::araim) fn bias(&self) -> Vector3<T> {
        if let Some((_, bias)) = &self.direct {
            return *bias;
        }
        let (mut turn, mut steps) = (identity(), [zero(); GROUPS]);
        let [first, second, third] = self.at.slots();
        let mut take = |column: &Vector3<T>, design: &Vector3<T>, group: usize| {
            add_whole_outer_product(&mut turn, column, design);
            if let Some((step, group)) = steps.get_mut(group).zip(self.groups.get(group)) {
                *step = plus_scaled(step, group.level, column);
            }
        };
        // Columns of A B⁻¹ from those of the elimination, beginning with the last row.
        let mut columns = [zero(); 3];
        let [of_first, of_second, of_third] = &mut columns;
        let point = |index: usize| self.point_here(index).map(|point| (point.design, point.group));
        let mut last = self.last;
        if let Some((taken, kept)) = self.third.as_ref().zip(self.second.as_ref()).filter(|_| third < ROWS) {
            let [by_first, by_second] = taken.factors;
            *of_third = taken.column;
            *of_second = difference(of_second, &scaled(by_second, &taken.column));
            *of_first = difference(of_first, &scaled(by_first, &taken.column));
            take(of_third, &taken.design, taken.group);
            last = kept.last();
        }
        if let Some((design, group)) = point(second) {
            *of_second = sum(of_second, &last.column);
            *of_first = difference(of_first, &scaled(last.factor, of_second));
            take(of_second, &design, group);
        }
        if let Some(taken) = self.first.as_ref().filter(|_| first < ROWS) {
            *of_first = sum(of_first, &taken.column);
            take(of_first, &taken.point.design, taken.point.group);
        } else if let Some((design, group)) = point(first) {
            *of_first = sum(of_first, &last.column);
            take(of_first, &design, group);
        }
        let rows = [first, second, third];
        self.summed_bias(&rows, &turn, &steps)
    }

    /// Returns `Σ w_i b_i |Z P'd_i + s_c|` over the remaining rows, without the constellations that
    /// the kernel has lost; `Z` is `turn`, `s_c` are `steps`.
    #[inline(never)]
    fn summed_bias(&self, out: &[usize; 3], turn: &Matrix3<T>, steps: &[Vector3<T>; GROUPS]) -> Vector3<T> {
        let [first, second, third] = columns(&matrix_product(turn, &self.kernel.covariance));
        let turned = [four(&first), four(&second), four(&third)];
        let nothing = T::Four::repeat(T::zero());
        let mut joined = [nothing; GROUPS];
        joined.iter_mut().zip(steps).for_each(|(joined, step)| *joined = four(step));
        let constellations = self.at.constellations;
        let part = |(row, fit, own): (&Row<T>, &RowFit<T>, &IntegrityRow<T>)| {
            let group = group_of(row);
            let is_lost = group < Constellation::COUNT && constellations >> group & 1 != 0;
            // No step is missing, because every group has one.
            joined.get(group).filter(|_| !is_lost).map(|step| share(&turned, &fit.centred, *step, own))
        };
        let of_all = self.rows().fold(nothing, |all, row| part(row).map_or(all, |one| all + one));
        let [east, north, up, _] =
            self.rows_of(out).fold(of_all, |left, row| part(row).map_or(left, |one| left - one)).numbers();
        Vector3::new(east, north, up)
    }

    /// Iterates over some rows, as [`Self::rows`] does over all.
    fn rows_of(&self, rows: &[usize; 3]) -> impl Iterator<Item = (&Row<T>, &RowFit<T>, &IntegrityRow<T>)> {
        rows.iter().filter_map(|&index| {
            Some((self.view.rows.get(index)?, self.view.fits.get(index)?, self.own.get(index)?))
        })
    }
}

/// Index in place of a missing row.
const NONE: usize = usize::MAX;
/// No rows.
const NOTHING: [usize; 3] = [NONE; 3];

/// Joins the axes, of which the fourth is nothing.
#[inline]
fn four<T: Real>(vector: &Vector3<T>) -> T::Four {
    T::Four::join([vector.x, vector.y, vector.z, T::zero()])
}

/// Returns the effect of one row's bias on each axis.
#[inline]
fn share<T: Real>(
    [first, second, third]: &[T::Four; 3],
    lever: &Vector3<T>,
    step: T::Four,
    own: &IntegrityRow<T>,
) -> T::Four {
    let (x, y, z) = (T::Four::repeat(lever.x), T::Four::repeat(lever.y), T::Four::repeat(lever.z));
    (*first * x + (*second * y + (*third * z + step))).magnitudes() * T::Four::repeat(own.weighted_bias)
}
