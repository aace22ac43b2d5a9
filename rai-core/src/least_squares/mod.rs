//! Weighted least squares of one linearised epoch by a single 3×3 solve.
//!
//! Each range depends on exactly one receiver clock, so that centring the rows of each
//! constellation eliminates the columns of the clocks. Let `h̄_c`, `ȳ_c` be the weighted means over
//! the rows of constellation `c`, and `W_c = Σ w_i` their weight. Then
//!
//! ```text
//! d_i = h_i − h̄_c      z_i = y_i − ȳ_c
//! N   = Σ w_i d_i d_iᵀ  P   = N⁻¹            x = P Σ w_i d_i z_i        b_c = ȳ_c − h̄_c·x
//! v_i = z_i − d_i·x     g_i = P d_i          r_i = 1 − w_i (1/W_c + d_i·g_i)
//! SSE = Σ w_i v_i²      dof = n − 3 − C
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `x` | [`Snapshot::correction`] east, north, up | m |
//! | `P` | [`Snapshot::covariance`] | m² |
//! | `v_i` | [`RowFit::residual`] | m |
//! | `g_i` | [`RowFit::gain`] (`w_i g_i` is the row of the least-squares gain) | m² |
//! | `r_i = S_ii` | [`RowFit::redundancy`] number, 0 untestable … 1 fully tested | – |
//! | `w_i / r_i` | [`RowFit::test_weight`] | 1/m² |
//! | `SSE` | [`Snapshot::sse`] | – |
//!
//! Up to rounding, `x`, `v`, `S` and the gain equal those of least squares with 3 + C columns.
//! Centring also makes `f32` sufficient, because it removes the clocks, which can be large.
//!
//! A row of weight 0 is left out. It contributes nothing and keeps its index. Its residual is the
//! range minus the prediction from the other rows. No n×n matrix is stored;
//! [`Snapshot::projection`] computes `S_ij` on demand.
//!
//! A [`Workspace`] owns the memory of the equations and lends it as a [`Snapshot`], which is always
//! solved. If rows are left out or taken back, its solution is updated.
//!
//! | module | content |
//! |---|---|
//! | [`equations`] | the linearised epoch |
//! | [`fix`] | Gauss–Newton on an epoch |
//! | [`downdate`] | the solution without a set of rows |
//! | [`Excludable`] | the interface of all searches |
//!
//! Cost on a Cortex-M4F in `f32`, for 20 satellites of two constellations: 2,900 instructions for a
//! solve with all quantities that its tests need, 1,800 for leaving one more row out. References:
//! [Baarda1968] for the redundancy numbers; the elimination of nuisance columns is the
//! Frisch–Waugh–Lovell theorem.
//!
//! [Baarda1968]: crate#references

use core::fmt;

use nalgebra::{Matrix3, Vector3};

use crate::bit_set::{bit, members};
use crate::least_squares::equations::{MAX_ROWS, References, Row};
use crate::numeric::absolute::Absolute;
use crate::numeric::real::Real;
use crate::numeric::space::{dot, product, zero};
use crate::satellite::Constellation;

pub(crate) mod curvature;
pub mod downdate;
pub mod equations;
mod excludable;
pub mod fix;
mod means;
mod solve;
mod statistics;
mod workspace;

pub use excludable::Excludable;
pub(crate) use solve::{Estimate, infinity, invert};
pub(crate) use statistics::{SquaredSlopes, Statistics, Worst, larger};
pub use workspace::Workspace;

use solve::Geometry;

/// Reason why an epoch has no position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SnapshotError {
    /// Fewer rows than unknowns.
    Insufficient,
    /// The rows do not determine the unknowns.
    Singular,
}

impl fmt::Display for SnapshotError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Insufficient => "fewer ranges than unknowns",
            Self::Singular => "geometry is singular",
        })
    }
}

impl core::error::Error for SnapshotError {}

