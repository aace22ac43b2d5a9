//! Nominal biases: the largest effect they can have together, exactly where it counts and by a bound elsewhere.

use nalgebra::{Matrix3, Vector3};

use super::super::Prior;
use super::super::modes::ROWS;
use super::Solutions;
use super::elimination::{Pair, Point};
use super::kernel::{GROUPS, group_of};
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
        let rows = self.view.rows.iter().zip(self.view.fits).zip(&self.own);
        rows.fold(T::zero(), |sum, ((row, fit), own)| {
            let shared = if group_of(row) == group { level } else { T::zero() };
            sum + own.weighted_bias * (shared + design.dot(&fit.gain)).abs()
        })
    }

    /// Bias of the solution with all satellites.
    pub(in crate::integrity::separation) fn whole_bias(&self) -> Vector3<T> {
        self.summed_bias(
            0,
            &[],
            &Matrix3::identity(),
            &[Vector3::zeros(); GROUPS],
            self.view.covariance,
            true,
        )
    }
    /// The bias without one row.
    pub(super) fn bias_without(&self, index: usize, column: &Vector3<T>, point: &Point<T>) -> Vector3<T> {
        let mut steps = [Vector3::zeros(); GROUPS];
        if let Some(step) = steps.get_mut(point.group) {
            *step = column * self.level(point.group);
        }
        let turn = Matrix3::identity() + column * point.design.transpose();
        self.summed_bias(0, &[index], &turn, &steps, self.view.covariance, true)
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
            pair = Pair { column: kept.column, factor: kept.factor, spread: kept.point.spread };
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
        let is_whole = self.at.constellations == 0;
        let rows = [first, second, third];
        self.summed_bias(self.at.constellations, &rows, &turn, &steps, &self.kernel.covariance, is_whole)
    }

    /// `Σ w_i b_i |Z P'd_i + s_c|` over what is left.
    fn summed_bias(
        &self,
        constellations: u8,
        out: &[usize],
        turn: &Matrix3<T>,
        steps: &[Vector3<T>; GROUPS],
        covariance: &Matrix3<T>,
        is_whole: bool,
    ) -> Vector3<T> {
        let turned = turn * covariance;
        let rows = self.view.rows.iter().zip(self.view.fits).zip(&self.own).enumerate();
        let mut sum = Vector3::zeros();
        for (index, ((row, fit), own)) in rows {
            let group = group_of(row);
            let is_lost = group < Constellation::COUNT && constellations >> group & 1 != 0;
            if is_lost || out.contains(&index) {
                continue;
            }
            let step = steps.get(group).copied().unwrap_or_else(Vector3::zeros);
            let gain = if is_whole { turn * fit.gain } else { turned * fit.centred };
            sum += (gain + step).abs() * own.weighted_bias;
        }
        sum
    }
}
