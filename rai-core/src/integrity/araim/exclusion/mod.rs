//! Exclusion after an alarm: the satellite or the constellation without which the others agree.
//!
//! A candidate must leave at least one satellite more than unknowns. Satellites are tried first,
//! then constellations, each in ascending order of the remaining weighted SSE. The first that does
//! not alarm is left out. It is judged by the modes that were chosen before the exclusion,
//! restricted to the remaining satellites. So the risk includes a wrong exclusion.
//!
//! If one of a constellation's two satellites is left out, its clock follows any error of the
//! other. Leaving out either of them therefore counts as leaving out their constellation. Nothing
//! is left out if two candidates explain the data equally well. The same applies if the candidate
//! is one of only two constellations and has two satellites ([`rivals`]).
//!
//! Judging a candidate is as expensive as judging the epoch, so that at most one satellite and one
//! constellation are judged. Most candidates need no judgement, because without them the test of
//! another single satellite still alarms. That test follows from the all-in-view solution:
//!
//! ```text
//! contradicted    |A_k v_k| > (1 + margin) K |A_k| √κ_kk     on any axis, for any single satellite k that remains
//! ```
//!
//! `A_k`, `v_k`, `κ_kk` are without the candidate ([`super::subsets`]), `K` is that of all
//! satellites. The candidate has no more modes and so no larger `K`. A contradiction here is
//! therefore also an alarm of the full judgement.
//!
//! References: [MAAST] for the order and the shares.
//!
//! [MAAST]: crate#references

mod rivals;

use heapless::Vec;
use nalgebra::Vector3;

use super::evaluation::Purpose;
use super::levels::Axis;
use super::modes::{Hypothesis, PriorOdds, RowSet, members};
use super::monitored::MonitoredModes;
use super::subsets::{IntegrityRow, SubsetSolutions};
use super::{AraimError, Finding, Prior, Priors, View};
use crate::allocation::Allocation;
use crate::bit_set::count_of;
use crate::bounded::MAX_ROWS;
use crate::least_squares::Excludable;
use crate::least_squares::equations::Row;
use crate::numeric::real::Real;
use crate::satellite::Constellation;

/// Result of an epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AraimOutcome<T> {
    /// No test alarms.
    Passed,
    /// A test alarms. A satellite or constellation was left out, and without it no test alarms.
    Excluded {
        /// The satellite or the constellation.
        excluded: Hypothesis,
        /// Bit set of its rows.
        rows: u64,
        /// Result without it.
        finding: Finding<T>,
    },
    /// A test alarms, and no permitted exclusion ends the alarm, or exclusion is off.
    NotIsolated,
    /// A test alarms, and several exclusions explain this equally well.
    Ambiguous,
}

/// Result of the judgement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AraimJudgement<T> {
    /// Number of exclusions that are possible after an alarm.
    pub options: usize,
    /// Share of the risk of each outcome.
    pub risk_share: T,
    /// Result with all satellites.
    pub whole: Finding<T>,
    /// Result after an alarm, if any.
    pub outcome: AraimOutcome<T>,
}

/// Prior probability below which a constellation is not a candidate.
const OPTIONAL: f64 = 1e-7;

/// Scratch memory for rows and terms, without state between epochs.
#[derive(Clone, Debug)]
pub struct AraimScratch<T: Real, const N: usize = MAX_ROWS> {
    odds: PriorOdds<T, N>,
    solving: SubsetScratch<T, N>,
}

/// Part of the scratch memory that each solution and each pass overwrites.
#[derive(Clone, Debug)]
struct SubsetScratch<T: Real, const N: usize> {
    own: Vec<IntegrityRow<T>, N>,
    axes: [Axis<T>; 3],
}

impl<T: Real, const N: usize> Default for AraimScratch<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real, const N: usize> AraimScratch<T, N> {
    /// Returns empty scratch memory.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub fn new() -> Self {
        let axes = [Axis::closed(), Axis::closed(), Axis::closed()];
        Self { odds: Vec::new(), solving: SubsetScratch { own: Vec::new(), axes } }
    }
}

/// Judges an epoch, and leaves out the faulty satellite or constellation.
///
/// # Errors
/// [`AraimError`] if a capacity is exceeded or a prior is invalid. No level is valid then.
pub fn judge<T: Real, const N: usize>(
    epoch: &mut impl Excludable<T, N>,
    priors: &Priors<'_, T>,
    allocation: &Allocation,
) -> Result<AraimJudgement<T>, AraimError> {
    judge_in(epoch, priors, allocation, &mut AraimScratch::new())
}

