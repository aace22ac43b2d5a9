//! The pipeline: one epoch in, one report out, and the little that is remembered between epochs.
//!
//! ```text
//! epoch ─► (clock aiding) ─► fix ─► snapshot ─► detection ─► identification ─► protection ─► report
//! ```
//!
//! A [`Strategy`] says which threshold detects and how the faulty satellite is found. Every policy's threshold is at or
//! above `τ1`, so the search, whose every step is held against `τ1`, ends with a set that passes under any policy;
//! protection levels are those of the threshold in use.
//!
//! Remembered are the last position, as the start of the next fix; a window of SSE/dof, which says whether the
//! sigmas are right; and, with clock aiding, the receiver clocks of the epochs that passed.
//!
//! References: [Yang2015] §1 for the order of the decisions, [Lin2016] §2 for detection and identification.

use core::fmt;

use heapless::{Deque, Vec};

use crate::bounded::gather;
use crate::clock::Clocks;
use crate::detection::{Detection, detect};
use crate::epoch::{Aided, Aiding, Epoch};
use crate::fix::{Fix, FixError};
use crate::frame::{Ecef, LocalFrame};
use crate::identification::baarda::{self, Excluded, Exclusion, Identification, Outcome, Reducible as _};
use crate::identification::parity;
use crate::identification::ransac::{self, MAX_WORK, Selection};
use crate::linear::LinearEpoch;
use crate::protection::largest_slopes;
use crate::real::Real;
use crate::report::{
    Alert, MAX_EXCLUDED, Protected, ProtectionLevels, Report, Solution, Suspect, Unavailable, Verdict,
};
use crate::requirements::{Requirements, RequirementsError};
use crate::satellite::{Constellation, SatelliteId};
use crate::snapshot::{Snapshot, SnapshotError};
use crate::threshold::policy::{Demand, Policy, Refusal};
use crate::threshold::{ThresholdError, Thresholds};

/// Epochs over which SSE/dof is averaged: with 10 degrees of freedom the mean is then known to 6 %.
pub const SIGMA_CHECK_WINDOW: usize = 60;

/// Why a monitor cannot be made.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MonitorError {
    /// A requirement is out of its range.
    Requirements(RequirementsError),
    /// A probability is not among the committed tables.
    Threshold(ThresholdError),
}

impl fmt::Display for MonitorError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Requirements(error) => error.fmt(formatter),
            Self::Threshold(error) => error.fmt(formatter),
        }
    }
}

impl core::error::Error for MonitorError {}

/// How the faulty satellites are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Method {
    /// The largest w-test, again and again.
    Baarda,
    /// In parity space.
    Parity(parity::Method),
    /// By consensus of disjoint subsets.
    Ransac,
}

/// How integrity is monitored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Strategy {
    /// Which threshold the global test uses.
    pub policy: Policy,
    /// How the faulty satellites are found.
    pub method: Method,
    /// Whether the predicted receiver clock takes a row beside the satellites.
    pub clock_aid: bool,
}

impl Strategy {
    /// The classic threshold, sequential exclusion, no aiding.
    pub const CLASSIC: Self = Self { policy: Policy::T1, method: Method::Baarda, clock_aid: false };
}

/// Watches over the positions of one receiver, at most `N` satellites at a time.
#[derive(Clone, Debug)]
pub struct Monitor<T: Real, const N: usize> {
    requirements: Requirements,
    strategy: Strategy,
    thresholds: Thresholds<'static>,
    clocks: Clocks<T>,
    subsets: Option<Subsets<N>>,
    start: Ecef,
    ratios: Deque<f32, SIGMA_CHECK_WINDOW>,
}

impl<T: Real, const N: usize> Monitor<T, N> {
    /// A monitor that knows no position yet.
    ///
    /// # Errors
    /// [`MonitorError`] names the requirement that cannot be met.
    pub fn new(requirements: Requirements) -> Result<Self, MonitorError> {
        let (requirements, thresholds) = accept(requirements)?;
        Ok(Self {
            requirements,
            strategy: Strategy::CLASSIC,
            thresholds,
            clocks: Clocks::new(),
            subsets: None,
            start: Ecef::CENTRE,
            ratios: Deque::new(),
        })
    }

    /// Replaces the requirements; what is remembered stays.
    ///
    /// # Errors
    /// As [`Self::new`]; nothing has changed then.
    pub fn require(&mut self, requirements: Requirements) -> Result<(), MonitorError> {
        (self.requirements, self.thresholds) = accept(requirements)?;
        Ok(())
    }

    /// Replaces the strategy; a change of clock aiding forgets the clocks.
    pub fn pursue(&mut self, strategy: Strategy) {
        if strategy.clock_aid != self.strategy.clock_aid {
            self.clocks.restart();
        }
        self.strategy = strategy;
    }

