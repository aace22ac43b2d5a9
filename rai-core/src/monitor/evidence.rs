//! Evidence against the sigmas: the residuals of every tracked satellite over the last minute.
//!
//! ```text
//! ratio = Σ SSE / Σ dof        of the epochs of the last minute, this one included
//! rest  = Σ SSE_r / Σ dof_r    of this epoch, and of those of the last minute that excluded satellites
//! refuted   ratio ≥ max(2, χ²_{1−1e-7}(Σ dof) / Σ dof)
//! refuted   rest ≥ χ²_{1−1e-2}(Σ dof_r) / Σ dof_r          only if this epoch excludes satellites
//! scaled    ratio ≥ χ²_{1−1e-3}(Σ dof) / Σ dof             protection levels times √ratio
//! ```
//!
//! If the sigmas are refuted, no position is promised. The second rule for `refuted` is applied
//! twice, to the rest of this epoch alone and to the sum over the minute. Either suffices. The rule
//! for `scaled` is applied to the ratio of the minute and to that of this epoch's rest. The larger
//! ratio scales the levels.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `SSE`, `dof` | [`EpochResiduals::all`]: weighted squares of the residuals against the solution, those of excluded satellites included, and their degrees of freedom | – |
//! | `SSE_r`, `dof_r` | [`EpochResiduals::rest`]: the same of the satellites used | – |
//! | `χ²_p(ν)/ν` | [`Residuals::ratio_at`] | – |
//!
//! A protection level assumes one faulty satellite at most. It also assumes that the errors of the
//! others are as large as their sigmas state. Exclusion alone cannot check this second assumption,
//! because it removes the residuals that contradict it. Therefore the sum contains the residuals of
//! excluded satellites too:
//!
//! - The largest residual of the excluded satellites does not count, because a level allows for one
//!   faulty satellite. Each of the other squares counts as at most [`MOST_EXCLUDED`].
//! - The satellites of a system that was left out as a whole do not count, because they are one
//!   fault.
//! - The SSE of an epoch counts as at most [`MOST_RATIO`]·dof, so that a short alert does not block
//!   a whole minute. If the ratio is 1 in one half of the minute, the whole other half must reach
//!   this cap to refute the sigmas.
//! - An epoch with [`Unidentified::Time`] does not count, because a wrong time tag is no error of
//!   the ranges. It also erases the evidence of earlier epochs.
//!
//! If `P_fa` is above 1e-7, one epoch that passes its own test without an exclusion never refutes
//! the sigmas: the bound for `refuted` exceeds `τ1` at the same degrees of freedom.
//!
//! **The rest after an exclusion.** The test's `P_fa` is small, because every healthy epoch risks a
//! false alarm. After an exclusion one fault is certain, and reflections come in groups. A rest
//! just below the threshold is then far likelier to contain another fault than to be healthy. Its
//! bound is therefore lower, and refuses a healthy rest in one of a hundred epochs that exclude
//! satellites. In simulated street canyons 170 errors exceeded a level. In 138 of these epochs
//! satellites were excluded, and the rest fails this bound.
//!
//! Assumes that the epochs of a minute are independent. Multipath that repeats from epoch to epoch
//! increases the spread of the ratio, not its mean.

use super::{EpochOutcome, Monitor};
use crate::epoch::{EpochView, Observation};
use crate::integrity::Judgement;
use crate::integrity::raim::isolation::exclusion::{ExclusionOutcome, Unidentified, leaves_enough};
use crate::least_squares::Snapshot;
use crate::least_squares::fix::Fix;
use crate::numeric::real::Real;
use crate::numeric::sqrt;
use crate::report::{Alert, Protected, Unavailable, Verdict};
use crate::weighting::residuals::{RecentResiduals, Residuals};

/// Length of one of the spans that make up the last minute, s.
const SPAN_S: f32 = 6.0;

/// Least ratio that refutes the sigmas, whatever the degrees of freedom.
const REFUTED: f32 = 2.0;

/// `Q⁻¹(1e-7)`, for the bound that refutes the sigmas. If the sigmas are right, the ratio exceeds
/// it in one of ten million minutes.
const REFUTED_QUANTILE: f32 = 5.199_338;

