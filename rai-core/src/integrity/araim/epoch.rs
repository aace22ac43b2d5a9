//! Judgement of an epoch by ARAIM, in the form of [`super::super::judge`].
//!
//! **One of two systems is never left out**, although the integrity support message may make a
//! fault of one likelier. A fault of either system explains the data, and the message describes the
//! provider, not counterfeit signals. Only a third system with at least two satellites can decide,
//! because a lone satellite agrees with any position.

use heapless::Vec;

use super::modes::members;
use super::{
    AraimError, AraimJudgement, AraimOutcome, AraimScratch, Finding, Hypothesis, Prior, Priors, judge_in,
};
use crate::bounded::gather;
use crate::epoch::EpochView;
use crate::integrity::raim::detection::Detection;
use crate::integrity::raim::detection::threshold::policy::NoThreshold;
use crate::integrity::raim::hypotheses::time_tag::{EpochRates, RangeRates};
use crate::integrity::raim::isolation::exclusion::{Excluded, ExclusionOutcome, Unidentified};
use crate::integrity::{Criteria, Judgement, Test, WithoutAiding};
use crate::least_squares::{Excludable, infinity};
use crate::numeric::real::Real;
use crate::report::{AraimReport, MAX_EXCLUDED, ProtectionLevels};
use crate::weighting::Ism;

/// Judges an epoch whose sigmas are those for integrity ([`crate::weighting::integrity_sigma_m`]).
#[inline(never)]
pub(in crate::integrity) fn judge_epoch<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    epoch: &EpochView<'_>,
    criteria: &Criteria<'_, T>,
    rates: Option<&RangeRates<'_>>,
    room: &mut AraimScratch<T, N>,
) -> Judgement<T> {
    let priors = priors(solution, epoch, criteria.ism);
    let constellations = criteria.ism.constellations.map(|support| T::narrow(support.constellation_fault));
    let priors = Priors { satellites: &priors, constellations };
    if solution.snapshot().dof() == 0 {
        return refused(ExclusionOutcome::Passed, NoThreshold::Redundancy);
    }
    match judge_in(solution, &priors, &criteria.requirements.allocation, room) {
        Ok(mut judged) => {
            take_back_one_of_two(solution, epoch, &mut judged);
            let is_of_time = blames_the_time(solution, epoch, &mut judged, criteria, rates);
            let mut judgement = judgement(solution, epoch, &judged, criteria);
            if is_of_time {
                judgement.outcome = ExclusionOutcome::NotIsolated(Unidentified::Time);
            }
            judgement
        }
        Err(AraimError::Rows | AraimError::Modes) => {
            refused(ExclusionOutcome::NotIsolated(Unidentified::Budget), NoThreshold::Risk)
        }
        Err(AraimError::Prior) => refused(ExclusionOutcome::Passed, NoThreshold::Risk),
    }
}

/// Takes back an exclusion of one of only two constellations with more than one satellite, and
/// makes the outcome ambiguous.
fn take_back_one_of_two<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    epoch: &EpochView<'_>,
    judged: &mut AraimJudgement<T>,
) {
    let AraimOutcome::Excluded { rows, excluded, .. } = &judged.outcome else { return };
    if excluded.constellations != 0 && systems_of_several(epoch) <= 2 {
        solution.take_back_all(*rows);
        judged.outcome = AraimOutcome::Ambiguous;
    }
}

/// Returns the number of constellations with more than one satellite.
fn systems_of_several(epoch: &EpochView<'_>) -> u32 {
    let (mut seen, mut several) = (0_u8, 0_u8);
    for observation in epoch.observations() {
        let system = 1 << (observation.satellite.constellation() as u8);
        several |= seen & system;
        seen |= system;
    }
    several.count_ones()
}

/// Returns true if a wrong time of all ranges explains an alarm as well as the exclusion. The
/// exclusion is then taken back.
#[inline(never)]
fn blames_the_time<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    epoch: &EpochView<'_>,
    judged: &mut AraimJudgement<T>,
    criteria: &Criteria<'_, T>,
    rates: Option<&RangeRates<'_>>,
) -> bool {
    let Some(rates) = rates.filter(|_| judged.whole.alarm).and_then(|rates| EpochRates::of(epoch, rates))
    else {
        return false;
    };
    let left = solution.snapshot().sse();
    let gone = match &judged.outcome {
        AraimOutcome::Excluded { rows, .. } => *rows,
        AraimOutcome::Passed | AraimOutcome::NotIsolated | AraimOutcome::Ambiguous => 0,
    };
    if gone != 0 {
        solution.take_back_all(gone);
    }
    let is_of_time = rates.rival(solution.snapshot(), gone.count_ones(), left, &criteria.thresholds);
    if gone != 0 && (is_of_time || solution.leave_out_all(gone).is_err()) {
        judged.outcome = AraimOutcome::NotIsolated;
    }
    is_of_time
}

