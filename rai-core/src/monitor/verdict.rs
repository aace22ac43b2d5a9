//! Conversion of a judgement to a verdict: protected, alert or unavailable, with the reason.

use crate::integrity::raim::detection::threshold::policy::{NoThreshold, Policy};
use crate::integrity::raim::isolation::exclusion::{ExclusionOutcome, Unidentified};
use crate::integrity::{Judgement, WithoutAiding};
use crate::numeric::real::Real;
use crate::report::{Alert, AraimReport, Protected, ProtectionLevels, Unavailable, Verdict};
use crate::requirements::Requirements;

use super::Monitor;

impl<T: Real, const N: usize> Monitor<T, N> {
    pub(super) fn verdict(&self, judgement: &Judgement<T>, none_excluded: bool) -> Verdict {
        let is_covered = judgement.is_covered;
        match (judgement.outcome, &judgement.test) {
            (ExclusionOutcome::NotIsolated(Unidentified::Time), _) => Verdict::Alert(Alert::Time),
            (ExclusionOutcome::NotIsolated(Unidentified::Budget), _) => {
                Verdict::Unavailable(Unavailable::Budget)
            }
            (ExclusionOutcome::NotIsolated(Unidentified::Ambiguous), _) if !is_covered => {
                Verdict::Alert(Alert::Ambiguous)
            }
            (ExclusionOutcome::NotIsolated(_), _) if !is_covered => Verdict::Alert(Alert::Fault),
            (_, Err(NoThreshold::Redundancy)) => Verdict::Unavailable(Unavailable::Redundancy),
            (_, Err(NoThreshold::Risk)) => Verdict::Unavailable(Unavailable::Risk),
            (_, Ok(test)) => {
                // If only an aiding row was left out, no satellite is faulty: the clock has jumped,
                // or the known height is wrong.
                let reason = match none_excluded {
                    true => Protected::Ok,
                    false if is_covered => Protected::Covered,
                    false => Protected::Excluded,
                };
                let verdict = match &judgement.araim {
                    Some(araim) => self.bounded_by_araim(reason, &test.levels, araim),
                    None => self.bounded(reason, &judgement.levels().unwrap_or(test.levels)),
                };
                match verdict {
                    // The limits have no room for every explanation, so that the position may be wrong.
                    Verdict::Unavailable(_) if is_covered => Verdict::Alert(Alert::Ambiguous),
                    verdict => verdict,
                }
            }
        }
    }

    /// Returns true if the position would also be protected without the aiding rows. If an epoch is
    /// protected only because of aiding rows, no clock is learned from it.
    pub(super) fn satellites_are_protected(&self, judgement: &Judgement<T>, verdict: Verdict) -> bool {
        let alone = match &judgement.without_aiding {
            WithoutAiding::Always => true,
            WithoutAiding::Untested => false,
            WithoutAiding::Tested(test) => {
                matches!(self.bounded(Protected::Ok, &test.levels), Verdict::Protected(_))
            }
        };
        alone && matches!(verdict, Verdict::Protected(_))
    }

    /// Returns the verdict on satellites that agree, by comparing their protection levels with the
    /// limits.
    ///
    /// A policy other than `T1` chooses the threshold so that the plain level is within
    /// `guard_fraction` of the limit. Shared errors, a possible time error and scaling add to that
    /// level, and may use the rest of the limit.
    fn bounded(&self, reason: Protected, levels: &ProtectionLevels) -> Verdict {
        let ProtectionLevels { hpl_m, vpl_m } = *levels;
        let fraction = self.validated.requirements.guard_fraction;
        let decided = self.strategy.policy != Policy::T1;
        // A NaN level fails this comparison.
        let within = |level_m: f64, limit_m: f64| {
            if decided { level_m <= limit_m } else { level_m < fraction * limit_m }
        };
        if !hpl_m.is_finite() || (self.validated.requirements.val_m.is_some() && !vpl_m.is_finite()) {
            Verdict::Unavailable(Unavailable::Geometry)
        } else if !within(hpl_m, self.validated.requirements.hal_m) {
            Verdict::Unavailable(Unavailable::Hpl)
        } else if !self.validated.requirements.val_m.is_none_or(|val_m| within(vpl_m, val_m)) {
            Verdict::Unavailable(Unavailable::Vpl)
        } else {
            Verdict::Protected(reason)
        }
    }

    /// Works like [`Self::bounded`] for ARAIM, which has two more limits. Its levels may reach the
    /// alert limits.
    fn bounded_by_araim(&self, reason: Protected, levels: &ProtectionLevels, araim: &AraimReport) -> Verdict {
        let Requirements { hal_m, val_m, allocation, .. } = &self.validated.requirements;
        // NaN fails this comparison.
        let within = |value: f64, limit: Option<f64>| limit.is_none_or(|limit| value <= limit);
        if !levels.hpl_m.is_finite() || (val_m.is_some() && !levels.vpl_m.is_finite()) {
            Verdict::Unavailable(if araim.is_risk_spent { Unavailable::Risk } else { Unavailable::Geometry })
        } else if !within(levels.hpl_m, Some(*hal_m)) {
            Verdict::Unavailable(Unavailable::Hpl)
        } else if !within(levels.vpl_m, *val_m) {
            Verdict::Unavailable(Unavailable::Vpl)
        } else if !within(araim.effective_monitor_threshold_m, allocation.emt_limit_m) {
            Verdict::Unavailable(Unavailable::Emt)
        } else if !within(araim.accuracy_m, allocation.accuracy_limit_m) {
            Verdict::Unavailable(Unavailable::Accuracy)
        } else {
            Verdict::Protected(reason)
        }
    }
}
