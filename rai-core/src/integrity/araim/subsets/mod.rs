//! The position without a mode's satellites, its uncertainty, and its separation from the
//! all-in-view position. All of them are derived from the one 3×3 solve.
//!
//! ```text
//! constellations X     P' = (N − N_X)⁻¹    T = P' − P    D' = D − D_X    x' − x = −P' Σ_X w_i d_i v_i
//!                      Cov_ss = T D' Tᵀ + P D_X Pᵀ
//! rows E of others     B_jj = 1/w_j − b_jj,  B_jk = −b_jk       b_jk = [c_j = c_k]/W_c + d_j·P'd_k
//!                      P_E = P' + A B⁻¹ Aᵀ       A_j = P'd_j    x_E = x' − A B⁻¹ v'_E
//!                      S_E − S = (S_X − S) − A B⁻¹ M_E          M_ji = δ_ji − w_i b_ji
//! κ_jk = (M C_acc Mᵀ)_jk = δ_jk a_j/w_j − (a_j + a_k) b_jk + [c_j = c_k] U_c/W_c² + d_jᵀΓd_k + d_j·t_ck + d_k·t_cj
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `P`, `d_i`, `g_i = P d_i`, `v_i` | of the snapshot | m², –, m², m |
//! | `a_i = w_i σ_acc,i²` | `share` | – |
//! | `B_jj` | `pivot` | m² |
//! | `κ_jj` | `kappa` | m² |
//! | `N_c = Σ w d dᵀ`, `D_c = Σ a w d dᵀ`, `U_c = Σ a w`, `τ_c = Σ a w d` | [`ConstellationSums`] | 1/m² |
//! | `Γ = P'D'P'`, `t_c = P'τ_c/W_c` | [`Kernel`] | m² |
//! | diagonal of `P_E` | [`SubsetSolution::variance`] | m² |
//! | diagonal of `Cov_ss` | [`SubsetSolution::separation`] | m² |
//! | `x_E − x` | [`SubsetSolution::shift`] | m |
//! | `Σ |S_qi| b_i` | [`SubsetSolutions::bias`] | m |
//!
//! Rows are left out one after another (elimination). A single row takes about 70 operations, a
//! pair another 90. The part that all pairs with the same first row share is computed once. `C_acc`
//! need not be proportional to `C`. Modes without an effect are dismissed before ([`bounds`]). Only
//! the bias is a sum over all rows. It is computed only if a bound on it does not suffice.
//!
//! Assumes that a mode leaves at least one row of every constellation that is not lost as a whole.
//! References: [Blanch2015], [`crate::least_squares::downdate`] for the elimination.
//!
//! [Blanch2015]: crate#references

mod bias;
mod bounds;
mod direct;
mod elimination;
mod kernel;

use heapless::Vec;
use nalgebra::{Matrix3, Vector3};

use elimination::{FirstRow, LastRow, SecondRow, ThirdRow};
use kernel::{ConstellationSums, Kernel, diagonal_of, hardly_left};
pub(super) use kernel::{GROUPS, group_of};

pub(super) use bounds::Bounds;

use super::modes::{Hypothesis, ROWS, RowSet, members};
use super::{Prior, View};
use crate::least_squares::equations::Row;
use crate::least_squares::{RowFit, curvature, invert};
use crate::numeric::real::Real;
use crate::numeric::space::{
    add_outer_product, diagonal, dot, matrix_difference, matrix_sum, mirror, plus_scaled, product, scaled,
    sum, trace, zero, zeros,
};
use crate::satellite::Constellation;
/// Solution without one mode.
#[derive(Clone, Copy, Debug)]
pub(super) struct SubsetSolution<T> {
    pub(super) variance: Vector3<T>,
    pub(super) separation: Vector3<T>,
    pub(super) shift: Vector3<T>,
}

