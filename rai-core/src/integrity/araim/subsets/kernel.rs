//! Sums over each constellation, and the solution without some of them. Rows are then left out of
//! this solution.

use nalgebra::{Matrix3, Vector3};

use super::SubsetSolution;
use crate::least_squares::equations::Row;
use crate::numeric::real::Real;
use crate::numeric::space::{
    columns, diagonal, dot, matrix_product, plus_scaled, product, products, sum, zero, zeros,
};
use crate::satellite::Constellation;

/// Number of constellations, and one more group for rows that depend on no clock.
pub(in crate::integrity::araim) const GROUPS: usize = Constellation::COUNT + 1;
/// Sums over one constellation.
#[derive(Clone, Copy, Debug)]
pub(super) struct ConstellationSums<T: Real> {
    /// `1/W_c`.
    pub(super) level: T,
    /// `U_c/W_c²`.
    pub(super) accuracy: T,
    /// `τ_c/W_c`.
    pub(super) lean: Vector3<T>,
    pub(super) normal: Matrix3<T>,
    pub(super) dispersion: Matrix3<T>,
    /// `Σ w d v`.
    pub(super) pull: Vector3<T>,
}

impl<T: Real> ConstellationSums<T> {
    pub(super) fn empty() -> Self {
        Self {
            level: T::zero(),
            accuracy: T::zero(),
            lean: zero(),
            normal: zeros(),
            dispersion: zeros(),
            pull: zero(),
        }
    }
}

/// Solution without some constellations, from which rows are left out.
#[derive(Clone, Debug)]
pub(super) struct Kernel<T: Real> {
    pub(super) covariance: Matrix3<T>,
    /// `P' − P`.
    pub(super) change: Matrix3<T>,
    /// `D'`.
    pub(super) dispersion: Matrix3<T>,
    /// `Γ`.
    pub(super) gamma: Matrix3<T>,
    /// `t_c`.
    pub(super) leans: [Vector3<T>; GROUPS],
    /// True if `Γ` and `t_c` are computed.
    pub(super) is_complete: bool,
    pub(super) solution: SubsetSolution<T>,
}

/// Returns the least remainder of 1 with which elimination is used. Below it, single precision
/// retains less than five digits. In double precision it is 1e-9.
pub(super) fn hardly_left<T: Real>() -> T {
    let digits = T::default_epsilon() * T::narrow(2e5);
    if digits > T::UNTESTABLE { digits } else { T::UNTESTABLE }
}

/// Returns the diagonal of `A M Aᵀ` for a symmetric `M`.
#[inline(never)]
pub(super) fn diagonal_of<T: Real>(a: &Matrix3<T>, m: &Matrix3<T>) -> Vector3<T> {
    let ([p1, p2, p3], [a1, a2, a3]) = (columns(&matrix_product(a, m)), columns(a));
    sum(&sum(&products(&p1, &a1), &products(&p2, &a2)), &products(&p3, &a3))
}

pub(in crate::integrity::araim) fn group_of<T: Real>(row: &Row<T>) -> usize {
    row.clock.map_or(Constellation::COUNT, |clock| clock as usize)
}
impl<T: Real> Kernel<T> {
    /// Returns the kernel before its first use.
    pub(super) fn nothing() -> Self {
        let nothing = zero();
        Self {
            covariance: zeros(),
            change: zeros(),
            dispersion: zeros(),
            gamma: zeros(),
            leans: [nothing; GROUPS],
            is_complete: false,
            solution: SubsetSolution { variance: nothing, separation: nothing, shift: nothing },
        }
    }

    /// Resets the kernel to all satellites.
    pub(super) fn regain_all(&mut self, covariance: &Matrix3<T>, dispersion: &Matrix3<T>) {
        (self.covariance, self.dispersion) = (*covariance, *dispersion);
        self.change = zeros();
        self.is_complete = false;
        self.solution.variance = diagonal(covariance);
        self.solution.separation = zero();
        self.solution.shift = zero();
    }

    /// Computes `Γ` and `t_c` from the covariance and the dispersion, for rows that are left out.
    #[inline(never)]
    pub(super) fn complete(&mut self, groups: &[ConstellationSums<T>; GROUPS]) {
        if self.is_complete {
            return;
        }
        self.is_complete = true;
        self.gamma = matrix_product(&matrix_product(&self.covariance, &self.dispersion), &self.covariance);
        for (lean, group) in self.leans.iter_mut().zip(groups) {
            *lean = product(&self.covariance, &group.lean);
        }
    }

    /// Returns `κ_jj` for a given `b_jj`.
    pub(super) fn kappa(
        &self,
        groups: &[ConstellationSums<T>; GROUPS],
        group: usize,
        design: &Vector3<T>,
        coupling: T,
        weight: T,
        share: T,
    ) -> T {
        let Some((sums, lean)) = groups.get(group).zip(self.leans.get(group)) else { return T::zero() };
        let two = T::one() + T::one();
        let own = if weight > T::zero() { weight.recip() } else { T::zero() };
        share * (own - two * coupling)
            + sums.accuracy
            + dot(design, &plus_scaled(&product(&self.gamma, design), two, lean))
    }
}