/// Works like [`judge`], with the scratch memory of a caller whose stack is small.
///
/// # Errors
/// As [`judge`].
pub fn judge_in<T: Real, const N: usize>(
    epoch: &mut impl Excludable<T, N>,
    priors: &Priors<'_, T>,
    allocation: &Allocation,
    room: &mut AraimScratch<T, N>,
) -> Result<AraimJudgement<T>, AraimError> {
    let AraimScratch { odds, solving } = room;
    let mut monitored = MonitoredModes::nothing(priors.constellations, allocation);
    choose(&mut monitored, odds, &View::of(epoch.snapshot()), priors)?;
    let options = ExclusionOptions::of(&monitored, &priors.constellations);
    if allocation.exclusion {
        monitored.risk_share = T::narrow((options.count() + 1) as f64).recip();
    }
    let whole = describe(
        &mut monitored,
        solving,
        View::of(epoch.snapshot()),
        priors.satellites,
        0,
        Purpose::Describe,
    )?;
    let mut judged = AraimJudgement {
        options: options.count(),
        risk_share: monitored.risk_share,
        whole,
        outcome: AraimOutcome::Passed,
    };
    if judged.whole.alarm {
        judged.outcome = AraimOutcome::NotIsolated;
        if allocation.exclusion {
            let factors = judged.whole.factors;
            judged.outcome = exclude(&mut monitored, solving, epoch, priors.satellites, options, factors)?;
        }
    }
    Ok(judged)
}

/// Smallest plausible sigma, m, as for a range ([`crate::epoch::Epoch::push`]).
const LEAST_M: f64 = 1e-3;
/// Largest plausible sigma, accuracy or bias, m. Fourth powers of larger numbers overflow.
const LARGEST_M: f64 = 1e6;

/// Chooses the modes of an epoch.
#[inline(never)]
pub(super) fn choose<'r, T: Real, const N: usize>(
    monitored: &mut MonitoredModes<'r, T>,
    odds: &'r mut PriorOdds<T, N>,
    view: &View<'_, T>,
    priors: &Priors<'_, T>,
) -> Result<(), AraimError> {
    let is_size = |value: T| value >= T::zero() && value <= T::narrow(LARGEST_M);
    let is_measured = |row: &Row<T>| row.sigma >= T::narrow(LEAST_M) && row.sigma <= T::narrow(LARGEST_M);
    let is_valid = |prior: &Prior<T>| is_size(prior.accuracy_m) && is_size(prior.bias_m);
    let mut rows = view.rows.iter().filter(|row| row.weight > T::zero());
    if !priors.satellites.iter().all(is_valid) || !rows.all(is_measured) {
        return Err(AraimError::Prior);
    }
    let mut faults = priors.satellites.iter().map(|prior| prior.fault);
    let satellites = view.rows.iter().map(|row| {
        let fault = faults.next().filter(|_| row.weight > T::zero())?;
        Some((row.clock?, fault))
    });
    monitored.modes.choose(satellites, odds, monitored.allocation)
}

/// Evaluates an epoch without the rows of a set.
#[inline(never)]
fn describe<T: Real, const N: usize>(
    monitored: &mut MonitoredModes<'_, T>,
    solving: &mut SubsetScratch<T, N>,
    view: View<'_, T>,
    priors: &[Prior<T>],
    gone: RowSet,
    purpose: Purpose,
) -> Result<Finding<T>, AraimError> {
    let SubsetScratch { own, axes } = solving;
    let mut solutions = SubsetSolutions::of(view, own);
    solutions.prepare(priors);
    monitored.judge(&mut solutions, axes, gone, purpose)
}

/// Satellites and constellations that may be left out.
#[derive(Clone, Copy, Debug)]
struct ExclusionOptions {
    satellites: RowSet,
    /// Constellations, a bit for each id.
    constellations: u8,
}

impl ExclusionOptions {
    fn of<T: Real>(monitored: &MonitoredModes<'_, T>, faults: &[T; Constellation::COUNT]) -> Self {
        let modes = &monitored.modes;
        let is_option = |(&size, &fault): (&usize, &T)| {
            // A lone satellite and its constellation are one option.
            size > 1 && fault > T::narrow(OPTIONAL)
        };
        let each = modes.sizes.iter().zip(faults).map(is_option).enumerate();
        let constellations = each.fold(0, |set, (id, is_option)| set | u8::from(is_option) << id);
        Self { satellites: modes.satellites, constellations }
    }

    /// Iterates over the constellations among the options.
    fn constellations(&self) -> impl Iterator<Item = Hypothesis> {
        let bits = (0..Constellation::COUNT).map(|id| 1 << id);
        bits.filter(|bit| self.constellations & bit != 0).map(Hypothesis::of_constellations)
    }