/// Integrity data of a row.
#[derive(Clone, Copy, Debug)]
pub(super) struct IntegrityRow<T> {
    pub(super) share: T,
    pivot: T,
    kappa: T,
    /// `w_i b_i`.
    pub(super) weighted_bias: T,
    /// Bound on `Σ_i |M_ji| b_i`, m; 0 without biases.
    spread: T,
}
/// Solutions without each mode. Intermediate results are stored for the next modes.
pub(super) struct SubsetSolutions<'v, T: Real, const N: usize> {
    view: View<'v, T>,
    own: &'v mut Vec<IntegrityRow<T>, N>,
    groups: [ConstellationSums<T>; GROUPS],
    total_dispersion: Matrix3<T>,
    largest_weight: T,
    has_bias: bool,
    /// Bias of the all-in-view solution, m.
    whole_bias: Vector3<T>,
    kernel: Kernel<T>,
    /// Mode to which the following fields belong.
    at: Hypothesis,
    /// True if the kernel has enough digits for leaving rows out of it.
    is_sound: bool,
    /// Solution and bias of a mode that was solved directly, because elimination would lose too
    /// many digits.
    direct: Option<(SubsetSolution<T>, Vector3<T>)>,
    first: Option<FirstRow<T>>,
    /// Values of the single row or the pair that was solved last.
    last: LastRow<T>,
    /// Second row of a pair, stored for triples.
    second: Option<SecondRow<T>>,
    third: Option<ThirdRow<T>>,
}
impl<'v, T: Real, const N: usize> SubsetSolutions<'v, T, N> {
    /// Returns the solutions of a view. Call [`Self::prepare`] before use; it works in place,
    /// because they are large.
    #[allow(clippy::inline_always, reason = "made where it stays: it is large")]
    #[inline(always)]
    pub(super) fn of(view: View<'v, T>, own: &'v mut Vec<IntegrityRow<T>, N>) -> Self {
        own.clear();
        Self {
            view,
            own,
            groups: [ConstellationSums::empty(); GROUPS],
            total_dispersion: zeros(),
            largest_weight: T::zero(),
            has_bias: false,
            whole_bias: zero(),
            kernel: Kernel::nothing(),
            at: Hypothesis::NONE,
            is_sound: true,
            direct: None,
            first: None,
            last: LastRow { column: zero(), factor: T::zero(), spread: T::zero() },
            second: None,
            third: None,
        }
    }

    /// Prepares the solutions for the modes.
    #[inline(never)]
    pub(super) fn prepare(&mut self, priors: &[Prior<T>]) {
        self.has_bias = self.prepare_without_biases(priors);
        if self.has_bias {
            self.spread_biases(priors);
            self.whole_bias = self.summed_bias_of_whole();
        }
    }

    /// Prepares the solutions as if no satellite had a nominal bias, for tests. Returns true if any
    /// satellite has one.
    #[inline(never)]
    pub(super) fn prepare_without_biases(&mut self, priors: &[Prior<T>]) -> bool {
        let has_bias = self.sum_up(priors);
        self.describe_whole();
        has_bias
    }

    /// Sums over the rows of each constellation. Returns true if any row has a nominal bias.
    fn sum_up(&mut self, priors: &[Prior<T>]) -> bool {
        let (mut biases, mut largest_weight) = (T::zero(), T::zero());
        let rows = self.view.rows.iter().zip(self.view.fits).enumerate();
        for (index, (row, fit)) in rows {
            let weight = row.weight;
            let prior = priors.get(index);
            // The accuracy of an aiding row is its sigma.
            let share = prior.map_or(T::one(), |prior| weight * prior.accuracy_m * prior.accuracy_m);
            let bias = prior.map_or(T::zero(), |prior| prior.bias_m);
            let pivot = if weight > T::zero() { fit.redundancy / weight } else { T::zero() };
            let own = IntegrityRow {
                share,
                pivot,
                kappa: T::zero(),
                weighted_bias: weight * bias,
                spread: T::zero(),
            };
            // Never full, because the view has no more rows than the capacity.
            let _ = self.own.push(own);
            biases += own.weighted_bias;
            if weight > largest_weight {
                largest_weight = weight;
            }
            // A row that is left out belongs to no group.
            let group = if weight > T::zero() { group_of(row) } else { GROUPS };
            if let Some(group) = self.groups.get_mut(group) {
                let (centred, residual) = (fit.centred, fit.residual);
                let weighted = scaled(weight, &centred);
                let accurate = scaled(share, &weighted);
                group.level += weight;
                group.accuracy += share * weight;
                group.lean = sum(&group.lean, &accurate);
                add_outer_product(&mut group.normal, &weighted, &centred);
                add_outer_product(&mut group.dispersion, &accurate, &centred);
                group.pull = plus_scaled(&group.pull, residual, &weighted);
            }
        }
        self.largest_weight = largest_weight;
        for (id, group) in self.groups.iter_mut().enumerate() {
            mirror(&mut group.dispersion);
            self.total_dispersion = matrix_sum(&self.total_dispersion, &group.dispersion);
            let has_clock = id < Constellation::COUNT && group.level > T::zero();
            group.level = if has_clock { group.level.recip() } else { T::zero() };
            group.accuracy *= group.level * group.level;
            group.lean = scaled(group.level, &group.lean);
        }
        // False if no bias is positive.
        biases > T::zero()
    }

