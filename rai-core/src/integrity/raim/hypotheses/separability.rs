//! Separability: does no other set of rows explain the data as well as the one that was left out?
//!
//! The set that explains the data best may consist of healthy satellites: of one if two are
//! strongly correlated, of several if few are left to contradict. Let a fault of row `j` have any
//! size, and let `ρ` be any correlation. Then `w_i² − w_j²` exceeds `κ²` with a probability of at
//! most `Q(κ)`. The proof takes `u = w_i − w_j` and `s = w_i + w_j`: the product `u s` needs
//! `u ≥ κ²/((1+ρ)δ)`, which is `κ √2/√(1+ρ) ≥ κ` standard deviations from its mean at the most
//! favourable δ.
//!
//! [`separable`] therefore requires that every other set of as many rows or fewer explains less by
//! `T_d²`, or fails the global test. A wrong exclusion is then no likelier than a false alarm. A
//! subset of the set found is no rival, because leaving out more than the faulty rows is safe.
//!
//! Work: all sets of up to as many of the testable rows.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `w_i` | [`Excluded::w_test`](crate::integrity::raim::isolation::exclusion::Excluded::w_test) | – |
//! | `T_d` | [`Thresholds::w_test`] | – |
//!
//! References: [Wang1994].
//!
//! [Wang1994]: crate#references

use heapless::Vec;

use super::constellation_shift;
use crate::bounded::gather;
use crate::integrity::raim::detection::Detection;
use crate::integrity::raim::detection::threshold::Thresholds;
use crate::integrity::raim::isolation::exclusion::Exclusion;
use crate::integrity::raim::isolation::sets::{SetBudget, each_of_size};
use crate::least_squares::downdate::{ExclusionSet, NormalisedRow, NormalisedRows, testable_rows};
use crate::least_squares::{Excludable, Snapshot, infinity};
use crate::numeric::real::Real;
use crate::report::MAX_EXCLUDED;

/// Returns true if no rival explains the data nearly as well as the exclusion: no other set of as
/// many rows or fewer, and no shifted constellation.
///
/// The rows are taken back together and left out again, so that `solution` ends as it began.
#[inline(never)]
pub fn separable<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    exclusion: &Exclusion<T>,
    thresholds: &Thresholds<'_>,
) -> bool {
    let set: Vec<usize, MAX_EXCLUDED> = gather(exclusion.rows.iter().map(|excluded| excluded.index));
    let found = solution.snapshot().sse();
    if solution.take_back(&set).is_err() {
        return false;
    }
    let unrivalled = is_unrivalled(solution.snapshot(), &set, thresholds)
        && !constellation_shift::rivals(solution.snapshot(), &set, found, thresholds);
    solution.set_aside(&set).is_ok() && unrivalled
}

/// Returns true if no other set of as many rows or fewer passes the global test with a sum of
/// squares within `T_d²` of this one's.
fn is_unrivalled<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    set: &[usize],
    thresholds: &Thresholds<'_>,
) -> bool {
    let mut rows = NormalisedRows::<T, N>::new();
    testable_rows(snapshot, &mut rows);
    let (Some(threshold), Some(found)) =
        (thresholds.w_test::<T>(snapshot.used()), ExclusionSet::among(&rows, set))
    else {
        return false;
    };
    let margin = threshold * threshold;
    let rival_test = RivalTest { snapshot, thresholds, rows: &rows, set, left: found.sse(&rows), margin };
    // The sums at hand lose digits to gross faults. A set that explains less than this by them
    // needs no closer test.
    let least = found.explained() - margin - snapshot.sse() * T::UNTESTABLE;
    let mut work = SetBudget::for_all();
    for size in 1..=set.len() {
        let mut has_rival = false;
        each_of_size::<T, N>(&rows, size, &mut work, least, &mut |_, rival| {
            has_rival |= rival.get(..size).is_some_and(|rival| rival_test.has(rival));
            // One rival suffices, so that no other set is shown.
            if has_rival { infinity() } else { least }
        });
        if has_rival {
            return false;
        }
    }
    !work.cut
}

/// A set that was found, and the limits that its rivals must reach.
struct RivalTest<'c, T: Real, const N: usize> {
    snapshot: &'c Snapshot<'c, T, N>,
    thresholds: &'c Thresholds<'c>,
    rows: &'c [NormalisedRow<T>],
    set: &'c [usize],
    /// Sum of squares without the set.
    left: T,
    /// Largest excess of a rival's sum of squares.
    margin: T,
}

impl<T: Real, const N: usize> RivalTest<'_, T, N> {
    /// Tests one set exactly. Never inlined, because few sets get here and the search over all must
    /// stay small.
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
