//! Elimination: leaves rows out of a kernel, one after another. The equations are in the
//! documentation of [`super`].

use nalgebra::Vector3;

use super::super::modes::Hypothesis;
use super::kernel::{GROUPS, group_of, hardly_left};
use super::{IntegrityRow, SubsetSolution, SubsetSolutions};
use crate::least_squares::RowFit;
use crate::least_squares::equations::Row;
use crate::numeric::real::Real;
use crate::numeric::space::{difference, divided, dot, plus_scaled, product, products, scaled, sum, zero};

/// A row in a kernel.
#[derive(Clone, Copy, Debug)]
pub(super) struct KernelRow<T: Real> {
    pub(super) group: usize,
    pub(super) design: Vector3<T>,
    pub(super) gain: Vector3<T>,
    pub(super) residual: T,
    pub(super) weight: T,
    pub(super) share: T,
    pub(super) pivot: T,
    pub(super) kappa: T,
    /// Covariance of `S_X − S` with `M_j`.
    pub(super) lag: Vector3<T>,
    pub(super) spread: T,
}

impl<T: Real> KernelRow<T> {
    /// Returns a row of the view in the kernel of all satellites.
    #[inline]
    pub(super) fn of(row: &Row<T>, fit: &RowFit<T>, own: &IntegrityRow<T>) -> Self {
        Self {
            group: group_of(row),
            design: fit.centred,
            gain: fit.gain,
            residual: fit.residual,
            weight: row.weight,
            share: own.share,
            pivot: own.pivot,
            kappa: own.kappa,
            lag: zero(),
            spread: own.spread,
        }
    }
}

/// Terms of one row from which its `b` and `κ` with any other row follow.
#[derive(Clone, Copy, Debug)]
struct RowCoupling<T: Real> {
    design: Vector3<T>,
    share: T,
    /// `Γd + t_c`.
    towards: Vector3<T>,
    /// Terms that depend only on the other row's group: `[c_j = c_k]/W_c`, and
    /// `d·t_c + [c_j = c_k] U_c/W_c²`.
    groups: [[T; 2]; GROUPS],
}

impl<T: Real> RowCoupling<T> {
    /// Returns `b_jk` and `κ_jk`.
    #[inline]
    fn with(&self, other: &KernelRow<T>) -> (T, T) {
        let [level, accuracy] = self.groups.get(other.group).copied().unwrap_or([T::zero(); 2]);
        let coupling = dot(&self.design, &other.gain) + level;
        (coupling, dot(&other.design, &self.towards) + accuracy - (self.share + other.share) * coupling)
    }
}

/// First row that is left out, and the solution without it.
#[derive(Clone, Copy, Debug)]
pub(super) struct FirstRow<T: Real> {
    pub(super) point: KernelRow<T>,
    reach: RowCoupling<T>,
    pub(super) inverse: T,
    /// `A/B`.
    pub(super) column: Vector3<T>,
    /// Bias without this row alone, m; 0 without biases.
    pub(super) bias: Vector3<T>,
    pub(super) solution: SubsetSolution<T>,
}

/// Second row that is left out, and the solution without both.
#[derive(Clone, Copy, Debug)]
pub(super) struct SecondRow<T: Real> {
    point: KernelRow<T>,
    reach: RowCoupling<T>,
    left: RowBesideFirst<T>,
    pub(super) solution: SubsetSolution<T>,
}

impl<T: Real> SecondRow<T> {
    pub(super) fn last(&self) -> LastRow<T> {
        LastRow { column: self.left.column, factor: self.left.factor, spread: self.point.spread }
    }
}

/// Remainder of a row without the first.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowBesideFirst<T: Real> {
    coupling: T,
    pub(super) factor: T,
    pub(super) pivot: T,
    inverse: T,
    direction: Vector3<T>,
    pub(super) column: Vector3<T>,
    pub(super) residual: T,
    lag: Vector3<T>,
    pub(super) kappa: T,
    pub(super) kappa_first: T,
}

impl<T: Real> RowBesideFirst<T> {
    #[inline]
    fn solution(&self, first: &FirstRow<T>) -> SubsetSolution<T> {
        let two = T::one() + T::one();
        let cross = scaled(two * self.kappa_first, &first.column);
        let cross = difference(&difference(&cross, &self.lag), &self.lag);
        let SubsetSolution { variance, separation, shift } = &first.solution;
        SubsetSolution {
            variance: sum(variance, &products(&self.direction, &self.column)),
            separation: sum(
                separation,
                &products(&self.column, &sum(&scaled(self.kappa, &self.column), &cross)),
            ),
            shift: difference(shift, &scaled(self.residual, &self.column)),
        }
    }
}

/// Values for the bias of the row that was left out last: a single row, or the second of a pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct LastRow<T: Real> {
    pub(super) column: Vector3<T>,
    pub(super) factor: T,
    pub(super) spread: T,
}

/// Values of the third row for the bias.
#[derive(Clone, Copy, Debug)]
pub(super) struct ThirdRow<T: Real> {
    pub(super) factors: [T; 2],
    pub(super) column: Vector3<T>,
    pub(super) design: Vector3<T>,
    pub(super) group: usize,
}

