//! Downdate: the solution of a snapshot without a set of rows, by algebra.
//!
//! With sigma-normalised residuals `r_i = √w_i v_i`, gains `A_i = √w_i g_i`, and the block `S_EE`
//! of the projection matrix that belongs to the set `E`,
//!
//! ```text
//! S_ij  = δ_ij − (√w_i d_i)·(√w_j g_j) − [c_i = c_j] √(w_i/W_c) √(w_j/W_c)
//! SSE_E = SSE − r_Eᵀ S_EE⁻¹ r_E        dof_E = dof − |E|
//! x_E   = x − A_E S_EE⁻¹ r_E           P_E   = P + A_E S_EE⁻¹ A_Eᵀ
//! r'_i  = r_i − S_iE S_EE⁻¹ r_E        (residual of a row that stays)
//! ```
//!
//! A set grows row by row. With `s = S_Ek`, `u = S_EE⁻¹ s`, the redundancy `p = S_kk − s·u` that
//! row `k` keeps and its residual `q = r_k − r_E·u` without `E`,
//!
//! ```text
//! S_E'E'⁻¹ = S_EE⁻¹ + t tᵀ / p,   t = (u, −1)        explained' = explained + q²/p
//! ```
//!
//! so that one row costs a division, and the squared w-test of `k` without `E` is `q²/p`.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `r_i` | [`NormalisedRow::residual`] | – |
//! | `S_ii` | [`NormalisedRow::redundancy`] | – |
//! | `r_Eᵀ S_EE⁻¹ r_E` | [`ExclusionSet::explained`] | – |
//! | `x_E`, `P_E` | [`ExclusionSet::correction`], [`ExclusionSet::covariance`] | m, m² |
//!
//! A set is refused if the smallest eigenvalue of `S_EE` is below [`Real::UNTESTABLE`], because its
//! rows then cannot be distinguished or are needed for a position. A set that empties a
//! constellation is such a set.
//!
//! A search over pairs with the same third row `k` projects `k` out of all other rows first: with
//! `a_i = S_ik/√S_kk` each row keeps the residual `r_i − a_i r_k/√S_kk` and the products
//! `S_ij − a_i a_j` (`ReducedRow::without`).
//!
//! In parity space `S_ij = p_i·p_j` and `r_i = p·p_i`, so that the rows here are the parity vectors
//! up to a rotation that no test sees. No n×n matrix is stored. Each row costs 48 bytes in `f32`,
//! another 16 while triples are compared, and about 10 instructions for each `S_ij`.
//!
//! The algebra is linear: if the fix was linearised elsewhere, solve again without the set before
//! the position is used.

use heapless::Vec;
use nalgebra::{Matrix3, Vector3};

use crate::least_squares::equations::{MAX_ROWS, Row};
use crate::least_squares::{RowFit, Snapshot};
use crate::numeric::real::Real;
use crate::numeric::space::{
    add_outer_product, add_outer_square, difference, dot, identity, matrix_product, matrix_sum, mirror,
    of_columns, product, scaled, symmetric_determinant, symmetric_product, zero, zeros,
};
use crate::report::MAX_EXCLUDED;

/// A row in units of its sigma, with the terms that its products with other rows need.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalisedRow<T: Real> {
    /// Index in the epoch.
    pub index: usize,
    /// `r_i`, dimensionless.
    pub residual: T,
    /// `S_ii`, dimensionless.
    pub redundancy: T,
    coupling_terms: CouplingTerms<T>,
    gain: Vector3<T>,
    /// `1/σ_i`.
    root: T,
}

/// Terms of a row that its products with many others need.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CouplingTerms<T: Real> {
    /// `√w_i d_i`.
    design: Vector3<T>,
    /// `1/(σ_i W_c)`; times the root of another row's weight it is the term that two rows share by
    /// their clock. 0 without a clock.
    level: T,
    /// Number of its clock, or [`NO_CLOCK`], so that one comparison of bytes suffices.
    clock: u8,
}

/// Number beyond every constellation.
const NO_CLOCK: u8 = u8::MAX;

impl<T: Real> CouplingTerms<T> {
    /// Returns `S_ij` of two rows, less the product `a_i a_j` of a row that was projected out.
    fn coupling(&self, other: &NormalisedRow<T>, projected: T) -> T {
        let shared =
            if self.clock == other.coupling_terms.clock { self.level * other.root } else { T::zero() };
        -(dot(&self.design, &other.gain) + projected + shared)
    }
}

