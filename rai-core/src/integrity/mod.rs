//! Integrity: is something wrong, which satellite is faulty, and how large can the undetected error
//! be?
//!
//! ```text
//! fix ─► test ─► (search, leave out, test again) ─► is it the only explanation? ─► judgement
//! ```
//!
//! Within this module, [`judge`] and its search are the only places that distinguish one [`Method`]
//! from another. Outside, the method also decides on aiding rows and sigmas. A [`Judgement`] is the
//! method's result; the monitor derives the verdict from it ([`crate::monitor`]).
//!
//! **A clock forecast or a known height as one more row** adds redundancy, so that four satellites
//! can be tested. But a forecast comes from earlier epochs and is not independent of the receiver,
//! and a stated height may be wrong for as long as somebody states it. If the satellites can be
//! tested without these rows, the tests with and without them must both pass, and the larger
//! protection levels are reported.
//!
//! Such a row is a row like any other. It takes a degree of freedom and is a candidate of every
//! search, and its slope enters the levels. With `h = (0, 0, 1)`, `w = 1/σ_h²` and the covariance
//! `P` of the position with the height, it has the redundancy `r = 1 − w P_UU`, the gain `g = P h`
//! and the slopes `√(w/r) √(P_EU² + P_NU²)` and `√(w/r) P_UU`. The levels therefore bound an error
//! of the height of any size that the test misses, as they bound that of a satellite, but not
//! errors of both at once. Before any method searches, the row alone is left out if the test then
//! passes and no exclusion of a satellite fits nearly as well.

pub mod araim;
mod judgement;
mod method;
pub mod raim;
mod search;
mod systems;

use heapless::Vec;

use crate::bounded::{MAX_ROWS, gather};
use crate::epoch::EpochView;
use crate::least_squares::{Excludable, Snapshot};
use crate::numeric::real::Real;
use crate::requirements::Requirements;
use crate::weighting::Ism;
use crate::weighting::shared::SharedError;
#[cfg(feature = "araim")]
use araim::judge_epoch;
use raim::detection::Detection;
use raim::detection::threshold::Thresholds;
use raim::detection::threshold::policy::{NoThreshold, Policy, ThresholdProblem};
use raim::hypotheses::constellation_shift;
use raim::hypotheses::separability::separable;
use raim::hypotheses::time_tag::{EpochRates, RangeRates, TimeTagOutcome, is_suspicious};
use raim::isolation::exclusion::{Exclusion, ExclusionOutcome, Unidentified, leaves_enough};
use raim::isolation::ransac;
use raim::levels::{KFactors, LevelInputs, Levels};
use raim::shared_errors::shared_shift;
use search::{isolate, jump};

pub use judgement::{Judgement, Test, WithoutAiding};
pub use method::{Method, MethodError};
pub use search::{AUTOMATIC_SETS, Search};
pub(crate) use systems::KeptOut;

/// Criteria of a judgement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Criteria<'c, T> {
    /// Limits and probabilities.
    pub requirements: &'c Requirements,
    /// Thresholds for these probabilities.
    pub thresholds: Thresholds<'static>,
    /// Factors of the protection levels for these probabilities.
    pub factors: &'c KFactors<T>,
    /// Threshold policy of the global test.
    pub policy: Policy,
    /// Method that finds the faulty satellites.
    pub method: Method,
    /// Quantity that a protection level bounds.
    pub levels: Levels,
    /// Integrity support message, for [`Method::Araim`].
    pub ism: &'c Ism,
}

/// Scratch memory of the methods, and the subsets that [`Method::Ransac`] keeps from epoch to
/// epoch.
#[derive(Clone, Debug)]
pub struct MethodScratch<T: Real, const N: usize = MAX_ROWS> {
    /// Subsets of [`Method::Ransac`].
    pub subsets: ransac::Subsets<N>,
    /// Made at the first use, so that this large value is made in place and not on the stack first.
    #[cfg(feature = "araim")]
    araim: Option<araim::AraimScratch<T, N>>,
    #[cfg(not(feature = "araim"))]
    scalar: core::marker::PhantomData<T>,
}

