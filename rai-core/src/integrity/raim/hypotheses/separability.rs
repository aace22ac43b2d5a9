//! Separability: is the set of rows that was left out the only one that explains the data?
//!
//! The set that explains the data best may consist of healthy satellites. One healthy satellite may
//! do so if it is strongly correlated with the faulty one, several if few others remain to
//! contradict them. Let `δ` be the mean of `w_j` under a fault of row `j`, of any size, and `ρ` the
//! correlation of `w_i` and `w_j`. Then `w_i² − w_j²` exceeds `κ²` with a probability of at most
//! `Q(κ)`. For the proof, let `a = w_i − w_j` and `b = w_i + w_j`. The product `a b` needs
//! `a ≥ κ²/((1+ρ)δ)`. At the most favourable `δ` this is `κ √2/√(1+ρ) ≥ κ` standard deviations from
//! the mean of `a`.
//!
//! A rival is another set with as many rows or fewer, without which the rest passes the global
//! test, and which explains less than `T_d²` less. Without a rival, a wrong exclusion is no likelier
//! than a false alarm. A subset of the excluded set is no rival, because leaving out more than the
//! faulty rows is safe.
//!
//! With rivals the faulty set is the excluded one or one of them, and the position without it has
//! its own levels. So a level about the position without the excluded set holds whichever it is, if
//! it covers each of these intervals:
//!
//! ```text
//! HPL = max( HPL without the excluded set,  max over rivals of  |x − x_rival| + g HPL without it )
//! ```
//!
//! Work: all sets of up to as many of the testable rows, and two solutions for each rival.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `w_i` | [`Excluded::w_test`](crate::integrity::raim::isolation::exclusion::Excluded::w_test) | – |
//! | `T_d` | [`Thresholds::w_test`] | – |
//! | `g` | factor on the sigmas that the residuals without the rival show, at least 1 | – |
//! | `x`, `x_rival` | [`Snapshot::correction`] without the excluded set, and without a rival | m |
//!
//! References: [Wang1994].
//!
//! [Wang1994]: crate#references

use heapless::Vec;

use super::constellation_shift;
use crate::bit_set::set_of;
use crate::bounded::gather;
use crate::integrity::raim::detection::Detection;
use crate::integrity::raim::detection::threshold::Thresholds;
use crate::integrity::raim::isolation::exclusion::Exclusion;
use crate::integrity::raim::isolation::sets::{SetBudget, each_of_size};
use crate::least_squares::downdate::{ExclusionSet, NormalisedRow, NormalisedRows, testable_rows};
use crate::least_squares::{Excludable, Snapshot, infinity};
use crate::numeric::real::Real;
use crate::report::MAX_EXCLUDED;

/// Largest number of rivals that a level can cover: with more, the levels are large as well.
const MAX_RIVALS: usize = 8;

/// Other explanations of the data.
#[derive(Clone, Debug)]
pub struct Rivals {
    sets: Vec<u64, MAX_RIVALS>,
    /// True if there is no other explanation than these sets: not more of them, and no shifted
    /// constellation.
    are_all: bool,
}

impl Rivals {
    /// Rivals that nobody has counted.
    const UNKNOWN: Self = Self { sets: Vec::new(), are_all: false };

    /// Returns true if the excluded set is the only explanation.
    pub fn is_none(&self) -> bool {
        self.are_all && self.sets.is_empty()
    }

    /// Adds a set; returns false if there is no room.
    fn add(&mut self, rival: &[usize]) -> bool {
        self.are_all &= self.sets.push(set_of(rival)).is_ok();
        self.are_all
    }

    /// Returns the sets; `None` if there are other explanations than these.
    pub fn all(&self) -> Option<&[u64]> {
        self.are_all.then_some(&self.sets)
    }
}

/// Returns true if no rival explains the data nearly as well as the exclusion: no other set of as
/// many rows or fewer, and no shifted constellation.
///
/// The rows are taken back for the comparison and left out again.
pub fn separable<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    exclusion: &Exclusion<T>,
    thresholds: &Thresholds<'_>,
) -> bool {
    rivals(solution, exclusion, thresholds).is_none()
}

