//! Means over the rows of each clock. Centring subtracts them, which eliminates the clocks.

use nalgebra::{Matrix3, Vector3};

use super::equations::Row;
use crate::numeric::four::Four;
use crate::numeric::real::Real;
use crate::numeric::space::{dot, symmetric_product, trace};
use crate::satellite::Constellation;

/// Weighted means of the rows that depend on one clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ClockMeans<T: Real> {
    pub(super) count: usize,
    weight: T,
    /// `1/W_c`.
    pub(super) variance: T,
    /// Mean design row and mean residual.
    means: [T; 4],
}

/// Returns four zeros.
#[inline]
fn nothing<T: Real>() -> [T; 4] {
    T::Four::repeat(T::zero()).numbers()
}

/// Joins the design row of an equation and its residual.
#[inline]
fn numbers<T: Real>(row: &Row<T>) -> T::Four {
    T::Four::join([row.design.x, row.design.y, row.design.z, row.residual])
}

impl<T: Real> ClockMeans<T> {
    fn empty() -> Self {
        Self { count: 0, weight: T::zero(), variance: T::zero(), means: nothing() }
    }

    /// Returns the mean design row.
    pub(super) fn design(&self) -> Vector3<T> {
        let [x, y, z, _] = self.means;
        Vector3::new(x, y, z)
    }

    /// Returns the mean residual, m.
    pub(super) fn residual(&self) -> T {
        let [.., residual] = self.means;
        residual
    }

    /// Returns the design row and the residual of a row minus their means, joined.
    #[allow(clippy::inline_always, reason = "shorter in its place than a call is")]
    #[inline(always)]
    pub(super) fn centred(&self, row: &Row<T>) -> T::Four {
        numbers(row) - T::Four::join(self.means)
    }

    #[inline]
    fn add(&mut self, row: &Row<T>, weight: T) {
        self.count += 1;
        self.weight += weight;
        self.means = (T::Four::join(self.means) + numbers(row) * T::Four::repeat(weight)).numbers();
    }

    /// Converts sums to means.
    fn centre(&mut self) {
        if self.count > 0 {
            self.variance = self.weight.recip();
            self.means = self.means.map(|sum| self.variance * sum);
        }
    }

    /// Removes a row from the means.
    fn leave_out(&mut self, row: &Row<T>) {
        self.count = self.count.saturating_sub(1);
        self.weight -= row.weight;
        if row.clock.is_some() {
            self.variance = self.weight.recip();
            let share = row.weight * self.variance;
            self.means = (T::Four::join(self.means) - self.centred(row) * T::Four::repeat(share)).numbers();
        }
    }
}

/// Index of the rows that depend on no clock, after the constellations.
const CLOCKLESS: usize = Constellation::COUNT;

/// Returns the index of a row's clock.
fn place<T>(row: &Row<T>) -> usize {
    row.clock.map_or(CLOCKLESS, |clock| clock as usize)
}

/// Means of all constellations, and the count of rows without a clock. The means of the latter are
/// 0, so that these rows are not centred.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeansByClock<T: Real>([ClockMeans<T>; CLOCKLESS + 1]);

impl<T: Real> MeansByClock<T> {
    pub(super) fn empty() -> Self {
        Self([ClockMeans::empty(); CLOCKLESS + 1])
    }

