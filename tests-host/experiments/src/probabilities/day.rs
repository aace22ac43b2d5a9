//! A day of hazards: the rate at which a protected position has an error above its promise.
//!
//! | word | a protected epoch whose horizontal error is |
//! |---|---|
//! | misleading | larger than its HPL |
//! | hazardous | larger than the alert limit |
//!
//! The level of the papers (`SLOPE`) bounds the effect of a bias on the position. The noise on the
//! position is added to it. With noise the worst bias, if missed, ends beyond the level about every
//! other time. Because position and residuals are independent, the expectation without exclusions
//! is, epoch by epoch,
//!
//! ```text
//! without a fault    P(|x| > HPL)           with the worst    P_md · P(|m + x| > HPL)      |m| = HPL
//! ```
//!
//! and the same with the alert limit instead of the level; `x` is the noise on the position, `m`
//! the effect of the bias. A healthy satellite that is left out instead of the faulty one is not
//! part of it, and is counted separately.

use anyhow::{Context as _, Result};
use nalgebra::{Matrix2, Vector2};
use raim::in_order::Together as _;
use raim::outcomes::{Outcome, Outcomes};
use raim::page::{self, Moment};
use raim::signal::sky::{Satellite, Sight, Site, sights};
use raim_core::epoch::Epoch;
use raim_core::frame::Enu;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::levels::Levels;
use raim_core::monitor::{Monitor, Strategy};
use raim_core::report::{Protected, Report, Verdict};
use raim_core::requirements::Requirements;

use super::disc::beyond;
use super::geometry::{Geometry, Worst, epoch, satellites};
use super::sampling::normal;
use super::{CAPACITY, MASK_DEG};
use crate::draw::generator;

/// Number of epochs that one thread judges in sequence.
const CHUNK: usize = 120;
/// Time between the epochs of a picture, s.
const PICTURED_S: f64 = 60.0;

/// Site, requirements and length of a day.
pub(super) struct Day<'t> {
    pub(super) site: Site,
    pub(super) requirements: Requirements,
    pub(super) thresholds: Thresholds<'t>,
    pub(super) epochs: usize,
    pub(super) step_s: f64,
    /// True if the worst satellite is wrong in every epoch.
    pub(super) is_faulty: bool,
    pub(super) seed: u64,
}

/// Outcomes of the day.
#[derive(Clone, Debug, Default)]
pub(super) struct DayOutcomes {
    /// Protected epochs without exclusions, alerts, and unavailable epochs.
    pub(super) whole: Outcomes,
    /// Protected epochs with exclusions.
    pub(super) reduced: Outcomes,
    /// Smallest and largest level of the day, m.
    pub(super) levels_m: Option<(f64, f64)>,
    /// Expected number of epochs that are protected in spite of the fault.
    pub(super) missed: f64,
    /// Expected number of misleading epochs without exclusions.
    pub(super) misleading: f64,
    /// Expected number of hazardous epochs without exclusions.
    pub(super) hazardous: f64,
    pub(super) moments: Vec<Moment>,
}

impl DayOutcomes {
    fn add(mut self, other: Self) -> Self {
        let widest = |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1));
        self.whole += other.whole;
        self.reduced += other.reduced;
        self.levels_m = match (self.levels_m, other.levels_m) {
            (Some(a), Some(b)) => Some(widest(a, b)),
            (one, other) => one.or(other),
        };
        self.missed += other.missed;
        self.misleading += other.misleading;
        self.hazardous += other.hazardous;
        self.moments.extend(other.moments);
        self
    }
}

/// One epoch of the day.
struct Instant {
    t_s: f64,
    sights: Vec<Sight>,
    geometry: Geometry,
    worst: Worst,
    /// Protection level by dense least squares, m.
    hpl_m: f64,
}