    /// What is required.
    pub fn requirements(&self) -> &Requirements {
        &self.requirements
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

    /// Judges one epoch; with clock aiding, with the forecast of a receiver clock beside it.
    pub fn process(&mut self, epoch: &Epoch<N>) -> Report<N> {
        let forecast = self.clocks.aiding(epoch).filter(|_| self.strategy.clock_aid);
        let mut room = Snapshot::unsolved();
        let mut report = match Fix::about(&mut room, Aided::by(epoch, forecast), self.start) {
            Ok(fix) => self.judge(fix, epoch),
            Err(error) => without_position(error, epoch),
        };
        // A position that must not be used is no start either.
        let usable = !matches!(report.verdict, Verdict::Alert(_));
        if let Some(solution) = report.solution.as_ref().filter(|_| usable) {
            self.start = solution.position;
        }
        report.sigma_check = self.sigma_check();
        report
    }

    fn judge(&mut self, mut fix: Fix<'_, T, N>, epoch: &Epoch<N>) -> Report<N> {
        let mut test = self.test(fix.snapshot());
        let mut exclusion = Exclusion { rows: Vec::new(), outcome: Outcome::Passed };
        if test.as_ref().is_ok_and(|test| test.detection.fault()) {
            exclusion = self.isolate(&mut fix, epoch);
            test = self.test(fix.snapshot());
        }
        let excluded = suspects(&exclusion, &fix, epoch);
        let separable = baarda::separable(&mut fix, &exclusion, &self.thresholds);

        let verdict = match (exclusion.outcome, &test) {
            (Outcome::NotIsolated(Identification::Ambiguous), _) => Verdict::Alert(Alert::Ambiguous),
            (Outcome::NotIsolated(Identification::Budget), _) => Verdict::Unavailable(Unavailable::Budget),
            (Outcome::NotIsolated(_), _) => Verdict::Alert(Alert::Fault),
            (_, Err(reason)) => Verdict::Unavailable(*reason),
            (Outcome::Isolated, Ok(_)) if !separable => Verdict::Alert(Alert::Ambiguous),
            (Outcome::Isolated, Ok(test)) if !excluded.is_empty() => self.bounded(Protected::Excluded, test),
            // Nothing was left out, or a forecast whose clock has jumped: no satellite's fault.
            (Outcome::Isolated | Outcome::Passed, Ok(test)) => self.bounded(Protected::Ok, test),
        };
        let test = test.ok();
        // Under a policy above T1 a search can fail although what it left passes: that is no epoch to learn from.
        let isolated = !matches!(exclusion.outcome, Outcome::NotIsolated(_));
        if let Some(test) = test.as_ref().filter(|test| isolated && !test.detection.fault()) {
            self.remember(&test.detection);
            if separable && self.strategy.clock_aid {
                self.clocks.learn(epoch.time_s(), fix.snapshot());
            }
        }
        describe(&fix, epoch, verdict, test.as_ref(), excluded)
    }

    /// Looks for what is wrong and leaves it out: a forecast whose clock has jumped, else the faulty satellites.
    ///
    /// Not inlined, nor are the ways it branches into: what one search needs of the stack would else be taken by every
    /// epoch, and beside what the others need.
    #[inline(never)]
    fn isolate(&mut self, fix: &mut Fix<'_, T, N>, epoch: &Epoch<N>) -> Exclusion<T> {
        if let Some(jump) = self.jump(fix, epoch) {
            return jump;
        }
        match self.strategy.method {
            Method::Parity(method) => {
                parity::exclude(method, fix, &self.thresholds, &parity::Limits::published())
            }
            Method::Ransac => self.isolate_by_consensus(fix, epoch),
            Method::Baarda => baarda::exclude_sequentially(fix, &self.thresholds),
        }
    }

    /// The exclusion of the forecast alone, where that explains everything and no satellite does nearly as well.
    ///
    /// Asked before any method is: a jump of a millisecond shows in every satellite's test, and methods that leave out
    /// whoever correlates with the worst would leave out healthy ones with it.
    fn jump(&self, fix: &mut Fix<'_, T, N>, epoch: &Epoch<N>) -> Option<Exclusion<T>> {
        let is_clock = |aiding: &Aiding| matches!(aiding, Aiding::Clock { .. });
        let index = epoch.observations().len() + fix.aided().aiding().position(is_clock)?;
        let (_, fit) = fix.snapshot().row(index)?;
        let forecast = Excluded { index, w_test: baarda::w_test(fit) };
        fix.leave_out(index).ok()?;
        let jump = Exclusion { rows: gather([forecast]), outcome: Outcome::Isolated };
        let passes = detect(fix.snapshot(), &self.thresholds).is_some_and(|detection| !detection.fault());
        if passes && baarda::separable(fix, &jump, &self.thresholds) {
            return Some(jump);
        }
        // What was there a moment ago determines a position.
        let _ = fix.take_back(index);
        None
    }

    fn isolate_by_consensus(&mut self, fix: &mut Fix<'_, T, N>, epoch: &Epoch<N>) -> Exclusion<T> {
        // The tables hold both of its probabilities; without them it falls back as without consensus.
        let Ok(limits) = ransac::Limits::published() else {
            return baarda::exclude_sequentially(fix, &self.thresholds);
        };
        let equations = fix.snapshot().epoch();
        let kept = self.subsets.take().filter(|subsets| subsets.are_of(epoch, equations.rows().len()));
        let subsets = self.subsets.insert(kept.unwrap_or_else(|| Subsets::of(epoch, equations)));
        ransac::exclude(fix, &subsets.selection, &self.thresholds, &limits)
    }

    /// The global test of a snapshot under the policy, and the protection levels that go with its threshold.
    fn test(&self, snapshot: &Snapshot<T, N>) -> Result<Test<T>, Unavailable> {
        let slopes = largest_slopes(snapshot);
        let demand = Demand::new(snapshot.dof(), slopes, &self.requirements, self.thresholds);
        let threshold = demand.threshold::<T>(self.strategy.policy).map_err(|refusal| match refusal {
            Refusal::Redundancy => Unavailable::Redundancy,
            Refusal::Risk => Unavailable::Risk,
        })?;
        let detection =
            Detection { sse: snapshot.sse(), threshold: T::narrow(threshold.tau), dof: snapshot.dof() };
        Ok(Test { detection, protection: slopes.protect(threshold.lambda) })
    }

    /// The verdict on a set of satellites that agree: are their protection levels within the limits?
    ///
    /// A policy other than `T1` has decided that already, and fills its share of the limit on purpose.
    fn bounded(&self, reason: Protected, test: &Test<T>) -> Verdict {
        let ProtectionLevels { hpl_m, vpl_m } = test.protection;
        let fraction = self.requirements.guard_fraction;
        let decided = self.strategy.policy != Policy::T1;
        // Written so that a level which is not a number is not within a limit.
        let within = |level_m: f64, limit_m: f64| decided || level_m < fraction * limit_m;
        if !hpl_m.is_finite() || (self.requirements.val_m.is_some() && !vpl_m.is_finite()) {
            Verdict::Unavailable(Unavailable::Geometry)
        } else if !within(hpl_m, self.requirements.hal_m) {
            Verdict::Unavailable(Unavailable::Hpl)
        } else if !self.requirements.val_m.is_none_or(|val_m| within(vpl_m, val_m)) {
            Verdict::Unavailable(Unavailable::Vpl)
        } else {
            Verdict::Protected(reason)
        }
    }

    /// Keeps SSE/dof of an epoch that passed: a detected fault says nothing about sigma.
    fn remember(&mut self, detection: &Detection<T>) {
        if self.ratios.is_full() {
            self.ratios.pop_front();
        }
        let ratio = detection.sse.widen() / detection.dof as f64;
        let _ = self.ratios.push_back(ratio as f32);
    }

    /// Mean of SSE/dof over the last [`SIGMA_CHECK_WINDOW`] tested epochs: about 1 where the sigmas are right.
    fn sigma_check(&self) -> Option<f64> {
        if self.ratios.is_empty() {
            return None;
        }
        let sum: f32 = self.ratios.iter().sum();
        Some(f64::from(sum) / self.ratios.len() as f64)
    }
}

/// Disjoint subsets of an epoch's satellites, kept while these stay the same.
#[derive(Clone, Debug)]
struct Subsets<const N: usize> {
    satellites: Vec<SatelliteId, N>,
    selection: Selection<N>,
}

impl<const N: usize> Subsets<N> {
    #[inline(never)]
    fn of<T: Real>(epoch: &Epoch<N>, equations: &LinearEpoch<T, N>) -> Self {
        let satellites = gather(epoch.observations().iter().map(|observation| observation.satellite));
        Self { satellites, selection: Selection::choose(equations, MAX_WORK) }
    }

