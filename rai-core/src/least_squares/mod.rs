//! The snapshot: weighted least squares of one linearised epoch by a single 3×3 solve.
//!
//! Each range touches exactly one receiver clock, so clocks need no columns: centring the rows of each
//! constellation eliminates them. With the weighted means `h̄_c`, `ȳ_c` over the rows of constellation `c`
//! (`W_c = Σ w_i`),
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
//! | `v_i` | [`Fit::residual`] | m |
//! | `g_i` | [`Fit::gain`] (`w_i g_i` is the row of the least-squares gain) | m² |
//! | `r_i = S_ii` | [`Fit::redundancy`] number, 0 untestable … 1 fully tested | – |
//! | `w_i / r_i` | [`Fit::test_weight`] | 1/m² |
//! | `SSE` | [`Snapshot::sse`] | – |
//!
//! Equal to least squares with 3 + C columns in `x`, `v`, `S` and the gain, to rounding. Centring is also what makes
//! `f32` safe: the clocks and their size are gone.
//!
//! A row of weight 0 is left out: it contributes nothing, keeps its index, and its residual is that of a prediction.
//! No n×n matrix is stored; [`Snapshot::projection`] gives `S_ij` on demand.
//!
//! A [`Workspace`] is the memory: it holds equations, and lends them solved. A [`Snapshot`] is what it lends; rows can be
//! left out of it and taken back, and it is solved at any time.
//!
//! Cost on a Cortex-M4F in `f32`, for 20 satellites of two constellations: 2,900 instructions for a solve with all that its
//! tests need, 1,800 to leave a row out of it. References: [Baarda1968] for the redundancy numbers; the elimination of nuisance
//! columns is the Frisch–Waugh–Lovell theorem.
//!
//! [Baarda1968]: crate#references

use core::fmt;

use nalgebra::{Matrix3, Vector3};

use crate::least_squares::equations::{References, Row};
use crate::numeric::absolute::Absolute;
use crate::numeric::real::Real;
use crate::numeric::space::{dot, product, zero};
use crate::satellite::Constellation;

pub mod downdate;
pub mod equations;
mod excludable;
pub mod fix;
mod solve;
mod statistics;
mod workspace;

pub use excludable::Excludable;
pub(crate) use solve::{Solution, infinity, invert};
pub(crate) use statistics::{SquaredSlopes, Statistics, Worst, larger};
pub use workspace::Workspace;

use solve::Geometry;

/// Why an epoch has no position.
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

/// What the solution says of one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit<T: Real> {
    /// Centred design row `d_i`.
    pub centred: Vector3<T>,
    /// `g_i = P d_i`, m².
    pub gain: Vector3<T>,
    /// Residual `v_i`, m.
    pub residual: T,
    /// Redundancy number `r_i`: the share of a bias that shows in the row's own residual.
    pub redundancy: T,
    /// `w_i / r_i`, 1/m², by which squared residuals become squared w-tests and squared gains squared slopes; 0 for a
    /// row that cannot be tested, and for one that is left out.
    pub test_weight: T,
}

impl<T: Real> Fit<T> {
    /// The w-test of the row, dimensionless; 0 where the row is untestable or left out.
    pub fn w_test(&self) -> T {
        self.residual * self.test_weight.sqrt()
    }

    /// The w-test squared, without the root: the decrease of SSE when the row is left out.
    pub fn w_squared(&self) -> T {
        self.residual * self.residual * self.test_weight
    }

    /// Of a row about which nothing has been said.
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

/// Equations that are solved: a view of a [`Workspace`], everything in it derived from one 3×3 solve.
#[derive(Debug, PartialEq)]
pub struct Snapshot<'w, T: Real> {
    rows: &'w mut [Row<T>],
    references: &'w mut References<T>,
    fits: &'w mut [Fit<T>],
    solved: &'w mut Solved<T>,
}

/// The solution of rows whose fits are written.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Solved<T: Real> {
    solution: Solution<T>,
    statistics: Statistics<T>,
}

