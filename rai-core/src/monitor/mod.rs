//! The pipeline: one epoch in, one report out, with a small state between epochs.
//!
//! ```text
//! epoch ─► (clock aiding) ─► fix ─► integrity::judge ─► verdict ─► report        judge: the monitor stays as it is
//!                                                                 └────► update        learn: changes the monitor, and
//!                                                                                      makes the report final
//! ```
//!
//! A [`Strategy`] selects the threshold and the isolation method. `τ1` is the threshold for `P_fa`,
//! and no policy uses a lower one. The search compares every step with `τ1`, so that its result
//! passes under any policy. Protection levels belong to the threshold in use.
//!
//! Between epochs the monitor stores:
//!
//! | field | content | use |
//! |---|---|---|
//! | `start` | last position | start of the next fix |
//! | `ratios` | SSE/dof of epochs that passed their test | sigma check |
//! | `evidence`, `named` | residuals of the last minute; satellites excluded lately | raise the noise; withdraw a promise |
//! | `kept_out` | systems that were broken again and again | are left out before the test |
//! | `height`, `motion` | last known height; last positions | are compared with the next ones |
//! | `continuity` | earlier verdicts ([`crate::continuity`]) | jumps, recovery after an alert |
//! | `clocks` | with clock aiding, the receiver clocks of protected epochs | forecast |
//! | `adaptation`, `rest` | residuals of epochs that passed their test at rest | lower the noise until something changes |
//! | `subsets` | subsets of [`Method::Ransac`] | next search |
//!
//! References: [Yang2015] §1 for the order of the decisions, [Lin2016] §2 for detection and
//! identification.
//!
//! [Yang2015]: crate#references
//! [Lin2016]: crate#references

mod assessment;
mod description;
mod evidence;
mod height;
mod kept_out;
mod named;
mod rest;
mod settings;
mod strategy;
mod validated;
mod verdict;
mod workspace;

use heapless::Deque;

use crate::clock::Clocks;
use crate::continuity::{Continuity, Motion};
use crate::epoch::{Aided, Epoch, EpochView};
use crate::frame::Ecef;
use crate::integrity::raim::detection::Detection;
use crate::integrity::raim::hypotheses::time_tag::RangeRates;
use crate::integrity::raim::isolation::ransac::Subsets;
use crate::integrity::{Criteria, KeptOut, Test, judge};
use crate::least_squares::Snapshot;
use crate::least_squares::fix::Fix;
use crate::numeric::real::Real;
use crate::report::{Alert, ProtectionLevels, Report, Suspect, Unavailable, Verdict};
use crate::requirements::Requirements;
use crate::velocity::{Velocity, VelocityError};
use crate::weighting::adaptation::{Adaptation, Residuals};

use description::residuals;
use evidence::{Evidence, shared_growth};
use height::HeightMemory;
use kept_out::KeptOutSystems;
use named::Named;
use rest::Rest;
use workspace::Update;

pub use crate::continuity::{ContinuityError, ContinuitySettings, Recovery};
pub use crate::integrity::raim::detection::threshold::ThresholdError;
pub use crate::integrity::raim::detection::threshold::policy::Policy;
pub use crate::integrity::raim::isolation::parity::Isolation;
pub use crate::integrity::raim::levels::Levels;
pub use crate::integrity::{Method, MethodError};
pub use crate::weighting::{Ism, IsmParameters, UserModel};
pub use strategy::{Noise, Strategy};
pub use validated::MonitorError;

#[doc(hidden)]
pub use crate::integrity::Search;
#[doc(hidden)]
pub use validated::ValidatedRequirements;
#[doc(hidden)]
pub use workspace::EpochOutcome;
pub use workspace::MonitorMemory;

/// Number of epochs over which SSE/dof is averaged. With 10 degrees of freedom and independent
/// epochs the mean is accurate to 6 %. Multipath, which repeats from epoch to epoch, makes it less
/// accurate.
const SIGMA_CHECK_WINDOW: usize = 60;