impl<T: Real> NormalisedRow<T> {
    fn new<const N: usize>(
        index: usize,
        row: &Row<T>,
        fit: &RowFit<T>,
        snapshot: &Snapshot<'_, T, N>,
    ) -> Self {
        let root = row.sigma.recip();
        Self {
            index,
            residual: fit.residual * root,
            redundancy: fit.redundancy,
            coupling_terms: CouplingTerms {
                design: scaled(root, &fit.centred),
                level: root * snapshot.level_variance(row),
                clock: row.clock.map_or(NO_CLOCK, |clock| clock as u8),
            },
            gain: scaled(root, &fit.gain),
            root,
        }
    }

    /// Returns `S_ij`, dimensionless: the share of one row's error that shows in the other's
    /// residual.
    pub fn projection(&self, other: &Self) -> T {
        if self.index == other.index {
            return self.redundancy;
        }
        self.coupling_terms.coupling(other, T::zero())
    }

    /// Returns the decrease of SSE without this row, which is its squared w-test.
    pub(crate) fn explained(&self) -> T {
        squared_w_test(self.residual, self.redundancy)
    }
}

/// A row beside a set under comparison: as in the snapshot, or with another row projected out.
///
/// It stores only what differs from the row, because there are as many as rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReducedRow<'r, T: Real> {
    row: &'r NormalisedRow<T>,
    residual: T,
    redundancy: T,
    /// `a_i` of the row that was projected out, 0 without one.
    projected: T,
}

/// Capacity for one reduced row per row.
pub(crate) type ReducedRows<'r, T, const N: usize> = Vec<ReducedRow<'r, T>, N>;

impl<'r, T: Real> ReducedRow<'r, T> {
    /// Returns the row as in the snapshot.
    pub(crate) fn of(row: &'r NormalisedRow<T>) -> Self {
        Self { row, residual: row.residual, redundancy: row.redundancy, projected: T::zero() }
    }

    /// Returns the row with another row projected out.
    ///
    /// `root` is the square root of the other row's redundancy, taken once for all rows.
    pub(crate) fn without(row: &'r NormalisedRow<T>, gone: &NormalisedRow<T>, root: T) -> Self {
        let projected = gone.projection(row) / root;
        Self {
            row,
            residual: row.residual - projected * gone.residual / root,
            redundancy: row.redundancy - projected * projected,
            projected,
        }
    }

    /// Returns the row beside a column of the design that is estimated with the position.
    ///
    /// `projected` is the column's product with the row in parity space, `residual` the column's
    /// own residual.
    pub(crate) fn beside(row: &'r NormalisedRow<T>, projected: T, residual: T) -> Self {
        let redundancy = row.redundancy - projected * projected;
        Self { row, residual: row.residual - projected * residual, redundancy, projected }
    }

    /// Returns index in the epoch.
    pub(crate) fn index(&self) -> usize {
        self.row.index
    }

    /// Returns the decrease of SSE without this row, which is its squared w-test.
    pub(crate) fn explained(&self) -> T {
        squared_w_test(self.residual, self.redundancy)
    }

    /// Returns true if no redundancy is left to test the row with.
    pub(crate) fn is_untestable(&self) -> bool {
        self.redundancy < T::UNTESTABLE
    }
}

/// The first row of a pair, with the terms that are the same for all second rows. Passed by value,
/// so that it stays in registers.
pub(crate) struct PairCandidate<T: Real> {
    coupling_terms: CouplingTerms<T>,
    /// `a_i`.
    projected: T,
    /// Decrease of SSE without this row and those before it.
    explained: T,
    /// Decrease by which another row surely does not reach the bar.
    lacking: T,
    /// `1/S_ii`.
    share: T,
    /// `r_i/S_ii`.
    bias: T,
}

impl<T: Real> PairCandidate<T> {
    /// Returns the terms of a row beside rows that explain `explained` already.
    pub(crate) fn new(explained: T, standing: &ReducedRow<'_, T>) -> Self {
        let share = standing.redundancy.recip();
        Self {
            coupling_terms: standing.row.coupling_terms,
            projected: standing.projected,
            explained: explained + squared_w_test(standing.residual, standing.redundancy),
            lacking: T::zero(),
            share,
            bias: standing.residual * share,
        }
    }

    /// Sets the decrease of SSE that a set must reach.
    pub(crate) fn set_bar(&mut self, bar: T) {
        // Less by more than all roundings of the comparison.
        let rounding = T::narrow(4.0) * T::default_epsilon() * bar;
        self.lacking = bar - self.explained - rounding;
    }

