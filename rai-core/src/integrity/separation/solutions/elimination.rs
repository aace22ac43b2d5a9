//! Rows taken out of a kernel one after another.

use nalgebra::Vector3;

use super::super::modes::Hypothesis;
use super::kernel::{GROUPS, group_of, hardly_left};
use super::{Own, Solution, Solutions};
use crate::equations::Row;
use crate::numeric::real::Real;
use crate::snapshot::Fit;

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

impl<T: Real> Point<T> {
    /// A row of the view as the kernel of all satellites sees it.
    #[inline]
    pub(super) fn of(row: &Row<T>, fit: &Fit<T>, own: &Own<T>) -> Self {
        Self {
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
        }
    }
}

/// What one row says of its `b` and `κ` with any other.
#[derive(Clone, Copy, Debug)]
struct Reach<T: Real> {
    design: Vector3<T>,
    share: T,
    /// `Γd + t_c`.
    towards: Vector3<T>,
    /// What depends on nothing but the other's group: `[c_j = c_k]/W_c`, and `d·t_c + [c_j = c_k] U_c/W_c²`.
    groups: [[T; 2]; GROUPS],
}

impl<T: Real> Reach<T> {
    /// `b_jk` and `κ_jk`.
    #[inline]
    fn with(&self, other: &Point<T>) -> (T, T) {
        let [level, accuracy] = self.groups.get(other.group).copied().unwrap_or([T::zero(); 2]);
        let coupling = self.design.dot(&other.gain) + level;
        (coupling, other.design.dot(&self.towards) + accuracy - (self.share + other.share) * coupling)
    }
}

/// The first row taken out, and the solution without it.
#[derive(Clone, Copy, Debug)]
pub(super) struct First<T: Real> {
    pub(super) point: Point<T>,
    reach: Reach<T>,
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
    point: Point<T>,
    reach: Reach<T>,
    left: Beside<T>,
    pub(super) solution: Solution<T>,
}

impl<T: Real> Second<T> {
    pub(super) fn last(&self) -> Last<T> {
        Last { column: self.left.column, factor: self.left.factor, spread: self.point.spread }
    }
}

/// What a first row leaves of another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beside<T: Real> {
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

impl<T: Real> Beside<T> {
    #[inline]
    fn solution(&self, first: &First<T>) -> Solution<T> {
        let two = T::one() + T::one();
        let cross = first.column * (two * self.kappa_first) - self.lag - self.lag;
        let Solution { variance, separation, shift } = &first.solution;
        Solution {
            variance: variance + self.direction.component_mul(&self.column),
            separation: separation + self.column.component_mul(&(self.column * self.kappa + cross)),
            shift: shift - self.column * self.residual,
        }
    }
}