/// `Q⁻¹(1e-3)`, for the bound above which levels are scaled.
const SCALED_QUANTILE: f32 = 3.090_232;

/// `Q⁻¹(1e-2)`, for the bound on the rest after an exclusion: the significance `α` of [Parity].
///
/// [Parity]: crate#references
const REST_QUANTILE: f32 = 2.326_348;

/// Limit for the square of an excluded satellite's residual divided by its sigma.
const MOST_EXCLUDED: f32 = 25.0;

/// Largest SSE/dof with which an epoch counts. If half of a minute has this value and the other
/// half has 1, the ratio is [`REFUTED`].
const MOST_RATIO: f32 = 3.0;

/// Belief in the sigmas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Belief {
    /// The residuals are no larger than the sigmas allow.
    Sound,
    /// The residuals are larger than the sigmas allow, and levels grow by this factor.
    Scaled(f32),
    /// The residuals contradict the sigmas.
    Refuted,
}

/// Residuals of an epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EpochResiduals {
    /// Residuals of every tracked satellite.
    all: Residuals,
    /// Residuals of the satellites used.
    rest: Residuals,
    /// Number of satellites that were excluded one by one; 0 if the rest does not agree.
    pub(super) excluded: u8,
}

impl EpochResiduals {
    /// The residuals of no epoch.
    pub(super) const NONE: Self = Self { all: Residuals::NONE, rest: Residuals::NONE, excluded: 0 };
}

/// Residuals of the last minute.
#[derive(Clone, Debug)]
pub(super) struct Evidence {
    all: RecentResiduals,
    /// Residuals of the satellites used, in epochs that excluded others.
    rests: RecentResiduals,
}

impl Evidence {
    /// Returns no evidence.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self { all: RecentResiduals::of(SPAN_S), rests: RecentResiduals::of(SPAN_S) }
    }

    /// Forgets everything.
    pub(super) fn restart(&mut self) {
        self.all.restart();
        self.rests.restart();
    }

    /// Adds an epoch. If its time is before the last span, the evidence begins anew. An epoch with
    /// a NaN time is not added.
    pub(super) fn learn(&mut self, time_s: f64, latest: &EpochResiduals) {
        self.all.add(time_s, latest.all);
        if latest.excluded > 0 {
            self.rests.add(time_s, latest.rest);
        }
    }

    /// Returns the belief in the sigmas after an epoch with these residuals.
    pub(super) fn belief(&self, time_s: f64, latest: &EpochResiduals) -> Belief {
        let (all, rest) = (self.all.sum_at(time_s, latest.all), latest.rest);
        if all.excess(REFUTED_QUANTILE) >= REFUTED {
            return Belief::Refuted;
        }
        if latest.excluded > 0 {
            let doubt = rest.excess(REST_QUANTILE) + self.rests.sum_at(time_s, rest).excess(REST_QUANTILE);
            if doubt > 0.0 {
                return Belief::Refuted;
            }
        }
        let (of_all, of_rest) = (all.excess(SCALED_QUANTILE), rest.excess(SCALED_QUANTILE));
        let scale = if of_all > of_rest { of_all } else { of_rest };
        if scale > 0.0 { Belief::Scaled(sqrt(scale)) } else { Belief::Sound }
    }
}

impl<T: Real, const N: usize> Monitor<T, N> {
    /// Adds an epoch, promised or not, to the evidence against sigmas and satellites.
    pub(super) fn remember(&mut self, outcome: &EpochOutcome<N>) {
        if !cfg!(feature = "past") {
            return;
        }
        let EpochOutcome { report, update, .. } = outcome;
        if report.verdict == Verdict::Alert(Alert::Time) {
            // A wrong time also explains earlier alarms that looked like faults.
            self.evidence.restart();
        } else {
            self.evidence.learn(update.time_s, &update.evidence);
        }
        if update.is_refuting_scale {
            self.adaptation.restart();
        }
        if update.ratio.is_some() {
            self.named.agree(update.time_s, &report.used);
            self.kept_out.learn(update.time_s, update.systems);
        }
    }