    /// Returns the decrease of SSE without this row, those before it and another one: the squared
    /// w-test of each, one after the other. `None` if it is surely below the bar, which a product
    /// finds out for nearly all sets, without a division.
    pub(crate) fn explains_with(&self, other: &ReducedRow<'_, T>) -> Option<T> {
        let coupling = self.coupling_terms.coupling(other.row, self.projected * other.projected);
        let residual = other.residual - coupling * self.bias;
        let redundancy = other.redundancy - coupling * coupling * self.share;
        // NaN fails this comparison, so that it is compared with the bar itself.
        if residual * residual < self.lacking * redundancy {
            return None;
        }
        Some(self.explained + squared_w_test(residual, redundancy))
    }
}

/// Returns the squared w-test, or 0 if no redundancy is left.
fn squared_w_test<T: Real>(residual: T, redundancy: T) -> T {
    if redundancy < T::UNTESTABLE { T::zero() } else { residual * residual / redundancy }
}

/// Capacity for the rows of a search: as many as the epoch may have.
pub type NormalisedRows<T, const N: usize = MAX_ROWS> = Vec<NormalisedRow<T>, N>;

/// Writes the rows of a snapshot that take part and can be tested, in the order of the epoch.
///
/// Any other row is untestable in every set. The caller provides the memory, because a returned
/// vector would be on the stack twice.
pub fn testable_rows<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    rows: &mut NormalisedRows<T, N>,
) {
    rows.clear();
    for (index, (row, fit)) in snapshot.rows().enumerate() {
        if row.weight > T::zero() && fit.redundancy >= T::UNTESTABLE {
            // Never full, because the capacity is that of the epoch.
            let _ = rows.push(NormalisedRow::new(index, row, fit, snapshot));
        }
    }
}

/// A set of at most [`MAX_EXCLUDED`] rows to leave out, with the inverse of its `S_EE`.
#[derive(Clone, Debug, PartialEq)]
pub struct ExclusionSet<T: Real> {
    rows: Vec<NormalisedRow<T>, MAX_EXCLUDED>,
    /// `S_EE`, padded by an identity; its lower triangle.
    projection: Matrix3<T>,
    /// `S_EE⁻¹`, padded by zeros; its lower triangle.
    inverse: Matrix3<T>,
    /// `S_EE⁻¹ r_E`, padded by zeros.
    solved: Vector3<T>,
    explained: T,
}

// One row or column of the three-by-three blocks for each row of a set.
const _: () = assert!(MAX_EXCLUDED == 3);

impl<T: Real> Default for ExclusionSet<T> {
    fn default() -> Self {
        Self::none()
    }
}

impl<T: Real> ExclusionSet<T> {
    /// Returns the empty set.
    pub fn none() -> Self {
        Self {
            rows: Vec::new(),
            projection: identity(),
            inverse: zeros(),
            solved: zero(),
            explained: T::zero(),
        }
    }

    /// Returns the set of these rows of a snapshot, or `None` if it is refused, or a row is not
    /// testable or listed twice.
    pub fn of<const N: usize>(snapshot: &Snapshot<'_, T, N>, set: &[usize]) -> Option<Self> {
        let mut rows = NormalisedRows::<T, N>::new();
        testable_rows(snapshot, &mut rows);
        Self::among(&rows, set)
    }

    /// Returns the set of those of `rows` that have these indices, or `None` as for [`Self::of`].
    pub fn among(rows: &[NormalisedRow<T>], set: &[usize]) -> Option<Self> {
        let mut removal = Self::none();
        for &index in set {
            removal.grow(rows.iter().find(|row| row.index == index)?)?;
        }
        Some(removal)
    }

    /// Returns the set with one more row, or `None` if it is refused or full.
    pub fn and(&self, row: &NormalisedRow<T>) -> Option<Self> {
        let mut larger = self.clone();
        larger.grow(row)?;
        Some(larger)
    }