/// Returns what explains the data nearly as well as the exclusion.
///
/// The rows are taken back for the comparison and left out again.
#[inline(never)]
pub fn rivals<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    exclusion: &Exclusion<T>,
    thresholds: &Thresholds<'_>,
) -> Rivals {
    let set = rows_of(exclusion);
    let found = solution.snapshot().sse();
    if solution.take_back(&set).is_err() {
        return Rivals::UNKNOWN;
    }
    let mut rivals = rival_sets(solution.snapshot(), &set, thresholds);
    rivals.are_all &= !constellation_shift::rivals(solution.snapshot(), &set, found, thresholds);
    rivals.are_all &= solution.set_aside(&set).is_ok();
    rivals
}

fn rows_of<T>(exclusion: &Exclusion<T>) -> Vec<usize, MAX_EXCLUDED> {
    gather(exclusion.rows.iter().map(|excluded| excluded.index))
}

/// Returns the rivals among the sets: others, of as many rows or fewer, that leave a passing SSE
/// which is less than `T_d²` larger.
fn rival_sets<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    set: &[usize],
    thresholds: &Thresholds<'_>,
) -> Rivals {
    let mut rows = NormalisedRows::<T, N>::new();
    testable_rows(snapshot, &mut rows);
    let (Some(threshold), Some((explained, left))) =
        (thresholds.w_test::<T>(snapshot.used()), explained_and_left(&rows, set))
    else {
        return Rivals::UNKNOWN;
    };
    let margin = threshold * threshold;
    let rival_test = RivalTest { snapshot, thresholds, rows: &rows, set, left, margin };
    // Gross faults cost these sums digits, so that the bar has a margin. A set whose sum stays
    // below the bar needs no exact test.
    let least = explained - margin - snapshot.sse() * T::UNTESTABLE;
    let mut work = SetBudget::for_all();
    let mut rivals = Rivals { sets: Vec::new(), are_all: true };
    for size in 1..=set.len() {
        each_of_size::<T, N>(&rows, size, &mut work, least, &mut |_, rival| {
            let rival = rival.get(..size).unwrap_or_default();
            // More than there is room for: an infinite bar ends the search.
            if !rival_test.has(rival) || rivals.add(rival) { least } else { infinity() }
        });
    }
    rivals.are_all &= !work.cut;
    rivals
}

/// Returns the part of the SSE that a set explains, and the SSE without the set. Not inlined, so
/// that the set is not on the stack while its rivals are searched for.
#[inline(never)]
fn explained_and_left<T: Real>(rows: &[NormalisedRow<T>], set: &[usize]) -> Option<(T, T)> {
    let found = ExclusionSet::among(rows, set)?;
    Some((found.explained(), found.sse(rows)))
}

/// The excluded set, and the limits that a rival must reach.
struct RivalTest<'c, T: Real, const N: usize> {
    snapshot: &'c Snapshot<'c, T, N>,
    thresholds: &'c Thresholds<'c>,
    rows: &'c [NormalisedRow<T>],
    set: &'c [usize],
    /// SSE without the excluded set.
    left: T,
    /// Largest excess of the SSE without a rival over `left`.
    margin: T,
}

impl<T: Real, const N: usize> RivalTest<'_, T, N> {
    /// Tests one set exactly. Not inlined, because few sets get here, and the loop over all sets
    /// must stay small.
    #[inline(never)]
    fn has(&self, rival: &[usize]) -> bool {
        if rival.iter().all(|row| self.set.contains(row)) {
            return false;
        }
        ExclusionSet::among(self.rows, rival).is_some_and(|removal| {
            let sse = removal.sse(self.rows);
            let test = Detection::of(sse, removal.dof(self.snapshot), self.thresholds);
            sse - self.left < self.margin && test.is_some_and(|test| !test.fault())
        })
    }
}
