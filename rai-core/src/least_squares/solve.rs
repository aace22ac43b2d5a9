//! One 3×3 solve over any rows; the equations are in the documentation of [`super`].
//!
//! A solve needs no memory except for its result. A search may therefore solve for a subset of the
//! rows, or for all but one, without copying them.

use nalgebra::{Matrix3, Vector3};

use super::means::{ClockMeans, MeansByClock};
use super::{RowFit, SnapshotError, Statistics};
use crate::bit_set::members;
use crate::least_squares::equations::Row;
use crate::numeric::four::Four;
use crate::numeric::real::Real;
use crate::numeric::space::{
    add_whole_outer_product, combination, difference, dot, scaled, symmetric_product, zero, zeros,
};
use crate::satellite::Constellation;

/// Squared w-test above which a row is removed by solving again. Below it the `f32` downdate is
/// accurate to 1e-4 sigma.
const GROSS: f64 = 1e6;

/// Least-squares estimate: everything of a snapshot except the fits of its rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Estimate<T: Real> {
    pub(super) groups: MeansByClock<T>,
    pub(super) covariance: Matrix3<T>,
    pub(super) correction: Vector3<T>,
    /// Bound on the trace of `(HᵀH)⁻¹`, clocks included, dimensionless.
    largest_trace: T,
    pub(super) used: usize,
    pub(super) dof: usize,
}

impl<T: Real> Estimate<T> {
    /// Returns an estimate without rows.
    pub(crate) fn none() -> Self {
        Self {
            groups: MeansByClock::empty(),
            covariance: zeros(),
            correction: zero(),
            largest_trace: T::zero(),
            used: 0,
            dof: 0,
        }
    }

    /// Solves for the rows that take part, in place. On error the contents are unspecified.
    ///
    /// # Errors
    /// As [`super::Workspace::solve`].
    pub(crate) fn solve<'r>(
        &mut self,
        rows: impl Iterator<Item = &'r Row<T>> + Clone,
    ) -> Result<(), SnapshotError> {
        self.groups.fill(rows.clone(), |row| row.weight);
        let groups = &self.groups;
        self.used = groups.used();
        self.dof =
            self.used.checked_sub(3 + groups.of_clocks().count()).ok_or(SnapshotError::Insufficient)?;
        let equations = NormalEquations::of(rows.clone(), groups, |row| row.weight);
        self.covariance = invert(&equations.normal)?;
        self.correction = symmetric_product(&self.covariance, &equations.right_hand_side);
        self.largest_trace = groups.largest_trace(&self.covariance);
        if self.largest_trace < T::SINGULAR || is_determined(rows) {
            Ok(())
        } else {
            Err(SnapshotError::Singular)
        }
    }

    /// Solves for a set of the rows, like [`Self::solve`].
    ///
    /// # Errors
    /// As [`super::Workspace::solve`].
    pub(crate) fn solve_set(&mut self, rows: &[Row<T>], set: u64) -> Result<(), SnapshotError> {
        self.solve(members(set).filter_map(|index| rows.get(index)))
    }

    /// Leaves a row out by a downdate with its fit ([`super::downdate`]):
    ///
    /// ```text
    /// P' = P + w/r g gᵀ   x' = x − w v/r g   W' = W − w   h̄' = h̄ − w/W' d   ȳ' = ȳ − w/W' (y − ȳ)
    /// ```
    ///
    /// Because `w d·g ≤ 1 − r` and `w/W ≤ 1 − r`, no variance grows by more than the factor `1/r`.
    ///
    /// Returns false without a change if this would lose precision: for a row that is hardly tested
    /// or takes no part, for a gross fault, and for a geometry that may be nearly singular.
    pub(super) fn leave_out(&mut self, row: &Row<T>, fit: &RowFit<T>) -> bool {
        let keeps_digits =
            fit.test_weight > T::zero() && !fit.is_hardly_tested() && fit.w_squared() < T::narrow(GROSS);
        let largest_trace = self.largest_trace / fit.redundancy;
        let Some(dof) = self.dof.checked_sub(1).filter(|_| keeps_digits && largest_trace < T::SINGULAR)
        else {
            return false;
        };
        self.groups.leave_out(row);
        add_whole_outer_product(&mut self.covariance, &fit.gain, &scaled(fit.test_weight, &fit.gain));
        self.correction = difference(&self.correction, &scaled(fit.test_weight * fit.residual, &fit.gain));
        self.largest_trace = largest_trace;
        (self.used, self.dof) = (self.used.saturating_sub(1), dof);
        true
    }

    /// Returns the covariance of the correction, m².
    pub(crate) fn covariance(&self) -> &Matrix3<T> {
        &self.covariance
    }

    /// Returns the number of rows that take part.
    pub(crate) fn used(&self) -> usize {
        self.used
    }

    /// Returns the degrees of freedom.
    pub(crate) fn dof(&self) -> usize {
        self.dof
    }

    /// Returns true if a row of a constellation takes part, so that its clock is determined.
    pub(crate) fn determines(&self, clock: Constellation) -> bool {
        self.groups.of_clock(clock).is_some()
    }

    /// Returns the variance `1/W_c`, m², that the clock of a row would have if the position were
    /// known; 0 if no row determines it.
    pub(crate) fn level_variance(&self, row: &Row<T>) -> T {
        self.groups.of_row(row).variance
    }

    /// Returns the fit of a row, which may be left out.
    pub(crate) fn fit(&self, row: &Row<T>) -> RowFit<T> {
        let group = self.groups.of_row(row);
        let mut fit = Solution::new(&self.covariance, &self.correction).compare(row, &group);
        fit.weigh(row, &group);
        fit
    }

    /// Writes the fit of each row, in their order. Returns the statistics of all rows.
    pub(super) fn fit_all(&self, rows: &[Row<T>], fits: &mut [RowFit<T>]) -> Statistics<T> {
        // Copies, which the compiler keeps in registers while the fits are written.
        let solution = Solution::new(&self.covariance, &self.correction);
        let (mut groups, mut statistics) = (self.groups.of_rows(), Statistics::none());
        for (index, (row, slot)) in rows.iter().zip(fits).enumerate() {
            let group = groups.of(row);
            let mut fit = solution.compare(row, group);
            if !fit.weigh(row, group) {
                statistics.all_are_tested = false;
            }
            statistics.add(index, row, &fit);
            *slot = fit;
        }
        statistics
    }
}