/// Integrity monitor for the positions of one receiver, at most `N` satellites at a time.
///
/// ```
/// use raim_core::{Epoch, Monitor, Requirements, Verdict};
///
/// let mut monitor = Monitor::<f32, 16>::new(Requirements::en_route())?;
/// let report = monitor.process(&Epoch::new(0.0)); // no satellite, so that there is no position
/// assert!(matches!(report.verdict, Verdict::Unavailable(_)));
/// # Ok::<(), raim_core::monitor::MonitorError>(())
/// ```
///
/// The [crate documentation](crate#example) has an epoch that ends protected.
#[derive(Clone, Debug)]
pub struct Monitor<T: Real, const N: usize> {
    validated: ValidatedRequirements<T, N>,
    strategy: Strategy,
    ism: Ism,
    clocks: Clocks<T>,
    adaptation: Adaptation,
    rest: Rest,
    subsets: Subsets<N>,
    start: Ecef,
    ratios: Deque<f32, SIGMA_CHECK_WINDOW>,
    evidence: Evidence,
    named: Named,
    height: HeightMemory,
    kept_out: KeptOutSystems,
    motion: Motion,
    continuity: Continuity,
    continuity_settings: Option<ContinuitySettings>,
}

impl<T: Real, const N: usize> Monitor<T, N> {
    /// Returns a monitor without a known position.
    ///
    /// # Errors
    /// [`MonitorError`] names the requirement that cannot be met.
    pub fn new(requirements: Requirements) -> Result<Self, MonitorError> {
        Ok(Self::of(ValidatedRequirements::new(requirements)?))
    }

    /// Works like [`Self::new`], from validated requirements.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    #[doc(hidden)]
    pub fn of(validated: ValidatedRequirements<T, N>) -> Self {
        Self {
            validated,
            strategy: Strategy::DEFAULT,
            ism: Ism::ICAO,
            clocks: Clocks::new(),
            adaptation: Adaptation::new(),
            rest: Rest::new(),
            subsets: Subsets::new(),
            start: Ecef::CENTRE,
            ratios: Deque::new(),
            evidence: Evidence::new(),
            named: Named::new(),
            height: HeightMemory::new(),
            kept_out: KeptOutSystems::new(),
            motion: Motion::new(),
            continuity: Continuity::new(),
            continuity_settings: Some(ContinuitySettings::anywhere()),
        }
    }

    /// Forgets the residuals of the adaptation, the systems kept out and the past motion. Call it if
    /// the ranges are now made in another way or come from other satellites. The noise of the last
    /// minute stays: it is that of the receiver, and can only raise levels.
    pub fn forget_residuals(&mut self) {
        self.adaptation.restart();
        self.kept_out.restart();
        self.motion.restart();
    }

    /// Takes what ranges of the other kind have taught about their noise, of one frequency or of two.
    /// If that is nothing yet, they count as `noisier` times as noisy as those before. Call it together
    /// with [`Self::forget_residuals`].
    pub fn change_kind(&mut self, noisier: f32) {
        self.motion.change_kind(noisier);
    }

    /// Forgets what limits the next position, so that it may be anywhere. The start of the next fix
    /// stays.
    pub fn forget_position(&mut self) {
        self.continuity.forget();
        self.kept_out.restart();
        self.motion.forget();
        self.height = HeightMemory::new();
    }

    /// Restarts the continuity after a gap longer than the time to alert. The next position must be
    /// where the receiver can be expected. Otherwise it is promised only after a longer agreement.
    pub fn interrupt(&mut self) {
        self.continuity.interrupt();
    }

    /// Judges one epoch, linearised at [`Self::start`], and learns from it.
    ///
    /// The memory for it is on the stack: [`Self::process_in`] needs less.
    pub fn process(&mut self, epoch: &Epoch<N>) -> Report<N> {
        let mut memory = MonitorMemory::new();
        self.process_in(&mut memory, epoch);
        memory.outcome.report
    }

