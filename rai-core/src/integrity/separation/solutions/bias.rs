//! Nominal biases: the largest effect they can have together, exactly where it counts and by a bound elsewhere.

use nalgebra::{Matrix3, Vector3};

use super::super::Prior;
use super::super::modes::ROWS;
use super::elimination::Point;
use super::kernel::{GROUPS, group_of};
use super::{Own, Solutions};
use crate::numeric::real::Real;
use crate::satellite::Constellation;

impl<T: Real> Solutions<'_, T> {
    /// Each row's `Σ |M_ji| b_i`.
    pub(super) fn spread_biases(&mut self, priors: &[Prior<T>]) {
        for index in 0..self.own.len().min(priors.len()) {
            let Some(point) = self.point(index) else { continue };
            let mut spread = self.coupled_bias(&point.design, point.group);
            // Its own share of itself is 1 less than the others'.
            let own = point.weight * (self.level(point.group) + point.design.dot(&point.gain));
            let bias = priors.get(index).map_or(T::zero(), |prior| prior.bias_m);
            spread += ((T::one() - own).abs() - own.abs()) * bias;
            if let Some(own) = self.own.get_mut(index) {
                own.spread = spread;
            }
        }
    }

    /// `Σ w_i b_i |b_ji|` over all rows.
    fn coupled_bias(&self, design: &Vector3<T>, group: usize) -> T {
        let level = self.level(group);
        let rows = self.view.rows.iter().zip(self.view.fits).zip(&*self.own);
        rows.fold(T::zero(), |sum, ((row, fit), own)| {
            let shared = if group_of(row) == group { level } else { T::zero() };
            sum + own.weighted_bias * (shared + design.dot(&fit.gain)).abs()
        })
    }

    /// Bias of the solution with all satellites.
    pub(in crate::integrity::separation) fn whole_bias(&self) -> Vector3<T> {
        self.summed_bias(&NOTHING, &Matrix3::identity(), &[Vector3::zeros(); GROUPS])
    }

    /// The bias without one row, all constellations in view.
    pub(super) fn bias_without(&self, index: usize, column: &Vector3<T>, point: &Point<T>) -> Vector3<T> {
        let mut steps = [Vector3::zeros(); GROUPS];
        if let Some(step) = steps.get_mut(point.group) {
            *step = column * self.level(point.group);
        }
        let turn = Matrix3::identity() + column * point.design.transpose();
        self.summed_bias(&[index, NONE, NONE], &turn, &steps)
    }

    /// A bound on the bias of the mode that was asked for last, where one is cheap: for rows of all constellations.
    #[inline]
    pub(in crate::integrity::separation) fn bias_bound(&self) -> Option<Vector3<T>> {
        if let Some((_, bias)) = &self.direct {
            return Some(*bias);
        }
        let [_, second, third] = self.at.slots();
        let first = self.first.as_ref().filter(|_| self.at.constellations == 0 && third >= ROWS)?;
        if second >= ROWS {
            return Some(first.bias);
        }
        let spread = self.pair.spread + self.pair.factor.abs() * first.point.spread;
        Some(first.bias + self.pair.column.abs() * spread)
    }

    /// The bias of the mode that was asked for last.
    #[inline(never)]
    pub(in crate::integrity::separation) fn bias(&self) -> Vector3<T> {
        if let Some((_, bias)) = &self.direct {
            return *bias;
        }
        let (mut turn, mut steps) = (Matrix3::identity(), [Vector3::zeros(); GROUPS]);
        let [first, second, third] = self.at.slots();
        let mut take = |column: &Vector3<T>, design: &Vector3<T>, group: usize| {
            turn += column * design.transpose();
            if let Some((step, group)) = steps.get_mut(group).zip(self.groups.get(group)) {
                *step += column * group.level;
            }
        };
        // Columns of A B⁻¹ from those of the elimination, the last row first.
        let mut columns = [Vector3::zeros(); 3];
        let [of_first, of_second, of_third] = &mut columns;
        let point = |index: usize| self.point_here(index).map(|point| (point.design, point.group));
        let mut pair = self.pair;
        if let Some((taken, kept)) = self.third.as_ref().zip(self.second.as_ref()).filter(|_| third < ROWS) {
            let [by_first, by_second] = taken.factors;
            *of_third = taken.column;
            *of_second -= taken.column * by_second;
            *of_first -= taken.column * by_first;
            take(of_third, &taken.design, taken.group);
            pair = kept.pair();
        }
        if let Some((design, group)) = point(second) {
            *of_second += pair.column;
            *of_first -= *of_second * pair.factor;
            take(of_second, &design, group);
        }
        if let Some(taken) = self.first.as_ref().filter(|_| first < ROWS) {
            *of_first += taken.column;
            take(of_first, &taken.point.design, taken.point.group);
        }
        let rows = [first, second, third];
        if self.at.constellations == 0 {
            self.summed_bias(&rows, &turn, &steps)
        } else {
            self.summed_bias_beyond(&rows, &turn, &steps)
        }
    }

    /// `Σ w_i b_i |Z P d_i + s_c|` over all rows but three, all constellations in view.
    #[inline(never)]
    fn summed_bias(&self, out: &[usize; 3], turn: &Matrix3<T>, steps: &[Vector3<T>; GROUPS]) -> Vector3<T> {
        let mut sum = Vector3::zeros();
        for (index, (row, fit, own)) in self.rows().enumerate() {
            if !is_out(out, index) {
                sum += share(turn, &fit.gain, steps.get(group_of(row)), own);
            }
        }
        sum
    }

    /// `Σ w_i b_i |Z P'd_i + s_c|` over what is left, without the constellations that the kernel has lost.
    #[inline(never)]
    fn summed_bias_beyond(
        &self,
        out: &[usize; 3],
        turn: &Matrix3<T>,
        steps: &[Vector3<T>; GROUPS],
    ) -> Vector3<T> {
        let (turned, constellations) = (turn * self.kernel.covariance, self.at.constellations);
        let mut sum = Vector3::zeros();
        for (index, (row, fit, own)) in self.rows().enumerate() {
            let group = group_of(row);
            let is_lost = group < Constellation::COUNT && constellations >> group & 1 != 0;
            if !is_lost && !is_out(out, index) {
                sum += share(&turned, &fit.centred, steps.get(group), own);
            }
        }
        sum
    }
}

/// In the place of a row where there is none.
const NONE: usize = usize::MAX;
/// No rows.
const NOTHING: [usize; 3] = [NONE; 3];

#[inline]
fn is_out(&[first, second, third]: &[usize; 3], index: usize) -> bool {
    index == first || index == second || index == third
}

/// What one row's bias can do.
#[inline]
fn share<T: Real>(
    turn: &Matrix3<T>,
    lever: &Vector3<T>,
    step: Option<&Vector3<T>>,
    own: &Own<T>,
) -> Vector3<T> {
    // Every group has its step.
    let Some(step) = step else { return Vector3::zeros() };
    let axis = |first: T, second: T, third: T, step: T| {
        (first * lever.x + (second * lever.y + (third * lever.z + step))).abs() * own.weighted_bias
    };
    Vector3::new(
        axis(turn.m11, turn.m12, turn.m13, step.x),
        axis(turn.m21, turn.m22, turn.m23, step.y),
        axis(turn.m31, turn.m32, turn.m33, step.z),
    )
}