    /// Adds one row to the set. Returns `None` without a change if the row is refused or the set is
    /// full.
    // In place and not inlined, because a set is large and several of one search would be on the
    // stack at once.
    #[inline(never)]
    pub(crate) fn grow(&mut self, row: &NormalisedRow<T>) -> Option<()> {
        let couplings = self.couplings(row);
        let (gains, left) = self.left_to(row, &couplings);
        let mut unit = [T::zero(); MAX_EXCLUDED];
        *unit.get_mut(self.rows.len())? = T::one();
        let unit = Vector3::from(unit);
        let mut projection = self.projection;
        add_outer_product(&mut projection, &unit, &couplings);
        add_outer_product(&mut projection, &unit, &scaled(row.redundancy - T::one(), &unit));
        // The smaller set passed: by interlacing only one eigenvalue can be below the bound, and
        // the sign of the determinant decides.
        let mut shifted = projection;
        shifted.m11 -= T::UNTESTABLE;
        shifted.m22 -= T::UNTESTABLE;
        shifted.m33 -= T::UNTESTABLE;
        if !(symmetric_determinant(&shifted) > T::zero() && left.redundancy > T::zero()) {
            return None;
        }
        self.rows.push(*row).ok()?;
        let direction = difference(&gains, &unit);
        let bias = left.residual / left.redundancy;
        self.projection = projection;
        add_outer_square(&mut self.inverse, &direction, left.redundancy);
        self.solved = difference(&self.solved, &scaled(bias, &direction));
        self.explained += left.residual * bias;
        Some(())
    }

    /// Returns the squared w-test of a row without this set: the decrease of SSE if the row is left
    /// out too.
    ///
    /// 0 if no redundancy is left.
    pub fn explains_more(&self, row: &NormalisedRow<T>) -> T {
        let (_, left) = self.left_to(row, &self.couplings(row));
        squared_w_test(left.residual, left.redundancy)
    }

    /// Returns `S_Ek`, padded by zeros.
    fn couplings(&self, row: &NormalisedRow<T>) -> Vector3<T> {
        let mut couplings = [T::zero(); MAX_EXCLUDED];
        for (slot, member) in couplings.iter_mut().zip(&self.rows) {
            *slot = member.projection(row);
        }
        couplings.into()
    }

    /// Returns `u`, and what remains of a row without this set.
    fn left_to(&self, row: &NormalisedRow<T>, couplings: &Vector3<T>) -> (Vector3<T>, Remainder<T>) {
        let gains = symmetric_product(&self.inverse, couplings);
        let left = Remainder {
            redundancy: row.redundancy - dot(couplings, &gains),
            residual: row.residual - dot(couplings, &self.solved),
        };
        (gains, left)
    }

    /// Returns the rows of the set, in the order they were added.
    pub fn rows(&self) -> &[NormalisedRow<T>] {
        &self.rows
    }

    /// Returns the decrease of SSE without the set, dimensionless.
    pub fn explained(&self) -> T {
        self.explained
    }

    /// Returns the SSE of the remaining rows, summed from their residuals.
    ///
    /// `SSE − explained` would cancel in `f32` after a fault of some kilometres.
    pub fn sse(&self, rows: &[NormalisedRow<T>]) -> T {
        let stays = |row: &&NormalisedRow<T>| self.rows.iter().all(|member| member.index != row.index);
        rows.iter().filter(stays).fold(T::zero(), |sum, row| {
            let residual = row.residual - dot(&self.couplings(row), &self.solved);
            sum + residual * residual
        })
    }

    /// Returns degrees of freedom without the set.
    pub fn dof<const N: usize>(&self, snapshot: &Snapshot<'_, T, N>) -> usize {
        snapshot.dof().saturating_sub(self.rows.len())
    }

    /// Returns correction of the position without the set, east, north, up, m.
    pub fn correction<const N: usize>(&self, snapshot: &Snapshot<'_, T, N>) -> Vector3<T> {
        difference(&snapshot.correction(), &product(&self.gains(), &self.solved))
    }

    /// Returns covariance of that correction, m².
    pub fn covariance<const N: usize>(&self, snapshot: &Snapshot<'_, T, N>) -> Matrix3<T> {
        let gains = self.gains();
        let mut inverse = self.inverse;
        mirror(&mut inverse);
        let grown = matrix_product(&matrix_product(&gains, &inverse), &gains.transpose());
        matrix_sum(snapshot.covariance(), &grown)
    }

    /// Returns `A_E`: one column for each row of the set, padded by zeros.
    fn gains(&self) -> Matrix3<T> {
        let mut gains = [zero(); MAX_EXCLUDED];
        for (column, row) in gains.iter_mut().zip(&self.rows) {
            *column = row.gain;
        }
        of_columns(&gains)
    }
}

/// Remainder of a row without a set.
struct Remainder<T> {
    redundancy: T,
    residual: T,
}
