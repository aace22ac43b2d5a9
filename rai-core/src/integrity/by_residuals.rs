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
use super::raim::hypotheses::separability::rivals;
use super::raim::hypotheses::time_tag::{EpochRates, RangeRates, TimeTagOutcome, is_suspicious};
use super::raim::isolation::exclusion::{Exclusion, ExclusionOutcome, Unidentified, leaves_enough};
use super::raim::isolation::ransac;
use super::raim::levels::LevelInputs;
use super::search::{Search, isolate, jump};
use super::{Criteria, height_row, systems};
use crate::bit_set::bit;
use crate::bounded::gather;
use crate::epoch::EpochView;
use crate::least_squares::{Excludable, Snapshot};
use crate::numeric::real::Real;
use crate::report::ProtectionLevels;
use crate::weighting::residuals::Residuals;

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
    /// True if the levels hold for every explanation of an ambiguous fault.
    is_covered: bool,
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
    let Finding { test, exclusion, searched, is_covered, .. } = finding;
    let mut judgement = Judgement {
        outcome: exclusion.outcome,
        excluded: exclusion.rows,
        test,
        without_aiding,
        is_covered,
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
        Finding { test, exclusion, searched, may_be_time, is_covered: false }
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
            } else if !is_rough {
                self.ask_for_rivals(solution, finding);
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

    /// Doubts a result beside which other sets of satellites explain the residuals, and computes the
    /// levels that hold whichever is faulty.
    fn ask_for_rivals<const N: usize>(&self, solution: &mut impl Excludable<T, N>, finding: &mut Finding<T>) {
        let Self { criteria, aids, .. } = self;
        let rivals = rivals(solution, &finding.exclusion, &criteria.thresholds);
        if rivals.is_none() {
            return;
        }
        finding.doubt(Unidentified::Ambiguous);
        // An aid whose error is another explanation has no bound but its sigma. A build that does not
        // see shifted systems, or noise beyond the sigmas, would cover those as faults of satellites.
        let is_seen_otherwise = cfg!(all(feature = "hypotheses", feature = "past"));
        if is_seen_otherwise
            && aids.is_empty()
            && !constellation_shift::shows(solution.snapshot(), &criteria.thresholds)
        {
            finding.is_covered = rivals.all().is_some_and(|rivals| self.cover(solution, finding, rivals));
        }
    }

    /// Widens the levels about the position of a solution without the excluded set, so that they hold
    /// whichever set is faulty ([`super::raim::hypotheses::separability`]). Returns false if there are
    /// no such levels.
    ///
    /// A rival leaves larger residuals. If it is the faulty one, they are those of the noise, so that
    /// its levels grow with them, as those of a whole epoch do (`monitor::evidence`).
    ///
    /// The rows are taken back for the comparison and left out again.
    fn cover<const N: usize>(
        &self,
        solution: &mut impl Excludable<T, N>,
        finding: &mut Finding<T>,
        rivals: &[u64],
    ) -> bool {
        let Ok(Test { levels: most, .. }) = &mut finding.test else { return false };
        let set = finding.exclusion.rows.iter().fold(0, |set, excluded| set | bit(excluded.index));
        let position = solution.snapshot().correction();
        let mut are_covered = leaves_company(solution.snapshot(), &finding.exclusion);
        solution.take_back_all(set);
        for &rival in rivals {
            if solution.set_aside_all(rival).is_err() {
                are_covered = false;
                continue;
            }
            let snapshot = solution.snapshot();
            let apart = snapshot.correction() - position;
            if let Ok(Test { levels, .. }) = self.criteria.test(snapshot, self.epoch.shared()) {
                let rest = Residuals { sse: snapshot.sse().widen() as f32, dof: snapshot.dof() as u32 };
                let horizontal = (apart.x * apart.x + apart.y * apart.y).sqrt_approx();
                let apart = ProtectionLevels::new(horizontal.widen(), apart.z.abs().widen());
                *most = most.or_larger(&levels.times(f64::from(rest.growth())).plus(&apart));
            } else {
                are_covered = false;
            }
            solution.take_back_all(rival);
        }
        solution.set_aside_all(set).is_ok() && are_covered
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
            TimeTagOutcome::Rows => {
                // The levels do not cover this explanation.
                finding.is_covered = false;
                if is_isolated {
                    finding.doubt(Unidentified::Ambiguous);
                }
            }
            TimeTagOutcome::None => {}
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

/// Returns true if the systems of the excluded rows keep two satellites or more each.
///
/// One that keeps a single satellite has a clock for that alone: the contradiction may be one of
/// systems, and the others may be wrong.
fn leaves_company<T: Real, const N: usize>(snapshot: &Snapshot<'_, T, N>, exclusion: &Exclusion<T>) -> bool {
    let rows = snapshot.equations();
    exclusion
        .rows
        .iter()
        .filter_map(|excluded| rows.get(excluded.index))
        .all(|gone| rows.iter().filter(|row| row.clock == gone.clock && row.weight > T::zero()).count() > 1)
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
