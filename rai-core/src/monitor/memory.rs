//! What one epoch takes and leaves: room to judge it in, what is said of it, and what it teaches.

use crate::clock::SolvedClocks;
use crate::frame::Ecef;
use crate::integrity::Scratch;
use crate::least_squares::Workspace;
use crate::numeric::real::Real;
use crate::report::{Alert, Report, Verdict};
use crate::weighting::adaptation::Residuals;

/// Room that judging takes, and where it says what it found. Nothing in it is remembered but the subsets of the satellites,
/// which [`Method::Ransac`](super::Method::Ransac) keeps from epoch to epoch.
#[derive(Clone, Debug)]
pub struct Memory<T: Real, const N: usize> {
    pub(super) workspace: Workspace<T, N>,
    pub(super) scratch: Scratch<T>,
    pub(super) assessment: Assessment<N>,
}

impl<T: Real, const N: usize> Default for Memory<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real, const N: usize> Memory<T, N> {
    /// Of no epoch yet.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub fn new() -> Self {
        Self { workspace: Workspace::new(), scratch: Scratch::new(), assessment: Assessment::nothing() }
    }

    /// What is said of the epoch that was judged last.
    pub fn assessment(&self) -> &Assessment<N> {
        &self.assessment
    }

    /// The same, to be learned from, or revised by who knows more.
    pub fn assessment_mut(&mut self) -> &mut Assessment<N> {
        &mut self.assessment
    }

    /// The room for equations, while nothing is judged.
    pub fn workspace(&mut self) -> &mut Workspace<T, N> {
        &mut self.workspace
    }
}

/// What is said of an epoch, and what it teaches.
#[derive(Clone, Debug, PartialEq)]
pub struct Assessment<const N: usize> {
    /// What is said.
    pub report: Report<N>,
    /// Whether faulty satellites were searched for: the expensive part.
    pub searched: bool,
    pub(super) lesson: Lesson,
}

impl<const N: usize> Assessment<N> {
    /// Of no epoch.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    fn nothing() -> Self {
        Self { report: Report::nothing(), searched: false, lesson: Lesson::none(0.0) }
    }

    /// Says an alert for a reason that the ranges do not tell, before anything is learned: the position is not what it seems,
    /// has no levels and teaches nothing. An epoch without a position, or under an alert already, stays what it is.
    pub fn distrust(&mut self, reason: Alert) {
        if self.report.solution.is_some() && !matches!(self.report.verdict, Verdict::Alert(_)) {
            self.report.verdict = Verdict::Alert(reason);
            self.report.protection = None;
            self.lesson = Lesson::none(self.lesson.time_s);
        }
    }
}

/// What [`Monitor::learn`](super::Monitor::learn) takes from an epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lesson {
    pub(super) time_s: f64,
    /// A position that may be used.
    pub(super) start: Option<Ecef>,
    /// SSE/dof of a test that passed: a detected fault says nothing about sigma.
    pub(super) ratio: Option<f32>,
    /// Clocks of satellites that were protected by themselves.
    pub(super) clocks: Option<SolvedClocks>,
    /// Residuals of a test that passed, by the sigmas as they came.
    pub(super) residuals: Option<Residuals>,
}

impl Lesson {
    /// That teaches nothing.
    pub(super) const fn none(time_s: f64) -> Self {
        Self { time_s, start: None, ratio: None, clocks: None, residuals: None }
    }
}
