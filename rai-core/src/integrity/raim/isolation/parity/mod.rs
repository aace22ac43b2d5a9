//! Parity space: isolation of several faults from one snapshot.
//!
//! The parity vector `p` is the part of the ranges that position and clocks do not explain. A bias
//! of row `i` moves it along the line `p_i`. Biases of a set `E` move it within the plane of their
//! lines. `SSE_E` is the squared length of the part of `p` outside this plane. All four methods
//! compare sets by `SSE_E` without solving again ([`crate::least_squares::downdate`]).
//!
//! | method | rows identified | function |
//! |---|---|---|
//! | simultaneous (A) | all with `|ρ_i| ≥ ρ_T` at once | [`simultaneous`] |
//! | sequential | the largest `|w|`, repeatedly, until the rest passes | [`sequential`] |
//! | hybrid (B, C) | those of A if the set is minimal and the rest passes, else sequential (B), else grouping (C) | [`hybrid`](fn@hybrid) |
//! | grouping (D) | of all sets of 1, 2, … rows the one with the smallest `SSE_E`, until the rest passes | [`grouping`](fn@grouping) |
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `SSE_E` | weighted sum of squared residuals without the set `E` | – |
//! | `τ1` | threshold of the global test for the degrees of freedom left | – |
//! | `ρ_T` | threshold on the correlation | – |
//!
//! A search compares at most [`SearchLimits::sets`] sets; [`MAX_SETS`] is the number of all sets of
//! up to three of 40 rows. If the budget is used up, the search identifies no row and reports
//! [`Unidentified::Budget`].
//!
//! In `f32` the ranking of sets resolves differences of about 1e-6 of SSE. The final test does not
//! lose these digits, so that it refuses a wrong set.
//!
//! The searches are not inlined: each needs at least 2.5 KiB of stack, which they then use in turn.
//!
//! References: [Parity] and, for the global test, [Yang2015] §1.
//!
//! [Yang2015]: crate#references
//! [Parity]: crate#references

mod correlation;
mod grouping;
mod hybrid;
mod sequential;

pub use correlation::{correlation, correlation_threshold};
pub use grouping::grouping;
pub use hybrid::{hybrid, hybrid_without_grouping};
pub use sequential::sequential;

use heapless::Vec;

use crate::bounded::gather;
use crate::integrity::raim::detection::threshold::Thresholds;
use crate::integrity::raim::detection::{Detection, detect};
use crate::integrity::raim::isolation::exclusion::{Exclusion, Unidentified, leave_out};
use crate::least_squares::downdate::{ExclusionSet, NormalisedRow, NormalisedRows, testable_rows};
use crate::least_squares::{Excludable, Snapshot};
use crate::numeric::probability::Probability;
use crate::numeric::real::Real;
use crate::report::MAX_EXCLUDED;

/// Number of all sets of one, two or three of 40 rows.
pub const MAX_SETS: usize = 40 + 40 * 39 / 2 + 40 * 39 * 38 / 6;
const _: () = assert!(MAX_SETS == 10_700);

/// `α` as published in [Parity].
///
/// [Parity]: crate#references
const ALPHA: Probability = match Probability::new(0.01) {
    Some(alpha) => alpha,
    None => unreachable!(),
};

/// Search method in parity space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Isolation {
    /// Leaves out all rows whose correlation is large, at once.
    Simultaneous,
    /// Leaves out the worst row, repeatedly.
    Sequential,
    /// Simultaneous, else sequential.
    HybridWithoutGrouping,
    /// Simultaneous, else sequential, else grouping.
    Hybrid,
    /// Compares every set of one row, then of two, then of three.
    Grouping,
}

/// Limits of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchLimits {
    /// Largest number of rows that may be left out; larger values mean [`MAX_EXCLUDED`].
    pub rows: usize,
    /// Largest number of sets that the search may compare.
    pub sets: usize,
    /// Probability that the correlation of a healthy row exceeds its threshold.
    pub alpha: Probability,
}

impl SearchLimits {
    /// Returns the limits of [Parity]: `α = 0.01`, up to [`MAX_EXCLUDED`] rows, and the budget that
    /// 40 rows need.
    ///
    /// [Parity]: crate#references
    pub const fn published() -> Self {
        Self { rows: MAX_EXCLUDED, sets: MAX_SETS, alpha: ALPHA }
    }

    fn rows(&self) -> usize {
        self.rows.min(MAX_EXCLUDED)
    }
}

/// Result of a search with its cost.
#[derive(Clone, Debug, PartialEq)]
pub struct ParityFinding<T: Real> {
    /// Set of rows without which the rest passes, or the reason why there is none. Empty if no
    /// fault was detected.
    pub set: Result<ExclusionSet<T>, Unidentified>,
    /// Number of sets whose `SSE_E` was compared.
    pub sets: usize,
}

