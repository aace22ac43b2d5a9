//! The interface that all searches use: a solved epoch whose rows can be left out and taken back.

use super::{Snapshot, SnapshotError};
use crate::bit_set::set_of;
use crate::bounded::MAX_ROWS;
use crate::numeric::real::Real;

/// A solved epoch whose rows can be left out and taken back.
///
/// A [`Snapshot`] stays linearised about its point. A [`Fix`](super::fix::Fix) linearises again
/// after an exclusion that moves the position far.
pub trait Excludable<T: Real, const N: usize = MAX_ROWS> {
    /// Returns the linearised epoch as it is solved now.
    fn snapshot(&self) -> &Snapshot<'_, T, N>;

    /// Leaves one more row out and solves again.
    ///
    /// # Errors
    /// The remaining rows must determine a position; otherwise nothing changes.
    fn leave_out(&mut self, index: usize) -> Result<(), SnapshotError>;

    /// Leaves out all rows of a bit set, all of which take part so far, and solves again.
    ///
    /// # Errors
    /// As [`Self::leave_out`].
    fn leave_out_all(&mut self, rows: u64) -> Result<(), SnapshotError>;

    /// Takes rows back, all at once. The point stays the same, so that exclusions of one epoch can
    /// be compared.
    ///
    /// # Errors
    /// As [`Self::leave_out`].
    fn take_back(&mut self, rows: &[usize]) -> Result<(), SnapshotError>;

    /// Takes back all rows that [`Self::leave_out_all`] left out.
    fn take_back_all(&mut self, rows: u64);

    /// Leaves out again the rows that [`Self::take_back`] took back, which restores the earlier
    /// solution.
    ///
    /// # Errors
    /// As [`Self::leave_out`].
    fn set_aside(&mut self, rows: &[usize]) -> Result<(), SnapshotError>;

    /// Leaves out all rows of a bit set without linearising again, even if the position moves far.
    ///
    /// # Errors
    /// As [`Self::leave_out`].
    fn set_aside_all(&mut self, rows: u64) -> Result<(), SnapshotError>;
}

impl<T: Real, const N: usize> Excludable<T, N> for Snapshot<'_, T, N> {
    fn snapshot(&self) -> &Snapshot<'_, T, N> {
        self
    }

    fn leave_out(&mut self, index: usize) -> Result<(), SnapshotError> {
        Snapshot::leave_out(self, index)
    }

    fn leave_out_all(&mut self, rows: u64) -> Result<(), SnapshotError> {
        self.reduce(rows)
    }

    fn take_back(&mut self, rows: &[usize]) -> Result<(), SnapshotError> {
        self.restore(set_of(rows))
    }

    fn take_back_all(&mut self, rows: u64) {
        // This cannot fail, because these rows were solved before.
        let _ = self.restore(rows);
    }

    fn set_aside(&mut self, rows: &[usize]) -> Result<(), SnapshotError> {
        self.reduce(set_of(rows))
    }

    fn set_aside_all(&mut self, rows: u64) -> Result<(), SnapshotError> {
        self.reduce(rows)
    }
}
