//! The pipeline: one epoch in, one report out, and the little that is remembered between epochs.
//!
//! ```text
//! epoch ─► (clock aiding) ─► fix ─► integrity::judge ─► verdict ─► report        judge: changes nothing
//!                                                                 └────► lesson        learn: a step, after which the
//!                                                                                      report is what is said
//! ```
//!
//! A [`Strategy`] says which threshold detects and how the faulty satellite is found. Every policy's threshold is at or
//! above `τ1`, so the search, whose every step is held against `τ1`, ends with a set that passes under any policy;
//! protection levels are those of the threshold in use.
//!
//! Remembered are the last position, as the start of the next fix; a window of SSE/dof, which says whether the
//! sigmas are right; with clock aiding, the receiver clocks of the epochs that passed; and what was said of the epochs
//! before ([`crate::continuity`]).
//!
//! References: [Yang2015] §1 for the order of the decisions, [Lin2016] §2 for detection and identification.
//!
//! [Yang2015]: crate#references
//! [Lin2016]: crate#references

mod accepted;
mod description;
mod memory;
mod verdict;

use heapless::Deque;

use crate::clock::{Clocks, SolvedClocks};
use crate::continuity::{Continuity, ContinuityError, ContinuitySettings};
use crate::epoch::{Aided, Epoch, EpochView};
use crate::frame::Ecef;
use crate::integrity::raim::detection::threshold::policy::Policy;
use crate::integrity::raim::hypotheses::time_tag::RangeRates;
use crate::integrity::raim::isolation::exclusion::Outcome;
use crate::integrity::raim::isolation::ransac::Subsets;
use crate::integrity::raim::levels::Levels;
use crate::integrity::{Criteria, Judgement, judge};
use crate::least_squares::SnapshotError;
use crate::least_squares::fix::{Fix, FixError};
use crate::numeric::real::Real;
use crate::report::{Alert, Report, Unavailable, Verdict};
use crate::requirements::Requirements;
use crate::weighting::Ism;
use crate::weighting::adaptation::Adaptation;

use description::{describe, residuals, suspects};
use memory::Lesson;

pub use crate::integrity::{Method, Search};
pub use accepted::{Accepted, MonitorError};
pub use memory::{Assessment, Memory};

/// Epochs over which SSE/dof is averaged: with 10 degrees of freedom the mean is then known to 6 %.
pub const SIGMA_CHECK_WINDOW: usize = 60;

/// How integrity is monitored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Strategy {
    /// Which threshold the global test uses.
    pub policy: Policy,
    /// How the faulty satellites are found.
    pub method: Method,
    /// What a protection level bounds.
    pub levels: Levels,
    /// Whether the predicted receiver clock takes a row beside the satellites.
    pub clock_aid: bool,
    /// Whether the sigmas are scaled by what the residuals of the last minutes say ([`Adaptation`]).
    pub sigma_adapt: bool,
}

impl Strategy {
    /// The classic threshold, the best exclusion that the budget of work allows, levels that bound, no aiding.
    pub const DEFAULT: Self = Self { method: Method::Auto, ..Self::CLASSIC };

    /// The same with sequential exclusion.
    pub const CLASSIC: Self = Self {
        policy: Policy::T1,
        method: Method::Baarda,
        levels: Levels::Bound,
        clock_aid: false,
        sigma_adapt: false,
    };
}

/// Watches over the positions of one receiver, at most `N` satellites at a time.
#[derive(Clone, Debug)]
pub struct Monitor<T: Real, const N: usize> {
    accepted: Accepted<T>,
    strategy: Strategy,
    ism: Ism,
    clocks: Clocks<T>,
    adaptation: Adaptation,
    subsets: Subsets,
    start: Ecef,
    ratios: Deque<f32, SIGMA_CHECK_WINDOW>,
    continuity: Continuity,
    continuity_settings: Option<ContinuitySettings>,
}