/// Covariance and correction, with which rows are compared: the columns of the one, each with the
/// component of the other.
#[derive(Clone, Copy)]
struct Solution<T: Real>([T::Four; 3]);

impl<T: Real> Solution<T> {
    fn new(covariance: &Matrix3<T>, correction: &Vector3<T>) -> Self {
        let (p, x) = (covariance, correction);
        Self([
            T::Four::join([p.m11, p.m21, p.m31, x.x]),
            T::Four::join([p.m21, p.m22, p.m32, x.y]),
            T::Four::join([p.m31, p.m32, p.m33, x.z]),
        ])
    }

    /// Compares a row with the solution. The redundancy is the raw difference `1 − w (…)`, and
    /// `test_weight` is 0 until [`RowFit::weigh`].
    #[inline]
    fn compare(&self, row: &Row<T>, group: &ClockMeans<T>) -> RowFit<T> {
        let [x, y, z, residual] = group.centred(row).numbers();
        let centred = Vector3::new(x, y, z);
        let [east, north, up, moved] = combination(&self.0, &centred).numbers();
        let gain = Vector3::new(east, north, up);
        RowFit {
            centred,
            gain,
            // The correction moves the row by `d·x`.
            residual: residual - moved,
            redundancy: T::one() - row.weight * (group.variance + dot(&centred, &gain)),
            test_weight: T::zero(),
        }
    }
}

impl<T: Real> RowFit<T> {
    /// Sets the weight of the row's test. Returns false for a row that is hardly tested.
    #[inline]
    fn weigh(&mut self, row: &Row<T>, group: &ClockMeans<T>) -> bool {
        // One comparison suffices for nearly all rows.
        let is_tested = !self.is_hardly_tested();
        if is_tested {
            self.test_weight = row.weight / self.redundancy;
        } else {
            self.weigh_with_care(row, group);
        }
        is_tested
    }

    fn weigh_with_care(&mut self, row: &Row<T>, group: &ClockMeans<T>) {
        // A lone satellite determines its clock, so that its redundancy is exactly 0.
        let is_lone = row.clock.is_some() && group.count == 1 && row.weight > T::zero();
        // NaN counts as zero redundancy too.
        if is_lone || !(self.redundancy > T::zero()) {
            self.redundancy = T::zero();
        }
        if self.redundancy >= T::UNTESTABLE {
            self.test_weight = row.weight / self.redundancy;
        }
    }
}

/// The geometry of the rows that take part, all with the same weight.
pub(super) struct Geometry<T: Real> {
    groups: MeansByClock<T>,
    pub(super) covariance: Matrix3<T>,
}

