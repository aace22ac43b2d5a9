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
//! **A clock forecast or a known height beside the satellites** lets four satellites be tested. A
//! forecast confirms itself, and a height may be wrong for as long as somebody states it. If the
//! satellites can be tested without these rows, both tests must pass, and the larger protection
//! levels count.
//!
//! Such a row is a row like any other. It takes a degree of freedom and is a candidate of every
//! search, and its slope enters the levels. With `h = (0, 0, 1)`, `w = 1/σ_h²` and the covariance `P`
//! of the position with the height, it has the redundancy `r = 1 − w P_UU`, the gain `g = P h` and
//! the slopes `√(w/r) √(P_EU² + P_NU²)` and `√(w/r) P_UU`. The levels therefore bound an error of
//! the height of any size that the test misses, as they bound that of a satellite, but not errors
//! of both at once. Before any method searches, the row alone is left out if that explains everything
//! and no satellite does nearly as well.

pub mod araim;
pub mod raim;
mod systems;

use core::fmt;

use heapless::Vec;

use crate::bounded::gather;
use crate::epoch::EpochView;
use crate::least_squares::{Excludable, Snapshot};
use crate::numeric::real::Real;
use crate::report::{AraimReport, MAX_EXCLUDED, ProtectionLevels};
use crate::requirements::Requirements;
use crate::satellite::SatelliteId;
use crate::weighting::Ism;
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
use raim::levels::{KFactors, LevelInputs, Levels, common_shift};

pub(crate) use systems::KeptOut;

/// Method that finds the faulty satellites.
///
/// ```
/// use raim_core::{Method, Monitor, Requirements};
/// use raim_core::monitor::Strategy;
///
/// let mut monitor = Monitor::<f32, 16>::new(Requirements::en_route())?;
/// let mut strategy = Strategy::DEFAULT;
/// strategy.method = Method::Araim;
/// monitor.set_strategy(strategy)?; // an error that names the feature in a build without ARAIM
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(not(feature = "unstable"), non_exhaustive)]
pub enum Method {
    /// Every set of one row, then of two, then of three, within [`AUTOMATIC_SETS`]; beyond, the
    /// largest w-test.
    Auto,
    /// The largest w-test, repeatedly.
    Baarda,
    /// Searches in parity space. Needs the feature `searches`.
    Parity(parity::Isolation),
    /// Consensus of disjoint subsets. Needs the feature `searches`.
    Ransac,
    /// Solution separation over all monitored fault modes: ARAIM. Needs the feature `araim`.
    Araim,
}

impl Method {
    /// Returns true if a clock forecast or a known height may take a row: ARAIM has no fault mode
    /// for them.
    pub fn allows_aiding(self) -> bool {
        !self.uses_ism()
    }

    /// Returns true if sigmas are those of an integrity support message, and not the expected ones.
    pub(crate) fn uses_ism(self) -> bool {
        self == Self::Araim
    }

    /// Returns the method if this build has it.
    ///
    /// # Errors
    /// [`MethodError`] names the feature that the build lacks.
    pub(crate) const fn built_in(self) -> Result<Self, MethodError> {
        match self {
            Self::Parity(_) | Self::Ransac if !cfg!(feature = "searches") => {
                Err(MethodError { method: self, feature: "searches" })
            }
            Self::Araim if !cfg!(feature = "araim") => Err(MethodError { method: self, feature: "araim" }),
            Self::Auto | Self::Baarda | Self::Parity(_) | Self::Ransac | Self::Araim => Ok(self),
        }
    }
}

/// The method that this build lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct MethodError {
    /// The method that was asked for.
    pub method: Method,
    /// The feature of this crate that it needs.
    pub feature: &'static str,
}

impl fmt::Display for MethodError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("method must be one of this build: it needs the feature ")?;
        formatter.write_str(self.feature)
    }
}

impl core::error::Error for MethodError {}

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

/// The test without the clock forecast and the known height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WithoutAiding<T> {
    /// Neither takes part.
    Always,
    /// The satellites cannot be tested without them.
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
    /// Test without the clock forecast and the known height.
    pub without_aiding: WithoutAiding<T>,
    /// Constellations left out as a whole, a bit for each id.
    pub lost_systems: u8,
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
    /// `common_m` is the shared error of the first rows ([`EpochView::common_m`]).
    ///
    /// # Errors
    /// [`NoThreshold`] names the reason why there is none.
    pub fn test(&self, snapshot: &Snapshot<'_, T>, common_m: &[f32]) -> Result<Test<T>, NoThreshold> {
        let exposure = LevelInputs::of(snapshot, self.levels, self.factors);
        let demand = ThresholdProblem::new(snapshot.dof(), &exposure, self.requirements, self.thresholds);
        let threshold = demand.threshold::<T>(self.policy)?;
        let detection =
            Detection { sse: snapshot.sse(), threshold: T::narrow(threshold.tau), dof: snapshot.dof() };
        let shift = common_shift(snapshot, common_m);
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
    let height = height_row(solution.snapshot(), epoch);
    let aiding = || [forecast, height].into_iter().flatten();
    let mut test = criteria.test(solution.snapshot(), epoch.common_m());
    let mut exclusion = Exclusion::passed();
    let mut searched = false;
    // Independent of the policy: where a policy tolerates the effect of a satellite, a wrong time
    // may have a larger one.
    let is_odd = test.is_ok() && is_suspicious(solution.snapshot(), &criteria.thresholds);
    if test.as_ref().is_ok_and(|test| test.detection.fault()) {
        let jump = aiding().find_map(|row| jump(solution, row, &criteria.thresholds));
        searched = jump.is_none() && !matches!(search, Search::Known(_));
        exclusion = jump.unwrap_or_else(|| isolate(solution, epoch, criteria, search, subsets));
        test = criteria.test(solution.snapshot(), epoch.common_m());
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
                        .plus(&common_shift(snapshot, epoch.common_m()));
                    test.levels = test.levels.or_larger(&levels);
                }
            }
            TimeTagOutcome::Time => {
                exclusion = Exclusion::not_isolated(Unidentified::Time);
                test = criteria.test(solution.snapshot(), epoch.common_m());
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
    if matches!(judgement.outcome, ExclusionOutcome::NotIsolated(reason) if reason != Unidentified::Time) {
        systems::leave_out_broken(solution, epoch, &aids, criteria, rates, &mut judgement);
    }
    judgement
}

/// Returns the row of a known height, which stands behind the satellites and touches no clock.
pub(crate) fn height_row<T: Real>(snapshot: &Snapshot<'_, T>, epoch: &EpochView<'_>) -> Option<usize> {
    let satellites = epoch.observations().len();
    let behind = snapshot.equations().get(satellites..)?;
    Some(satellites + behind.iter().position(|row| row.clock.is_none())?)
}

/// Tests a solution without its aiding rows; the solution ends as it began.
#[inline(never)]
fn without_aids<T: Real>(
    solution: &mut impl Excludable<T>,
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
    let test = criteria.test(solution.snapshot(), epoch.common_m());
    // These rows determined a position a moment ago.
    let _ = solution.take_back(&taking_part);
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

/// Returns the exclusion of an aiding row alone, if it explains everything and no satellite does
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
