//! Parity space: isolation of several faults from one snapshot.
//!
//! The parity vector `p` is what the ranges say once position and clocks are taken out. A bias of row `i` moves it
//! along the line `p_i`; a set `E` of biases moves it within the plane of their lines, and what remains outside is
//! `SSE_E`. All four methods compare sets by `SSE_E` without solving anything again ([`crate::removal`]).
//!
//! | method | rows named | function |
//! |---|---|---|
//! | simultaneous (A) | all with `|ρ_i| ≥ ρ_T` at once | [`simultaneous`] |
//! | sequential | the largest `|w|`, again and again, until the rest passes | [`sequential`] |
//! | hybrid (B, C) | A where its set is minimal and the rest passes, else sequential (B), else grouping (C) | [`hybrid`] |
//! | grouping (D) | of all sets of 1, 2, … rows the one with the smallest `SSE_E`, until that passes | [`grouping`] |
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `SSE_E` | weighted sum of squared residuals without the set `E` | – |
//! | `τ1` | threshold of the global test for the degrees of freedom left | – |
//! | `ρ_T` | threshold on the correlation | – |
//!
//! Work is bounded: [`Limits::sets`] sets at most, [`MAX_SETS`] of them being every set of up to three of 40 rows. A
//! search that is cut names nothing and says so ([`Identification::Budget`]).
//!
//! In `f32` the ranking of sets resolves differences of about 1e-6 of SSE; the test of the set found does not lose
//! these digits, so that a wrong set is refused, not believed.
//!
//! The searches are not inlined: each takes 2.5 KiB of the stack and more, and one after the other they share it.
//!
//! References: \[Parity\] and, for the global test, [Yang2015] §1.

mod correlation;
mod grouping;
mod hybrid;
mod sequential;

pub use correlation::{correlation, correlation_threshold};
pub use grouping::grouping;
pub use hybrid::{hybrid, hybrid_without_grouping};
pub use sequential::sequential;

use heapless::Vec;

use super::baarda::{Excluded, Exclusion, Identification, Outcome, Reducible, w_test};
use crate::bounded::gather;
use crate::detection::detect;
use crate::probability::Probability;
use crate::real::Real;
use crate::removal::{NormalisedRow, Removal, testable_rows};
use crate::report::MAX_EXCLUDED;
use crate::snapshot::Snapshot;
use crate::threshold::Thresholds;

/// All sets of one, two or three of 40 rows.
pub const MAX_SETS: usize = 40 + 40 * 39 / 2 + 40 * 39 * 38 / 6;
const _: () = assert!(MAX_SETS == 10_700);

/// `α` of \[Parity\].
const ALPHA: Probability = match Probability::new(0.01) {
    Some(alpha) => alpha,
    None => unreachable!(),
};

/// How the faulty rows are searched for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Method {
    /// All rows whose correlation is large, at once.
    Simultaneous,
    /// The worst row, again and again.
    Sequential,
    /// Simultaneous, else sequential.
    HybridWithoutGrouping,
    /// Simultaneous, else sequential, else grouping.
    Hybrid,
    /// Every set of one row, then of two, then of three.
    Grouping,
}

/// How far a search may go, and what it believes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Rows that may be left out; above [`MAX_EXCLUDED`] it means that.
    pub rows: usize,
    /// Sets that may be tested before the search is cut.
    pub sets: usize,
    /// Probability that the correlation of a healthy row exceeds its threshold.
    pub alpha: Probability,
}

impl Limits {
    /// As in \[Parity\]: `α = 0.01`; up to [`MAX_EXCLUDED`] rows, with the work that 40 rows need.
    pub const fn published() -> Self {
        Self { rows: MAX_EXCLUDED, sets: MAX_SETS, alpha: ALPHA }
    }

    fn rows(&self) -> usize {
        self.rows.min(MAX_EXCLUDED)
    }
}

/// What a search found, and what it cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding<T: Real> {
    /// The set of rows without which the rest passes, empty where nothing was detected; or why there is none.
    pub set: Result<Removal<T>, Identification>,
    /// Sets whose `SSE_E` was looked at.
    pub sets: usize,
}

/// A snapshot in which a fault was detected, and what a search in it needs.
struct Search<'s, T: Real, const N: usize> {
    snapshot: &'s Snapshot<T, N>,
    thresholds: &'s Thresholds<'s>,
    limits: &'s Limits,
    rows: &'s [NormalisedRow<T>],
}