    /// Works like [`Self::process`], in memory of the caller's, such as a static. Any memory will
    /// do for any epoch, because it carries nothing from one to the next.
    pub fn process_in<'m>(&mut self, memory: &'m mut MonitorMemory<T, N>, epoch: &Epoch<N>) -> &'m Report<N> {
        // `judge_about` borrows `self`, so that the subsets move into `memory` for the call and
        // back afterwards.
        core::mem::swap(&mut memory.scratch.subsets, &mut self.subsets);
        self.judge_about(epoch, self.start, Search::Anew, None, memory);
        core::mem::swap(&mut memory.scratch.subsets, &mut self.subsets);
        self.learn_from(&mut memory.outcome, None, None, VelocityError::Redundancy);
        &memory.outcome.report
    }

    /// Judges one epoch whose position is near `start`. With clock aiding, the forecast of a
    /// receiver clock adds a row.
    ///
    /// Writes only to `memory`, which also contains the [`EpochOutcome`]; a caller with a small
    /// stack can keep it in a static. A caller whose corrections depend on the position may judge
    /// an epoch at several points in turn. It then learns once, from the last outcome. A caller
    /// that knows orbits passes `rates`: without them a wrong time tag counts as faulty satellites
    /// ([`crate::integrity::raim::hypotheses::time_tag`]).
    #[doc(hidden)]
    pub fn judge<'m>(
        &self,
        epoch: &Epoch<N>,
        start: Ecef,
        search: Search<'_>,
        rates: Option<&RangeRates<'_>>,
        memory: &'m mut MonitorMemory<T, N>,
    ) -> &'m mut EpochOutcome<N> {
        self.judge_about(epoch, start, search, rates, memory)
    }

    /// Returns the levels of an epoch whose ranges contain no fault, or `None` without a position
    /// or a test. They depend on geometry and sigmas, and not on residuals.
    ///
    /// `noise` is the factor on the receiver's part of the variances ([`Self::noise`]).
    #[doc(hidden)]
    pub fn levels(
        &self,
        epoch: &Epoch<N>,
        start: Ecef,
        noise: f32,
        memory: &mut MonitorMemory<T, N>,
    ) -> Option<ProtectionLevels> {
        self.tested(epoch, start, noise, memory, |test, _| test.levels)
    }

    /// Works like [`Self::levels`], and returns with them the residuals over the sigmas of the epoch,
    /// or `None` in their place if the test fails.
    #[doc(hidden)]
    pub fn fault_free(
        &self,
        epoch: &Epoch<N>,
        start: Ecef,
        noise: f32,
        memory: &mut MonitorMemory<T, N>,
    ) -> Option<(ProtectionLevels, Option<Residuals>)> {
        self.tested(epoch, start, noise, memory, |test, snapshot| {
            let residuals = (!test.detection.fault()).then(|| residuals(snapshot, &epoch.view()));
            (test.levels, residuals)
        })
    }

    /// Tests an epoch, and returns what follows from the test.
    fn tested<R>(
        &self,
        epoch: &Epoch<N>,
        start: Ecef,
        noise: f32,
        memory: &mut MonitorMemory<T, N>,
        result: impl FnOnce(&Test<T>, &Snapshot<'_, T, N>) -> R,
    ) -> Option<R> {
        let noise = self.as_before(noise, epoch);
        let aided = Aided::alone(epoch).noisier(noise);
        let fix = Fix::about(&mut memory.workspace, aided, start).ok()?;
        let test = self.criteria(shared_growth(noise)).test(fix.snapshot(), epoch.shared()).ok()?;
        Some(result(&test, fix.snapshot()))
    }

    /// Returns the residuals learned at rest, to exchange them for those of another kind of ranges.
    #[doc(hidden)]
    pub const fn adaptation_mut(&mut self) -> &mut Adaptation {
        &mut self.adaptation
    }

    /// Makes the report's verdict final by comparing it with earlier epochs. Then updates the state
    /// as far as that verdict permits.
    ///
    /// `own_clock_s` is the arrival time of the epoch by a clock that no signal can set, if the
    /// caller has one. `velocity` is the velocity in the epoch, or the reason why its range rates
    /// determine none.
    #[doc(hidden)]
    pub fn learn(
        &mut self,
        outcome: &mut EpochOutcome<N>,
        own_clock_s: Option<f64>,
        velocity: Result<&Velocity, VelocityError>,
    ) {
        let refusal = velocity.err().unwrap_or(VelocityError::Redundancy);
        self.learn_from(outcome, own_clock_s, velocity.ok(), refusal);
    }

    /// Judges an epoch, for [`Self::process`] and for `judge`.
    #[inline(never)]
    pub(crate) fn judge_about<'m>(
        &self,
        epoch: &Epoch<N>,
        start: Ecef,
        search: Search<'_>,
        rates: Option<&RangeRates<'_>>,
        memory: &'m mut MonitorMemory<T, N>,
    ) -> &'m mut EpochOutcome<N> {
        let is_aided = self.strategy.aids_with_clock() && self.strategy.method.allows_aiding();
        let forecast = if is_aided { self.clocks.aiding(&epoch.view()) } else { None };
        let MonitorMemory { workspace, scratch, outcome } = memory;
        let aided = Aided::by(epoch, forecast);
        let mut noise = self.as_before(self.noise(epoch.time_s()), epoch);
        let mut is_refuting = false;
        loop {
            // Judged in place, because a copy would be on the stack during every search.
            match &mut Fix::about(workspace, aided.noisier(noise), start) {
                Ok(fix) if noise < 1.0 && self.ends_rest(fix) => {
                    (noise, is_refuting) = (1.0, true);
                    continue;
                }
                Ok(fix) => {
                    let clock_row = fix.clock_row().filter(|_| cfg!(feature = "aiding"));
                    let kept_out = self.keep_out(fix, &epoch.view());
                    let criteria = self.criteria(shared_growth(noise));
                    let mut judgement =
                        judge(fix, &epoch.view(), clock_row, &criteria, search, rates, scratch);
                    let is_broken = judgement.lost_systems;
                    kept_out.describe(&mut judgement);
                    self.assess(fix, &epoch.view(), noise, &mut judgement, outcome);
                    outcome.update.systems.excluded = is_broken;
                    outcome.update.systems.kept_out_agree = kept_out.agrees;
                    outcome.update.is_refuting_quiet = is_refuting;
                }
                Err(error) => self.assess_without_position(*error, epoch, outcome),
            }
            return outcome;
        }
    }

    /// Returns true if an epoch with lowered noise contradicts the quiet time before it.
    fn ends_rest(&self, fix: &Fix<'_, T, N>) -> bool {
        let (sse, dof) = (fix.snapshot().sse(), fix.snapshot().dof());
        let detection = Detection::of(sse, dof, &self.validated.thresholds);
        !self.rest.is_near(fix.position()) || detection.is_none_or(|detection| detection.fault())
    }

    /// Updates the state from a judged epoch, for [`Self::process`] and `learn`.
    ///
    /// `refusal` is the reason if there is no velocity. They are two parameters and not one
    /// `Result`, because the compiler propagates constants only through simple parameters. A
    /// program without range rates then contains no comparison with rates.
    #[inline(never)]
    fn learn_from(
        &mut self,
        outcome: &mut EpochOutcome<N>,
        own_clock_s: Option<f64>,
        velocity: Option<&Velocity>,
        refusal: VelocityError,
    ) {
        self.remember(outcome);
        self.continue_from(outcome, own_clock_s, velocity.ok_or(refusal));
        // Only a protected epoch records its exclusions. Those during an alert, or during the
        // recovery after it, may be wrong, as may those that are ambiguous.
        if matches!(outcome.report.verdict, Verdict::Protected(_)) && outcome.update.ratio.is_some() {
            // The satellites of a system that is left out as a whole are not recorded one by one.
            let lost = outcome.report.excluded_constellations;
            let is_lost = |suspect: &&Suspect| lost >> (suspect.satellite.constellation() as u8) & 1 != 0;
            for excluded in outcome.report.excluded.iter().filter(|suspect| !is_lost(suspect)) {
                self.named.name(excluded.satellite);
            }
        }
        let Update { time_s, start, ratio, clocks, residuals, .. } = &outcome.update;
        if let Some(start) = *start {
            self.start = start;
        }
        if let Some(ratio) = *ratio {
            if self.ratios.is_full() {
                self.ratios.pop_front();
            }
            let _ = self.ratios.push_back(ratio);
        }
        if cfg!(feature = "aiding")
            && let Some(clocks) = clocks
        {
            self.clocks.learn(*time_s, clocks);
        }
        if self.strategy.lowers_noise() {
            let is_at_rest = start.is_some_and(|place| {
                self.rest.continues(*time_s, place, &outcome.report.used, velocity.ok_or(refusal))
            });
            if !is_at_rest {
                self.adaptation.restart();
            }
            if let Some(residuals) = *residuals {
                self.adaptation.learn(*time_s, residuals);
            }
        }
    }

    /// Applies continuity to an epoch.
    ///
    /// After an alert of this step, or at an impossible place, the start, the sigma check, the
    /// clocks and the residuals are not updated. During recovery only the clocks are not updated.
    /// The evidence against the sigmas was updated earlier, by `remember`.
    fn continue_from(
        &mut self,
        outcome: &mut EpochOutcome<N>,
        own_clock_s: Option<f64>,
        velocity: Result<&Velocity, VelocityError>,
    ) {
        let Some(settings) = &self.continuity_settings else { return };
        let EpochOutcome { report, update, .. } = outcome;
        if !matches!(report.verdict, Verdict::Alert(_))
            && let Some(contradiction) = self.motion.judge(update.time_s, report, velocity)
        {
            report.verdict = Verdict::Alert(contradiction);
        } else if matches!(report.verdict, Verdict::Protected(_))
            && self.motion.is_refused_for_long(update.time_s)
        {
            report.verdict = Verdict::Unavailable(Unavailable::Recovering);
        }
        if cfg!(feature = "aiding")
            && let Some(height) = &report.height
            && !matches!(report.verdict, Verdict::Alert(_))
        {
            report.verdict = self.height.judge(update.time_s, height, report.verdict);
            if matches!(report.verdict, Verdict::Alert(_)) {
                report.protection = None;
                update.clear();
            }
        }
        let speed_m_s = velocity.ok().map(Velocity::speed_m_s);
        let is_doubted = self.motion.is_doubted();
        report.verdict =
            self.continuity.conclude(settings, update.time_s, own_clock_s, report, speed_m_s, is_doubted);
        match report.verdict {
            Verdict::Alert(Alert::Jump | Alert::Clock | Alert::Track) => {
                report.protection = None;
                update.clear();
            }
            Verdict::Unavailable(Unavailable::Place) => {
                update.clear();
            }
            Verdict::Unavailable(Unavailable::Recovering) => update.clocks = None,
            _ => {}
        }
    }

    /// Leaves out the satellites of systems that were excluded as a whole three times.
    fn keep_out(&self, fix: &mut Fix<'_, T, N>, epoch: &EpochView<'_>) -> KeptOut {
        match self.kept_out.systems() {
            0 => KeptOut::NONE,
            systems => KeptOut::of(fix, epoch, systems, &self.validated.thresholds),
        }
    }

    fn criteria(&self, shared_growth: f32) -> Criteria<'_, T> {
        Criteria {
            requirements: &self.validated.requirements,
            thresholds: self.validated.thresholds,
            factors: &self.validated.factors,
            policy: self.strategy.policy,
            method: self.strategy.method,
            levels: self.strategy.levels,
            ism: &self.ism,
            shared_growth,
        }
    }
}
