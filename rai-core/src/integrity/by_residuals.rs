//! Judgement by the residuals of all rows at once: every method except ARAIM.
//!
//! ```text
//! find: test ─► jump of an aid, or search ─► test again
//! question: do satellites alone agree? is it the only explanation?
//! ask the rates: is the time tag wrong instead?
//! leave out a system that is broken as a whole
//! ```
//!
//! Each step takes a [`Finding`] and may turn an exclusion into a doubt, never the reverse, except
//! the last: it takes what no step explained.

use heapless::Vec;

use super::judgement::{Judgement, Test, WithoutAiding};
use super::raim::detection::threshold::policy::NoThreshold;
use super::raim::hypotheses::constellation_shift;
use super::raim::hypotheses::separability::separable;
use super::raim::hypotheses::time_tag::{EpochRates, RangeRates, TimeTagOutcome, is_suspicious};
use super::raim::isolation::exclusion::{Exclusion, ExclusionOutcome, Unidentified, leaves_enough};
use super::raim::isolation::ransac;
use super::raim::levels::LevelInputs;
use super::search::{Search, isolate, jump};
use super::{Criteria, height_row, systems};
use crate::bounded::gather;
use crate::epoch::EpochView;
use crate::least_squares::Excludable;
use crate::numeric::real::Real;

/// What a judgement is about.
struct Case<'j, T> {
    epoch: &'j EpochView<'j>,
    criteria: &'j Criteria<'j, T>,
    search: Search<'j>,
    /// Rows that are no satellites: the forecast of the clock, the known height.
    aids: Vec<usize, 2>,
}

/// What the steps have found so far.
struct Finding<T> {
    /// Test of the rows that are not excluded.
    test: Result<Test<T>, NoThreshold>,
    exclusion: Exclusion<T>,
    /// True if a method searched for faulty satellites.
    searched: bool,
    /// True if a wrong time tag could explain the residuals of all rows.
    may_be_time: bool,
}

impl<T> Finding<T> {
    fn is(&self, outcome: ExclusionOutcome) -> bool {
        self.exclusion.outcome == outcome
    }

    fn doubt(&mut self, reason: Unidentified) {
        self.exclusion.outcome = ExclusionOutcome::NotIsolated(reason);
    }
}

/// Tests a solution, searches for faulty rows and leaves them out, as [`super::judge`] says.
// Not inlined, because ARAIM has the deepest stack and does not need this frame.
#[inline(never)]
pub(super) fn judge_by_residuals<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    epoch: &EpochView<'_>,
    forecast: Option<usize>,
    criteria: &Criteria<'_, T>,
    search: Search<'_>,
    rates: Option<&RangeRates<'_>>,
    subsets: &mut ransac::Subsets<N>,
) -> Judgement<T> {
    let height = height_row(solution.snapshot(), epoch);
    let case = Case { epoch, criteria, search, aids: gather([forecast, height].into_iter().flatten()) };
    let mut finding = case.find(solution, subsets);
    let without_aiding = match case.aids.as_slice() {
        [] => WithoutAiding::Always,
        aids => without_aids(solution, aids, epoch, criteria),
    };
    case.question(solution, &without_aiding, &mut finding);
    if let Some(rates) = rates {
        case.ask_rates(solution, rates, &mut finding);
    }
    let Finding { test, exclusion, searched, .. } = finding;
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
        systems::leave_out_broken(solution, epoch, &case.aids, criteria, rates, &mut judgement);
    }
    judgement
}

