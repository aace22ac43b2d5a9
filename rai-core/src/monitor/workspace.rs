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
/// It keeps no state except for the subsets of satellites, which
/// [`Method::Ransac`](super::Method::Ransac) keeps from epoch to epoch.
#[derive(Clone, Debug)]
pub struct MonitorWorkspace<T: Real, const N: usize> {
    pub(super) workspace: Workspace<T, N>,
    pub(super) scratch: MethodScratch<T, N>,
    pub(super) outcome: EpochOutcome<N>,
}

impl<T: Real, const N: usize> Default for MonitorWorkspace<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real, const N: usize> MonitorWorkspace<T, N> {
    /// Returns empty memory.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub fn new() -> Self {
        Self { workspace: Workspace::new(), scratch: MethodScratch::new(), outcome: EpochOutcome::nothing() }
    }

    /// Returns the outcome of the epoch that was judged last.
    pub fn outcome(&self) -> &EpochOutcome<N> {
        &self.outcome
    }

    /// Returns the outcome, for learning from it or for a caller that revises it.
    pub fn outcome_mut(&mut self) -> &mut EpochOutcome<N> {
        &mut self.outcome
    }

    /// Returns the workspace of the equations, which is free between judgements.
    pub fn workspace(&mut self) -> &mut Workspace<T, N> {
        &mut self.workspace
    }
}

/// Outcome of an epoch: its report and its update of the state.
#[derive(Clone, Debug, PartialEq)]
pub struct EpochOutcome<const N: usize> {
    /// Report of the epoch.
    pub report: Report<N>,
    /// True if faulty satellites were searched for, the expensive part.
    pub searched: bool,
    pub(super) update: Update,
}

impl<const N: usize> EpochOutcome<N> {
    /// Returns the outcome of no epoch.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    fn nothing() -> Self {
        Self { report: Report::nothing(), searched: false, update: Update::none(0.0) }
    }

    /// Overrides the verdict by an alert whose reason is outside the ranges, before
    /// [`Monitor::learn`](super::Monitor::learn).
    ///
    /// The position then has no levels and updates nothing. An epoch without a position, or under
    /// an alert already, stays as it is.
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
    /// [`Monitor::learn`](super::Monitor::learn). The epoch then updates nothing. Any other verdict
    /// stays.
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
    /// Start of the next fix, from a position that is not under an alert.
    pub(super) start: Option<Ecef>,
    /// SSE/dof of a test that passed, because a detected fault has no information on sigma.
    pub(super) ratio: Option<f32>,
    /// Residuals of every tracked satellite, alarms included.
    pub(super) evidence: EpochResiduals,
    /// True if sigmas scaled below 1 made the epoch fail its test.
    pub(super) is_refuting_scale: bool,
    /// Clocks of satellites that were protected without a forecast.
    pub(super) clocks: Option<SolvedClocks>,
    /// Residuals of a test that passed, by the sigmas of the epoch.
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
            is_refuting_scale: false,
            clocks: None,
            residuals: None,
            systems: SystemsSeen::NONE,
        }
    }

    /// Takes every effect back.
    // Compiled once for all callers.
    #[inline(never)]
    pub(super) fn clear(&mut self) {
        *self = Self::none(self.time_s);
    }
}