    /// Computes the kernel of all satellites, and each row's `κ_jj` in it.
    fn describe_whole(&mut self) {
        self.kernel.regain_all(self.view.covariance, &self.total_dispersion);
        self.kernel.complete(&self.groups);
        for ((row, fit), own) in self.view.rows.iter().zip(self.view.fits).zip(self.own.iter_mut()) {
            if row.weight > T::zero() {
                let coupling = row.weight.recip() - own.pivot;
                let group = group_of(row);
                own.kappa =
                    self.kernel.kappa(&self.groups, group, &fit.centred, coupling, row.weight, own.share);
            }
        }
    }
    /// Returns `1/W_c`.
    fn level(&self, group: usize) -> T {
        self.groups.get(group).map_or(T::zero(), |group| group.level)
    }

    /// Returns true if any satellite has a nominal bias.
    pub(super) fn has_bias(&self) -> bool {
        self.has_bias
    }

    /// Returns the bias of the all-in-view solution, m.
    pub(super) fn whole_bias(&self) -> Vector3<T> {
        self.whole_bias
    }

    /// Returns the all-in-view solution: its variance, and in `separation` its variance for
    /// accuracy.
    pub(super) fn whole(&self) -> SubsetSolution<T> {
        let covariance = self.view.covariance;
        SubsetSolution {
            variance: diagonal(covariance),
            separation: diagonal_of(covariance, &self.total_dispersion),
            shift: zero(),
        }
    }

    /// Iterates over the rows with their fits and integrity data.
    pub(super) fn rows(&self) -> impl Iterator<Item = (&Row<T>, &RowFit<T>, &IntegrityRow<T>)> {
        self.view.rows.iter().zip(self.view.fits).zip(&*self.own).map(|((row, fit), own)| (row, fit, own))
    }

    /// Returns the largest weight of all rows.
    pub(super) fn largest_weight(&self) -> T {
        self.largest_weight
    }

    /// Returns the solution without a mode, or `None` if the remaining rows do not determine it.
    #[allow(clippy::inline_always, reason = "called in one place, once for every mode")]
    #[inline(always)]
    pub(super) fn without(&mut self, hypothesis: Hypothesis) -> Option<SubsetSolution<T>> {
        let by_algebra = if self.first.is_some() && hypothesis.is_pair_after(self.at) {
            self.at = hypothesis;
            // The stored second row belongs to another pair.
            self.second = None;
            self.leave_out_pair(hypothesis)
        } else {
            self.by_algebra(hypothesis)
        };
        if by_algebra.is_some() {
            if self.has_bias {
                self.direct = None;
            }
            return by_algebra;
        }
        self.direct = direct::solve(self, hypothesis);
        self.direct.as_ref().map(|(solution, _)| *solution)
    }

    /// Returns the solution without a mode by elimination, or `None` if this would lose too many
    /// digits.
    #[inline(never)]
    fn by_algebra(&mut self, hypothesis: Hypothesis) -> Option<SubsetSolution<T>> {
        let [first, second, third] = hypothesis.slots();
        if self.at.constellations != hypothesis.constellations {
            self.enter(hypothesis.constellations);
        }
        let [at_first, at_second, _] = self.at.slots();
        self.at = hypothesis;
        if !self.is_sound {
            return None;
        }
        if first >= ROWS {
            return Some(self.kernel.solution);
        }
        self.kernel.complete(&self.groups);
        if second >= ROWS {
            self.first = None;
            return self.leave_out_alone(first);
        }
        if at_first != first || self.first.is_none() {
            self.enter_first(hypothesis);
        }
        self.first.as_ref()?;
        if third >= ROWS && hypothesis.constellations == 0 {
            self.second = None;
            return self.leave_out_pair(hypothesis);
        }
        if third >= ROWS {
            // The stored second row belongs to another pair.
            self.second = None;
            let taken = self.leave_out_second(second)?;
            self.last = taken.last();
            return Some(taken.solution);
        }
        if at_first != first || at_second != second || self.second.is_none() {
            self.second = self.leave_out_second(second);
        }
        self.leave_out_third(third)
    }