impl Day<'_> {
    /// Judges every epoch.
    pub(super) fn tally(&self) -> Result<DayOutcomes> {
        let satellites = satellites();
        let starts: Vec<usize> = (0..self.epochs).step_by(CHUNK).collect();
        let chunk = |&start: &usize| {
            let mut monitor = Monitor::<f32, CAPACITY>::new(self.requirements)?;
            // The level of the papers, whose misleading epochs theory predicts.
            monitor.set_strategy(Strategy::CLASSIC.with_levels(Levels::Slope))?;
            monitor.disable_continuity();
            let mut tally = DayOutcomes::default();
            for number in start..(start + CHUNK).min(self.epochs) {
                let instant = self.instant(&satellites, number)?;
                self.expect(&instant, &mut tally)?;
                let report = monitor.process(&self.epoch(&instant, number)?);
                self.count(&instant, &report, &mut tally);
            }
            Ok(tally)
        };
        let chunks: Vec<DayOutcomes> = starts.iter().together(chunk).collect::<Result<_>>()?;
        Ok(chunks.into_iter().fold(DayOutcomes::default(), DayOutcomes::add))
    }

    fn instant(&self, satellites: &[Satellite], number: usize) -> Result<Instant> {
        let t_s = number as f64 * self.step_s;
        let sights = sights(satellites, &self.site, t_s, MASK_DEG.to_radians());
        let geometry = Geometry::seen(&sights).context("a redundant sky")?;
        let worst = geometry.worst().context("a testable satellite")?;
        let lambda: f64 = self.thresholds.lambda(geometry.dof()).context("beyond the tables")?;
        Ok(Instant { t_s, sights, geometry, worst, hpl_m: worst.slope_m * lambda.sqrt() })
    }

    /// Returns the ranges for the module.
    fn epoch(&self, instant: &Instant, number: usize) -> Result<Epoch<CAPACITY>> {
        let noise = normal(instant.sights.len(), &mut generator(self.seed, number as u64));
        let bias_m = instant.hpl_m / instant.worst.moved.norm();
        let bias = self.is_faulty.then_some((instant.worst.index, bias_m));
        epoch(instant.t_s, &instant.sights, &instant.geometry.noisy(&noise, bias))
    }

    fn expect(&self, instant: &Instant, tally: &mut DayOutcomes) -> Result<()> {
        let Requirements { hal_m, guard_fraction, missed_detection, .. } = self.requirements;
        if instant.hpl_m >= guard_fraction * hal_m {
            return Ok(());
        }
        let covariance_m2: Matrix2<f64> =
            instant.geometry.dense.covariance_m2.fixed_view::<2, 2>(0, 0).into_owned();
        let (passed, moved_m) = if self.is_faulty {
            let direction = instant.worst.moved.try_normalize(0.0).context("a direction")?;
            (missed_detection.get(), direction * instant.hpl_m)
        } else {
            (1.0, Vector2::zeros())
        };
        tally.missed += passed;
        tally.misleading += passed * beyond(instant.hpl_m, moved_m, covariance_m2);
        tally.hazardous += passed * beyond(hal_m, moved_m, covariance_m2);
        Ok(())
    }

    fn count(&self, instant: &Instant, report: &Report<CAPACITY>, tally: &mut DayOutcomes) {
        let error = report
            .solution
            .as_ref()
            .map(|solution| self.site.frame.rotate(solution.position - self.site.position));
        let error_m = error.map_or(f64::NAN, Enu::horizontal);
        let level_m = report.protection.map_or(f64::NAN, |protection| protection.hpl_m);
        let is_protected = matches!(report.verdict, Verdict::Protected(_));
        let is_misleading = error_m > level_m;
        let promised = Outcome::Promised { is_misleading, is_hazardous: error_m > self.requirements.hal_m };
        match report.verdict {
            Verdict::Protected(Protected::Ok) => tally.whole.add(promised),
            Verdict::Protected(_) => tally.reduced.add(promised),
            Verdict::Alert(_) => tally.whole.add(Outcome::Alert),
            Verdict::Unavailable(_) => tally.whole.add(Outcome::Unavailable),
        }
        let (low_m, high_m) = tally.levels_m.unwrap_or((f64::INFINITY, 0.0));
        tally.levels_m = Some((low_m.min(instant.hpl_m), high_m.max(instant.hpl_m)));
        if instant.t_s % PICTURED_S == 0.0 || (is_protected && is_misleading) {
            tally.moments.push(self.moment(instant.t_s, report, error));
        }
    }

    fn moment(&self, time_s: f64, report: &Report<CAPACITY>, error: Option<Enu>) -> Moment {
        let verdict = match report.verdict {
            Verdict::Protected(_) => page::Verdict::Protected,
            Verdict::Alert(_) => page::Verdict::Alert,
            Verdict::Unavailable(_) => page::Verdict::Unavailable,
        };
        Moment {
            time_s,
            verdict,
            reason: String::new(),
            statistic: report.test.map(|test| test.statistic),
            threshold: report.test.map(|test| test.threshold),
            hpl_m: report.protection.map(|protection| protection.hpl_m),
            vpl_m: report.protection.map(|protection| protection.vpl_m),
            hal_m: Some(self.requirements.hal_m),
            val_m: None,
            horizontal_error_m: error.map(Enu::horizontal),
            vertical_error_m: error.map(|error| error.up),
            pin_is_high: None,
            used: report.used.len(),
            excluded: report.excluded.iter().map(|suspect| suspect.satellite).collect(),
        }
    }
}