/// Test of a row: without it the position changes by its column times its residual.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowTest<T: Real> {
    column: Vector3<T>,
    residual: T,
    kappa: T,
}

impl<T: Real> RowTest<T> {
    /// Returns true if the change of the position exceeds its threshold on any axis.
    #[inline]
    pub(super) fn exceeds(&self, limits: &Vector3<T>) -> bool {
        let squared = self.residual * self.residual;
        let exceeds = |column: T, limit: T| {
            let moved = column * column;
            moved * squared > limit * (moved * self.kappa)
        };
        self.kappa > T::zero()
            && (exceeds(self.column.x, limits.x)
                || exceeds(self.column.y, limits.y)
                || exceeds(self.column.z, limits.z))
    }
}

impl<T: Real, const N: usize> SubsetSolutions<'_, T, N> {
    /// Returns the test of a row without the first row, if no constellation is lost.
    #[inline]
    pub(super) fn left_by_first(&self, index: usize) -> Option<RowTest<T>> {
        let (first, point) = (self.first.as_ref()?, self.point(index)?);
        let RowBesideFirst { column, residual, kappa, .. } = Self::beside(first, &point, zero())?;
        Some(RowTest { column, residual, kappa })
    }

    /// Returns the test of a row without the constellations that the kernel has lost.
    #[inline]
    pub(super) fn left_by_kernel(&self, index: usize) -> Option<RowTest<T>> {
        let point = self.point_here(index)?;
        let is_sound = point.pivot * point.weight >= hardly_left();
        is_sound.then_some(RowTest { column: point.gain, residual: point.residual, kappa: point.kappa })
    }

    /// Returns a row of the view in the kernel of all satellites, or `None` if there is no such
    /// row.
    #[inline]
    pub(super) fn point(&self, index: usize) -> Option<KernelRow<T>> {
        let (row, fit) = self.view.rows.get(index).zip(self.view.fits.get(index))?;
        let own = self.own.get(index)?;
        Some(KernelRow::of(row, fit, own))
    }

    /// Returns a row in the present kernel.
    #[inline]
    pub(super) fn point_here(&self, index: usize) -> Option<KernelRow<T>> {
        let point = self.point(index)?;
        if self.at.constellations == 0 { Some(point) } else { Some(self.point_beyond(point)) }
    }

    /// Returns a row without the constellations that the kernel has lost.
    #[inline(never)]
    pub(super) fn point_beyond(&self, mut point: KernelRow<T>) -> KernelRow<T> {
        let kernel = &self.kernel;
        point.gain = product(&kernel.covariance, &point.design);
        point.residual -= dot(&point.design, &kernel.solution.shift);
        let own = self.level(point.group) + dot(&point.design, &point.gain);
        point.pivot = point.weight.recip() - own;
        point.kappa = kernel.kappa(&self.groups, point.group, &point.design, own, point.weight, point.share);
        let lean = self.groups.get(point.group).map_or_else(zero, |group| group.lean);
        let behind = difference(&scaled(point.share, &point.design), &lean);
        let behind = difference(&behind, &product(&kernel.dispersion, &point.gain));
        point.lag = product(&kernel.change, &behind);
        point
    }

    #[inline]
    pub(super) fn leave_out_first(&self, index: usize) -> Option<FirstRow<T>> {
        let point = self.point_here(index)?;
        if !(point.pivot * point.weight >= hardly_left()) {
            return None;
        }
        let inverse = point.pivot.recip();
        let column = scaled(inverse, &point.gain);
        let solution = self.alone(&point, &column);
        let bias = if self.has_bias && self.at.constellations == 0 {
            self.bias_without(index, &column, &point)
        } else {
            zero()
        };
        Some(FirstRow { reach: self.reach(&point), inverse, column, bias, solution, point })
    }

    /// Returns the solution without a row of the present kernel.
    #[inline(never)]
    pub(super) fn leave_out_alone(&mut self, index: usize) -> Option<SubsetSolution<T>> {
        let point = self.point_here(index)?;
        if !(point.pivot * point.weight >= hardly_left()) {
            return None;
        }
        let column = scaled(point.pivot.recip(), &point.gain);
        if self.has_bias {
            self.last = LastRow { column, factor: T::zero(), spread: point.spread };
        }
        Some(self.alone(&point, &column))
    }

    /// Returns the solution without a row, by its column `A/B`.
    #[inline]
    fn alone(&self, point: &KernelRow<T>, column: &Vector3<T>) -> SubsetSolution<T> {
        let base = &self.kernel.solution;
        let across = difference(&difference(&scaled(point.kappa, column), &point.lag), &point.lag);
        SubsetSolution {
            variance: sum(&base.variance, &products(&point.gain, column)),
            separation: sum(&base.separation, &products(column, &across)),
            shift: difference(&base.shift, &scaled(point.residual, column)),
        }
    }

    fn reach(&self, point: &KernelRow<T>) -> RowCoupling<T> {
        let lean = self.kernel.leans.get(point.group).copied().unwrap_or_else(zero);
        let mut groups = [[T::zero(); 2]; GROUPS];
        for (id, (slot, lean)) in groups.iter_mut().zip(&self.kernel.leans).enumerate() {
            let own = self.groups.get(id).filter(|_| id == point.group);
            let [level, accuracy] = own.map_or([T::zero(); 2], |own| [own.level, own.accuracy]);
            *slot = [level, dot(&point.design, lean) + accuracy];
        }
        let towards = sum(&product(&self.kernel.gamma, &point.design), &lean);
        RowCoupling { design: point.design, share: point.share, towards, groups }
    }

    /// Returns the remainder of another row without the first.
    #[inline]
    pub(super) fn beside(
        first: &FirstRow<T>,
        point: &KernelRow<T>,
        lag: Vector3<T>,
    ) -> Option<RowBesideFirst<T>> {
        let (coupling, kappa) = first.reach.with(point);
        let factor = -coupling * first.inverse;
        let pivot = point.pivot + factor * coupling;
        if !(pivot * point.weight >= hardly_left()) {
            return None;
        }
        let inverse = pivot.recip();
        let kappa_first = kappa - factor * first.point.kappa;
        let direction = difference(&point.gain, &scaled(factor, &first.point.gain));
        Some(RowBesideFirst {
            coupling,
            factor,
            pivot,
            inverse,
            direction,
            column: scaled(inverse, &direction),
            residual: point.residual - factor * first.point.residual,
            lag,
            kappa: point.kappa - factor * (kappa + kappa_first),
            kappa_first,
        })
    }

    /// Returns the solution without a pair whose first row is already left out. No constellation is
    /// lost, so that the lag is 0.
    #[allow(clippy::inline_always, reason = "called in one place, once for every mode")]
    #[inline(always)]
    pub(super) fn leave_out_pair(&mut self, pair: Hypothesis) -> Option<SubsetSolution<T>> {
        let [_, second, _] = pair.slots();
        let (first, point) = (self.first.as_ref()?, self.point(second)?);
        let left = Self::beside(first, &point, zero())?;
        let solution = left.solution(first);
        if self.has_bias {
            self.last = LastRow { column: left.column, factor: left.factor, spread: point.spread };
        }
        Some(solution)
    }

    #[inline(never)]
    pub(super) fn leave_out_second(&self, index: usize) -> Option<SecondRow<T>> {
        let first = self.first.as_ref()?;
        let point = self.point_here(index)?;
        let (coupling, _) = first.reach.with(&point);
        let lag = plus_scaled(&point.lag, coupling * first.inverse, &first.point.lag);
        let left = Self::beside(first, &point, lag)?;
        let solution = left.solution(first);
        Some(SecondRow { reach: self.reach(&point), point, left, solution })
    }

    #[inline(never)]
    pub(super) fn leave_out_third(&mut self, index: usize) -> Option<SubsetSolution<T>> {
        self.third = None;
        let (first, second) = (self.first?, self.second?);
        let left = second.left;
        let point = self.point_here(index)?;
        let (to_first, kappa_first) = first.reach.with(&point);
        let (to_second, kappa_second) = second.reach.with(&point);
        // Coupling to the second row without the first.
        let rest = -to_second - left.coupling * to_first * first.inverse;
        let factors = [-to_first * first.inverse, rest * left.inverse];
        let [by_first, by_second] = factors;
        let pivot = point.pivot + by_first * to_first - by_second * rest;
        if !(pivot * point.weight >= hardly_left()) {
            return None;
        }
        let with_second = kappa_second - left.factor * kappa_first;
        let two = T::one() + T::one();
        let kappa =
            point.kappa + by_first * by_first * first.point.kappa + by_second * by_second * left.kappa
                - two
                    * (by_first * kappa_first + by_second * with_second
                        - by_first * by_second * left.kappa_first);
        let across_first = kappa_first - by_first * first.point.kappa - by_second * left.kappa_first;
        let across_second = with_second - by_first * left.kappa_first - by_second * left.kappa;
        let apart = |own: &Vector3<T>, of_first: &Vector3<T>, of_second: &Vector3<T>| {
            difference(&difference(own, &scaled(by_first, of_first)), &scaled(by_second, of_second))
        };
        let direction = apart(&point.gain, &first.point.gain, &left.direction);
        let residual = point.residual - by_first * first.point.residual - by_second * left.residual;
        let lag = apart(&point.lag, &first.point.lag, &left.lag);
        let column = divided(&direction, pivot);
        let cross = plus_scaled(&scaled(across_first, &first.column), across_second, &left.column);
        let cross = scaled(two, &difference(&cross, &lag));
        self.third = Some(ThirdRow { factors, column, design: point.design, group: point.group });
        Some(SubsetSolution {
            variance: sum(&second.solution.variance, &products(&direction, &column)),
            separation: sum(
                &second.solution.separation,
                &products(&column, &sum(&scaled(kappa, &column), &cross)),
            ),
            shift: difference(&second.solution.shift, &scaled(residual, &column)),
        })
    }
}
