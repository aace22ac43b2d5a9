//! Integrity: is something wrong, which satellite is faulty, and how large can the undetected error
//! be?
//!
//! ```text
//! fix ─► test ─► (search, leave out, test again) ─► is it the only explanation? ─► judgement
//! ```
//!
//! [`judge`] is the only place that distinguishes one [`Method`] from another. A [`Judgement`] is
//! the method's result; the monitor derives the verdict from it ([`crate::monitor`]).
//!
//! **A clock forecast beside the satellites** lets four satellites be tested, but it confirms
//! itself. If the satellites can be tested without it, both tests must pass, and the larger
//! protection levels count.

pub mod araim;
pub mod raim;

use heapless::Vec;

use crate::bounded::gather;
use crate::epoch::EpochView;
use crate::least_squares::{Excludable, Snapshot};
use crate::numeric::real::Real;
use crate::report::{AraimReport, MAX_EXCLUDED, ProtectionLevels};
use crate::requirements::Requirements;
use crate::satellite::SatelliteId;
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
use raim::isolation::baarda::exclude_sequentially;
use raim::isolation::exclusion::{
    Excluded, Exclusion, ExclusionOutcome, Unidentified, leave_out, leaves_enough,
};
use raim::isolation::sets::count_up_to;
use raim::isolation::{parity, ransac};
use raim::levels::{KFactors, LevelInputs, Levels};
use raim::shared_errors::shared_shift;

/// Method that finds the faulty satellites.
///
/// ```
/// use raim_core::{Method, Monitor, Requirements};
/// use raim_core::monitor::Strategy;
///
/// let mut monitor = Monitor::<f32, 16>::new(Requirements::en_route())?;
/// monitor.set_strategy(Strategy { method: Method::Baarda, ..Strategy::DEFAULT });
/// # Ok::<(), raim_core::monitor::MonitorError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Method {
    /// Every set of one row, then of two, then of three, within [`AUTOMATIC_SETS`]; beyond, the
    /// largest w-test.
    Auto,
    /// The largest w-test, repeatedly.
    Baarda,
    /// Searches in parity space.
    #[cfg(feature = "searches")]
    Parity(parity::Isolation),
    /// Consensus of disjoint subsets.
    #[cfg(feature = "searches")]
    Ransac,
    /// Solution separation over all monitored fault modes: ARAIM.
    #[cfg(feature = "araim")]
    Araim,
}

impl Method {
    /// Returns true if a clock forecast may take a row: ARAIM has no fault mode for it.
    pub(crate) fn allows_clock_aiding(self) -> bool {
        !self.uses_ism()
    }

    /// Returns true if sigmas are those of an integrity support message, and not the expected ones.
    #[cfg_attr(not(feature = "araim"), expect(clippy::unused_self, reason = "no other method does"))]
    pub(crate) fn uses_ism(self) -> bool {
        #[cfg(feature = "araim")]
        if self == Self::Araim {
            return true;
        }
        false
    }
}

/// Most sets that [`Method::Auto`] compares: all of up to three of 40 rows, some 0.9 million
/// instructions in `f32` on a Cortex-M4F. Beyond, the largest w-test costs a hundredth.
pub const AUTOMATIC_SETS: usize = parity::MAX_SETS;

/// Sum of squares of a gross fault: ten thousand sigmas, some tens of kilometres. If it moves the
/// position by `d`, the linearised ranges are off by `d²/2ρ`, metres.
const GROSS_SSE: f64 = 1e8;

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
pub struct MethodScratch<T: Real> {
    /// Subsets of [`Method::Ransac`].
    pub subsets: ransac::Subsets,
    /// Made at the first use, so that this large value is made in place and not on the stack first.
    #[cfg(feature = "araim")]
    araim: Option<araim::AraimScratch<T>>,
    #[cfg(not(feature = "araim"))]
    scalar: core::marker::PhantomData<T>,
}

impl<T: Real> Default for MethodScratch<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real> MethodScratch<T> {
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
    fn araim(&mut self) -> &mut araim::AraimScratch<T> {
        self.araim.get_or_insert_with(araim::AraimScratch::new)
    }
}

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

/// The global test of a snapshot, and the protection levels under its threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Test<T> {
    /// The test.
    pub detection: Detection<T>,
    /// Protection levels.
    pub levels: ProtectionLevels,
}