impl<T: Real, const N: usize> Monitor<T, N> {
    /// A monitor that knows no position yet.
    ///
    /// # Errors
    /// [`MonitorError`] names the requirement that cannot be met.
    pub fn new(requirements: Requirements) -> Result<Self, MonitorError> {
        Ok(Self::of(Accepted::new(requirements)?))
    }

    /// As [`Self::new`], of requirements that are known to be met.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub fn of(accepted: Accepted<T>) -> Self {
        Self {
            accepted,
            strategy: Strategy::DEFAULT,
            ism: Ism::ICAO,
            clocks: Clocks::new(),
            adaptation: Adaptation::new(),
            subsets: Subsets::new(),
            start: Ecef::CENTRE,
            ratios: Deque::new(),
            continuity: Continuity::new(),
            continuity_settings: Some(ContinuitySettings::anywhere()),
        }
    }

    /// Replaces the requirements; what is remembered stays.
    ///
    /// # Errors
    /// As [`Self::new`]; nothing has changed then.
    pub fn require(&mut self, requirements: Requirements) -> Result<(), MonitorError> {
        self.accepted = Accepted::new(requirements)?;
        Ok(())
    }

    /// Replaces the strategy; a change of clock aiding forgets the clocks; one of adaptation the residuals, as does one between
    /// sigmas that are expected and such that are promised.
    pub fn set_strategy(&mut self, strategy: Strategy) {
        if strategy.clock_aid != self.strategy.clock_aid {
            self.clocks.restart();
        }
        let is_weighted_alike = strategy.method.holds_a_promise() == self.strategy.method.holds_a_promise();
        if strategy.sigma_adapt != self.strategy.sigma_adapt || !is_weighted_alike {
            self.forget_residuals();
        }
        self.strategy = strategy;
    }

    /// Ranges are made another way, or are of other satellites: what residuals have said of the sigmas counts for nothing.
    pub fn forget_residuals(&mut self) {
        self.adaptation.restart();
    }

    /// Replaces what a receiver can do and how long satellites must agree after an alert; what is remembered stays.
    ///
    /// # Errors
    /// [`ContinuityError`] names the setting that is out of its range; nothing has changed then.
    pub fn set_continuity(&mut self, settings: ContinuitySettings) -> Result<(), ContinuityError> {
        self.continuity_settings = Some(settings.validate()?);
        Ok(())
    }

    /// What a receiver can do and how long satellites must agree after an alert; none where every epoch is judged by itself.
    pub fn continuity_settings(&self) -> Option<&ContinuitySettings> {
        self.continuity_settings.as_ref()
    }

    /// From now on every epoch is judged by itself, as experiments need that draw each anew: nothing is a jump, nothing
    /// has to be recovered from.
    pub fn forgo_continuity(&mut self) {
        self.continuity_settings = None;
    }

    /// The last position counts for nothing: the next may be anywhere.
    pub fn forget_position(&mut self) {
        self.continuity.forget();
    }

    /// No epoch came for too long, of which the caller has told: the next stands by itself, as the first of all.
    pub fn interrupt(&mut self) {
        self.continuity.interrupt();
    }

    /// Replaces what is promised of the satellites ([`Ism::ICAO`] at first), for [`Method::Separation`].
    pub fn set_ism(&mut self, ism: Ism) {
        // Nothing is worse than a promise that is no number.
        if ism.is_valid() {
            self.ism = ism;
        }
    }

    /// What is promised of the satellites.
    pub fn ism(&self) -> &Ism {
        &self.ism
    }

    /// What is required.
    pub fn requirements(&self) -> &Requirements {
        &self.accepted.requirements
    }

    /// What is required, with what follows from it.
    pub fn accepted(&self) -> &Accepted<T> {
        &self.accepted
    }

    /// Where the next fix starts: the last position, or what [`Self::start_from`] said.
    pub fn start(&self) -> Ecef {
        self.start
    }

    /// Sets where the next fix starts; a point that is not finite is ignored.
    pub fn start_from(&mut self, point: Ecef) {
        if point.is_finite() {
            self.start = point;
        }
    }

    /// Judges one epoch about [`Self::start`] and learns from it.
    pub fn process(&mut self, epoch: &Epoch<N>) -> Report<N> {
        // Taken out while the monitor is read, and put back.
        let mut memory = Memory::new();
        core::mem::swap(&mut memory.scratch.subsets, &mut self.subsets);
        self.judge(epoch, self.start, Search::Anew, None, &mut memory);
        core::mem::swap(&mut memory.scratch.subsets, &mut self.subsets);
        self.learn(&mut memory.assessment, None);
        memory.assessment.report
    }

    /// Judges one epoch whose position is near `start`; with clock aiding, with the forecast of a receiver clock beside it.
    ///
    /// Changes nothing but `memory`, which who has little stack keeps elsewhere, and leaves the [`Assessment`] in it. Whoever
    /// corrects ranges about the position may judge about better and better points, and learns once, from the last. Whoever knows
    /// orbits gives `rates`: without them a wrong time tag is taken for faulty satellites ([`crate::integrity::raim::hypotheses::time_tag`]).
    #[inline(never)]
    pub fn judge<'m>(
        &self,
        epoch: &Epoch<N>,
        start: Ecef,
        search: Search<'_>,
        rates: Option<&RangeRates<'_>>,
        memory: &'m mut Memory<T, N>,
    ) -> &'m mut Assessment<N> {
        let is_aided = self.strategy.clock_aid && self.strategy.method.takes_a_forecast();
        let forecast = self.clocks.aiding(&epoch.view()).filter(|_| is_aided);
        let scale = self.scale(epoch.time_s());
        let Memory { workspace, scratch, assessment } = memory;
        // Judged where it is: a copy would lie on the stack below every search.
        match &mut Fix::about(workspace, Aided::by(epoch, forecast).scaled(scale), start) {
            Ok(fix) => {
                let clock_row = fix.clock_row();
                let judgement =
                    judge(fix, &epoch.view(), clock_row, &self.criteria(), search, rates, scratch);
                self.assess(fix, &epoch.view(), &judgement, assessment);
            }
            Err(error) => self.assess_without_position(*error, epoch, assessment),
        }
        assessment
    }

    /// Takes from an epoch what it teaches: where the next fix starts, whether the sigmas are right, and the clocks. What
    /// the report says is then said in the light of the epochs before.
    ///
    /// `own_clock_s` is when the epoch came, by a clock that no signal can set, where the caller has one.
    #[inline(never)]
    pub fn learn(&mut self, assessment: &mut Assessment<N>, own_clock_s: Option<f64>) {
        self.continue_from(assessment, own_clock_s);
        let Lesson { time_s, start, ratio, clocks, residuals } = &assessment.lesson;
        if let Some(start) = *start {
            self.start = start;
        }
        if let Some(ratio) = *ratio {
            if self.ratios.is_full() {
                self.ratios.pop_front();
            }
            let _ = self.ratios.push_back(ratio);
        }
        if let Some(clocks) = clocks {
            self.clocks.learn(*time_s, clocks);
        }
        if let Some(residuals) = *residuals {
            self.adaptation.learn(*time_s, residuals);
        }
    }

    /// Says of an epoch what it comes to after those before; what is not said any more teaches nothing either.
    fn continue_from(&mut self, assessment: &mut Assessment<N>, own_clock_s: Option<f64>) {
        let Some(settings) = &self.continuity_settings else { return };
        let Assessment { report, lesson, .. } = assessment;
        report.verdict = self.continuity.conclude(settings, lesson.time_s, own_clock_s, report);
        match report.verdict {
            Verdict::Alert(Alert::Jump) => {
                report.protection = None;
                *lesson = Lesson::none(lesson.time_s);
            }
            Verdict::Unavailable(Unavailable::Place) => {
                *lesson = Lesson::none(lesson.time_s);
            }
            Verdict::Unavailable(Unavailable::Recovering) => lesson.clocks = None,
            _ => {}
        }
    }

    /// What all sigmas are multiplied by, where they learn.
    ///
    /// Minutes of small residuals take nothing off what is promised: an integrity support message speaks of faults that they have
    /// not seen.
    fn scale(&self, time_s: f64) -> Option<f64> {
        let least = if self.strategy.method.holds_a_promise() { 1.0 } else { 0.0 };
        self.strategy.sigma_adapt.then(|| self.adaptation.scale(time_s).max(least))
    }

    fn criteria(&self) -> Criteria<'_, T> {
        Criteria {
            requirements: &self.accepted.requirements,
            thresholds: self.accepted.thresholds,
            factors: &self.accepted.factors,
            policy: self.strategy.policy,
            method: self.strategy.method,
            levels: self.strategy.levels,
            ism: &self.ism,
        }
    }

    /// Makes of what was found what is said and what is learned.
    // Not inlined: what it needs of the stack the search before it need not have beside its own.
    #[inline(never)]
    fn assess(
        &self,
        fix: &Fix<'_, T>,
        epoch: &EpochView<'_>,
        judgement: &Judgement<T>,
        assessment: &mut Assessment<N>,
    ) {
        let excluded = suspects(judgement, fix, epoch);
        let verdict = self.verdict(judgement, excluded.is_empty());
        let passed = !matches!(judgement.outcome, Outcome::NotIsolated(_));
        // Under a policy above T1 a search can fail although what it left passes: that is no epoch to learn from.
        let test = judgement.test.as_ref().ok().map(|test| test.detection);
        let ratio = test.filter(|test| passed && !test.fault());
        let ratio = ratio.map(|test| (test.sse.widen() / test.dof as f64) as f32);
        let teaches = self.strategy.clock_aid && self.satellites_are_protected(judgement, verdict);
        let Assessment { report, searched, lesson } = assessment;
        *lesson = Lesson {
            time_s: epoch.time_s(),
            // A position that must not be used is no start either.
            start: (!matches!(verdict, Verdict::Alert(_))).then(|| fix.position()),
            ratio,
            clocks: teaches.then(|| SolvedClocks::of(fix.snapshot())),
            residuals: ratio.filter(|_| self.strategy.sigma_adapt).map(|_| residuals(fix.snapshot(), epoch)),
        };
        *searched = judgement.searched;
        report.excluded = excluded;
        report.sigma_check = self.sigma_check(ratio);
        describe(fix, epoch, verdict, judgement, report);
    }

    /// Mean of SSE/dof over the last [`SIGMA_CHECK_WINDOW`] tested epochs, this one included: about 1 where the sigmas are
    /// right.
    fn sigma_check(&self, latest: Option<f32>) -> Option<f64> {
        let forgotten = usize::from(latest.is_some() && self.ratios.is_full());
        let ratios = || self.ratios.iter().skip(forgotten).copied().chain(latest);
        let count = ratios().count();
        (count > 0).then(|| f64::from(ratios().sum::<f32>()) / count as f64)
    }

    /// What is said of an epoch that has no position.
    #[inline(never)]
    fn assess_without_position(&self, error: FixError, epoch: &Epoch<N>, assessment: &mut Assessment<N>) {
        let reason = match error {
            FixError::Snapshot(SnapshotError::Singular) => Unavailable::Geometry,
            FixError::Snapshot(SnapshotError::Insufficient) | FixError::NotConverged => Unavailable::NoFix,
        };
        assessment.searched = false;
        assessment.lesson = Lesson::none(epoch.time_s());
        let report = &mut assessment.report;
        report.clear();
        report.verdict = Verdict::Unavailable(reason);
        report.tracked = epoch.observations().len() as u8;
        report.sigma_check = self.sigma_check(None);
    }
}
