//! The vocabulary of exclusions: which rows were left out, how it ended, and whether another set would have done as well.
//!
//! **Separability.** The set that explains the data best may consist of healthy satellites: of one where two are strongly
//! correlated, of several where few are left to contradict. Under a fault of `j`, `w_i² − w_j²` exceeds `κ²` with a
//! probability of at most `Q(κ)`, whatever the fault's size and the correlation: with `u = w_i − w_j`, `s = w_i + w_j`
//! and correlation ρ, the product `u s` needs `u ≥ κ²/((1+ρ)δ)`, which is `κ √2/√(1+ρ) ≥ κ` standard deviations from its
//! mean at the most favourable δ. [`separable`] therefore asks every other set of as many rows or fewer to explain less by
//! `T_d²`, or to fail the global test: a wrong exclusion is then no likelier than a false alarm. A set within the one that
//! was found is no rival: who leaves out more than is faulty errs on the safe side.
//!
//! **Least redundancy.** `k` biases can be told from any other `k` only where `2k` degrees of freedom show them: an
//! exclusion of `k` rows must leave `k` of them ([`leaves_enough`]).
//!
//! Work of the separability: all sets of up to as many of [`MAX_ROWS`] rows.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `w_i` | [`Excluded::w_test`] | – |
//! | `T_d` | [`Thresholds::w_test`] | – |
//!
//! References: [Wang1994].
//!
//! [Wang1994]: crate#references

use heapless::Vec;

use super::detection::Detection;
use super::sets::{Work, count_up_to, each_of_size};
use super::shift;
use super::threshold::Thresholds;
use crate::bounded::gather;
use crate::equations::MAX_ROWS;
use crate::numeric::real::Real;
use crate::removal::{NormalisedRow, Removal, testable_rows};
use crate::report::MAX_EXCLUDED;
use crate::snapshot::{Reducible, Snapshot, infinity};

/// Why no row is named although a fault was detected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Unidentified {
    /// With fewer than two degrees of freedom all |w| are equal.
    NoRedundancy,
    /// No |w| is large enough.
    BelowThreshold,
    /// Several sets of rows explain the data nearly equally.
    Ambiguous,
    /// No set of rows that may be left out explains it.
    NoSet,
    /// The declared work ended the search.
    Budget,
    /// Not rows: a wrong time of all ranges explains them.
    Time,
}

/// How an exclusion ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Outcome {
    /// Nothing was detected.
    Passed,
    /// What remains passes the test.
    Isolated,
    /// The fault remains, and the reason why no row could be named.
    NotIsolated(Unidentified),
}

/// A row that was left out, as it stood at that moment.
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
    /// In the order of removal.
    pub rows: Vec<Excluded<T>, MAX_EXCLUDED>,
    /// How it ended.
    pub outcome: Outcome,
}

impl<T: Real> Exclusion<T> {
    /// Nothing to leave out.
    pub const fn passed() -> Self {
        Self { rows: Vec::new(), outcome: Outcome::Passed }
    }

    /// Nothing left out although there is a fault.
    pub const fn not_isolated(reason: Unidentified) -> Self {
        Self { rows: Vec::new(), outcome: Outcome::NotIsolated(reason) }
    }
}

/// Leaves a set of rows out of a solution and tests what remains.
pub fn leave_out<T: Real>(
    solution: &mut impl Reducible<T>,
    set: &[usize],
    thresholds: &Thresholds<'_>,
) -> Exclusion<T> {
    let mut rows = Vec::new();
    for &index in set {
        let w_test = solution.snapshot().row(index).map_or(T::zero(), |(_, fit)| fit.w_test());
        // Where no position is left, the test below speaks of the rows that are out so far.
        if solution.leave_out(index).is_err() || rows.push(Excluded { index, w_test }).is_err() {
            break;
        }
    }
    let outcome = match (Detection::passes(solution.snapshot(), thresholds), rows.is_empty()) {
        (true, true) => Outcome::Passed,
        (true, false) => Outcome::Isolated,
        (false, _) => Outcome::NotIsolated(Unidentified::NoSet),
    };
    Exclusion { rows, outcome }
}

/// Whether an exclusion leaves as many degrees of freedom as it has rows.
pub fn leaves_enough(excluded: usize, dof: usize) -> bool {
    dof >= excluded
}

/// True when no other exclusion of as many rows or fewer explains the data nearly as well as the one found, nor a constellation at a
/// place of its own.
///
/// The rows left out are taken back together, and left out again: `solution` ends as it began.
#[inline(never)]
pub fn separable<T: Real>(
    solution: &mut impl Reducible<T>,
    exclusion: &Exclusion<T>,
    thresholds: &Thresholds<'_>,
) -> bool {
    let set: Vec<usize, MAX_EXCLUDED> = gather(exclusion.rows.iter().map(|excluded| excluded.index));
    let found = solution.snapshot().sse();
    if solution.take_back(&set).is_err() {
        return false;
    }
    let unrivalled = is_unrivalled(solution.snapshot(), &set, thresholds)
        && !shift::rivals(solution.snapshot(), &set, found, thresholds);
    solution.set_aside(&set).is_ok() && unrivalled
}

/// True when no other set of as many rows or fewer passes the global test with a sum of squares within `T_d²` of this one's.
fn is_unrivalled<T: Real>(snapshot: &Snapshot<'_, T>, set: &[usize], thresholds: &Thresholds<'_>) -> bool {
    let mut rows = Vec::new();
    testable_rows(snapshot, &mut rows);
    let (Some(threshold), Some(found)) =
        (thresholds.w_test::<T>(snapshot.used()), Removal::among(&rows, set))
    else {
        return false;
    };
    let margin = threshold * threshold;
    let contest = Contest { snapshot, thresholds, rows: &rows, set, left: found.sse(&rows), margin };
    // What explains less than this by the sums at hand, which lose digits to gross faults, need not be looked at closely.
    let least = found.explained() - margin - snapshot.sse() * T::UNTESTABLE;
    let mut work = Work::new(count_up_to(set.len(), MAX_ROWS));
    for size in 1..=set.len() {
        let mut has_rival = false;
        each_of_size(&rows, size, &mut work, least, |_, rival| {
            has_rival |= rival.get(..size).is_some_and(|rival| contest.has(rival));
            // One is enough: no other set is shown.
            if has_rival { infinity() } else { least }
        });
        if has_rival {
            return false;
        }
    }
    !work.cut
}

/// A set that was found, and what another has to reach to be its rival.
struct Contest<'c, T: Real> {
    snapshot: &'c Snapshot<'c, T>,
    thresholds: &'c Thresholds<'c>,
    rows: &'c [NormalisedRow<T>],
    set: &'c [usize],
    /// Sum of squares that it leaves.
    left: T,
    /// How much more a rival leaves at most.
    margin: T,
}

impl<T: Real> Contest<'_, T> {
    /// Looks closely at a set. Never inlined: hardly one in a thousand gets here, and the search over all is to stay small.
    #[inline(never)]
    fn has(&self, rival: &[usize]) -> bool {
        if rival.iter().all(|row| self.set.contains(row)) {
            return false;
        }
        Removal::among(self.rows, rival).is_some_and(|removal| {
            let sse = removal.sse(self.rows);
            let test = Detection::of(sse, removal.dof(self.snapshot), self.thresholds);
            sse - self.left < self.margin && test.is_some_and(|test| !test.fault())
        })
    }
}
