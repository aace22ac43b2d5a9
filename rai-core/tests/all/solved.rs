//! A solved snapshot without a workspace beside it, for tests, which leak its memory.

use raim_core::internals::least_squares::equations::{LinearEpoch, MAX_ROWS};
use raim_core::internals::least_squares::{Snapshot, SnapshotError, Workspace};
use raim_core::internals::numeric::real::Real;

/// Works like [`Workspace::solve`].
pub(crate) fn solved<T: Real>(
    equations: LinearEpoch<T, MAX_ROWS>,
) -> Result<Snapshot<'static, T>, SnapshotError> {
    Box::leak(Box::new(Workspace::of(equations))).solve()
}

/// Works like [`Workspace::copy_of`].
#[allow(dead_code, reason = "not every test compares ways to leave rows out")]
pub(crate) fn copied<T: Real>(snapshot: &Snapshot<'_, T>) -> Snapshot<'static, T> {
    Box::leak(Box::new(Workspace::<T, MAX_ROWS>::new())).copy_of(snapshot).expect("room")
}