impl<T: Real> Geometry<T> {
    pub(super) fn of<'r>(rows: impl Iterator<Item = &'r Row<T>> + Clone) -> Result<Self, SnapshotError> {
        let equal = |row: &Row<T>| if row.weight > T::zero() { T::one() } else { T::zero() };
        let groups = MeansByClock::of(rows.clone(), equal);
        let equations = NormalEquations::of(rows, &groups, equal);
        Ok(Self { groups, covariance: invert(&equations.normal)? })
    }

    pub(super) fn hdop_without(&self, row: &Row<T>) -> T {
        let group = self.groups.of_row(row);
        let centred = difference(&row.design, &group.design());
        let gain = symmetric_product(&self.covariance, &centred);
        let redundancy = T::one() - group.variance - dot(&centred, &gain);
        let moved = gain.x * gain.x + gain.y * gain.y;
        let increase = if redundancy > T::UNTESTABLE {
            moved / redundancy
        } else if dot(&gain, &gain) > T::UNMOVED * T::UNMOVED {
            // Without this row the position is undetermined; HDOP is then infinite, whichever
            // coordinate is affected.
            infinity()
        } else {
            T::zero()
        };
        (self.covariance.m11 + self.covariance.m22 + increase).sqrt_approx()
    }
}

/// Returns infinity.
pub(crate) fn infinity<T: Real>() -> T {
    T::narrow(f64::INFINITY)
}

/// The normal equations of the rows that take part.
struct NormalEquations<T: Real> {
    normal: Matrix3<T>,
    right_hand_side: Vector3<T>,
}

impl<T: Real> NormalEquations<T> {
    #[inline]
    fn of<'r>(
        rows: impl Iterator<Item = &'r Row<T>>,
        groups: &MeansByClock<T>,
        weight: impl Fn(&Row<T>) -> T,
    ) -> Self {
        let zero = T::Four::repeat(T::zero());
        let [mut first, mut second, mut third, mut right_hand_side] = [zero; 4];
        let mut groups = groups.of_rows();
        // No branch is needed, because a row without weight adds zeros.
        for row in rows {
            let group = groups.of(row);
            let centred = group.centred(row);
            let weighted = centred * T::Four::repeat(weight(row));
            let [x, y, z, residual] = centred.numbers();
            first = first + weighted * T::Four::repeat(x);
            second = second + weighted * T::Four::repeat(y);
            third = third + weighted * T::Four::repeat(z);
            right_hand_side = right_hand_side + weighted * T::Four::repeat(residual);
        }
        let ([m11, m21, m31, _], [_, m22, m32, _]) = (first.numbers(), second.numbers());
        let ([_, _, m33, _], [x, y, z, _]) = (third.numbers(), right_hand_side.numbers());
        Self {
            normal: Matrix3::new(m11, m21, m31, m21, m22, m32, m31, m32, m33),
            right_hand_side: Vector3::new(x, y, z),
        }
    }
}

/// Returns true if the trace of `(HᵀH)⁻¹`, clocks included, is below [`Real::SINGULAR`].
fn is_determined<'r, T: Real>(rows: impl Iterator<Item = &'r Row<T>> + Clone) -> bool {
    // A NaN sum fails this comparison.
    Geometry::of(rows).is_ok_and(|plain| plain.groups.trace(&plain.covariance) < T::SINGULAR)
}

/// Inverts a symmetric matrix by `L D Lᵀ`, `P = L⁻ᵀ D⁻¹ L⁻¹`, without a root. The matrix counts as
/// singular if a pivot is not positive.
///
/// Reads the lower triangle.
pub(crate) fn invert<T: Real>(normal: &Matrix3<T>) -> Result<Matrix3<T>, SnapshotError> {
    // A NaN pivot also returns `Singular`.
    let pivot = |value: T| if value > T::zero() { Ok(value.recip()) } else { Err(SnapshotError::Singular) };
    let d1 = pivot(normal.m11)?;
    let (l21, l31) = (normal.m21 * d1, normal.m31 * d1);
    let d2 = pivot(normal.m22 - l21 * normal.m21)?;
    let rest = normal.m32 - l31 * normal.m21;
    let l32 = rest * d2;
    let d3 = pivot(normal.m33 - l31 * normal.m31 - l32 * rest)?;
    // Third row of L⁻¹ below; its second row is (−l21, 1, 0).
    let (m31, m32) = (l21 * l32 - l31, -l32);
    let p21 = m31 * m32 * d3 - l21 * d2;
    let (p31, p32) = (m31 * d3, m32 * d3);
    let p11 = d1 + l21 * l21 * d2 + m31 * p31;
    let p22 = d2 + m32 * p32;
    Ok(Matrix3::new(p11, p21, p31, p21, p22, p32, p31, p32, d3))
}