    /// Returns the means of the rows that have a weight.
    pub(super) fn of<'r>(rows: impl Iterator<Item = &'r Row<T>>, weight: impl Fn(&Row<T>) -> T) -> Self {
        let mut groups = Self::empty();
        groups.fill(rows, weight);
        groups
    }

    /// Computes the means in place.
    #[inline]
    pub(super) fn fill<'r>(&mut self, rows: impl Iterator<Item = &'r Row<T>>, weight: impl Fn(&Row<T>) -> T) {
        *self = Self::empty();
        // The rows of a constellation are mostly adjacent, so that their sums stay in registers.
        let (mut here, mut sums) = (CLOCKLESS, ClockMeans::empty());
        for (row, weight) in rows.map(|row| (row, weight(row))).filter(|&(_, weight)| weight > T::zero()) {
            let place = place(row);
            if place != here {
                self.set(here, &sums);
                (here, sums) = (place, self.get(place));
            }
            sums.add(row, weight);
        }
        self.set(here, &sums);
        let [of_clocks @ .., clockless] = &mut self.0;
        of_clocks.iter_mut().for_each(ClockMeans::centre);
        clockless.means = nothing();
    }

    /// Returns the means at an index.
    #[inline]
    fn get(&self, place: usize) -> ClockMeans<T> {
        self.0.get(place).copied().unwrap_or_else(ClockMeans::empty)
    }

    #[inline]
    fn set(&mut self, place: usize, group: &ClockMeans<T>) {
        if let Some(slot) = self.0.get_mut(place) {
            *slot = *group;
        }
    }

    /// Removes a row that is not the only one of its clock.
    pub(super) fn leave_out(&mut self, row: &Row<T>) {
        if let Some(group) = self.0.get_mut(place(row)) {
            group.leave_out(row);
        }
    }

    /// Returns the means of a row's clock; 0 for a clock without rows.
    pub(super) fn of_row(&self, row: &Row<T>) -> ClockMeans<T> {
        self.get(place(row))
    }

    /// Returns a constellation's means if one of its rows takes part.
    pub(super) fn of_clock(&self, clock: Constellation) -> Option<&ClockMeans<T>> {
        self.0.get(clock as usize).filter(|group| group.count > 0)
    }

    /// Returns an accessor to the means of each requested row's clock; 0 for a clock without rows.
    pub(super) fn of_rows(&self) -> MeansOfRow<'_, T> {
        MeansOfRow { groups: self, place: CLOCKLESS, group: self.get(CLOCKLESS) }
    }

    pub(super) fn of_clocks(&self) -> impl Iterator<Item = &ClockMeans<T>> {
        self.0.iter().take(CLOCKLESS).filter(|group| group.count > 0)
    }

    /// Returns the number of rows that take part.
    pub(super) fn used(&self) -> usize {
        self.0.iter().map(|group| group.count).sum()
    }

    /// Returns an upper bound on the trace of `(HᵀH)⁻¹`, clocks included. It needs no unweighted
    /// geometry.
    ///
    /// No weight exceeds the sum of all weights, so that the trace is at most this sum times the
    /// trace of the weighted covariance. In the latter, each clock's `h̄_c P h̄_cᵀ` is at most the
    /// trace of `P`, because a mean of unit vectors is no longer than 1.
    pub(super) fn largest_trace(&self, covariance: &Matrix3<T>) -> T {
        let sum = |of: fn(&ClockMeans<T>) -> T| self.0.iter().fold(T::zero(), |sum, group| sum + of(group));
        let positions = T::narrow((Constellation::COUNT + 1) as f64) * trace(covariance);
        sum(|group| group.weight) * (sum(|group| group.variance) + positions)
    }

    /// Returns the trace of the covariance of all unknowns, clocks included.
    pub(super) fn trace(&self, covariance: &Matrix3<T>) -> T {
        let clocks = self.of_clocks().map(|group| {
            group.variance + dot(&group.design(), &symmetric_product(covariance, &group.design()))
        });
        clocks.fold(trace(covariance), |sum, term| sum + term)
    }
}

/// Means of the current row's clock. The rows of a constellation are mostly adjacent, so that the
/// means stay in registers.
pub(super) struct MeansOfRow<'g, T: Real> {
    groups: &'g MeansByClock<T>,
    place: usize,
    group: ClockMeans<T>,
}

impl<T: Real> MeansOfRow<'_, T> {
    #[inline]
    pub(super) fn of(&mut self, row: &Row<T>) -> &ClockMeans<T> {
        let place = place(row);
        if place != self.place {
            (self.place, self.group) = (place, self.groups.get(place));
        }
        &self.group
    }
}
