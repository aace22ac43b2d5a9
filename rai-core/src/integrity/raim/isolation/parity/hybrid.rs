//! Hybrid isolation: simultaneous isolation first, a search only if it fails.
//!
//! The simultaneous set is used if it is not empty, not too large, passes the test, and is
//! **minimal**: no set with one row less passes. [Parity] does not state the last rule. But without
//! it healthy rows that are nearly collinear with the faulty one are left out too. The paper's rate
//! for single faults cannot then be reached (0.923 instead of 0.993).
//!
//! Otherwise sequential isolation is tried (method B); if that fails too, grouping (method C).
//!
//! [Parity]: crate#references

use super::{ParityFinding, ParitySearch, SearchLimits, search};
use crate::integrity::raim::detection::threshold::Thresholds;
use crate::least_squares::Snapshot;
use crate::least_squares::downdate::ExclusionSet;
use crate::numeric::real::Real;

/// Isolates simultaneously, or else sequentially (method B).
#[inline(never)]
pub fn hybrid_without_grouping<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    thresholds: &Thresholds<'_>,
    limits: &SearchLimits,
) -> ParityFinding<T> {
    search(snapshot, thresholds, limits, |search: &ParitySearch<'_, T, N>| search.hybrid_without_grouping())
}

/// Isolates simultaneously, or else sequentially, or else by grouping (method C).
#[inline(never)]
pub fn hybrid<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    thresholds: &Thresholds<'_>,
    limits: &SearchLimits,
) -> ParityFinding<T> {
    search(snapshot, thresholds, limits, |search| {
        let cheap = search.hybrid_without_grouping();
        if cheap.set.is_ok() {
            return cheap;
        }
        let thorough = search.grouping();
        ParityFinding { sets: cheap.sets + thorough.sets, ..thorough }
    })
}

impl<T: Real, const N: usize> ParitySearch<'_, T, N> {
    fn hybrid_without_grouping(&self) -> ParityFinding<T> {
        match self.correlated_set() {
            Some(removal) => {
                // Cost: the set itself, and each set with one row less.
                let sets = 1 + removal.rows().len();
                if self.passes(&removal) && self.is_minimal(&removal) {
                    return ParityFinding { set: Ok(removal), sets };
                }
                let sequential = self.sequential();
                ParityFinding { sets: sets + sequential.sets, ..sequential }
            }
            None => self.sequential(),
        }
    }

    /// Returns the simultaneous set, or `None` if it is empty, larger than may be left out, or
    /// refused.
    // Like the next function not inlined, so that these large sets are off the stack during later
    // searches.
    #[inline(never)]
    fn correlated_set(&self) -> Option<ExclusionSet<T>> {
        if self.correlated().count() > self.limits.rows() {
            return None;
        }
        let mut set = ExclusionSet::none();
        for row in self.correlated() {
            set.grow(row)?;
        }
        if set.rows().is_empty() { None } else { Some(set) }
    }

    /// Returns true if every row of a set is needed.
    #[inline(never)]
    fn is_minimal(&self, removal: &ExclusionSet<T>) -> bool {
        removal.rows().iter().all(|spared| {
            let mut others = removal.rows().iter().filter(|row| row.index != spared.index);
            let mut smaller = ExclusionSet::none();
            let is_refused = others.any(|row| smaller.grow(row).is_none());
            is_refused || !self.passes(&smaller)
        })
    }
}
