//! Downdate: the solution of a snapshot without a set of rows, derived from the solution with all
//! rows.
//!
//! Let `u_i = √w_i v_i` be the normalised residuals and `A_i = √w_i g_i` the gains. `S_EE` is the
//! block of the projection matrix that belongs to the set `E`. Then
//!
//! ```text
//! S_ij  = δ_ij − (√w_i d_i)·(√w_j g_j) − [c_i = c_j] √(w_i/W_c) √(w_j/W_c)
//! SSE_E = SSE − u_Eᵀ S_EE⁻¹ u_E        dof_E = dof − |E|
//! x_E   = x − A_E S_EE⁻¹ u_E           P_E   = P + A_E S_EE⁻¹ A_Eᵀ
//! u'_i  = u_i − S_iE S_EE⁻¹ u_E        (residual of a row that stays)
//! ```
//!
//! A set grows row by row. Let `s = S_Ek` and `m = S_EE⁻¹ s`. Without `E`, row `k` has the
//! redundancy `p = S_kk − s·m` and the residual `q = u_k − u_E·m`. Then
//!
//! ```text
//! S_E'E'⁻¹ = S_EE⁻¹ + t tᵀ / p,   t = (m, −1)        explained' = explained + q²/p
//! ```
//!
//! Each row thus costs one division, and the squared w-test of `k` without `E` is `q²/p`.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `u_i` | [`NormalisedRow::residual`] | – |
//! | `S_ii` | [`NormalisedRow::redundancy`] | – |
//! | `u_Eᵀ S_EE⁻¹ u_E` | [`ExclusionSet::explained`] | – |
//! | `x_E`, `P_E` | [`ExclusionSet::correction`], [`ExclusionSet::covariance`] | m, m² |
//!
//! A set is refused if the smallest eigenvalue of `S_EE` is below [`Real::UNTESTABLE`]: its rows
//! then cannot be distinguished, or are needed for a position. This includes every set that empties
//! a constellation.
//!
//! A search over pairs with the same third row `k` first projects `k` out of all other rows
//! (`ReducedRow::without`). With `a_i = S_ik/√S_kk` each row then has the residual
//! `u_i − a_i u_k/√S_kk` and the products `S_ij − a_i a_j`.
//!
//! In parity space `S_ij = p_i·p_j` and `u_i = p·p_i`. The rows here therefore represent the parity
//! vectors, up to a rotation that changes no test. No n×n matrix is stored. Each row takes 48 bytes
//! in `f32`, and another 16 while triples are compared. Each `S_ij` takes about 10 instructions.
//!
//! A downdate keeps the linearisation point. If it is far from the new position, solve again
//! without the set before the position is used.

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

/// A row in units of its sigma, with the terms for its products with other rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalisedRow<T: Real> {
    /// Index in the epoch.
    pub index: usize,
    /// `u_i`, dimensionless.
    pub residual: T,
    /// `S_ii`, dimensionless.
    pub redundancy: T,
    coupling_terms: CouplingTerms<T>,
    gain: Vector3<T>,
    /// `1/σ_i`.
    root: T,
}

/// Terms of a row for its products with many others.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CouplingTerms<T: Real> {
    /// `√w_i d_i`.
    design: Vector3<T>,
    /// `1/(σ_i W_c)`. Multiplied by `√w_j` of another row of the clock, it is the clock term of
    /// `S_ij`. 0 without a clock.
    level: T,
    /// Number of its clock, or [`NO_CLOCK`]. Comparing two rows thus takes one comparison of bytes.
    clock: u8,
}

/// Number beyond every constellation.
const NO_CLOCK: u8 = u8::MAX;

impl<T: Real> CouplingTerms<T> {
    /// Returns `S_ij` of two rows, minus the product `a_i a_j` for a row that was projected out.
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

/// A row in the comparison of sets: as in the snapshot, or with another row projected out.
///
/// It stores only the differences to the row, because there is one for each row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReducedRow<'r, T: Real> {
    row: &'r NormalisedRow<T>,
    residual: T,
    redundancy: T,
    /// `a_i` of the row that was projected out, 0 without one.
    projected: T,
}

/// One reduced row for each row.
pub(crate) type ReducedRows<'r, T, const N: usize> = Vec<ReducedRow<'r, T>, N>;

impl<'r, T: Real> ReducedRow<'r, T> {
    /// Returns the row as in the snapshot.
    pub(crate) fn of(row: &'r NormalisedRow<T>) -> Self {
        Self { row, residual: row.residual, redundancy: row.redundancy, projected: T::zero() }
    }