/// Returns the integrity support data of each satellite of the epoch.
///
/// The variance for accuracy is the row's with the URE in place of the URA. If a row's sigma is
/// below the URA, it comes from another model, and the sigma itself is the accuracy.
#[inline(never)]
fn priors<T: Real, const N: usize>(
    solution: &impl Excludable<T, N>,
    epoch: &EpochView<'_>,
    ism: &Ism,
) -> Vec<Prior<T>, N> {
    let rows = solution.snapshot().equations();
    gather(epoch.observations().iter().zip(rows).map(|(observation, row)| {
        let support = ism.of(observation.satellite.constellation());
        let [ura, ure] = [support.ura_m, support.ure_m].map(T::narrow);
        let variance = row.sigma * row.sigma;
        let accurate = variance - ura * ura + ure * ure;
        let accuracy_m = if row.sigma >= ura { accurate.sqrt_approx() } else { row.sigma };
        Prior { accuracy_m, bias_m: T::narrow(support.bias_m), fault: T::narrow(support.satellite_fault) }
    }))
}

fn refused<T: Real>(outcome: ExclusionOutcome, reason: NoThreshold) -> Judgement<T> {
    Judgement {
        outcome,
        excluded: Vec::new(),
        test: Err(reason),
        without_aiding: WithoutAiding::Always,
        is_covered: false,
        lost_systems: 0,
        searched: false,
        araim: None,
    }
}

#[inline(never)]
fn judgement<T: Real, const N: usize>(
    solution: &impl Excludable<T, N>,
    epoch: &EpochView<'_>,
    judged: &AraimJudgement<T>,
    criteria: &Criteria<'_, T>,
) -> Judgement<T> {
    let (mut outcome, excluded, finding) = match &judged.outcome {
        AraimOutcome::Passed => (ExclusionOutcome::Passed, None, &judged.whole),
        AraimOutcome::Excluded { rows, finding, .. } => (ExclusionOutcome::Isolated, Some(*rows), finding),
        AraimOutcome::NotIsolated => {
            (ExclusionOutcome::NotIsolated(Unidentified::NoSet), None, &judged.whole)
        }
        AraimOutcome::Ambiguous => {
            (ExclusionOutcome::NotIsolated(Unidentified::Ambiguous), None, &judged.whole)
        }
    };
    let lost = match &judged.outcome {
        AraimOutcome::Excluded { excluded, .. } => excluded.constellations,
        AraimOutcome::Passed | AraimOutcome::NotIsolated | AraimOutcome::Ambiguous => 0,
    };
    let snapshot = solution.snapshot();
    // At most [`MAX_EXCLUDED`] satellites of a constellation are listed; the ARAIM part of the
    // report names it as a whole.
    let excluded = members(excluded.unwrap_or(0)).filter_map(|index| {
        let (_, fit) = snapshot.row(index)?;
        Some(Excluded { index, w_test: fit.w_test() })
    });
    let levels = ProtectionLevels { hpl_m: finding.hpl_m().widen(), vpl_m: finding.vpl_m().widen() };
    // No test sees shared range errors (ionosphere on one frequency), so that they are added, as
    // for every method.
    let levels = levels.plus(&criteria.shared_shift(snapshot, epoch.shared()));
    // Only the global test detects unmonitored faults, which have probability 0 or are too
    // unlikely. After such a fault no level is valid, and the faulty satellite is unknown. Beyond
    // the table there is no threshold, and the test counts as passed.
    let (sse, dof) = (snapshot.sse(), snapshot.dof());
    let untested = Detection { sse, threshold: infinity(), dof };
    let detection = Detection::of(sse, dof, &criteria.thresholds).unwrap_or(untested);
    if detection.fault() && !matches!(outcome, ExclusionOutcome::NotIsolated(_)) {
        outcome = ExclusionOutcome::NotIsolated(Unidentified::NoSet);
    }
    Judgement {
        outcome,
        excluded: gather::<_, MAX_EXCLUDED>(excluded),
        test: Ok(Test { detection, levels }),
        without_aiding: WithoutAiding::Always,
        is_covered: false,
        lost_systems: lost,
        searched: judged.whole.alarm,
        araim: Some(described(epoch, judged, finding, lost)),
    }
}

fn described<T: Real>(
    epoch: &EpochView<'_>,
    judged: &AraimJudgement<T>,
    finding: &Finding<T>,
    excluded_constellations: u8,
) -> AraimReport {
    let name = |hypothesis: Hypothesis| {
        let [first, second, third] = hypothesis.named();
        [first, second, third].map(|row| Some(epoch.observations().get(row?)?.satellite))
    };
    let [east, north, up] = finding.levels_m;
    let [of_east, of_north, of_up] = finding.dominant;
    let horizontal = if east > north { of_east } else { of_north };
    AraimReport {
        modes: finding.modes as u16,
        unmonitored_probability: finding.unmonitored_probability.widen(),
        share: judged.risk_share.widen(),
        ratio: finding.ratio.widen(),
        effective_monitor_threshold_m: finding.effective_monitor_threshold_m.widen(),
        accuracy_m: finding.accuracy_m.widen(),
        horizontal: crate::report::DominantMode {
            constellations: horizontal.constellations,
            satellites: name(horizontal),
        },
        vertical: crate::report::DominantMode {
            constellations: of_up.constellations,
            satellites: name(of_up),
        },
        excluded_constellations,
        is_risk_spent: !up.is_finite() || !east.is_finite(),
    }
}