impl<T: Real> Case<'_, T> {
    /// Tests all rows. If the test fails, leaves out an aid that has jumped, or what the method
    /// finds, and tests again.
    fn find<const N: usize>(
        &self,
        solution: &mut impl Excludable<T, N>,
        subsets: &mut ransac::Subsets<N>,
    ) -> Finding<T> {
        let Self { epoch, criteria, search, aids } = self;
        let mut test = criteria.test(solution.snapshot(), epoch.shared());
        // The time test uses `τ1` under every policy: a wrong time may move the position farther
        // than the satellite faults that a policy tolerates.
        let may_be_time = test.is_ok() && is_suspicious(solution.snapshot(), &criteria.thresholds);
        let mut exclusion = Exclusion::passed();
        let mut searched = false;
        if test.as_ref().is_ok_and(|test| test.detection.fault()) {
            let jump = aids.iter().find_map(|&row| jump(solution, row, &criteria.thresholds));
            searched = jump.is_none() && !matches!(search, Search::Known(_));
            exclusion = jump.unwrap_or_else(|| isolate(solution, epoch, criteria, *search, subsets));
            test = criteria.test(solution.snapshot(), epoch.shared());
        }
        Finding { test, exclusion, searched, may_be_time }
    }

    /// Doubts a result that satellites alone contradict, that leaves too few of them, or that is
    /// not the only explanation.
    fn question<const N: usize>(
        &self,
        solution: &mut impl Excludable<T, N>,
        without_aiding: &WithoutAiding<T>,
        finding: &mut Finding<T>,
    ) {
        let Self { criteria, search, aids, .. } = self;
        let is_rough = *search == Search::Rough;
        if matches!(without_aiding, WithoutAiding::Tested(test) if test.detection.fault()) {
            finding.doubt(Unidentified::NoSet);
        }
        if finding.is(ExclusionOutcome::Isolated) && finding.test.is_ok() {
            let rows = finding.exclusion.rows.iter();
            let satellites = rows.filter(|excluded| !aids.contains(&excluded.index)).count();
            if !leaves_enough(satellites, solution.snapshot().dof()) {
                finding.doubt(Unidentified::NoRedundancy);
            } else if !is_rough && !separable(solution, &finding.exclusion, &criteria.thresholds) {
                finding.doubt(Unidentified::Ambiguous);
            }
        }
        // After a rough search, a result with exclusions is checked at the next, more accurate
        // point.
        let is_asked = !is_rough || finding.is(ExclusionOutcome::Passed);
        let is_good =
            finding.test.is_ok() && !matches!(finding.exclusion.outcome, ExclusionOutcome::NotIsolated(_));
        if is_asked && is_good && constellation_shift::shows(solution.snapshot(), &criteria.thresholds) {
            finding.doubt(Unidentified::Ambiguous);
        }
    }

    /// Compares the finding with the range rates: a wrong time tag moves every range by its rate.
    fn ask_rates<const N: usize>(
        &self,
        solution: &mut impl Excludable<T, N>,
        rates: &RangeRates<'_>,
        finding: &mut Finding<T>,
    ) {
        let Self { epoch, criteria, search, .. } = self;
        let is_isolated = finding.is(ExclusionOutcome::Isolated);
        let is_believed = finding.searched && *search == Search::Rough && is_isolated;
        if !finding.may_be_time || is_believed {
            return;
        }
        let Some(rates) = EpochRates::of(epoch, rates) else { return };
        match rates.compare(solution, &finding.exclusion, &criteria.thresholds, criteria.factors) {
            TimeTagOutcome::Rows if is_isolated => finding.doubt(Unidentified::Ambiguous),
            TimeTagOutcome::None | TimeTagOutcome::Rows => {}
            TimeTagOutcome::Shift(slopes, shown) => {
                if let Ok(test) = &mut finding.test {
                    let snapshot = solution.snapshot();
                    let levels = LevelInputs::of(snapshot, criteria.levels, criteria.factors)
                        .protect_against(slopes, shown, criteria.factors)
                        .plus(&criteria.shared_shift(snapshot, epoch.shared()));
                    test.levels = test.levels.or_larger(&levels);
                }
            }
            TimeTagOutcome::Time => {
                finding.exclusion = Exclusion::not_isolated(Unidentified::Time);
                finding.test = criteria.test(solution.snapshot(), epoch.shared());
            }
        }
    }
}

/// Tests a solution without its aiding rows, and then restores them.
#[inline(never)]
pub(super) fn without_aids<T: Real, const N: usize>(
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
    // This cannot fail, because these rows were solved before.
    let _ = solution.take_back(&taking_part);
    test.map_or(WithoutAiding::Untested, WithoutAiding::Tested)
}