    /// If a constellation has only two satellites, replaces them by the constellation.
    fn with_pairs_as_one<T: Real>(mut self, monitored: &MonitoredModes<'_, T>) -> Self {
        for (id, members) in monitored.modes.members.iter().enumerate() {
            if count_of(members & self.satellites) == 2 {
                self.satellites &= !members;
                self.constellations |= 1 << id;
            }
        }
        self
    }

    fn count(&self) -> usize {
        count_of(self.satellites) + self.constellations.count_ones() as usize
    }
}

/// Relative margin of a squared test over its squared threshold. It exceeds the effect of rounding.
const MARGIN: f64 = 1e-2;

/// Largest number of options that are judged: the best satellite, then the best constellation.
///
/// Each is nearly as expensive as the epoch itself. If neither explains the data, there are several
/// faults, which is an alert. A second satellite would explain the data less well than the first.
const MOST_TRIED: usize = 2;

/// Judges one option after another.
#[cold]
#[inline(never)]
fn exclude<T: Real, const N: usize>(
    monitored: &mut MonitoredModes<'_, T>,
    solving: &mut SubsetScratch<T, N>,
    epoch: &mut impl Excludable<T, N>,
    priors: &[Prior<T>],
    options: ExclusionOptions,
    factors: [T; 3],
) -> Result<AraimOutcome<T>, AraimError> {
    let mut left = options.with_pairs_as_one(monitored);
    let limits = Vector3::from(factors.map(|factor| factor * factor * T::narrow(1.0 + MARGIN)));
    for _ in 0..MOST_TRIED {
        let view = View::of(epoch.snapshot());
        let Some(choice) = next(monitored, solving, view, priors, &left, &limits) else { break };
        let excluded = choice.option;
        let rows = monitored.modes.taken_by(excluded);
        left.satellites = 0;
        left.constellations &= !excluded.constellations;
        if epoch.leave_out_all(rows).is_err() {
            continue;
        }
        let finding =
            describe(monitored, solving, View::of(epoch.snapshot()), priors, rows, Purpose::Accept)?;
        if !finding.alarm && !choice.is_rivalled {
            return Ok(AraimOutcome::Excluded { excluded, rows, finding });
        }
        epoch.take_back_all(rows);
        if !finding.alarm {
            return Ok(AraimOutcome::Ambiguous);
        }
    }
    Ok(AraimOutcome::NotIsolated)
}

/// The option to judge next.
#[derive(Clone, Copy, Debug)]
struct Choice {
    option: Hypothesis,
    /// True if another option explains the data equally well.
    is_rivalled: bool,
}

/// Returns the option that leaves the smallest SSE, of those that no single satellite contradicts.
///
/// A fault of tens of kilometres moves the position so far that healthy satellites seem to
/// contradict each other. If this distance may explain the contradiction, the option is not
/// dismissed ([`curvature`]).
///
/// [`curvature`]: crate::least_squares::curvature
#[inline(never)]
fn next<T: Real, const N: usize>(
    monitored: &MonitoredModes<'_, T>,
    solving: &mut SubsetScratch<T, N>,
    view: View<'_, T>,
    priors: &[Prior<T>],
    left: &ExclusionOptions,
    limits: &Vector3<T>,
) -> Option<Choice> {
    let mut solutions = SubsetSolutions::of(view, &mut solving.own);
    solutions.prepare_without_biases(priors);
    // Single precision resolves no smaller difference of two sums.
    let tie = view.sse * T::TIE;
    let singles = monitored.singles();
    let mut agreeing = |option: Hypothesis, limit: Option<T>| {
        let taken = monitored.modes.taken_by(option);
        let is_left = monitored.leaves_enough(taken, 1);
        let sse = if is_left { solutions.sse_without(view.sse, option)? } else { return None };
        let is_close = limit.is_none_or(|limit| sse < limit);
        let singles_left = singles & monitored.modes.not_alone(taken) & !taken;
        let agrees = is_close
            && (!solutions.contradict(option, singles_left, limits)
                || solutions.may_agree_elsewhere(option, sse));
        agrees.then_some((sse, option))
    };
    let satellites = members(left.satellites).map(Hypothesis::of_row);
    if let Some(best) = rivals::best(satellites, tie, &mut agreeing) {
        return Some(best);
    }
    // Constellations need no margin between their sums, because their prior probabilities differ.
    let best = rivals::best(left.constellations(), T::zero(), &mut agreeing)?;
    let is_rivalled = best.is_rivalled || rivals::is_pair_beside_one(monitored, best.option);
    Some(Choice { is_rivalled, ..best })
}