impl<T: Real, const N: usize> Default for MethodScratch<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real, const N: usize> MethodScratch<T, N> {
    /// Returns empty scratch memory.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub fn new() -> Self {
        Self {
            subsets: ransac::Subsets::new(),
            #[cfg(feature = "araim")]
            araim: None,
            #[cfg(not(feature = "araim"))]
            scalar: core::marker::PhantomData,
        }
    }

    // Not inlined, so that the stack of the initialisation is free during the judging.
    #[cfg(feature = "araim")]
    #[inline(never)]
    fn araim(&mut self) -> &mut araim::AraimScratch<T, N> {
        self.araim.get_or_insert_with(araim::AraimScratch::new)
    }
}

impl<T: Real> Criteria<'_, T> {
    /// Applies the global test to a snapshot under the policy, and computes the protection levels
    /// for its threshold.
    ///
    /// `shared` are the shared errors of the first rows ([`EpochView::shared`]).
    ///
    /// # Errors
    /// [`NoThreshold`] names the reason why no threshold exists.
    pub fn test<const N: usize>(
        &self,
        snapshot: &Snapshot<'_, T, N>,
        shared: &[SharedError],
    ) -> Result<Test<T>, NoThreshold> {
        let exposure = LevelInputs::of(snapshot, self.levels, self.factors);
        let demand = ThresholdProblem::new(snapshot.dof(), &exposure, self.requirements, self.thresholds);
        let threshold = demand.threshold::<T>(self.policy)?;
        let detection =
            Detection { sse: snapshot.sse(), threshold: T::narrow(threshold.tau), dof: snapshot.dof() };
        let shift = shared_shift(snapshot, shared);
        Ok(Test { detection, levels: exposure.protect(threshold.lambda).plus(&shift) })
    }
}

/// Tests a solution, searches for faulty rows and leaves them out.
///
/// `forecast` is the row of a predicted clock, if there is one. A caller that knows orbits passes
/// `rates`, which distinguish wrong time tags from faulty satellites
/// ([`raim::hypotheses::time_tag`]). `solution` ends as the solution without the rows of
/// [`Judgement::excluded`].
pub fn judge<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    epoch: &EpochView<'_>,
    forecast: Option<usize>,
    criteria: &Criteria<'_, T>,
    search: Search<'_>,
    rates: Option<&RangeRates<'_>>,
    scratch: &mut MethodScratch<T, N>,
) -> Judgement<T> {
    #[cfg(feature = "araim")]
    if criteria.method == Method::Araim {
        return judge_epoch(solution, epoch, criteria, rates, scratch.araim());
    }
    judge_by_residuals(solution, epoch, forecast, criteria, search, rates, &mut scratch.subsets)
}

