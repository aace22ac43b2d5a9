//! Memory for equations and their fits. It lends them only if they are solved.

use heapless::Vec;
use nalgebra::Vector3;

use super::{RowFit, Snapshot, SnapshotError, Solved};
use crate::least_squares::equations::LinearEpoch;
use crate::numeric::real::Real;
use crate::numeric::space::dot;

/// Memory for at most `N` equations and their solution. It is reused from epoch to epoch, so that
/// nothing large is moved.
#[derive(Clone, Debug)]
pub struct Workspace<T: Real, const N: usize> {
    equations: LinearEpoch<T, N>,
    fits: Vec<RowFit<T>, N>,
    solved: Solved<T>,
}

impl<T: Real, const N: usize> Default for Workspace<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real, const N: usize> Workspace<T, N> {
    /// Returns a workspace without equations.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub fn new() -> Self {
        Self { equations: LinearEpoch::new(), fits: Vec::new(), solved: Solved::none() }
    }

    /// Returns a workspace that holds these equations.
    pub fn of(equations: LinearEpoch<T, N>) -> Self {
        Self { equations, fits: Vec::new(), solved: Solved::none() }
    }

    /// Returns the equations.
    pub fn equations(&self) -> &LinearEpoch<T, N> {
        &self.equations
    }

    /// Returns the equations, so that the caller can add or replace rows.
    pub fn equations_mut(&mut self) -> &mut LinearEpoch<T, N> {
        &mut self.equations
    }

    /// Solves the equations.
    ///
    /// # Errors
    /// [`SnapshotError::Insufficient`] if there are fewer rows than unknowns, or no rows;
    /// [`SnapshotError::Singular`] if the rows do not determine them.
    pub fn solve(&mut self) -> Result<Snapshot<'_, T, N>, SnapshotError> {
        self.solve_rows()?;
        Ok(self.lend())
    }

    /// Copies a snapshot, so that rows can be left out of the copy. Returns `None` if the snapshot
    /// has more than `N` rows.
    pub fn copy_of<const M: usize>(&mut self, snapshot: &Snapshot<'_, T, M>) -> Option<Snapshot<'_, T, N>> {
        self.equations.copy_from(snapshot.rows, snapshot.references)?;
        self.solved = *snapshot.solved;
        Some(self.lend())
    }

    /// Returns a residual of the last solution over its standard deviation, dimensionless: the
    /// w-test of a row that takes part, and the same for a row that is left out, whose residual is
    /// its difference to the prediction by the others. `None` if nothing else tests the row.
    pub fn w_test(&self, index: usize) -> Option<T> {
        let (row, fit) = self.equations.rows().get(index).zip(self.fits.get(index))?;
        if row.weight > T::zero() {
            return Some(fit.w_test()).filter(|_| fit.test_weight > T::zero());
        }
        let estimate = &self.solved.estimate;
        let is_predicted = row.clock.is_none_or(|clock| estimate.determines(clock));
        let predicted = estimate.level_variance(row) + dot(&fit.centred, &fit.gain);
        is_predicted.then(|| fit.residual / (row.sigma * row.sigma + predicted).sqrt_approx())
    }

    /// Solves the equations in place without fits. Returns the correction of the position, east,
    /// north, up, m.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub(crate) fn solve_rows(&mut self) -> Result<Vector3<T>, SnapshotError> {
        self.solved.estimate.solve(self.equations.rows().iter())?;
        Ok(self.solved.estimate.correction)
    }

    /// Lends the last solution of [`Self::solve_rows`], with the fit of each row.
    pub(crate) fn lend(&mut self) -> Snapshot<'_, T, N> {
        let Self { equations, fits, solved } = self;
        let (rows, references) = equations.parts_mut();
        // Both vectors have the capacity `N`, so that a push never fails. A vector that is long
        // enough is overwritten, which avoids a copy on the stack.
        fits.truncate(rows.len());
        while fits.len() < rows.len() && fits.push(RowFit::nothing()).is_ok() {}
        solved.fit_all(rows, fits);
        Snapshot { rows, references, fits, solved }
    }
}