/// Prepares a search and makes it; says what there is to say where nothing is to be searched for.
fn search<T: Real, const N: usize>(
    snapshot: &Snapshot<T, N>,
    thresholds: &Thresholds<'_>,
    limits: &Limits,
    find: impl FnOnce(&Search<'_, T, N>) -> Finding<T>,
) -> Finding<T> {
    match detect(snapshot, thresholds) {
        None => Finding { set: Err(Identification::NoRedundancy), sets: 0 },
        Some(detection) if !detection.fault() => Finding { set: Ok(Removal::none()), sets: 0 },
        Some(_) => find(&Search { snapshot, thresholds, limits, rows: &testable_rows(snapshot) }),
    }
}

impl<T: Real, const N: usize> Search<'_, T, N> {
    /// True when the rest passes the global test without a set.
    fn passes(&self, removal: &Removal<T>) -> bool {
        let threshold = self.thresholds.tau1(removal.dof(self.snapshot));
        threshold.is_some_and(|threshold| removal.sse(self.rows) < T::narrow(threshold))
    }

    /// Rows whose correlation reaches its threshold, none with fewer than two degrees of freedom.
    fn correlated(&self) -> impl Iterator<Item = &NormalisedRow<T>> {
        let threshold = correlation_threshold::<T>(self.limits.alpha, self.snapshot.dof());
        // |ρ_i| ≥ ρ_T without a root: r_i² ≥ ρ_T² SSE S_ii.
        let bound = threshold.map(|threshold| threshold * threshold * self.snapshot.sse());
        self.rows.iter().filter(move |row| {
            bound.is_some_and(|bound| row.residual * row.residual >= bound * row.redundancy)
        })
    }
}

/// Names all rows whose correlation with the parity vector is large, without testing what remains.
///
/// Empty where nothing was detected.
#[inline(never)]
pub fn simultaneous<T: Real, const N: usize>(
    snapshot: &Snapshot<T, N>,
    thresholds: &Thresholds<'_>,
    limits: &Limits,
) -> Vec<usize, N> {
    if !detect(snapshot, thresholds).is_some_and(|detection| detection.fault()) {
        return Vec::new();
    }
    let search = Search { snapshot, thresholds, limits, rows: &testable_rows(snapshot) };
    gather(search.correlated().map(|row| row.index))
}

/// Isolates by one of the methods and leaves the rows found out.
///
/// `solution` ends as the solution without the rows listed, solved again and tested again: whatever a method
/// believes, [`Outcome::Isolated`] means that the rest passes.
pub fn exclude<T: Real, const N: usize>(
    method: Method,
    solution: &mut impl Reducible<T, N>,
    thresholds: &Thresholds<'_>,
    limits: &Limits,
) -> Exclusion<T> {
    let snapshot = solution.snapshot();
    let found = match method {
        Method::Simultaneous => all_at_once(snapshot, thresholds, limits),
        Method::Sequential => indices(sequential(snapshot, thresholds, limits)),
        Method::HybridWithoutGrouping => indices(hybrid_without_grouping(snapshot, thresholds, limits)),
        Method::Hybrid => indices(hybrid(snapshot, thresholds, limits)),
        Method::Grouping => indices(grouping(snapshot, thresholds, limits)),
    };
    match found {
        Ok(set) => leave_out(solution, &set, thresholds),
        Err(identification) => Exclusion { rows: Vec::new(), outcome: Outcome::NotIsolated(identification) },
    }
}

/// Rows that may be left out.
type Set = Vec<usize, MAX_EXCLUDED>;

fn indices<T: Real>(finding: Finding<T>) -> Result<Set, Identification> {
    finding.set.map(|removal| gather(removal.rows().iter().map(|row| row.index)))
}

/// The simultaneous set; more rows than may be left out are none.
fn all_at_once<T: Real, const N: usize>(
    snapshot: &Snapshot<T, N>,
    thresholds: &Thresholds<'_>,
    limits: &Limits,
) -> Result<Set, Identification> {
    if snapshot.dof() == 0 {
        return Err(Identification::NoRedundancy);
    }
    let set = simultaneous(snapshot, thresholds, limits);
    if set.len() > limits.rows() {
        return Err(Identification::NoSet);
    }
    Ok(gather(set.iter().copied()))
}

/// Leaves a set of rows out of a solution and tests what remains.
pub(super) fn leave_out<T: Real, const N: usize>(
    solution: &mut impl Reducible<T, N>,
    set: &[usize],
    thresholds: &Thresholds<'_>,
) -> Exclusion<T> {
    let mut rows = Vec::new();
    for &index in set {
        let w_test = solution.snapshot().row(index).map_or(T::zero(), |(_, fit)| w_test(fit));
        // Where no position is left, the test below speaks of the rows that are out so far.
        if solution.leave_out(index).is_err() || rows.push(Excluded { index, w_test }).is_err() {
            break;
        }
    }
    let passed = detect(solution.snapshot(), thresholds).is_some_and(|detection| !detection.fault());
    let outcome = match (passed, rows.is_empty()) {
        (true, true) => Outcome::Passed,
        (true, false) => Outcome::Isolated,
        (false, _) => Outcome::NotIsolated(Identification::NoSet),
    };
    Exclusion { rows, outcome }
}