// Not inlined, because ARAIM has the deepest stack of all and needs nothing of this frame.
#[inline(never)]
fn judge_by_residuals<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    epoch: &EpochView<'_>,
    forecast: Option<usize>,
    criteria: &Criteria<'_, T>,
    search: Search<'_>,
    rates: Option<&RangeRates<'_>>,
    subsets: &mut ransac::Subsets<N>,
) -> Judgement<T> {
    let height = height_row(solution.snapshot(), epoch);
    let aiding = || [forecast, height].into_iter().flatten();
    let mut test = criteria.test(solution.snapshot(), epoch.shared());
    let mut exclusion = Exclusion::passed();
    let mut searched = false;
    // With τ1 under every policy, because a wrong time may move the position more than the fault of
    // a satellite that the policy tolerates.
    let is_odd = test.is_ok() && is_suspicious(solution.snapshot(), &criteria.thresholds);
    if test.as_ref().is_ok_and(|test| test.detection.fault()) {
        let jump = aiding().find_map(|row| jump(solution, row, &criteria.thresholds));
        searched = jump.is_none() && !matches!(search, Search::Known(_));
        exclusion = jump.unwrap_or_else(|| isolate(solution, epoch, criteria, search, subsets));
        test = criteria.test(solution.snapshot(), epoch.shared());
    }
    let aids: Vec<usize, 2> = gather(aiding());
    let without_aiding =
        if aids.is_empty() { WithoutAiding::Always } else { without_aids(solution, &aids, epoch, criteria) };
    if let WithoutAiding::Tested(test) = &without_aiding
        && test.detection.fault()
    {
        exclusion.outcome = ExclusionOutcome::NotIsolated(Unidentified::NoSet);
    }
    if exclusion.outcome == ExclusionOutcome::Isolated && test.is_ok() {
        let satellites = exclusion.rows.iter().filter(|excluded| !aids.contains(&excluded.index)).count();
        if !leaves_enough(satellites, solution.snapshot().dof()) {
            exclusion.outcome = ExclusionOutcome::NotIsolated(Unidentified::NoRedundancy);
        } else if search != Search::Rough && !separable(solution, &exclusion, &criteria.thresholds) {
            exclusion.outcome = ExclusionOutcome::NotIsolated(Unidentified::Ambiguous);
        }
    }
    // After a rough search, a result with exclusions is checked at the next point, which is better.
    let is_asked = search != Search::Rough || exclusion.outcome == ExclusionOutcome::Passed;
    let is_good = test.is_ok() && !matches!(exclusion.outcome, ExclusionOutcome::NotIsolated(_));
    if is_asked && is_good && constellation_shift::shows(solution.snapshot(), &criteria.thresholds) {
        exclusion.outcome = ExclusionOutcome::NotIsolated(Unidentified::Ambiguous);
    }
    let is_believed = searched && search == Search::Rough && exclusion.outcome == ExclusionOutcome::Isolated;
    let asked = rates.filter(|_| is_odd && !is_believed);
    if let Some(rates) = asked.and_then(|rates| EpochRates::of(epoch, rates)) {
        match rates.compare(solution, &exclusion, &criteria.thresholds, criteria.factors) {
            TimeTagOutcome::Rows if exclusion.outcome == ExclusionOutcome::Isolated => {
                exclusion.outcome = ExclusionOutcome::NotIsolated(Unidentified::Ambiguous);
            }
            TimeTagOutcome::None | TimeTagOutcome::Rows => {}
            TimeTagOutcome::Shift(slopes, shown) => {
                if let Ok(test) = &mut test {
                    let snapshot = solution.snapshot();
                    let levels = LevelInputs::of(snapshot, criteria.levels, criteria.factors)
                        .protect_against(slopes, shown, criteria.factors)
                        .plus(&shared_shift(snapshot, epoch.shared()));
                    test.levels = test.levels.or_larger(&levels);
                }
            }
            TimeTagOutcome::Time => {
                exclusion = Exclusion::not_isolated(Unidentified::Time);
                test = criteria.test(solution.snapshot(), epoch.shared());
            }
        }
    }
    let mut judgement = Judgement {
        outcome: exclusion.outcome,
        excluded: exclusion.rows,
        test,
        without_aiding,
        lost_systems: 0,
        searched,
        araim: None,
    };
    if cfg!(feature = "hypotheses")
        && matches!(judgement.outcome, ExclusionOutcome::NotIsolated(reason) if reason != Unidentified::Time)
    {
        systems::leave_out_broken(solution, epoch, &aids, criteria, rates, &mut judgement);
    }
    judgement
}

/// Returns the row of a known height, which stands behind the satellites and touches no clock.
pub(crate) fn height_row<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    epoch: &EpochView<'_>,
) -> Option<usize> {
    if !cfg!(feature = "aiding") {
        return None;
    }
    let satellites = epoch.observations().len();
    let behind = snapshot.equations().get(satellites..)?;
    Some(satellites + behind.iter().position(|row| row.clock.is_none())?)
}

/// Tests a solution without its aiding rows; the solution ends as it began.
#[inline(never)]
fn without_aids<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    aids: &[usize],
    epoch: &EpochView<'_>,
    criteria: &Criteria<'_, T>,
) -> WithoutAiding<T> {
    let takes_part =
        |row: &usize| solution.snapshot().row(*row).is_some_and(|(row, _)| row.weight > T::zero());
    let taking_part: Vec<usize, 2> = gather(aids.iter().copied().filter(takes_part));
    if taking_part.is_empty() {
        return WithoutAiding::Always;
    }
    if solution.set_aside(&taking_part).is_err() {
        return WithoutAiding::Untested;
    }
    let test = criteria.test(solution.snapshot(), epoch.shared());
    // This cannot fail, because the solution with these rows existed before.
    let _ = solution.take_back(&taking_part);
    test.map_or(WithoutAiding::Untested, WithoutAiding::Tested)
}