    /// Returns the row with another row projected out.
    ///
    /// `root` is the square root of the other row's redundancy, computed once for all rows.
    pub(crate) fn without(row: &'r NormalisedRow<T>, gone: &NormalisedRow<T>, root: T) -> Self {
        let projected = gone.projection(row) / root;
        Self {
            row,
            residual: row.residual - projected * gone.residual / root,
            redundancy: row.redundancy - projected * projected,
            projected,
        }
    }

    /// Returns the row with one more column of the design projected out, which is estimated
    /// together with the position.
    ///
    /// `projected` is the column's product with the row in parity space, `residual` that with the
    /// parity vector.
    pub(crate) fn beside(row: &'r NormalisedRow<T>, projected: T, residual: T) -> Self {
        let redundancy = row.redundancy - projected * projected;
        Self { row, residual: row.residual - projected * residual, redundancy, projected }
    }

    /// Returns the index in the epoch.
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

/// The first row of a pair, with the terms that are the same for all second rows. It is passed by
/// value, so that it stays in registers.
pub(crate) struct PairCandidate<T: Real> {
    coupling_terms: CouplingTerms<T>,
    /// `a_i`.
    projected: T,
    /// Decrease of SSE without this row and the earlier rows of the set.
    explained: T,
    /// Further decrease that a second row must reach for the set to reach the bar, minus rounding.
    lacking: T,
    /// `1/S_ii`.
    share: T,
    /// `u_i/S_ii`.
    bias: T,
}

impl<T: Real> PairCandidate<T> {
    /// Returns the terms of a row in a set whose earlier rows explain `explained`.
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
        // The margin exceeds all roundings of the comparison.
        let rounding = T::narrow(4.0) * T::default_epsilon() * bar;
        self.lacking = bar - self.explained - rounding;
    }

    /// Returns the decrease of SSE without the earlier rows, this row and another one. Returns
    /// `None` if it is surely below the bar; for nearly all sets a product shows this, without a
    /// division.
    pub(crate) fn explains_with(&self, other: &ReducedRow<'_, T>) -> Option<T> {
        let coupling = self.coupling_terms.coupling(other.row, self.projected * other.projected);
        let residual = other.residual - coupling * self.bias;
        let redundancy = other.redundancy - coupling * coupling * self.share;
        // NaN fails this comparison, so that the sum below is compared with the bar itself.
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
/// All other rows are untestable in every set. The caller provides the memory, because a returned
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
    /// Lower triangle of `S_EE`, padded by an identity.
    projection: Matrix3<T>,
    /// Lower triangle of `S_EE⁻¹`, padded by zeros.
    inverse: Matrix3<T>,
    /// `S_EE⁻¹ u_E`, padded by zeros.
    solved: Vector3<T>,
    explained: T,
}

// The blocks of a set are 3×3: one row and column for each of its rows.
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

    /// Returns the set of these rows of a snapshot. Returns `None` if the set is refused, or if a
    /// row is untestable or listed twice.
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
    // In place and not inlined, because a set is large, and a search would have several on the
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
        // All eigenvalues of the smaller set are above the bound. By interlacing only one of the
        // larger set can be below it, so that the sign of the determinant decides.
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

    /// Returns the squared w-test of a row without this set, which is the further decrease of SSE
    /// if the row is left out too.
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

    /// Returns `m`, and the remainder of a row without this set.
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
    /// After a fault of some kilometres `SSE − explained` would cancel in `f32`.
    pub fn sse(&self, rows: &[NormalisedRow<T>]) -> T {
        let stays = |row: &&NormalisedRow<T>| self.rows.iter().all(|member| member.index != row.index);
        rows.iter().filter(stays).fold(T::zero(), |sum, row| {
            let residual = row.residual - dot(&self.couplings(row), &self.solved);
            sum + residual * residual
        })
    }

    /// Returns the degrees of freedom without the set.
    pub fn dof<const N: usize>(&self, snapshot: &Snapshot<'_, T, N>) -> usize {
        snapshot.dof().saturating_sub(self.rows.len())
    }

    /// Returns the correction of the position without the set, east, north, up, m.
    pub fn correction<const N: usize>(&self, snapshot: &Snapshot<'_, T, N>) -> Vector3<T> {
        difference(&snapshot.correction(), &product(&self.gains(), &self.solved))
    }

    /// Returns the covariance of that correction, m².
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

/// Redundancy `p` and residual `q` of a row without a set.
struct Remainder<T> {
    redundancy: T,
    residual: T,
}
