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

/// Most sets that [`Method::Auto`] compares: all of up to three of 40 rows, some 0.9 million
/// instructions in `f32` on a Cortex-M4F. Beyond, the largest w-test costs a hundredth.
pub const AUTOMATIC_SETS: usize = parity::MAX_SETS;

/// Sum of squares of a gross fault: ten thousand sigmas, some tens of kilometres. If it moves the
/// position by `d`, the linearised ranges are off by `d²/2ρ`, metres.
const GROSS_SSE: f64 = 1e8;

/// Permitted search after a detected fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search<'s> {
    /// Search for the faulty satellites.
    Anew,
    /// Search about an inaccurate point and accept the result provisionally.
    ///
    /// The separability check, as expensive as the search, runs from a better point, where the
    /// satellites are [`Self::Known`].
    Rough,
    /// Leave out the satellites that a search about another point found, and search for no others.
    Known(&'s [SatelliteId]),
}

/// Searches for the faulty satellites and leaves them out.
///
/// A separate function, as are its branches, so that an epoch without a fault does not pay for the
/// stack of the searches, and each search only for its own.
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
        // A system that is kept out has no rows to leave out.
        let known = listed
            .filter(|(index, observation)| satellites.contains(&observation.satellite) && takes_part(*index));
        let rows: Vec<usize, MAX_EXCLUDED> = gather(known.map(|(index, _)| index));
        return leave_out(solution, &rows, thresholds);
    }
    if solution.snapshot().sse() > T::narrow(GROSS_SSE) {
        // A gross fault distorts the linearised comparison of sets, beyond recognition at one
        // millisecond. Leaving out the worst row and solving again about another point is robust
        // against it.
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
        // A monitor refuses them.
        #[cfg(not(feature = "searches"))]
        Method::Parity(_) | Method::Ransac => Exclusion::not_isolated(Unidentified::NoSet),
        // ARAIM excludes by its own tests.
        Method::Baarda | Method::Araim => exclude_sequentially(solution, thresholds),
    }
}

/// Isolates by every set if sets can be distinguished at all, or by the largest w-test if they are
/// too many.
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

/// Returns the exclusion of an aiding row alone, if it explains everything and no satellite does
/// nearly as well.
///
/// This comes before any method: a jump of a millisecond shows in every satellite's test, and
/// methods that leave out all rows that correlate with the worst would leave out healthy ones.
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
    // These rows determined a position a moment ago.
    let _ = solution.take_back(&[row]);
    None
}
