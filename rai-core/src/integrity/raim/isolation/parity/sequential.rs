//! Sequential isolation: leaves out the row with the largest |w| until the rest passes.
//!
//! Without the rows left out so far, a row's `w²` is `q²/p` of [`crate::least_squares::downdate`].
//! Work: at most `n` sets for each row left out. Unlike
//! [`crate::integrity::raim::isolation::baarda::exclude_sequentially`] it applies no threshold to
//! |w|: [Parity] relies on the global test of the remaining rows.
//!
//! [Parity]: crate#references

use super::{ParityFinding, ParitySearch, SearchLimits, search};
use crate::integrity::raim::detection::threshold::Thresholds;
use crate::integrity::raim::isolation::exclusion::Unidentified;
use crate::least_squares::Snapshot;
use crate::least_squares::downdate::ExclusionSet;
use crate::numeric::real::Real;

/// Leaves out the worst row repeatedly from a snapshot in which a fault was detected.
#[inline(never)]
pub fn sequential<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    thresholds: &Thresholds<'_>,
    limits: &SearchLimits,
) -> ParityFinding<T> {
    search(snapshot, thresholds, limits, |search: &ParitySearch<'_, T, N>| search.sequential())
}

impl<T: Real, const N: usize> ParitySearch<'_, T, N> {
    pub(super) fn sequential(&self) -> ParityFinding<T> {
        let (mut removal, mut sets) = (ExclusionSet::none(), 0);
        for _ in 0..self.limits.rows() {
            sets += self.rows.len();
            if self.leave_out_worst(&mut removal).is_none() {
                break;
            }
            if self.passes(&removal) {
                return ParityFinding { set: Ok(removal), sets };
            }
        }
        ParityFinding { set: Err(Unidentified::NoSet), sets }
    }

    /// Adds the row with the largest |w| to the set, the first of equal ones. Returns `None` if it
    /// is refused.
    fn leave_out_worst(&self, removal: &mut ExclusionSet<T>) -> Option<()> {
        let (mut worst, mut largest) = (None, T::zero());
        for row in self.rows {
            let squared = removal.explains_more(row);
            if squared > largest {
                (worst, largest) = (Some(row), squared);
            }
        }
        removal.grow(worst?)
    }
}
