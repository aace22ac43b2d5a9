//! The search for the faulty satellites after a detected fault.

use heapless::Vec;

use super::raim::detection::Detection;
use super::raim::detection::threshold::Thresholds;
use super::raim::hypotheses::separability::separable;
use super::raim::isolation::baarda::exclude_sequentially;
#[cfg(not(feature = "searches"))]
use super::raim::isolation::exclusion::Unidentified;
use super::raim::isolation::exclusion::{Excluded, Exclusion, ExclusionOutcome, leave_out};
use super::raim::isolation::sets::count_up_to;
use super::raim::isolation::{parity, ransac};
use super::{Criteria, Method};
use crate::bounded::gather;
use crate::epoch::EpochView;
use crate::least_squares::Excludable;
use crate::numeric::real::Real;
use crate::report::MAX_EXCLUDED;
use crate::satellite::SatelliteId;

/// Largest number of sets that [`Method::Auto`] compares: all sets of up to three of 40 rows, some
/// 0.9 million instructions in `f32` on a Cortex-M4F. If there are more sets, sequential exclusion
/// by w-test is used, at a hundredth of the cost.
pub const AUTOMATIC_SETS: usize = parity::MAX_SETS;

/// SSE above which a fault is gross: ten thousand sigmas, some tens of kilometres. If such a fault
/// moves the position by `d`, the linearised ranges are wrong by `d²/2ρ`, which is metres.
const GROSS_SSE: f64 = 1e8;

/// Permitted search after a detected fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search<'s> {
    /// Search for the faulty satellites.
    Anew,
    /// Search about an inaccurate point and accept the result provisionally.
    ///
    /// The separability check is as expensive as the search. For satellites it therefore runs only
    /// at a better point, where these are [`Self::Known`].
    Rough,
    /// Leave out the satellites that a search about another point found, and search for no others.
    Known(&'s [SatelliteId]),
}

/// Searches for the faulty satellites and leaves them out.
///
/// Neither this function nor its branches are inlined. An epoch without a fault thus needs no stack
/// for a search, and each search only its own.
#[inline(never)]
pub(super) fn isolate<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    epoch: &EpochView<'_>,
    criteria: &Criteria<'_, T>,
    search: Search<'_>,
    #[cfg_attr(not(feature = "searches"), expect(unused_variables))] subsets: &mut ransac::Subsets<N>,
) -> Exclusion<T> {
    let thresholds = &criteria.thresholds;
    if let Search::Known(satellites) = search {
        let listed = epoch.observations().iter().enumerate();
        let equations = solution.snapshot().equations();
        let takes_part = |index: usize| equations.get(index).is_some_and(|row| row.weight > T::zero());
        // The rows of a system that is kept out are left out already.
        let known = listed
            .filter(|(index, observation)| satellites.contains(&observation.satellite) && takes_part(*index));
        let rows: Vec<usize, MAX_EXCLUDED> = gather(known.map(|(index, _)| index));
        return leave_out(solution, &rows, thresholds);
    }
    if solution.snapshot().sse() > T::narrow(GROSS_SSE) {
        // A gross fault distorts the linearised comparison of sets; a range error of one
        // millisecond (300 km) makes it useless. Leaving out the worst row and solving again about
        // another point avoids this.
        return exclude_sequentially(solution, thresholds);
    }
    match criteria.method {
        Method::Auto => isolate_within_budget(solution, thresholds),
        #[cfg(feature = "searches")]
        Method::Parity(isolation) => {
            parity::exclude(isolation, solution, thresholds, &parity::SearchLimits::published())
        }
        #[cfg(feature = "searches")]
        Method::Ransac => ransac::exclude_in(solution, epoch, thresholds, subsets),
        // [`Method::built_in`] refuses these methods before.
        #[cfg(not(feature = "searches"))]
        Method::Parity(_) | Method::Ransac => Exclusion::not_isolated(Unidentified::NoSet),
        // Only `Baarda` gets here: `judge` handles ARAIM, and a build without it refuses the
        // method.
        Method::Baarda | Method::Araim => exclude_sequentially(solution, thresholds),
    }
}

/// Compares every set of up to `dof/2` rows, at most three, the most that can be identified. If
/// these are too many, excludes sequentially by w-test.
fn isolate_within_budget<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    thresholds: &Thresholds<'_>,
) -> Exclusion<T> {
    let rows = (solution.snapshot().dof() / 2).min(MAX_EXCLUDED);
    if count_up_to(rows, solution.snapshot().used()) > AUTOMATIC_SETS {
        return exclude_sequentially(solution, thresholds);
    }
    let limits = parity::SearchLimits { rows, ..parity::SearchLimits::published() };
    parity::exclude(parity::Isolation::Grouping, solution, thresholds, &limits)
}

/// Returns the exclusion of an aiding row alone, if the rest then passes and no exclusion of a
/// satellite explains nearly as much.
///
/// It is tried before any method: a clock jump of a millisecond shows in every satellite's test. A
/// method that leaves out all rows that correlate with the worst would then leave out healthy ones.
pub(super) fn jump<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    row: usize,
    thresholds: &Thresholds<'_>,
) -> Option<Exclusion<T>> {
    let (_, fit) = solution.snapshot().row(row)?;
    let aid = Excluded { index: row, w_test: fit.w_test() };
    solution.leave_out(row).ok()?;
    let jump = Exclusion { rows: gather([aid]), outcome: ExclusionOutcome::Isolated };
    if Detection::passes(solution.snapshot(), thresholds) && separable(solution, &jump, thresholds) {
        return Some(jump);
    }
    // This cannot fail, because these rows were solved before.
    let _ = solution.take_back(&[row]);
    None
}