    /// Returns the belief in the sigmas after an epoch with these residuals. If epochs are judged
    /// independently, there is no evidence, and the result is [`Belief::Sound`].
    pub(super) fn belief(&self, time_s: f64, latest: &EpochResiduals) -> Belief {
        match self.continuity_settings {
            Some(_) if cfg!(feature = "past") => self.evidence.belief(time_s, latest),
            _ => Belief::Sound,
        }
    }

    /// Returns true if a system that should be kept out takes part, because the others alone
    /// determine no position.
    fn rests_on_kept_out(&self, fix: &Fix<'_, T, N>, epoch: &EpochView<'_>) -> bool {
        let systems = self.kept_out.systems();
        let is_kept_out = |seen: &Observation| systems >> (seen.satellite.constellation() as u8) & 1 != 0;
        let mut rows = fix.snapshot().rows().zip(epoch.observations());
        systems != 0 && rows.any(|((row, _), seen)| row.weight > T::zero() && is_kept_out(seen))
    }

    /// Returns the verdict on a protected epoch after comparing it with the evidence of earlier
    /// epochs.
    pub(super) fn supported(
        &self,
        how: Protected,
        belief: Belief,
        fix: &Fix<'_, T, N>,
        epoch: &EpochView<'_>,
        excluded: u8,
    ) -> Verdict {
        if belief == Belief::Refuted {
            return Verdict::Unavailable(Unavailable::Sigmas);
        }
        if self.rests_on_kept_out(fix, epoch) {
            return Verdict::Unavailable(Unavailable::Redundancy);
        }
        if !cfg!(feature = "past") || self.continuity_settings.is_none() || self.named.is_empty() {
            return Verdict::Protected(how);
        }
        let used =
            fix.snapshot().rows().zip(epoch.observations()).filter(|((row, _), _)| row.weight > T::zero());
        let doubtful = used.filter(|(_, observation)| self.named.contains(observation.satellite)).count();
        // A doubtful satellite must not count as redundancy: its degree of freedom is subtracted.
        if !leaves_enough(usize::from(excluded.max(1)) + doubtful, fix.snapshot().dof()) {
            return Verdict::Unavailable(Unavailable::Redundancy);
        }
        Verdict::Protected(how)
    }
}

/// Returns two sums: `rest` has the residuals of the satellites used. `all` adds those of the
/// excluded satellites, except for the largest one.
pub(super) fn residuals_of_all<T: Real, const N: usize>(
    judgement: &Judgement<T>,
    snapshot: &Snapshot<'_, T, N>,
    satellites: usize,
) -> EpochResiduals {
    if judgement.outcome == ExclusionOutcome::NotIsolated(Unidentified::Time) {
        return EpochResiduals::NONE;
    }
    let (mut sum, mut largest, mut count) = (0.0_f32, 0.0_f32, 0_u32);
    for (row, fit) in judgement.single_exclusions(snapshot, satellites) {
        let normalised = (fit.residual / row.sigma).widen() as f32;
        let square = (normalised * normalised).min(MOST_EXCLUDED);
        (sum, largest, count) = (sum + square, largest.max(square), count + 1);
    }
    let rest = Residuals { sse: snapshot.sse().widen() as f32, dof: snapshot.dof() as u32 };
    let dof = rest.dof + count.saturating_sub(1);
    let sse = rest.sse + sum - largest;
    let most = MOST_RATIO * dof as f32;
    // An infinite or NaN sum counts as the largest permitted one.
    let all = Residuals { sse: if sse < most { sse } else { most }, dof };
    let agrees = judgement.outcome == ExclusionOutcome::Isolated;
    EpochResiduals { all, rest, excluded: if agrees { count as u8 } else { 0 } }
}

#[cfg(test)]
mod tests {
    use super::{Belief, EpochResiduals, Evidence};
    use crate::weighting::residuals::Residuals;

    /// Returns an epoch with this ratio of all satellites, and one of the rest far below 1.
    fn of_all(ratio: f32) -> EpochResiduals {
        EpochResiduals { all: Residuals { sse: 10.0 * ratio, dof: 10 }, ..EpochResiduals::NONE }
    }