    fn are_of(&self, epoch: &Epoch<N>, rows: usize) -> bool {
        self.selection.rows() == rows
            && self
                .satellites
                .iter()
                .eq(epoch.observations().iter().map(|observation| &observation.satellite))
    }
}

/// The global test of a snapshot, and what an undetected fault can do under its threshold.
#[derive(Clone, Copy, Debug)]
struct Test<T> {
    detection: Detection<T>,
    protection: ProtectionLevels,
}

fn accept(requirements: Requirements) -> Result<(Requirements, Thresholds<'static>), MonitorError> {
    let requirements = requirements.validate().map_err(MonitorError::Requirements)?;
    let thresholds = Thresholds::from_tables(requirements.false_alarm, requirements.missed_detection)
        .map_err(MonitorError::Threshold)?;
    Ok((requirements, thresholds))
}

/// The excluded satellites with the biases that the final solution shows.
///
/// A left-out row's residual is that of a prediction: it is the bias. An aiding row that was left out names no
/// satellite and is not listed.
fn suspects<T: Real, const N: usize>(
    exclusion: &Exclusion<T>,
    fix: &Fix<'_, T, N>,
    epoch: &Epoch<N>,
) -> Vec<Suspect, MAX_EXCLUDED> {
    let listed = exclusion.rows.iter().filter_map(|excluded| {
        let observation = epoch.observations().get(excluded.index)?;
        let (row, fit) = fix.snapshot().row(excluded.index)?;
        let predicted_m2 = fit.centred.dot(&fit.gain).widen();
        Some(Suspect {
            satellite: observation.satellite,
            w_test: excluded.w_test.widen(),
            bias_m: fit.residual.widen(),
            bias_sigma_m: libm::sqrt(row.sigma.widen() * row.sigma.widen() + predicted_m2.max(0.0)),
        })
    });
    gather(listed)
}

/// The report on a position: the verdict, and what is known about the satellites.
///
/// Not inlined: so it is made where the caller wants it, and not moved there.
#[inline(never)]
fn describe<T: Real, const N: usize>(
    fix: &Fix<'_, T, N>,
    epoch: &Epoch<N>,
    verdict: Verdict,
    test: Option<&Test<T>>,
    excluded: Vec<Suspect, MAX_EXCLUDED>,
) -> Report<N> {
    let used = fix.snapshot().rows().zip(epoch.observations()).filter(|((row, _), _)| row.weight > T::zero());
    let mut satellites = Vec::new();
    let mut squares = T::zero();
    for ((_, fit), observation) in used {
        // Both hold N: never full here.
        let _ = satellites.push(observation.satellite);
        squares += fit.residual * fit.residual;
    }
    Report {
        verdict,
        solution: Some(solution(fix)),
        test: test.map(|test| test.detection.statistic()),
        protection: test.map(|test| test.protection),
        excluded,
        suspect: test.and_then(|_| suspect(fix.snapshot(), epoch)),
        residual_rms_m: libm::sqrt(squares.widen() / satellites.len().max(1) as f64),
        used: satellites,
        tracked: epoch.observations().len() as u8,
        sigma_check: None,
    }
}

fn suspect<T: Real, const N: usize>(snapshot: &Snapshot<T, N>, epoch: &Epoch<N>) -> Option<Suspect> {
    let (index, _, _) = baarda::worst_two(snapshot)?;
    let observation = epoch.observations().get(index)?;
    let (row, fit) = snapshot.row(index)?;
    if fit.redundancy < T::UNTESTABLE {
        return None;
    }
    Some(Suspect {
        satellite: observation.satellite,
        w_test: baarda::w_test(fit).widen(),
        bias_m: (fit.residual / fit.redundancy).widen(),
        bias_sigma_m: (row.sigma / fit.redundancy.sqrt()).widen(),
    })
}

fn solution<T: Real, const N: usize>(fix: &Fix<'_, T, N>) -> Solution {
    let snapshot = fix.snapshot();
    let position = fix.position();
    let covariance = snapshot.covariance();
    let (hdop, vdop) = snapshot.dilutions();
    let element =
        |row: usize, column: usize| covariance.get((row, column)).map_or(0.0, |value| value.widen());
    Solution {
        position,
        geodetic: LocalFrame::at(position).geodetic(),
        covariance_m2: [
            element(0, 0),
            element(0, 1),
            element(0, 2),
            element(1, 1),
            element(1, 2),
            element(2, 2),
        ],
        clocks_m: Constellation::ALL.map(|constellation| snapshot.clock_m(constellation)),
        hdop: hdop.widen(),
        vdop: vdop.widen(),
    }
}

fn without_position<const N: usize>(error: FixError, epoch: &Epoch<N>) -> Report<N> {
    let reason = match error {
        FixError::Snapshot(SnapshotError::Singular) => Unavailable::Geometry,
        FixError::Snapshot(SnapshotError::Insufficient) | FixError::NotConverged => Unavailable::NoFix,
    };
    Report {
        verdict: Verdict::Unavailable(reason),
        solution: None,
        test: None,
        protection: None,
        excluded: Vec::new(),
        suspect: None,
        used: Vec::new(),
        residual_rms_m: 0.0,
        tracked: epoch.observations().len() as u8,
        sigma_check: None,
    }
}