/// The test without the clock forecast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WithoutAiding<T> {
    /// No forecast takes part.
    Always,
    /// The satellites cannot be tested without the forecast.
    Untested,
    /// The test of the satellites alone.
    Tested(Test<T>),
}

/// Result of a method for one epoch.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement<T> {
    /// Result of the exclusion.
    pub outcome: ExclusionOutcome,
    /// Rows left out, in the order of exclusion.
    pub excluded: Vec<Excluded<T>, MAX_EXCLUDED>,
    /// Test of the remaining rows, or the reason why there is none.
    pub test: Result<Test<T>, NoThreshold>,
    /// Test without the clock forecast.
    pub without_aiding: WithoutAiding<T>,
    /// True if faulty satellites were searched for.
    pub searched: bool,
    /// Additional results of [`Method::Araim`].
    pub araim: Option<AraimReport>,
}

impl<T: Real> Judgement<T> {
    /// Returns the protection levels: the larger of those with and without the forecast.
    pub fn levels(&self) -> Option<ProtectionLevels> {
        let levels = self.test.ok()?.levels;
        Some(match &self.without_aiding {
            WithoutAiding::Tested(alone) => levels.or_larger(&alone.levels),
            WithoutAiding::Always | WithoutAiding::Untested => levels,
        })
    }

    /// Multiplies every protection level by a factor.
    pub(crate) fn scale_levels(&mut self, factor: f64) {
        if let Ok(test) = &mut self.test {
            test.levels = test.levels.times(factor);
        }
        if let WithoutAiding::Tested(alone) = &mut self.without_aiding {
            alone.levels = alone.levels.times(factor);
        }
    }
}