/// A snapshot in which a fault was detected, with the rows and thresholds of a search.
struct ParitySearch<'s, T: Real, const N: usize> {
    snapshot: &'s Snapshot<'s, T, N>,
    thresholds: &'s Thresholds<'s>,
    limits: &'s SearchLimits,
    rows: &'s [NormalisedRow<T>],
}

/// Runs a search. Returns at once if no fault is detected or there is no redundancy.
fn search<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    thresholds: &Thresholds<'_>,
    limits: &SearchLimits,
    find: impl FnOnce(&ParitySearch<'_, T, N>) -> ParityFinding<T>,
) -> ParityFinding<T> {
    match detect(snapshot, thresholds) {
        None => ParityFinding { set: Err(Unidentified::NoRedundancy), sets: 0 },
        Some(detection) if !detection.fault() => ParityFinding { set: Ok(ExclusionSet::none()), sets: 0 },
        Some(_) => {
            let mut rows = NormalisedRows::<T, N>::new();
            testable_rows(snapshot, &mut rows);
            find(&ParitySearch { snapshot, thresholds, limits, rows: &rows })
        }
    }
}

impl<T: Real, const N: usize> ParitySearch<'_, T, N> {
    /// Returns true if the rest passes the global test without a set.
    fn passes(&self, removal: &ExclusionSet<T>) -> bool {
        let test = Detection::of(removal.sse(self.rows), removal.dof(self.snapshot), self.thresholds);
        test.is_some_and(|test| !test.fault())
    }

    /// Iterates over the rows whose correlation reaches its threshold; none with fewer than two
    /// degrees of freedom.
    fn correlated(&self) -> impl Iterator<Item = &NormalisedRow<T>> {
        let threshold = correlation_threshold::<T>(self.limits.alpha, self.snapshot.dof());
        // |ρ_i| ≥ ρ_T without a root: u_i² ≥ ρ_T² SSE S_ii.
        let bound = threshold.map(|threshold| threshold * threshold * self.snapshot.sse());
        self.rows.iter().filter(move |row| {
            bound.is_some_and(|bound| row.residual * row.residual >= bound * row.redundancy)
        })
    }
}

/// Identifies all rows whose correlation with the parity vector is large, without testing the
/// remaining rows.
///
/// Empty if no fault was detected.
#[inline(never)]
pub fn simultaneous<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    thresholds: &Thresholds<'_>,
    limits: &SearchLimits,
) -> Vec<usize, N> {
    if !detect(snapshot, thresholds).is_some_and(|detection| detection.fault()) {
        return Vec::new();
    }
    let mut rows = NormalisedRows::<T, N>::new();
    testable_rows(snapshot, &mut rows);
    let search = ParitySearch { snapshot, thresholds, limits, rows: &rows };
    gather(search.correlated().map(|row| row.index))
}

/// Isolates by one of the methods and leaves out the rows found.
///
/// Afterwards, `solution` is solved and tested without the listed rows. For every method
/// [`ExclusionOutcome::Isolated`](super::exclusion::ExclusionOutcome::Isolated) means that the rest
/// passes.
pub fn exclude<T: Real, const N: usize>(
    method: Isolation,
    solution: &mut impl Excludable<T, N>,
    thresholds: &Thresholds<'_>,
    limits: &SearchLimits,
) -> Exclusion<T> {
    let snapshot = solution.snapshot();
    let found = match method {
        Isolation::Simultaneous => all_at_once(snapshot, thresholds, limits),
        Isolation::Sequential => indices(sequential(snapshot, thresholds, limits)),
        Isolation::HybridWithoutGrouping => indices(hybrid_without_grouping(snapshot, thresholds, limits)),
        Isolation::Hybrid => indices(hybrid(snapshot, thresholds, limits)),
        Isolation::Grouping => indices(grouping(snapshot, thresholds, limits)),
    };
    match found {
        Ok(set) => leave_out(solution, &set, thresholds),
        Err(reason) => Exclusion::not_isolated(reason),
    }
}

/// Indices of rows that may be left out.
type RowIndices = Vec<usize, MAX_EXCLUDED>;

fn indices<T: Real>(finding: ParityFinding<T>) -> Result<RowIndices, Unidentified> {
    finding.set.map(|removal| gather(removal.rows().iter().map(|row| row.index)))
}

/// Returns the simultaneous set, or an error if it has more rows than may be left out.
fn all_at_once<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    thresholds: &Thresholds<'_>,
    limits: &SearchLimits,
) -> Result<RowIndices, Unidentified> {
    if snapshot.dof() == 0 {
        return Err(Unidentified::NoRedundancy);
    }
    let set = simultaneous(snapshot, thresholds, limits);
    if set.len() > limits.rows() {
        return Err(Unidentified::NoSet);
    }
    Ok(gather(set.iter().copied()))
}