    /// Leaves the first row of a hypothesis out. Pairs with it are then solved from the result.
    #[inline(never)]
    fn enter_first(&mut self, hypothesis: Hypothesis) {
        if self.at.constellations != hypothesis.constellations {
            self.enter(hypothesis.constellations);
        }
        self.at = hypothesis;
        self.second = None;
        self.kernel.complete(&self.groups);
        let [first, ..] = hypothesis.slots();
        self.first = self.leave_out_first(first);
    }

    /// Computes the kernel without some constellations.
    #[inline(never)]
    fn enter(&mut self, constellations: u8) {
        self.at = Hypothesis::of_constellations(constellations);
        self.first = None;
        self.second = None;
        if constellations == 0 {
            self.is_sound = true;
            self.kernel.regain_all(self.view.covariance, &self.total_dispersion);
            return;
        }
        self.is_sound = self.kernel_without(constellations).is_some();
    }

    fn kernel_without(&mut self, constellations: u8) -> Option<()> {
        let mut normal = zeros();
        let (mut kept, mut lost, mut pull) = (zeros(), zeros(), zero());
        for (id, group) in self.groups.iter().enumerate() {
            if id < Constellation::COUNT && constellations >> id & 1 != 0 {
                lost = matrix_sum(&lost, &group.dispersion);
                pull = sum(&pull, &group.pull);
            } else {
                normal = matrix_sum(&normal, &group.normal);
                kept = matrix_sum(&kept, &group.dispersion);
            }
        }
        let covariance = invert(&normal).ok()?;
        // A NaN trace fails this comparison.
        if !(self.largest_weight * trace(&covariance) * hardly_left() < T::one()) {
            return None;
        }
        let whole = self.view.covariance;
        let change = matrix_difference(&covariance, whole);
        let kernel = &mut self.kernel;
        kernel.solution = SubsetSolution {
            variance: diagonal(&covariance),
            separation: sum(&diagonal_of(&change, &kept), &diagonal_of(whole, &lost)),
            shift: scaled(-T::one(), &product(&covariance, &pull)),
        };
        (kernel.covariance, kernel.change, kernel.dispersion) = (covariance, change, kept);
        kernel.is_complete = false;
        Some(())
    }
    /// Returns true if the test of any single row alarms without a hypothesis; `limits` are the
    /// squares of `K`.
    ///
    /// The hypothesis is one row, or constellations. Rows whose loss would leave too poor a
    /// geometry for elimination are not tested.
    #[inline(never)]
    pub(super) fn contradict(
        &mut self,
        hypothesis: Hypothesis,
        singles: RowSet,
        limits: &Vector3<T>,
    ) -> bool {
        let is_of_row = hypothesis.rows().next().is_some();
        if is_of_row {
            // [`Self::by_algebra`] does not store a single row, which the tests of the others need
            // here.
            self.enter_first(hypothesis);
            if self.first.is_none() {
                return false;
            }
        } else if self.by_algebra(hypothesis).is_none() {
            return false;
        }
        self.kernel.complete(&self.groups);
        members(singles).any(|index| {
            let left = if is_of_row { self.left_by_first(index) } else { self.left_by_kernel(index) };
            left.is_some_and(|left| left.exceeds(limits))
        })
    }

    /// Returns true if the rows without a hypothesis may agree about another point. `sse` is their
    /// weighted SSE about the present point, which the distance alone may explain.
    #[cold]
    #[inline(never)]
    pub(super) fn may_agree_elsewhere(&mut self, hypothesis: Hypothesis, sse: T) -> bool {
        /// SSE that noise of 36 degrees of freedom exceeds once in 360 epochs.
        const NOISE: f64 = 64.0;
        let rows = self.view.rows;
        self.by_algebra(hypothesis)
            .is_none_or(|without| curvature::may_explain(sse, NOISE, rows, &without.shift))
    }

    /// Returns the weighted SSE without one row, or without one constellation.
    pub(super) fn sse_without(&mut self, sse: T, hypothesis: Hypothesis) -> Option<T> {
        if let Some(index) = hypothesis.rows().next() {
            let point = self.point(index)?;
            let is_tested = point.pivot * point.weight >= T::UNTESTABLE;
            return is_tested.then(|| sse - point.residual * point.residual / point.pivot);
        }
        let shift = self.without(hypothesis)?.shift;
        let rows = self.view.rows.iter().zip(self.view.fits);
        let left = rows.filter(|(row, _)| hypothesis.constellations >> group_of(row) & 1 == 0);
        Some(left.fold(T::zero(), |sum, (row, fit)| {
            let residual = fit.residual - dot(&fit.centred, &shift);
            sum + row.weight * residual * residual
        }))
    }
}