/// What a bias needs of the row that was taken out last: of a single one, or of a pair's second.
#[derive(Clone, Copy, Debug)]
pub(super) struct Last<T: Real> {
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
    /// The test of a row without the first row, all constellations in view.
    #[inline]
    pub(super) fn left_by_first(&self, index: usize) -> Option<Tested<T>> {
        let (first, point) = (self.first.as_ref()?, self.point(index)?);
        let Beside { column, residual, kappa, .. } = Self::beside(first, &point, Vector3::zeros())?;
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
    #[inline]
    pub(super) fn point(&self, index: usize) -> Option<Point<T>> {
        let (row, fit) = self.view.rows.get(index).zip(self.view.fits.get(index))?;
        let own = self.own.get(index)?;
        Some(Point::of(row, fit, own))
    }

    /// The row as the present kernel sees it.
    #[inline]
    pub(super) fn point_here(&self, index: usize) -> Option<Point<T>> {
        let point = self.point(index)?;
        if self.at.constellations == 0 { Some(point) } else { Some(self.point_beyond(point)) }
    }

    /// The row without the constellations that the kernel has lost.
    #[inline(never)]
    pub(super) fn point_beyond(&self, mut point: Point<T>) -> Point<T> {
        let kernel = &self.kernel;
        point.gain = kernel.covariance * point.design;
        point.residual -= point.design.dot(&kernel.solution.shift);
        let own = self.level(point.group) + point.design.dot(&point.gain);
        point.pivot = point.weight.recip() - own;
        point.kappa = kernel.kappa(&self.groups, point.group, &point.design, own, point.weight, point.share);
        let lean = self.groups.get(point.group).map_or_else(Vector3::zeros, |group| group.lean);
        point.lag = kernel.change * (point.design * point.share - lean - kernel.dispersion * point.gain);
        point
    }

    #[inline]
    pub(super) fn leave_out_first(&self, index: usize) -> Option<First<T>> {
        let point = self.point_here(index)?;
        if !(point.pivot * point.weight >= hardly_left()) {
            return None;
        }
        let inverse = point.pivot.recip();
        let column = point.gain * inverse;
        let solution = self.alone(&point, &column);
        let bias = if self.has_bias && self.at.constellations == 0 {
            self.bias_without(index, &column, &point)
        } else {
            Vector3::zeros()
        };
        Some(First { reach: self.reach(&point), inverse, column, bias, solution, point })
    }

    /// The solution without a row and nothing else of what the kernel has.
    #[inline(never)]
    pub(super) fn leave_out_alone(&mut self, index: usize) -> Option<Solution<T>> {
        let point = self.point_here(index)?;
        if !(point.pivot * point.weight >= hardly_left()) {
            return None;
        }
        let column = point.gain * point.pivot.recip();
        if self.has_bias {
            self.last = Last { column, factor: T::zero(), spread: point.spread };
        }
        Some(self.alone(&point, &column))
    }

    /// The same by the row's column `A/B`.
    #[inline]
    fn alone(&self, point: &Point<T>, column: &Vector3<T>) -> Solution<T> {
        let base = &self.kernel.solution;
        let across = column * point.kappa - point.lag - point.lag;
        Solution {
            variance: base.variance + point.gain.component_mul(column),
            separation: base.separation + column.component_mul(&across),
            shift: base.shift - column * point.residual,
        }
    }

    fn reach(&self, point: &Point<T>) -> Reach<T> {
        let lean = self.kernel.leans.get(point.group).copied().unwrap_or_else(Vector3::zeros);
        let mut groups = [[T::zero(); 2]; GROUPS];
        for (id, (slot, lean)) in groups.iter_mut().zip(&self.kernel.leans).enumerate() {
            let own = self.groups.get(id).filter(|_| id == point.group);
            let [level, accuracy] = own.map_or([T::zero(); 2], |own| [own.level, own.accuracy]);
            *slot = [level, point.design.dot(lean) + accuracy];
        }
        let towards = self.kernel.gamma * point.design + lean;
        Reach { design: point.design, share: point.share, towards, groups }
    }

    /// What the first row leaves of another one.
    #[inline]
    pub(super) fn beside(first: &First<T>, point: &Point<T>, lag: Vector3<T>) -> Option<Beside<T>> {
        let (coupling, kappa) = first.reach.with(point);
        let factor = -coupling * first.inverse;
        let pivot = point.pivot + factor * coupling;
        if !(pivot * point.weight >= hardly_left()) {
            return None;
        }
        let inverse = pivot.recip();
        let kappa_first = kappa - factor * first.point.kappa;
        let direction = point.gain - first.point.gain * factor;
        Some(Beside {
            coupling,
            factor,
            pivot,
            inverse,
            direction,
            column: direction * inverse,
            residual: point.residual - factor * first.point.residual,
            lag,
            kappa: point.kappa - factor * (kappa + kappa_first),
            kappa_first,
        })
    }

    /// The solution without a pair whose first row is out already, all constellations in view: nothing lags then.
    #[allow(clippy::inline_always, reason = "called in one place, once for every mode")]
    #[inline(always)]
    pub(super) fn leave_out_pair(&mut self, pair: Hypothesis) -> Option<Solution<T>> {
        let [_, second, _] = pair.slots();
        let (first, point) = (self.first.as_ref()?, self.point(second)?);
        let left = Self::beside(first, &point, Vector3::zeros())?;
        let solution = left.solution(first);
        if self.has_bias {
            self.last = Last { column: left.column, factor: left.factor, spread: point.spread };
        }
        Some(solution)
    }

    #[inline(never)]
    pub(super) fn leave_out_second(&self, index: usize) -> Option<Second<T>> {
        let first = self.first.as_ref()?;
        let point = self.point_here(index)?;
        let (coupling, _) = first.reach.with(&point);
        let lag = point.lag + first.point.lag * (coupling * first.inverse);
        let left = Self::beside(first, &point, lag)?;
        let solution = left.solution(first);
        Some(Second { reach: self.reach(&point), point, left, solution })
    }

    #[inline(never)]
    pub(super) fn leave_out_third(&mut self, index: usize) -> Option<Solution<T>> {
        self.third = None;
        let (first, second) = (self.first?, self.second?);
        let left = second.left;
        let point = self.point_here(index)?;
        let (to_first, kappa_first) = first.reach.with(&point);
        let (to_second, kappa_second) = second.reach.with(&point);
        // What couples it to the second, the first gone.
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
        let direction = point.gain - first.point.gain * by_first - left.direction * by_second;
        let residual = point.residual - by_first * first.point.residual - by_second * left.residual;
        let lag = point.lag - first.point.lag * by_first - left.lag * by_second;
        let column = direction / pivot;
        let cross = (first.column * across_first + left.column * across_second - lag) * two;
        self.third = Some(Third { factors, column, design: point.design, group: point.group });
        Some(Solution {
            variance: second.solution.variance + direction.component_mul(&column),
            separation: second.solution.separation + column.component_mul(&(column * kappa + cross)),
            shift: second.solution.shift - column * residual,
        })
    }
}
