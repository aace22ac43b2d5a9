//! The types of an exclusion: the rows that were left out, and the result.
//!
//! **Least redundancy.** `2k` degrees of freedom are needed to distinguish `k` biases from `k`
//! others. After an exclusion of `k` rows, `k` must therefore remain ([`leaves_enough`]).
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `w_i` | [`Excluded::w_test`] | – |

use heapless::Vec;

use crate::integrity::raim::detection::Detection;
use crate::integrity::raim::detection::threshold::Thresholds;
use crate::least_squares::Excludable;
use crate::numeric::real::Real;
use crate::report::MAX_EXCLUDED;

/// Reason why no row is identified although a fault was detected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Unidentified {
    /// There are fewer than two degrees of freedom, or the exclusion leaves fewer of them than rows
    /// that it leaves out.
    NoRedundancy,
    /// No |w| is large enough.
    BelowThreshold,
    /// Several sets of rows explain the data nearly equally well.
    Ambiguous,
    /// No set of rows that may be left out explains the data.
    NoSet,
    /// The search exceeded its work budget.
    Budget,
    /// A wrong time of all ranges explains the data.
    Time,
}

/// Result of an exclusion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ExclusionOutcome {
    /// No fault was detected.
    Passed,
    /// The remaining rows pass the test.
    Isolated,
    /// The fault is not isolated, for this reason.
    NotIsolated(Unidentified),
}

/// A row that was left out, with its w-test at that moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excluded<T> {
    /// Index of the row in the epoch.
    pub index: usize,
    /// Its w-test, signed, dimensionless.
    pub w_test: T,
}

/// Rows left out one after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Exclusion<T> {
    /// Rows in the order of exclusion.
    pub rows: Vec<Excluded<T>, MAX_EXCLUDED>,
    /// Result.
    pub outcome: ExclusionOutcome,
}

impl<T: Real> Exclusion<T> {
    /// Returns the exclusion of no rows.
    pub const fn passed() -> Self {
        Self { rows: Vec::new(), outcome: ExclusionOutcome::Passed }
    }

    /// Returns the exclusion of no rows, although there is a fault.
    pub const fn not_isolated(reason: Unidentified) -> Self {
        Self { rows: Vec::new(), outcome: ExclusionOutcome::NotIsolated(reason) }
    }
}

/// Leaves a set of rows out of a solution and tests the remaining ones.
pub fn leave_out<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    set: &[usize],
    thresholds: &Thresholds<'_>,
) -> Exclusion<T> {
    let mut rows = Vec::new();
    for &index in set {
        let w_test = solution.snapshot().row(index).map_or(T::zero(), |(_, fit)| fit.w_test());
        // If no position is left without this row, it stays in. The test below then applies to the
        // solution without the earlier rows.
        if solution.leave_out(index).is_err() || rows.push(Excluded { index, w_test }).is_err() {
            break;
        }
    }
    let outcome = match (Detection::passes(solution.snapshot(), thresholds), rows.is_empty()) {
        (true, true) => ExclusionOutcome::Passed,
        (true, false) => ExclusionOutcome::Isolated,
        (false, _) => ExclusionOutcome::NotIsolated(Unidentified::NoSet),
    };
    Exclusion { rows, outcome }
}

/// Returns true if an exclusion leaves as many degrees of freedom as it has rows.
pub fn leaves_enough(excluded: usize, dof: usize) -> bool {
    dof >= excluded
}
