//! Integrity: is something wrong, which satellite is it, and how wrong could the position be without anyone noticing?
//!
//! ```text
//! fix ─► test ─► (search, leave out, test again) ─► is it the only explanation? ─► judgement
//! ```
//!
//! [`judge`] is the only place that knows one [`Method`] from another. A [`Judgement`] is what the method found; what it
//! means for the user is the monitor's to say ([`crate::monitor`]).
//!
//! **A forecast beside the satellites** raises what four satellites can say of each other, and vouches for itself. Where the
//! satellites can be tested without it they are, too: both tests must pass, and the protection levels are the larger ones.

pub mod araim;
pub mod raim;

use heapless::Vec;

use crate::bounded::gather;
use crate::epoch::EpochView;
use crate::least_squares::{Excludable, Snapshot};
use crate::numeric::real::Real;
use crate::report::{MAX_EXCLUDED, ProtectionLevels, Separation};
use crate::requirements::Requirements;
use crate::satellite::SatelliteId;
use crate::weighting::Ism;
#[cfg(feature = "araim")]
use araim::judge_epoch;
use raim::detection::Detection;
use raim::detection::threshold::Thresholds;
use raim::detection::threshold::policy::{Demand, NoThreshold, Policy};
use raim::hypotheses::constellation_shift;
use raim::hypotheses::separability::separable;
use raim::hypotheses::time_tag::{Doubt, RangeRates, Rates, is_suspicious};
use raim::isolation::baarda::exclude_sequentially;
use raim::isolation::exclusion::{Excluded, Exclusion, Outcome, Unidentified, leave_out, leaves_enough};
use raim::isolation::sets::count_up_to;
use raim::isolation::{parity, ransac};
use raim::levels::{Exposure, Factors, Levels, common_shift};

/// How the faulty satellites are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Method {
    /// Every set of one row, then of two, then of three, where that is within [`AUTOMATIC_SETS`]; else the largest w-test.
    Auto,
    /// The largest w-test, again and again.
    Baarda,
    /// In parity space.
    #[cfg(feature = "searches")]
    Parity(parity::Isolation),
    /// By consensus of disjoint subsets.
    #[cfg(feature = "searches")]
    Ransac,
    /// By solutions with and without every plausible set of them: ARAIM.
    #[cfg(feature = "araim")]
    Separation,
}

impl Method {
    /// Whether a forecast may stand beside the satellites: separation knows none that could be wrong.
    pub(crate) fn takes_a_forecast(self) -> bool {
        !self.holds_a_promise()
    }

    /// Whether sigmas are what is promised of the satellites, and not what is expected of them.
    #[cfg_attr(not(feature = "araim"), expect(clippy::unused_self, reason = "no other method does"))]
    pub(crate) fn holds_a_promise(self) -> bool {
        #[cfg(feature = "araim")]
        if self == Self::Separation {
            return true;
        }
        false
    }
}

/// Sets that [`Method::Auto`] looks at: all of up to three of 40 rows, some 0.9 million instructions in `f32` on a
/// Cortex-M4F. Beyond, the largest w-test costs a hundredth.
pub const AUTOMATIC_SETS: usize = parity::MAX_SETS;

/// Sum of squares of which a fault is gross: of ten thousand sigmas, some tens of kilometres. Where it moves the position by `d`,
/// ranges are off by `d²/2ρ`, metres.
const GROSS_SSE: f64 = 1e8;

/// What an epoch is judged by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Criteria<'c, T> {
    /// Limits and probabilities.
    pub requirements: &'c Requirements,
    /// Thresholds for these probabilities.
    pub thresholds: Thresholds<'static>,
    /// Factors of the protection levels for these probabilities.
    pub factors: &'c Factors<T>,
    /// Which threshold the global test uses.
    pub policy: Policy,
    /// How the faulty satellites are found.
    pub method: Method,
    /// What a protection level bounds.
    pub levels: Levels,
    /// What is promised of the satellites, for [`Method::Separation`].
    pub ism: &'c Ism,
}

/// Room that methods take beside the equations, and the subsets that [`Method::Ransac`] keeps from epoch to epoch.
#[derive(Clone, Debug)]
pub struct Scratch<T: Real> {
    /// For [`Method::Ransac`].
    pub subsets: ransac::Subsets,
    /// Made when it is asked for first: it is large, and empty it need not be on the stack before it is where it stays.
    #[cfg(feature = "araim")]
    separation: Option<araim::Room<T>>,
    #[cfg(not(feature = "araim"))]
    scalar: core::marker::PhantomData<T>,
}