/// Fit of one row: how it compares with the solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowFit<T: Real> {
    /// Centred design row `d_i`.
    pub centred: Vector3<T>,
    /// Gain `g_i = P d_i`, m².
    pub gain: Vector3<T>,
    /// Residual `v_i`, m.
    pub residual: T,
    /// Redundancy number `r_i`, dimensionless: the share of a row's bias that its own residual
    /// shows.
    pub redundancy: T,
    /// `w_i / r_i`, 1/m². Multiplied by it, a squared residual becomes the squared w-test, and a
    /// squared gain the squared slope.
    ///
    /// 0 for a row that cannot be tested or is left out.
    pub test_weight: T,
}

impl<T: Real> RowFit<T> {
    /// Returns the w-test of the row, dimensionless; 0 if the row is untestable or left out.
    pub fn w_test(&self) -> T {
        self.residual * self.test_weight.sqrt_approx()
    }

    /// Returns the squared w-test, which needs no root. It is the decrease of SSE if the row is
    /// left out.
    pub fn w_squared(&self) -> T {
        self.residual * self.residual * self.test_weight
    }

    /// Returns the fit of a row that is not solved yet.
    fn nothing() -> Self {
        Self {
            centred: zero(),
            gain: zero(),
            residual: T::zero(),
            redundancy: T::zero(),
            test_weight: T::zero(),
        }
    }
}

/// A solved view of a [`Workspace`], derived from one 3×3 solve. `N` is the capacity of the
/// workspace. Every search in the view needs memory for at most `N` rows.
#[derive(Debug, PartialEq)]
pub struct Snapshot<'w, T: Real, const N: usize = MAX_ROWS> {
    rows: &'w mut [Row<T>],
    references: &'w mut References<T>,
    fits: &'w mut [RowFit<T>],
    solved: &'w mut Solved<T>,
}

/// The solution of rows whose fits are written.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Solved<T: Real> {
    estimate: Estimate<T>,
    statistics: Statistics<T>,
}

impl<T: Real> Solved<T> {
    /// Returns a solution without rows.
    fn none() -> Self {
        Self { estimate: Estimate::none(), statistics: Statistics::none() }
    }

    /// Solves the rows once and fits each of them. On error the contents are unspecified.
    fn solve(&mut self, rows: &[Row<T>], fits: &mut [RowFit<T>]) -> Result<(), SnapshotError> {
        self.estimate.solve(rows.iter())?;
        self.fit_all(rows, fits);
        Ok(())
    }

    /// Fits each row.
    fn fit_all(&mut self, rows: &[Row<T>], fits: &mut [RowFit<T>]) {
        self.statistics = self.estimate.fit_all(rows, fits);
    }
}