impl<T: Real> Solved<T> {
    /// Of no rows.
    fn none() -> Self {
        Self { solution: Solution::none(), statistics: Statistics::none() }
    }

    /// One solve over the rows, and what it says of each. Unless it succeeds, what is there then is of no use.
    fn solve(&mut self, rows: &[Row<T>], fits: &mut [Fit<T>]) -> Result<(), SnapshotError> {
        self.solution.solve(rows.iter())?;
        self.fit_all(rows, fits);
        Ok(())
    }

    /// Says of each row what the solution says of it.
    fn fit_all(&mut self, rows: &[Row<T>], fits: &mut [Fit<T>]) {
        self.statistics = self.solution.fit_all(rows, fits);
    }
}

impl<T: Real> Snapshot<'_, T> {
    /// Leaves one more row out, in place: by algebra on the solution, or solves again where that would cost digits.
    ///
    /// # Errors
    /// As [`Workspace::solve`]; the snapshot is then unchanged.
    pub fn leave_out(&mut self, index: usize) -> Result<(), SnapshotError> {
        if let (Some(row), Some(fit)) = (self.rows.get_mut(index), self.fits.get(index))
            && self.solved.solution.leave_out(row, fit)
        {
            row.leave_out();
            self.solved.fit_all(self.rows, self.fits);
            return Ok(());
        }
        self.reduce([index])
    }

    /// Takes a left-out row back and solves again, in place.
    ///
    /// # Errors
    /// As [`Workspace::solve`]; the snapshot is then unchanged.
    pub fn take_back(&mut self, index: usize) -> Result<(), SnapshotError> {
        self.restore([index])
    }

    /// Leaves rows out, all at once.
    pub(crate) fn reduce(
        &mut self,
        rows: impl IntoIterator<Item = usize> + Clone,
    ) -> Result<(), SnapshotError> {
        self.change(rows, Row::leave_out, Row::take_back)
    }

    /// Takes rows back, all at once.
    pub(crate) fn restore(
        &mut self,
        rows: impl IntoIterator<Item = usize> + Clone,
    ) -> Result<(), SnapshotError> {
        self.change(rows, Row::take_back, Row::leave_out)
    }

    /// Changes rows and solves again; where that fails, changes them back to what has been solved before.
    #[inline(never)]
    fn change(
        &mut self,
        rows: impl IntoIterator<Item = usize> + Clone,
        change: fn(&mut Row<T>),
        change_back: fn(&mut Row<T>),
    ) -> Result<(), SnapshotError> {
        self.each(rows.clone(), change);
        let solved = self.solve_again();
        if solved.is_err() {
            self.each(rows, change_back);
            let _ = self.solve_again();
        }
        solved
    }

    fn each(&mut self, rows: impl IntoIterator<Item = usize>, change: impl Fn(&mut Row<T>)) {
        for index in rows {
            if let Some(row) = self.rows.get_mut(index) {
                change(row);
            }
        }
    }

    /// One 3×3 solve over the rows as they stand now.
    fn solve_again(&mut self) -> Result<(), SnapshotError> {
        self.solved.solve(self.rows, self.fits)
    }

    /// Writes the equations anew, as many as there are, and solves them.
    ///
    /// # Errors
    /// As [`Workspace::solve`], and [`SnapshotError::Singular`] where `write` gives up. The rows are then those written, and
    /// what is said of them is not theirs: the caller must write others.
    pub(crate) fn rewrite(
        &mut self,
        write: impl FnOnce(&mut References<T>, &mut dyn FnMut(Row<T>) -> Option<()>) -> Option<()>,
    ) -> Result<(), SnapshotError> {
        *self.references = References::none();
        let mut slots = self.rows.iter_mut();
        let written = write(self.references, &mut |row| {
            *slots.next()? = row;
            Some(())
        });
        written.ok_or(SnapshotError::Singular)?;
        self.solve_again()
    }

    /// The equations, left-out ones included.
    pub fn equations(&self) -> &[Row<T>] {
        self.rows
    }

    /// What the equations' residuals are relative to, m; `None` where a constellation has no row.
    pub fn reference_m(&self, constellation: Constellation) -> Option<f64> {
        self.references.of(constellation).map(Absolute::widen)
    }

    /// The equations, left-out ones included, each with what the solution says of it.
    pub fn rows(&self) -> impl Iterator<Item = (&Row<T>, &Fit<T>)> {
        self.rows.iter().zip(self.fits.iter())
    }

    /// What the solution says of each row, in their order.
    pub fn fits(&self) -> &[Fit<T>] {
        self.fits
    }

    /// One row with what the solution says of it.
    pub fn row(&self, index: usize) -> Option<(&Row<T>, &Fit<T>)> {
        self.rows.get(index).zip(self.fits.get(index))
    }

    /// Correction of the position, east, north, up, m.
    pub fn correction(&self) -> Vector3<T> {
        self.solved.solution.correction
    }

    /// Covariance of the correction, m².
    pub fn covariance(&self) -> &Matrix3<T> {
        &self.solved.solution.covariance
    }

    /// Weighted sum of squared residuals, dimensionless.
    pub fn sse(&self) -> T {
        self.solved.statistics.sse
    }

    /// What the rows say together.
    pub(crate) fn statistics(&self) -> &Statistics<T> {
        &self.solved.statistics
    }

    /// Rows that take part.
    pub fn used(&self) -> usize {
        self.solved.solution.used
    }

    /// Degrees of freedom: rows that take part, less 3, less the clocks among them.
    pub fn dof(&self) -> usize {
        self.solved.solution.dof
    }

    /// Receiver clock of a constellation times the speed of light, m; `None` where it has no row that takes part.
    pub fn clock_m(&self, constellation: Constellation) -> Option<f64> {
        let group = self.solved.solution.groups.of_clock(constellation)?;
        let relative = group.residual - dot(&group.design, &self.solved.solution.correction);
        Some(self.reference_m(constellation)? + relative.widen())
    }

    /// True where a constellation has a row that takes part, and so a clock.
    pub fn determines(&self, constellation: Constellation) -> bool {
        self.solved.solution.determines(constellation)
    }

    /// Variance of [`Self::clock_m`], m²: `1/W_c + h̄_c P h̄_cᵀ`.
    pub fn clock_variance(&self, constellation: Constellation) -> Option<T> {
        let group = self.solved.solution.groups.of_clock(constellation)?;
        let gain = product(&self.solved.solution.covariance, &group.design);
        Some(group.variance + dot(&group.design, &gain))
    }

    /// Variance `1/W_c` of the clock that a row touches, the position known, m²; 0 where no row determines it.
    pub fn level_variance(&self, row: &Row<T>) -> T {
        self.solved.solution.level_variance(row)
    }

    /// Element `S_ij` of the matrix that projects ranges on normalised residuals; `None` outside the epoch.
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
        Some(-(row_i.weight * row_j.weight).sqrt() * (shared + dot(&fit_i.centred, &fit_j.gain)))
    }

    /// Horizontal and vertical dilution of precision, dimensionless, of the unweighted geometry.
    pub fn dilutions(&self) -> (T, T) {
        // What was solved is not singular: the fall-back is never taken.
        let geometry = Geometry::of(self.rows.iter());
        let covariance = geometry.map_or(self.solved.solution.covariance, |geometry| geometry.covariance);
        ((covariance.m11 + covariance.m22).sqrt(), covariance.m33.sqrt())
    }

    /// HDOP without one row: `√(HDOP² + (A_1i² + A_2i²)/S_ii)` of the unweighted geometry ([Lin2016] eq. 22).
    ///
    /// The lone satellite of a constellation takes its clock with it and changes nothing; a row without which the
    /// geometry is singular gives infinity. `None` for a row that takes no part.
    ///
    /// [Lin2016]: crate#references
    pub fn hdop_without(&self, index: usize) -> Option<T> {
        let (row, _) = self.row(index).filter(|(row, _)| row.weight > T::zero())?;
        Some(Geometry::of(self.rows.iter()).ok()?.hdop_without(row))
    }
}