impl<T: Real> Default for Scratch<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real> Scratch<T> {
    /// Of no epoch yet.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub fn new() -> Self {
        Self {
            subsets: ransac::Subsets::new(),
            #[cfg(feature = "araim")]
            separation: None,
            #[cfg(not(feature = "araim"))]
            scalar: core::marker::PhantomData,
        }
    }

    // Not inlined: what its making takes of the stack is not needed beside the judging.
    #[cfg(feature = "araim")]
    #[inline(never)]
    fn separation(&mut self) -> &mut araim::Room<T> {
        self.separation.get_or_insert_with(araim::Room::new)
    }
}

/// What may be done once a fault is detected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search<'s> {
    /// Look for the faulty satellites.
    Anew,
    /// Look for them about a poor point, and believe what is found for now: whether anything else explains as much, which is as dear
    /// as the search, is asked about a better point, where they are [`Self::Known`].
    Rough,
    /// Leave out those that a search about another point has found, and look for no others.
    Known(&'s [SatelliteId]),
}

/// The global test of a snapshot, and what an undetected fault can do under its threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Test<T> {
    /// The test.
    pub detection: Detection<T>,
    /// Protection levels.
    pub levels: ProtectionLevels,
}

/// What the satellites say without the forecast beside them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Alone<T> {
    /// No forecast takes part.
    Always,
    /// Without it nothing is left to test.
    Untested,
    /// The test of the satellites alone.
    Tested(Test<T>),
}

/// What a method found in an epoch.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement<T> {
    /// How it ended.
    pub outcome: Outcome,
    /// Rows left out, in the order of removal.
    pub excluded: Vec<Excluded<T>, MAX_EXCLUDED>,
    /// The test of what is left, or why there is none.
    pub test: Result<Test<T>, NoThreshold>,
    /// The same without the forecast.
    pub alone: Alone<T>,
    /// Whether faulty satellites were searched for.
    pub searched: bool,
    /// What only [`Method::Separation`] finds.
    pub separation: Option<Separation>,
}

impl<T: Real> Judgement<T> {
    /// Protection levels: the larger of those with and without the forecast.
    pub fn levels(&self) -> Option<ProtectionLevels> {
        let levels = self.test.ok()?.levels;
        Some(match &self.alone {
            Alone::Tested(alone) => levels.or_larger(&alone.levels),
            Alone::Always | Alone::Untested => levels,
        })
    }
}

impl<T: Real> Criteria<'_, T> {
    /// The global test of a snapshot under the policy, and the protection levels that go with its threshold.
    ///
    /// `common_m` is what the first rows' errors share ([`EpochView::common_m`]).
    ///
    /// # Errors
    /// [`NoThreshold`] says why there is none.
    pub fn test(&self, snapshot: &Snapshot<'_, T>, common_m: &[f32]) -> Result<Test<T>, NoThreshold> {
        let exposure = Exposure::of(snapshot, self.levels, self.factors);
        let demand = Demand::new(snapshot.dof(), &exposure, self.requirements, self.thresholds);
        let threshold = demand.threshold::<T>(self.policy)?;
        let detection =
            Detection { sse: snapshot.sse(), threshold: T::narrow(threshold.tau), dof: snapshot.dof() };
        let shift = common_shift(snapshot, common_m);
        Ok(Test { detection, levels: exposure.protect(threshold.lambda).plus(&shift) })
    }
}

/// Tests a solution, looks for what is wrong and leaves it out.
///
/// `forecast` is the row of a predicted clock, if there is one; `rates`, of whom knows orbits, tell wrong tags from wrong
/// satellites ([`raim::hypotheses::time_tag`]). `solution` ends as the solution without the rows listed.
pub fn judge<T: Real>(
    solution: &mut impl Excludable<T>,
    epoch: &EpochView<'_>,
    forecast: Option<usize>,
    criteria: &Criteria<'_, T>,
    search: Search<'_>,
    rates: Option<&RangeRates<'_>>,
    scratch: &mut Scratch<T>,
) -> Judgement<T> {
    #[cfg(feature = "araim")]
    if criteria.method == Method::Separation {
        return judge_epoch(solution, epoch, criteria, rates, scratch.separation());
    }
    judge_by_residuals(solution, epoch, forecast, criteria, search, rates, &mut scratch.subsets)
}

