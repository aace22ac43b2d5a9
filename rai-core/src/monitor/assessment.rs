//! The assessment: derives the verdict, the report and the update of the monitor from a judgement.
//!
//! The monitor stores `ratio = SSE/dof` of each epoch that passed its test. The mean of these
//! ratios is the sigma check of the report, about 1 if the sigmas are right.

use super::description::{describe, known_height, residuals, suspects};
use super::evidence::residuals_of_all;
use super::kept_out::SystemsSeen;
use super::workspace::Update;
use super::{EpochOutcome, Monitor};
use crate::clock::SolvedClocks;
use crate::epoch::{Epoch, EpochView};
use crate::integrity::Judgement;
use crate::integrity::raim::isolation::exclusion::ExclusionOutcome;
use crate::least_squares::SnapshotError;
use crate::least_squares::fix::{Fix, FixError};
use crate::numeric::real::Real;
use crate::report::{Unavailable, Verdict};

impl<T: Real, const N: usize> Monitor<T, N> {
    /// Derives the verdict, the report and the update from a judgement.
    // Not inlined, so that its stack is free during the search before it.
    #[inline(never)]
    pub(super) fn assess(
        &self,
        fix: &Fix<'_, T, N>,
        epoch: &EpochView<'_>,
        noise: f32,
        judgement: &mut Judgement<T>,
        outcome: &mut EpochOutcome<N>,
    ) {
        let excluded = suspects(judgement, fix, epoch);
        let evidence = residuals_of_all(judgement, fix.snapshot(), epoch, noise);
        let growth = self.growth(epoch.time_s(), &evidence);
        if let Some(factor) = growth {
            judgement.scale_levels(f64::from(factor));
        }
        let verdict = match self.verdict(judgement, excluded.is_empty()) {
            Verdict::Protected(how) => self.supported(how, growth, fix, epoch, evidence.excluded),
            other => other,
        };
        let passed = !matches!(judgement.outcome, ExclusionOutcome::NotIsolated(_));
        // If the policy's threshold is above `τ1`, a search can fail although its remaining rows
        // pass. Such an epoch adds neither to the sigma check nor to the residuals.
        let test = judgement.test.as_ref().ok().map(|test| test.detection);
        let ratio = test.filter(|test| passed && !test.fault());
        let ratio = ratio.map(|test| (test.sse.widen() / test.dof as f64) as f32);
        let teaches =
            self.strategy.aids_with_clock() && passed && self.satellites_are_protected(judgement, verdict);
        let EpochOutcome { report, searched, update } = outcome;
        *update = Update {
            time_s: epoch.time_s(),
            // The next fix does not start from a position under an alert.
            start: (!matches!(verdict, Verdict::Alert(_))).then(|| fix.position()),
            ratio,
            evidence,
            is_refuting_quiet: false,
            clocks: teaches.then(|| SolvedClocks::of(fix.snapshot())),
            residuals: ratio
                .filter(|_| self.strategy.lowers_noise())
                .map(|_| residuals(fix.snapshot(), epoch)),
            systems: SystemsSeen { in_view: systems_of(epoch), ..SystemsSeen::NONE },
        };
        *searched = judgement.searched;
        report.excluded = excluded;
        report.height = known_height(judgement, fix.snapshot(), epoch);
        report.excluded_constellations = judgement.lost_systems;
        report.sigma_check = self.sigma_check(ratio);
        describe(fix, epoch, verdict, judgement, report);
        if verdict == Verdict::Unavailable(Unavailable::Sigmas) {
            // If the sigmas are refuted, the level bounds nothing.
            report.protection = None;
        }
    }

    /// Returns the mean of SSE/dof over the last [`SIGMA_CHECK_WINDOW`] tested epochs, this one
    /// included: about 1 if the sigmas are right.
    fn sigma_check(&self, latest: Option<f32>) -> Option<f64> {
        let forgotten = usize::from(latest.is_some() && self.ratios.is_full());
        let ratios = || self.ratios.iter().skip(forgotten).copied().chain(latest);
        let count = ratios().count();
        (count > 0).then(|| f64::from(ratios().sum::<f32>()) / count as f64)
    }

    /// Writes the outcome of an epoch without a position.
    #[inline(never)]
    pub(super) fn assess_without_position(
        &self,
        error: FixError,
        epoch: &Epoch<N>,
        outcome: &mut EpochOutcome<N>,
    ) {
        let reason = match error {
            FixError::Snapshot(SnapshotError::Singular) => Unavailable::Geometry,
            FixError::Snapshot(SnapshotError::Insufficient) | FixError::NotConverged => Unavailable::NoFix,
        };
        outcome.searched = false;
        outcome.update.time_s = epoch.time_s();
        outcome.update.clear();
        let report = &mut outcome.report;
        report.clear();
        report.verdict = Verdict::Unavailable(reason);
        report.tracked = epoch.observations().len() as u8;
        report.sigma_check = self.sigma_check(None);
    }
}

/// Returns the systems of an epoch, a bit for each id.
fn systems_of(epoch: &EpochView<'_>) -> u8 {
    epoch.observations().iter().fold(0, |set, seen| set | 1 << (seen.satellite.constellation() as u8))
}