impl<T: Real> Criteria<'_, T> {
    /// Applies the global test to a snapshot under the policy, and computes the protection levels
    /// for its threshold.
    ///
    /// `shared` are the shared errors of the first rows ([`EpochView::shared`]).
    ///
    /// # Errors
    /// [`NoThreshold`] names the reason why there is none.
    pub fn test(&self, snapshot: &Snapshot<'_, T>, shared: &[SharedError]) -> Result<Test<T>, NoThreshold> {
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
/// ([`raim::hypotheses::time_tag`]). `solution` ends as the solution without the listed rows.
pub fn judge<T: Real>(
    solution: &mut impl Excludable<T>,
    epoch: &EpochView<'_>,
    forecast: Option<usize>,
    criteria: &Criteria<'_, T>,
    search: Search<'_>,
    rates: Option<&RangeRates<'_>>,
    scratch: &mut MethodScratch<T>,
) -> Judgement<T> {
    #[cfg(feature = "araim")]
    if criteria.method == Method::Araim {
        return judge_epoch(solution, epoch, criteria, rates, scratch.araim());
    }
    judge_by_residuals(solution, epoch, forecast, criteria, search, rates, &mut scratch.subsets)
}

// Not inlined, because ARAIM has the deepest stack of all and needs nothing of this frame.
#[inline(never)]
fn judge_by_residuals<T: Real>(
    solution: &mut impl Excludable<T>,
    epoch: &EpochView<'_>,
    forecast: Option<usize>,
    criteria: &Criteria<'_, T>,
    search: Search<'_>,
    rates: Option<&RangeRates<'_>>,
    subsets: &mut ransac::Subsets,
) -> Judgement<T> {
    let mut test = criteria.test(solution.snapshot(), epoch.shared());
    let mut exclusion = Exclusion::passed();
    let mut searched = false;
    // Independent of the policy: where a policy tolerates the effect of a satellite, a wrong time
    // may have a larger one.
    let is_odd = test.is_ok() && is_suspicious(solution.snapshot(), &criteria.thresholds);
    if test.as_ref().is_ok_and(|test| test.detection.fault()) {
        let jump = forecast.and_then(|row| jump(solution, row, &criteria.thresholds));
        searched = jump.is_none() && !matches!(search, Search::Known(_));
        exclusion = jump.unwrap_or_else(|| isolate(solution, epoch, criteria, search, subsets));
        test = criteria.test(solution.snapshot(), epoch.shared());
    }
    let without_aiding =
        forecast.map_or(WithoutAiding::Always, |row| without_forecast(solution, row, epoch, criteria));
    if let WithoutAiding::Tested(test) = &without_aiding
        && test.detection.fault()
    {
        exclusion.outcome = ExclusionOutcome::NotIsolated(Unidentified::NoSet);
    }
    if exclusion.outcome == ExclusionOutcome::Isolated && test.is_ok() {
        let satellites = exclusion.rows.iter().filter(|excluded| Some(excluded.index) != forecast).count();
        if !leaves_enough(satellites, solution.snapshot().dof()) {
            exclusion.outcome = ExclusionOutcome::NotIsolated(Unidentified::NoRedundancy);
        } else if search != Search::Rough && !separable(solution, &exclusion, &criteria.thresholds) {
            exclusion.outcome = ExclusionOutcome::NotIsolated(Unidentified::Ambiguous);
        }
    }
    // As for other sets, exclusions about an inaccurate point are checked about the next one.
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
    Judgement {
        outcome: exclusion.outcome,
        excluded: exclusion.rows,
        test,
        without_aiding,
        searched,
        araim: None,
    }
}

/// Tests a solution without its forecast; the solution ends as it began.
fn without_forecast<T: Real>(
    solution: &mut impl Excludable<T>,
    row: usize,
    epoch: &EpochView<'_>,
    criteria: &Criteria<'_, T>,
) -> WithoutAiding<T> {
    let takes_part = solution.snapshot().row(row).is_some_and(|(row, _)| row.weight > T::zero());
    if !takes_part {
        return WithoutAiding::Always;
    }
    if solution.set_aside(&[row]).is_err() {
        return WithoutAiding::Untested;
    }
    let test = criteria.test(solution.snapshot(), epoch.shared());
    // These rows determined a position a moment ago.
    let _ = solution.take_back(&[row]);
    test.map_or(WithoutAiding::Untested, WithoutAiding::Tested)
}

/// Returns searches for the faulty satellites and leaves them out.
///
/// A separate function, as are its branches, so that an epoch without a fault does not pay for the
/// stack of the searches, and each search only for its own.
#[inline(never)]
fn isolate<T: Real>(
    solution: &mut impl Excludable<T>,
    epoch: &EpochView<'_>,
    criteria: &Criteria<'_, T>,
    search: Search<'_>,
    #[cfg_attr(not(feature = "searches"), expect(unused_variables))] subsets: &mut ransac::Subsets,
) -> Exclusion<T> {
    let thresholds = &criteria.thresholds;
    if let Search::Known(satellites) = search {
        let listed = epoch.observations().iter().enumerate();
        let known = listed.filter(|(_, observation)| satellites.contains(&observation.satellite));
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
        Method::Baarda => exclude_sequentially(solution, thresholds),
        // ARAIM excludes by its own tests.
        #[cfg(feature = "araim")]
        Method::Araim => exclude_sequentially(solution, thresholds),
    }
}

/// Isolates by every set if sets can be distinguished at all, or by the largest w-test if they are
/// too many.
fn isolate_within_budget<T: Real>(
    solution: &mut impl Excludable<T>,
    thresholds: &Thresholds<'_>,
) -> Exclusion<T> {
    let rows = (solution.snapshot().dof() / 2).min(MAX_EXCLUDED);
    if count_up_to(rows, solution.snapshot().used()) > AUTOMATIC_SETS {
        return exclude_sequentially(solution, thresholds);
    }
    let limits = parity::SearchLimits { rows, ..parity::SearchLimits::published() };
    parity::exclude(parity::Isolation::Grouping, solution, thresholds, &limits)
}

/// Returns the exclusion of the forecast alone, if it explains everything and no satellite does
/// nearly as well.
///
/// This comes before any method: a jump of a millisecond shows in every satellite's test, and
/// methods that leave out all rows that correlate with the worst would leave out healthy ones.
fn jump<T: Real>(
    solution: &mut impl Excludable<T>,
    row: usize,
    thresholds: &Thresholds<'_>,
) -> Option<Exclusion<T>> {
    let (_, fit) = solution.snapshot().row(row)?;
    let forecast = Excluded { index: row, w_test: fit.w_test() };
    solution.leave_out(row).ok()?;
    let jump = Exclusion { rows: gather([forecast]), outcome: ExclusionOutcome::Isolated };
    if Detection::passes(solution.snapshot(), thresholds) && separable(solution, &jump, thresholds) {
        return Some(jump);
    }
    // These rows determined a position a moment ago.
    let _ = solution.take_back(&[row]);
    None
}