// Not inlined: separation has frames of its own, the deepest of all, and needs nothing of this one's.
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
    let mut test = criteria.test(solution.snapshot(), epoch.common_m());
    let mut exclusion = Exclusion::passed();
    let mut searched = false;
    // Whatever the policy: where it tolerates what a satellite can do, a wrong time may do more.
    let is_odd = test.is_ok() && is_suspicious(solution.snapshot(), &criteria.thresholds);
    if test.as_ref().is_ok_and(|test| test.detection.fault()) {
        let jump = forecast.and_then(|row| jump(solution, row, &criteria.thresholds));
        searched = jump.is_none() && !matches!(search, Search::Known(_));
        exclusion = jump.unwrap_or_else(|| isolate(solution, epoch, criteria, search, subsets));
        test = criteria.test(solution.snapshot(), epoch.common_m());
    }
    let alone = forecast.map_or(Alone::Always, |row| without_forecast(solution, row, epoch, criteria));
    if let Alone::Tested(test) = &alone
        && test.detection.fault()
    {
        exclusion.outcome = Outcome::NotIsolated(Unidentified::NoSet);
    }
    if exclusion.outcome == Outcome::Isolated && test.is_ok() {
        let satellites = exclusion.rows.iter().filter(|excluded| Some(excluded.index) != forecast).count();
        if !leaves_enough(satellites, solution.snapshot().dof()) {
            exclusion.outcome = Outcome::NotIsolated(Unidentified::NoRedundancy);
        } else if search != Search::Rough && !separable(solution, &exclusion, &criteria.thresholds) {
            exclusion.outcome = Outcome::NotIsolated(Unidentified::Ambiguous);
        }
    }
    // As of other sets: what is left out about a rough point is asked about the next.
    let is_asked = search != Search::Rough || exclusion.outcome == Outcome::Passed;
    let is_good = test.is_ok() && !matches!(exclusion.outcome, Outcome::NotIsolated(_));
    if is_asked && is_good && constellation_shift::shows(solution.snapshot(), &criteria.thresholds) {
        exclusion.outcome = Outcome::NotIsolated(Unidentified::Ambiguous);
    }
    let is_believed = searched && search == Search::Rough && exclusion.outcome == Outcome::Isolated;
    let asked = rates.filter(|_| is_odd && !is_believed);
    if let Some(rates) = asked.and_then(|rates| Rates::of(epoch, rates)) {
        match rates.contest(solution, &exclusion, &criteria.thresholds, criteria.factors) {
            Doubt::Rows if exclusion.outcome == Outcome::Isolated => {
                exclusion.outcome = Outcome::NotIsolated(Unidentified::Ambiguous);
            }
            Doubt::None | Doubt::Rows => {}
            Doubt::Shift(slopes, shown) => {
                if let Ok(test) = &mut test {
                    let snapshot = solution.snapshot();
                    let levels = Exposure::of(snapshot, criteria.levels, criteria.factors)
                        .protect_against(slopes, shown, criteria.factors)
                        .plus(&common_shift(snapshot, epoch.common_m()));
                    test.levels = test.levels.or_larger(&levels);
                }
            }
            Doubt::Time => {
                exclusion = Exclusion::not_isolated(Unidentified::Time);
                test = criteria.test(solution.snapshot(), epoch.common_m());
            }
        }
    }
    Judgement {
        outcome: exclusion.outcome,
        excluded: exclusion.rows,
        test,
        alone,
        searched,
        separation: None,
    }
}

/// The test of a solution without its forecast, which ends as it began.
fn without_forecast<T: Real>(
    solution: &mut impl Excludable<T>,
    row: usize,
    epoch: &EpochView<'_>,
    criteria: &Criteria<'_, T>,
) -> Alone<T> {
    let takes_part = solution.snapshot().row(row).is_some_and(|(row, _)| row.weight > T::zero());
    if !takes_part {
        return Alone::Always;
    }
    if solution.set_aside(&[row]).is_err() {
        return Alone::Untested;
    }
    let test = criteria.test(solution.snapshot(), epoch.common_m());
    // What was there a moment ago determines a position.
    let _ = solution.take_back(&[row]);
    test.map_or(Alone::Untested, Alone::Tested)
}

/// Looks for the faulty satellites and leaves them out.
///
/// A function of its own, as are the ways that it branches into: what one search needs of the stack would else be taken
/// by every epoch, and beside what the others need.
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
        // It bends what all sets are compared in, one of a millisecond beyond recognition. Leaving out the worst and solving again
        // about another point does not mind.
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
        // Separation excludes by its own tests.
        #[cfg(feature = "araim")]
        Method::Separation => exclude_sequentially(solution, thresholds),
    }
}

/// By every set, as far as sets can be told apart at all, or by the largest w-test where these are too many.
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

/// The exclusion of the forecast alone, where that explains everything and no satellite does nearly as well.
///
/// Asked before any method is: a jump of a millisecond shows in every satellite's test, and methods that leave out
/// whoever correlates with the worst would leave out healthy ones with it.
fn jump<T: Real>(
    solution: &mut impl Excludable<T>,
    row: usize,
    thresholds: &Thresholds<'_>,
) -> Option<Exclusion<T>> {
    let (_, fit) = solution.snapshot().row(row)?;
    let forecast = Excluded { index: row, w_test: fit.w_test() };
    solution.leave_out(row).ok()?;
    let jump = Exclusion { rows: gather([forecast]), outcome: Outcome::Isolated };
    if Detection::passes(solution.snapshot(), thresholds) && separable(solution, &jump, thresholds) {
        return Some(jump);
    }
    // What was there a moment ago determines a position.
    let _ = solution.take_back(&[row]);
    None
}
