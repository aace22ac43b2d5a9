//! Memory of one epoch: the workspace of its judgement, its report, and its update of the state.

use super::evidence::EpochResiduals;
use super::kept_out::SystemsSeen;
use crate::clock::SolvedClocks;
use crate::frame::Ecef;
use crate::integrity::MethodScratch;
use crate::least_squares::Workspace;
use crate::numeric::real::Real;
use crate::report::{Alert, Report, Unavailable, Verdict};
use crate::weighting::residuals::Residuals;

/// Memory for judging, which also holds the outcome.
///
/// Its only state from epoch to epoch are the subsets of satellites of
/// [`Method::Ransac`](super::Method::Ransac).
#[derive(Clone, Debug)]
pub struct MonitorMemory<T: Real, const N: usize> {
    pub(super) workspace: Workspace<T, N>,
    pub(super) scratch: MethodScratch<T, N>,
    pub(super) outcome: EpochOutcome<N>,
}

impl<T: Real, const N: usize> Default for MonitorMemory<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real, const N: usize> MonitorMemory<T, N> {
    /// Returns empty memory.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub fn new() -> Self {
        Self { workspace: Workspace::new(), scratch: MethodScratch::new(), outcome: EpochOutcome::nothing() }
    }

    /// Returns the outcome of the epoch that was judged last.
    #[doc(hidden)]
    pub fn outcome(&self) -> &EpochOutcome<N> {
        &self.outcome
    }

    /// Returns the outcome, for [`Monitor::learn`](super::Monitor::learn) or for a caller that
    /// revises it.
    #[doc(hidden)]
    pub fn outcome_mut(&mut self) -> &mut EpochOutcome<N> {
        &mut self.outcome
    }

    /// Returns the workspace of the equations, which is free between judgements.
    #[doc(hidden)]
    pub fn workspace(&mut self) -> &mut Workspace<T, N> {
        &mut self.workspace
    }
}

/// Outcome of an epoch: its report and its update of the state.
#[derive(Clone, Debug, PartialEq)]
pub struct EpochOutcome<const N: usize> {
    /// Report of the epoch.
    pub report: Report<N>,
    /// True if faulty satellites were searched for, which is the expensive part.
    pub searched: bool,
    pub(super) update: Update,
}

impl<const N: usize> EpochOutcome<N> {
    /// Returns an outcome without an epoch.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    fn nothing() -> Self {
        Self { report: Report::nothing(), searched: false, update: Update::none(0.0) }
    }

    /// Returns the factor on the receiver's part of the variances with which the epoch was judged.
    pub fn noise(&self) -> f32 {
        self.update.evidence.noise
    }

    /// Returns SSE/dof of the satellites used, under every method; `None` if the test failed, or if the
    /// epoch updates nothing.
    pub const fn variance_ratio(&self) -> Option<f32> {
        self.update.ratio
    }

    /// Overrides the verdict by an alert whose reason is outside the ranges, before
    /// [`Monitor::learn`](super::Monitor::learn).
    ///
    /// The position then has no levels, and the epoch updates nothing. An outcome without a
    /// position, or with an alert, does not change.
    pub fn override_alert(&mut self, reason: Alert) {
        if self.report.solution.is_some() && !matches!(self.report.verdict, Verdict::Alert(_)) {
            self.report.verdict = Verdict::Alert(reason);
            self.report.protection = None;
            self.update.clear();
        }
    }
}

impl<const N: usize> EpochOutcome<N> {
    /// Withdraws a promise for a reason outside the ranges, before
    /// [`Monitor::learn`](super::Monitor::learn). The epoch then updates nothing. A verdict other
    /// than protected does not change.
    pub fn withdraw(&mut self, reason: Unavailable) {
        if matches!(self.report.verdict, Verdict::Protected(_)) {
            self.report.verdict = Verdict::Unavailable(reason);
            self.update.clear();
        }
    }
}

/// Update of the state by [`Monitor::learn`](super::Monitor::learn).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Update {
    pub(super) time_s: f64,
    /// Start of the next fix; `None` under an alert.
    pub(super) start: Option<Ecef>,
    /// SSE/dof, if the test passed; with a detected fault it tells nothing about sigma.
    pub(super) ratio: Option<f32>,
    /// Residuals of every tracked satellite, also if the test fails.
    pub(super) evidence: EpochResiduals,
    /// True if the epoch contradicted a noise below 1.
    pub(super) is_refuting_quiet: bool,
    /// Clocks, if the position is also protected without a forecast.
    pub(super) clocks: Option<SolvedClocks>,
    /// Residuals over the sigmas of the epoch, if the test passed.
    pub(super) residuals: Option<Residuals>,
    /// Systems in view, and those left out.
    pub(super) systems: SystemsSeen,
}

impl Update {
    /// Returns an update without effect.
    pub(super) const fn none(time_s: f64) -> Self {
        Self {
            time_s,
            start: None,
            ratio: None,
            evidence: EpochResiduals::NONE,
            is_refuting_quiet: false,
            clocks: None,
            residuals: None,
            systems: SystemsSeen::NONE,
        }
    }

    /// Removes every effect.
    // Compiled once for all callers.
    #[inline(never)]
    pub(super) fn clear(&mut self) {
        *self = Self::none(self.time_s);
    }
}