impl<T: Real, const N: usize> Snapshot<'_, T, N> {
    /// Leaves one more row out, in place: by a downdate of the solution, or by solving again if a
    /// downdate would lose precision.
    ///
    /// # Errors
    /// As [`Workspace::solve`]; the snapshot is then unchanged.
    pub fn leave_out(&mut self, index: usize) -> Result<(), SnapshotError> {
        if let (Some(row), Some(fit)) = (self.rows.get_mut(index), self.fits.get(index))
            && self.solved.estimate.leave_out(row, fit)
        {
            row.leave_out();
            self.solved.fit_all(self.rows, self.fits);
            return Ok(());
        }
        self.reduce(bit(index))
    }

    /// Takes a left-out row back and solves again, in place.
    ///
    /// # Errors
    /// As [`Workspace::solve`]; the snapshot is then unchanged.
    pub fn take_back(&mut self, index: usize) -> Result<(), SnapshotError> {
        self.restore(bit(index))
    }

    /// Leaves the rows of a set out, all at once.
    pub(crate) fn reduce(&mut self, rows: u64) -> Result<(), SnapshotError> {
        self.change(rows, Row::leave_out, Row::take_back)
    }

    /// Takes the rows of a set back, all at once.
    pub(crate) fn restore(&mut self, rows: u64) -> Result<(), SnapshotError> {
        self.change(rows, Row::take_back, Row::leave_out)
    }

    /// Changes rows and solves again; on failure restores the rows that were solved before.
    #[inline(never)]
    fn change(
        &mut self,
        rows: u64,
        change: fn(&mut Row<T>),
        change_back: fn(&mut Row<T>),
    ) -> Result<(), SnapshotError> {
        self.each(rows, change);
        let solved = self.solve_again();
        if solved.is_err() {
            self.each(rows, change_back);
            let _ = self.solve_again();
        }
        solved
    }

    fn each(&mut self, rows: u64, change: fn(&mut Row<T>)) {
        for index in members(rows) {
            if let Some(row) = self.rows.get_mut(index) {
                change(row);
            }
        }
    }

    /// Solves the rows once as they are now.
    fn solve_again(&mut self) -> Result<(), SnapshotError> {
        self.solved.solve(self.rows, self.fits)
    }

    /// Overwrites all equations by rows relative to `references`, and solves them. The number of
    /// rows stays the same.
    ///
    /// # Errors
    /// As [`Workspace::solve`], and [`SnapshotError::Singular`] if `write` stops early. The fits of
    /// the new rows are then unspecified, so that the caller must write again.
    pub(crate) fn rewrite(
        &mut self,
        references: References<T>,
        write: impl FnOnce(&mut References<T>, &mut dyn FnMut(Row<T>) -> Option<()>) -> Option<()>,
    ) -> Result<(), SnapshotError> {
        *self.references = references;
        let mut slots = self.rows.iter_mut();
        let written = write(self.references, &mut |row| {
            *slots.next()? = row;
            Some(())
        });
        written.ok_or(SnapshotError::Singular)?;
        self.solve_again()
    }

    /// Returns the equations, left-out ones included.
    pub fn equations(&self) -> &[Row<T>] {
        self.rows
    }

    /// Returns the reference of a constellation's residuals, m, or `None` if it has no row.
    pub fn reference_m(&self, constellation: Constellation) -> Option<f64> {
        self.references.of(constellation).map(Absolute::widen)
    }

    /// Iterates over the equations with their fits, left-out ones included.
    pub fn rows(&self) -> impl Iterator<Item = (&Row<T>, &RowFit<T>)> {
        self.rows.iter().zip(self.fits.iter())
    }

    /// Returns the fit of each row, in their order.
    pub fn fits(&self) -> &[RowFit<T>] {
        self.fits
    }

    /// Returns one row with its fit.
    pub fn row(&self, index: usize) -> Option<(&Row<T>, &RowFit<T>)> {
        self.rows.get(index).zip(self.fits.get(index))
    }

    /// Returns the correction of the position, east, north, up, m.
    pub fn correction(&self) -> Vector3<T> {
        self.solved.estimate.correction
    }

    /// Returns the covariance of the correction, m².
    pub fn covariance(&self) -> &Matrix3<T> {
        &self.solved.estimate.covariance
    }

    /// Returns the weighted sum of squared residuals, dimensionless.
    pub fn sse(&self) -> T {
        self.solved.statistics.sse
    }

    /// Returns the statistics of all rows.
    pub(crate) fn statistics(&self) -> &Statistics<T> {
        &self.solved.statistics
    }

    /// Returns the number of rows that take part.
    pub fn used(&self) -> usize {
        self.solved.estimate.used
    }

    /// Returns the degrees of freedom: the number of rows that take part, minus 3, minus the number
    /// of their clocks.
    pub fn dof(&self) -> usize {
        self.solved.estimate.dof
    }

    /// Returns the receiver clock of a constellation times the speed of light, m, or `None` if no
    /// row of it takes part.
    // Not inlined, so that its many callers share one copy.
    #[inline(never)]
    pub fn clock_m(&self, constellation: Constellation) -> Option<f64> {
        Some(self.reference_m(constellation)? + self.relative_clock(constellation)?.widen())
    }

    /// Returns a clock minus its reference, m.
    fn relative_clock(&self, constellation: Constellation) -> Option<T> {
        let group = self.solved.estimate.groups.of_clock(constellation)?;
        Some(group.residual() - dot(&group.design(), &self.solved.estimate.correction))
    }

    /// Returns true if a clock is farther from its reference than `limit_m`, so that residuals lose
    /// digits.
    pub(crate) fn is_far_from_references(&self, limit_m: f64) -> bool {
        let limit = T::narrow(limit_m);
        let clocks = Constellation::ALL.into_iter().filter_map(|clock| self.relative_clock(clock));
        // NaN is far as well.
        clocks.into_iter().any(|relative| !(relative.abs() <= limit))
    }

    /// Returns the clocks of the rows that take part, as references for equations about a nearby
    /// point.
    ///
    /// The first residual of a constellation is unsuitable. It may be wrong by 100,000 km, and it
    /// stays the reference even if its row is left out. Subtracting it would leave residuals so
    /// large that `f32` cannot resolve metres.
    // Not inlined, so that it adds nothing to the stack of the solve that follows.
    #[inline(never)]
    pub(crate) fn clocks_as_references(&self) -> References<T> {
        let mut clocks = References::none();
        for constellation in Constellation::ALL {
            let relative = self.relative_clock(constellation);
            if let (Some(reference), Some(relative)) = (self.references.of(constellation), relative)
                && relative.is_finite()
            {
                clocks.keep(constellation, reference.less(T::Absolute::of(-relative.widen())));
            }
        }
        clocks
    }

    /// Returns true if a row of a constellation takes part, so that its clock is determined.
    pub fn determines(&self, constellation: Constellation) -> bool {
        self.solved.estimate.determines(constellation)
    }

    /// Returns the variance of [`Self::clock_m`], m²: `1/W_c + h̄_c P h̄_cᵀ`.
    pub fn clock_variance(&self, constellation: Constellation) -> Option<T> {
        let group = self.solved.estimate.groups.of_clock(constellation)?;
        let gain = product(&self.solved.estimate.covariance, &group.design());
        Some(group.variance + dot(&group.design(), &gain))
    }

    /// Returns the variance `1/W_c`, m², that the clock of a row would have if the position were
    /// known; 0 if no row determines it.
    pub fn level_variance(&self, row: &Row<T>) -> T {
        self.solved.estimate.level_variance(row)
    }

    /// Returns element `S_ij` of the matrix that projects normalised ranges on normalised
    /// residuals, or `None` outside the epoch.
    pub fn projection(&self, i: usize, j: usize) -> Option<T> {
        let (row_i, fit_i) = self.row(i)?;
        let (row_j, fit_j) = self.row(j)?;
        if i == j {
            return Some(fit_i.redundancy);
        }
        let shared = match (row_i.clock, row_j.clock) {
            (Some(a), Some(b)) if a == b => self.level_variance(row_i),
            _ => T::zero(),
        };
        Some(-(row_i.weight * row_j.weight).sqrt_approx() * (shared + dot(&fit_i.centred, &fit_j.gain)))
    }

    /// Returns the horizontal and vertical dilution of precision of the unweighted geometry,
    /// dimensionless.
    pub fn dilutions(&self) -> (T, T) {
        // A solved geometry is not singular, so that the default is never used.
        let geometry = Geometry::of(self.rows.iter());
        let covariance = geometry.map_or(self.solved.estimate.covariance, |geometry| geometry.covariance);
        ((covariance.m11 + covariance.m22).sqrt_approx(), covariance.m33.sqrt_approx())
    }

    /// Returns HDOP without one row: `√(HDOP² + (A_1i² + A_2i²)/S_ii)` of the unweighted geometry
    /// ([Lin2016] eq. 22).
    ///
    /// If the row is its constellation's only one, its clock disappears with it, and HDOP does not
    /// change. If the geometry is singular without the row, HDOP is infinite. `None` for a row that
    /// takes no part.
    ///
    /// [Lin2016]: crate#references
    pub fn hdop_without(&self, index: usize) -> Option<T> {
        let (row, _) = self.row(index).filter(|(row, _)| row.weight > T::zero())?;
        Some(Geometry::of(self.rows.iter()).ok()?.hdop_without(row))
    }
}
