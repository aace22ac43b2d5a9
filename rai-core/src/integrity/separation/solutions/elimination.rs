//! Rows taken out of a kernel one after another.

use nalgebra::Vector3;

use super::kernel::{group_of, hardly_left};
use super::{Solution, Solutions};
use crate::numeric::real::Real;

/// A row as a kernel sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point<T: Real> {
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

/// The first row taken out, and the solution without it.
#[derive(Clone, Copy, Debug)]
pub(super) struct First<T: Real> {
    pub(super) point: Point<T>,
    /// `Γd + t_c`.
    pub(super) towards: Vector3<T>,
    pub(super) inverse: T,
    /// `A/B`.
    pub(super) column: Vector3<T>,
    /// Without it and nothing else; 0 without biases.
    pub(super) bias: Vector3<T>,
    pub(super) solution: Solution<T>,
}

/// The second row, as the first leaves it, and the solution without both.
#[derive(Clone, Copy, Debug)]
pub(super) struct Second<T: Real> {
    pub(super) point: Point<T>,
    pub(super) towards: Vector3<T>,
    pub(super) coupling: T,
    pub(super) factor: T,
    pub(super) inverse: T,
    pub(super) direction: Vector3<T>,
    pub(super) column: Vector3<T>,
    pub(super) residual: T,
    pub(super) lag: Vector3<T>,
    pub(super) kappa: T,
    pub(super) kappa_first: T,
    pub(super) solution: Solution<T>,
}

/// What a bias needs of a pair's second row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair<T: Real> {
    pub(super) column: Vector3<T>,
    pub(super) factor: T,
    pub(super) spread: T,
}

/// The third row, likewise: only what a bias needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Third<T: Real> {
    pub(super) factors: [T; 2],
    pub(super) column: Vector3<T>,
    pub(super) design: Vector3<T>,
    pub(super) group: usize,
}

/// A row's test: `A_k v_k` is how far the position moves without it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tested<T: Real> {
    column: Vector3<T>,
    residual: T,
    kappa: T,
}

impl<T: Real> Tested<T> {
    /// Whether the position moves by more than its threshold on any axis.
    #[inline]
    pub(super) fn exceeds(&self, limits: &Vector3<T>) -> bool {
        let squared = self.residual * self.residual;
        let moves = self.column.component_mul(&self.column);
        let mut axes = moves.iter().zip(limits);
        self.kappa > T::zero() && axes.any(|(&moved, &limit)| moved * squared > limit * (moved * self.kappa))
    }
}