    /// Returns an epoch whose satellites used have this ratio.
    fn of_rest(ratio: f32, is_excluding: bool) -> EpochResiduals {
        let rest = Residuals { sse: 10.0 * ratio, dof: 10 };
        EpochResiduals { rest, excluded: u8::from(is_excluding), ..of_all(1.0) }
    }

    fn after(epochs: u32, step_s: f64, latest: &EpochResiduals) -> Evidence {
        let mut evidence = Evidence::new();
        (0..epochs).for_each(|index| evidence.learn(f64::from(index) * step_s, latest));
        evidence
    }

    #[test]
    fn residuals_that_the_sigmas_allow_change_nothing() {
        let none = EpochResiduals::NONE;
        assert_eq!(after(60, 1.0, &of_all(1.0)).belief(59.0, &none), Belief::Sound);
        assert_eq!(after(1, 1.0, &of_all(2.5)).belief(0.0, &none), Belief::Sound);
        assert_eq!(Evidence::new().belief(0.0, &none), Belief::Sound);
    }

    #[test]
    fn a_minute_of_larger_ones_scales_the_levels_and_then_refutes_the_sigmas() {
        let none = EpochResiduals::NONE;
        let scaled = after(60, 1.0, &of_all(1.5)).belief(59.0, &none);
        let is_root = |factor: f32| (factor - 1.5_f32.sqrt()).abs() < 1e-6;
        assert!(matches!(scaled, Belief::Scaled(factor) if is_root(factor)), "{scaled:?}");
        assert_eq!(after(60, 1.0, &of_all(2.1)).belief(59.0, &none), Belief::Refuted);
        assert_eq!(after(9, 30.0, &of_all(4.0)).belief(240.0, &none), Belief::Refuted);
    }

    #[test]
    fn evidence_ends_after_a_minute_or_if_time_goes_back() {
        let none = EpochResiduals::NONE;
        let mut evidence = after(60, 1.0, &of_all(4.0));
        assert_eq!(evidence.belief(120.0, &none), Belief::Sound);
        evidence.learn(f64::NAN, &of_all(0.0));
        assert_eq!(evidence.belief(59.0, &none), Belief::Refuted);
        evidence.learn(-100.0, &of_all(0.1));
        assert_eq!(evidence.belief(-100.0, &none), Belief::Sound);
    }

    /// χ² of 10 degrees of freedom is above 23.21 once in a hundred times, and above 29.59 once in
    /// a thousand (printed tables).
    #[test]
    fn rest_after_an_exclusion_must_be_as_small_as_in_99_of_100_healthy_epochs() {
        let quiet = after(60, 1.0, &of_all(0.8));
        assert_eq!(quiet.belief(60.0, &of_rest(2.2, true)), Belief::Sound);
        assert_eq!(quiet.belief(60.0, &of_rest(2.4, true)), Belief::Refuted);
        assert_eq!(quiet.belief(60.0, &of_rest(2.4, false)), Belief::Sound);
    }

    /// χ² of 600 degrees of freedom is above 683.5 once in a hundred times.
    #[test]
    fn rests_of_a_minute_are_compared_together() {
        let large = after(60, 1.0, &of_rest(1.2, true));
        assert_eq!(large.belief(60.0, &of_rest(1.2, true)), Belief::Refuted);
        assert_eq!(large.belief(60.0, &of_rest(1.2, false)), Belief::Sound);
        assert_eq!(large.belief(130.0, &of_rest(1.2, true)), Belief::Sound);
        let small = after(60, 1.0, &of_rest(1.05, true));
        assert_eq!(small.belief(60.0, &of_rest(1.05, true)), Belief::Sound);
    }

    #[test]
    fn one_epoch_with_large_residuals_scales_its_own_levels() {
        let quiet = after(60, 1.0, &of_all(0.5));
        let scaled = quiet.belief(60.0, &of_rest(3.2, false));
        let is_root = |factor: f32| (factor - 3.2_f32.sqrt()).abs() < 1e-6;
        assert!(matches!(scaled, Belief::Scaled(factor) if is_root(factor)), "{scaled:?}");
        assert_eq!(quiet.belief(60.0, &of_rest(2.8, false)), Belief::Sound);
    }
}