impl<T: Real> Solutions<'_, T> {
    /// The test of a row without the first row.
    #[inline]
    pub(super) fn left_by_first(&self, index: usize) -> Option<Tested<T>> {
        let Second { column, residual, kappa, .. } = self.leave_out_second(index)?;
        Some(Tested { column, residual, kappa })
    }

    /// The test of a row without the constellations that the kernel has lost.
    #[inline]
    pub(super) fn left_by_kernel(&self, index: usize) -> Option<Tested<T>> {
        let point = self.point_here(index)?;
        let is_sound = point.pivot * point.weight >= hardly_left();
        is_sound.then_some(Tested { column: point.gain, residual: point.residual, kappa: point.kappa })
    }

    /// The row of the view as the kernel of all satellites sees it; `None` where it takes no part.
    pub(super) fn point(&self, index: usize) -> Option<Point<T>> {
        let (row, fit) = self.view.rows.get(index).zip(self.view.fits.get(index))?;
        let own = self.own.get(index)?;
        Some(Point {
            group: group_of(row),
            design: fit.centred,
            gain: fit.gain,
            residual: fit.residual,
            weight: row.weight,
            share: own.share,
            pivot: own.pivot,
            kappa: own.kappa,
            lag: Vector3::zeros(),
            spread: own.spread,
        })
    }

    /// The row as the present kernel sees it.
    #[inline]
    pub(super) fn point_here(&self, index: usize) -> Option<Point<T>> {
        let point = self.point(index)?;
        if self.at.constellations == 0 { Some(point) } else { Some(self.point_beyond(point)) }
    }

    /// The row without the constellations that the kernel has lost.
    pub(super) fn point_beyond(&self, mut point: Point<T>) -> Point<T> {
        let kernel = &self.kernel;
        point.gain = kernel.covariance * point.design;
        point.residual -= point.design.dot(&kernel.solution.shift);
        let own = self.level(point.group) + point.design.dot(&point.gain);
        point.pivot = point.weight.recip() - own;
        point.kappa =
            kernel.kappa(&self.groups, point.group, &point.design, &point.gain, point.weight, point.share);
        let lean = self.groups.get(point.group).map_or_else(Vector3::zeros, |group| group.lean);
        point.lag = kernel.change * (point.design * point.share - lean - kernel.dispersion * point.gain);
        point
    }

    pub(super) fn leave_out_first(&self, index: usize) -> Option<First<T>> {
        let point = self.point_here(index)?;
        if !(point.pivot * point.weight >= hardly_left()) {
            return None;
        }
        let inverse = point.pivot.recip();
        let column = point.gain * inverse;
        let base = &self.kernel.solution;
        let bias = if self.has_bias && self.at.constellations == 0 {
            self.bias_without(index, &column, &point)
        } else {
            Vector3::zeros()
        };
        let lean = self.kernel.leans.get(point.group).copied().unwrap_or_else(Vector3::zeros);
        Some(First {
            towards: self.kernel.gamma * point.design + lean,
            inverse,
            column,
            bias,
            solution: Solution {
                variance: base.variance + point.gain.component_mul(&column),
                separation: base.separation
                    + column.component_mul(&(column * point.kappa - point.lag - point.lag)),
                shift: base.shift - column * point.residual,
            },
            point,
        })
    }

    /// `b_jk` and `κ_jk` of two rows, by what one of them is.
    #[inline]
    pub(super) fn pair(&self, one: &Point<T>, towards: &Vector3<T>, other: &Point<T>) -> (T, T) {
        let lean = self.kernel.leans.get(other.group).copied().unwrap_or_else(Vector3::zeros);
        let (mut coupling, mut kappa) = (one.design.dot(&other.gain), T::zero());
        if one.group == other.group
            && let Some(group) = self.groups.get(one.group)
        {
            coupling += group.level;
            kappa = group.accuracy;
        }
        kappa += other.design.dot(towards) + one.design.dot(&lean) - (one.share + other.share) * coupling;
        (coupling, kappa)
    }

    #[inline]
    pub(super) fn leave_out_second(&self, index: usize) -> Option<Second<T>> {
        let first = self.first.as_ref()?;
        let point = self.point_here(index)?;
        let (coupling, kappa) = self.pair(&first.point, &first.towards, &point);
        let factor = -coupling * first.inverse;
        let pivot = point.pivot + factor * coupling;
        if !(pivot * point.weight >= hardly_left()) {
            return None;
        }
        let inverse = pivot.recip();
        let kappa_first = kappa - factor * first.point.kappa;
        let own_kappa = point.kappa - factor * (kappa + kappa_first);
        let direction = point.gain - first.point.gain * factor;
        let column = direction * inverse;
        let residual = point.residual - factor * first.point.residual;
        let lag = point.lag - first.point.lag * factor;
        let two = T::one() + T::one();
        let cross = first.column * (two * kappa_first) - lag - lag;
        Some(Second {
            point,
            // Only a third row asks for it.
            towards: Vector3::zeros(),
            coupling,
            factor,
            inverse,
            direction,
            column,
            residual,
            lag,
            kappa: own_kappa,
            kappa_first,
            solution: Solution {
                variance: first.solution.variance + direction.component_mul(&column),
                separation: first.solution.separation + column.component_mul(&(column * own_kappa + cross)),
                shift: first.solution.shift - column * residual,
            },
        })
    }

    /// As [`Self::leave_out_second`], for third rows to follow.
    #[inline(never)]
    pub(super) fn keep_second(&self, index: usize) -> Option<Second<T>> {
        self.leave_out_second(index)
    }

    #[inline(never)]
    pub(super) fn leave_out_third(&mut self, index: usize) -> Option<Solution<T>> {
        self.third = None;
        let (first, mut second) = (self.first?, self.second?);
        let lean = self.kernel.leans.get(second.point.group).copied().unwrap_or_else(Vector3::zeros);
        second.towards = self.kernel.gamma * second.point.design + lean;
        let point = self.point_here(index)?;
        let (to_first, kappa_first) = self.pair(&first.point, &first.towards, &point);
        let (to_second, kappa_second) = self.pair(&second.point, &second.towards, &point);
        // What couples it to the second, the first gone.
        let left = -to_second - second.coupling * to_first * first.inverse;
        let factors = [-to_first * first.inverse, left * second.inverse];
        let [by_first, by_second] = factors;
        let pivot = point.pivot + by_first * to_first - by_second * left;
        if !(pivot * point.weight >= hardly_left()) {
            return None;
        }
        let with_second = kappa_second - second.factor * kappa_first;
        let two = T::one() + T::one();
        let kappa =
            point.kappa + by_first * by_first * first.point.kappa + by_second * by_second * second.kappa
                - two
                    * (by_first * kappa_first + by_second * with_second
                        - by_first * by_second * second.kappa_first);
        let across_first = kappa_first - by_first * first.point.kappa - by_second * second.kappa_first;
        let across_second = with_second - by_first * second.kappa_first - by_second * second.kappa;
        let direction = point.gain - first.point.gain * by_first - second.direction * by_second;
        let residual = point.residual - by_first * first.point.residual - by_second * second.residual;
        let lag = point.lag - first.point.lag * by_first - second.lag * by_second;
        let column = direction / pivot;
        let cross = (first.column * across_first + second.column * across_second - lag) * two;
        self.third = Some(Third { factors, column, design: point.design, group: point.group });
        Some(Solution {
            variance: second.solution.variance + direction.component_mul(&column),
            separation: second.solution.separation + column.component_mul(&(column * kappa + cross)),
            shift: second.solution.shift - column * residual,
        })
    }
}
