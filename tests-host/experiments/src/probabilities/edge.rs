//! Detection and exclusion at the edge of availability, over geometries of the whole globe.
//!
//! The tests of [DO-229] and DO-316 that run off line ask for geometries at which the function is
//! just available, because there a missed fault moves the position farthest relative to the limit.
//! Here every geometry is at its edge, because its alert limit is what its own level just meets:
//!
//! ```text
//! detection   HAL = 1.02 HPL                                exclusion   HAL = 1.02 HEL
//! ```
//!
//! | row | event | requirement |
//! |---|---|---|
//! | false detection | no fault, and the test exceeds its threshold | `P_fa` |
//! | false alert | no fault, and no position is promised | `P_fa` |
//! | missed alert | a fault, the error exceeds HAL, and the position is promised | `P_md` |
//! | wrong exclusion | the same, and only healthy satellites are excluded | `P_md`, with the others |
//! | failed exclusion | a fault that moves the position by HAL or more, and nothing is promised ([`exclusion`](super::exclusion)) | `P_fe` |
//!
//! The fault is a bias on the satellite with the largest horizontal slope. For exclusions it is on
//! the satellite that is hardest to exclude. Rare events are drawn by
//! importance sampling. Half of the draws are shifted so that about half of the faults are missed.
//! The weight is the ratio of the densities, so it is at most 2:
//!
//! ```text
//! w = 2 / (1 + exp(−δ u·z − δ²/2))        δ = max(b v − √max(τ1 − ν, 0), 0)
//! ```
//!
//! The symbols are those of [`sampling`](super::sampling). The mean over all geometries must be
//! within the requirement. [`worst`](super::worst) adds the largest risk of any single geometry in
//! closed form.
//!
//! [DO-229]: raim_core#references

use anyhow::{Context as _, Result, ensure};
use indicatif::ProgressBar;
use nalgebra::DVector;
use raim::in_order::Together as _;
use raim::signal::sky::Site;
use raim_core::epoch::Epoch;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::levels::Levels;
use raim_core::monitor::{Monitor, MonitorMemory, Search, Strategy};
use raim_core::report::{Protected, Report, Verdict};
use raim_core::requirements::Requirements;
use rand::RngExt as _;
use rand::rngs::ChaCha8Rng;

use super::exclusion::{FAILED_EXCLUSION, Failures, HardestExclusion};
use super::geometry::{Worst, epoch};
use super::sampling::{Alarming, alarming, normal};
use super::skies::{Scene, scene};
use super::{CAPACITY, exclusion, worst};
use crate::draw::generator;
use crate::{Effort, Experiment, Finding, Interval, Judgement, Outcome, Row, Section};

/// Entry for the command line.
pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "fde",
    about: "missed and false alerts, failed and wrong exclusions at the edge of availability",
    run,
};

/// Ratio of an alert limit to its level, so that the noise of an epoch does not move the level
/// beyond it.
pub(super) const ABOVE: f64 = 1.02;

/// Sizes of the bias, as multiples of the one that corresponds to `√λ`.
const SIZES: [f64; 8] = [0.5, 0.65, 0.8, 1.0, 1.25, 1.5, 2.0, 4.0];

/// Numbers of satellites of a geometry, by the number of constellations less one.
const COUNTS: [&[usize]; 2] = [&[6, 7, 8, 9, 10, 11], &[8, 10, 12, 14, 16]];

/// Number of events from which the sample's deviation bounds the mean.
const FEW: usize = 10;

/// Seed of all random choices.
const SEED: u64 = 9000;

/// Number of rates that must hold together.
const FAMILY: usize = 2 + 2 * SIZES.len() + exclusion::RATES;

fn run(effort: Effort, bar: &ProgressBar) -> Result<Outcome> {
    let count = effort.pick(500, 100_000);
    bar.set_length(count);
    let requirements = Requirements::non_precision_approach();
    let thresholds = Thresholds::from_tables(requirements.false_alarm, requirements.missed_detection)?;
    let judged = |number: u64| {
        let counts = Edge::drawn(number)?.map(|edge| edge.judged(&thresholds, number)).transpose();
        bar.inc(1);
        counts
    };
    let counts: Vec<Counts> =
        (0..count).together(judged).filter_map(Result::transpose).collect::<Result<_>>()?;
    ensure!(!counts.is_empty(), "no geometry has a level within the limit");
    Ok(Outcome {
        name: EXPERIMENT.name,
        title: "Detection and exclusion at the edge of availability".into(),
        setup: format!(
            "{} geometries (of {count} drawn, those with a level within 556 m): places uniform over the globe, \
             instants of a day, 6 to 16 satellites of one or two constellations chosen at random; sigma 1.5 m / sin of \
             the elevation; method AUTO with BOUND; the alert limit of each geometry is 1.02 times its own level. \
             Faults are on the satellite with the largest horizontal slope, and for exclusions on the one that is hardest \
             to exclude. P_fa {:e}, P_md {:e}, P_fe \
             {FAILED_EXCLUSION:e}. Held: no interval lies above 1, {FAMILY} intervals together at 95 % (Bonferroni).",
            counts.len(),
            requirements.false_alarm.get(),
            requirements.missed_detection.get()
        ),
        sections: sections(&counts, &requirements),
        pictures: vec![],
    })
}

/// A geometry at its edge of availability.
struct Edge {
    site: Site,
    scene: Scene,
    worst: Worst,
    requirements: Requirements,
    /// The hardest exclusion; `None` if its level is beyond the limit of the approach.
    exclusion: Option<HardestExclusion>,
}

/// Weights of one geometry.
#[derive(Clone, Debug)]
struct Counts {
    false_detection: f64,
    false_alert: f64,
    /// Largest weight of any noise that alarms.
    heaviest: f64,
    missed: [f64; SIZES.len()],
    wrong: [f64; SIZES.len()],
    /// Failed exclusions; `None` if exclusion is not available.
    failed: Option<Failures>,
    /// Largest risk over every size of the fault in closed form, over `P_md`.
    closed_form: f64,
}

impl Edge {
    /// Draws a geometry; returns `None` if the sky has too few satellites or its level is beyond
    /// the limit of a non-precision approach.
    fn drawn(number: u64) -> Result<Option<Self>> {
        let Some((site, scene)) = sky(number) else { return Ok(None) };
        let Some(worst) = scene.geometry.worst() else { return Ok(None) };
        let approach = Requirements::non_precision_approach().with_guard_fraction(1.0);
        let level_m = level_m(&approach, &site, &scene)?;
        let Some(hal_m) = level_m.map(|level_m| level_m * ABOVE).filter(|&hal_m| hal_m < approach.hal_m)
        else {
            return Ok(None);
        };
        let exclusion = HardestExclusion::of(&scene.geometry, &approach)?
            .filter(|exclusion| exclusion.level_m * ABOVE < approach.hal_m);
        let requirements = approach.with_hal_m(hal_m);
        Ok(Some(Self { site, scene, worst, requirements, exclusion }))
    }

    /// Judges draws of every kind.
    fn judged(&self, thresholds: &Thresholds<'_>, number: u64) -> Result<Counts> {
        let mut chance = generator(SEED + 1, number);
        let mut judge = Judge::new(self)?;
        let (false_detection, false_alert, heaviest) = judge.without_fault(thresholds, &mut chance)?;
        let mut counts = Counts {
            false_detection,
            false_alert,
            heaviest,
            missed: [0.0; SIZES.len()],
            wrong: [0.0; SIZES.len()],
            failed: None,
            closed_form: worst::horizontal_risk(&self.scene.geometry, thresholds)?,
        };
        for (size, (missed, wrong)) in SIZES.iter().zip(counts.missed.iter_mut().zip(&mut counts.wrong)) {
            (*missed, *wrong) = judge.with_fault(thresholds, *size, &mut chance)?;
        }
        if let Some(exclusion) = &self.exclusion {
            counts.failed = Some(judge.failed_exclusions(exclusion, &mut chance)?);
        }
        Ok(counts)
    }

    fn bias_m(&self, thresholds: &Thresholds<'_>, size: f64) -> Result<f64> {
        let Scene { geometry, .. } = &self.scene;
        let lambda: f64 = thresholds.lambda(geometry.dof()).context("beyond the tables")?;
        Ok(size * lambda.sqrt() / geometry.visibility(self.worst.index))
    }
}

/// Draws a place on the globe and the satellites in view of it; `None` if they are too few.
pub(super) fn sky(number: u64) -> Option<(Site, Scene)> {
    let mut chance = generator(SEED, number);
    let latitude_deg = chance.random_range(-1.0_f64..1.0).asin().to_degrees();
    let site = Site::geodetic(latitude_deg, chance.random_range(-180.0..180.0), 0.0);
    let constellations = 1 + (number % COUNTS.len() as u64) as usize;
    let counts = COUNTS[constellations - 1];
    let count = counts[chance.random_range(0..counts.len())];
    Some((site, scene(&site, constellations, count, number)?))
}

/// A geometry with a monitor, which judges each epoch independently.
struct Judge<'e> {
    edge: &'e Edge,
    monitor: Monitor<f32, CAPACITY>,
    memory: Box<MonitorMemory<f32, CAPACITY>>,
}

impl<'e> Judge<'e> {
    fn new(edge: &'e Edge) -> Result<Self> {
        Ok(Self { edge, monitor: monitor(edge.requirements)?, memory: Box::new(MonitorMemory::new()) })
    }

    /// Judges ranges with this noise and bias; returns the report and the horizontal error.
    fn report(
        &mut self,
        noise: &DVector<f64>,
        bias: Option<(usize, f64)>,
    ) -> Result<(&Report<CAPACITY>, f64)> {
        let Edge { site, scene, .. } = self.edge;
        let epoch = epoch(0.0, &scene.sights, &scene.geometry.noisy(noise, bias))?;
        let report = &self.monitor.judge(&epoch, site.position, Search::Anew, None, &mut self.memory).report;
        let error_m = report
            .solution
            .as_ref()
            .map_or(f64::NAN, |solution| site.frame.rotate(solution.position - site.position).horizontal());
        Ok((report, error_m))
    }

    /// Returns the weights of a false detection and of a false alert, and the largest possible one.
    fn without_fault(
        &mut self,
        thresholds: &Thresholds<'_>,
        chance: &mut ChaCha8Rng,
    ) -> Result<(f64, f64, f64)> {
        let Alarming { noise, weight, heaviest } = alarming(&self.edge.scene.geometry, thresholds, chance)?;
        let verdict = self.report(&noise, None)?.0.verdict;
        let weigh = |happened: bool| if happened { weight } else { 0.0 };
        let is_promised = matches!(verdict, Verdict::Protected(_));
        Ok((weigh(verdict != Verdict::Protected(Protected::Ok)), weigh(!is_promised), heaviest))
    }

    /// Returns the weights of a missed alert and of a wrong exclusion under a bias.
    fn with_fault(
        &mut self,
        thresholds: &Thresholds<'_>,
        size: f64,
        chance: &mut ChaCha8Rng,
    ) -> Result<(f64, f64)> {
        let Edge { scene: Scene { geometry, sights }, worst, requirements, .. } = self.edge;
        let bias_m = self.edge.bias_m(thresholds, size)?;
        let tau: f64 = thresholds.tau1(geometry.dof()).context("beyond the tables")?;
        let boundary = (tau - geometry.dof() as f64).max(0.0).sqrt();
        let shift = (bias_m * geometry.visibility(worst.index) - boundary).max(0.0);
        let signature = geometry.signature(worst.index);
        let mut noise = normal(geometry.rows.len(), chance);
        if chance.random_bool(0.5) {
            noise -= &signature * shift;
        }
        let weight = 2.0 / (1.0 + (-shift * signature.dot(&noise) - shift * shift / 2.0).exp());
        let faulty = sights[worst.index].satellite;
        let (report, error_m) = self.report(&noise, Some((worst.index, bias_m)))?;
        let is_missed = matches!(report.verdict, Verdict::Protected(_)) && error_m > requirements.hal_m;
        let is_wrong = is_missed
            && !report.excluded.is_empty()
            && report.excluded.iter().all(|suspect| suspect.satellite != faulty);
        let weigh = |happened: bool| if happened { weight } else { 0.0 };
        Ok((weigh(is_missed), weigh(is_wrong)))
    }

    /// Judges faults of each size, within 1.02 times the exclusion level.
    fn failed_exclusions(
        &mut self,
        exclusion: &HardestExclusion,
        chance: &mut ChaCha8Rng,
    ) -> Result<Failures> {
        let Edge { scene, requirements, .. } = self.edge;
        let hal_m = requirements.hal_m.max(exclusion.level_m * ABOVE);
        self.monitor = monitor(requirements.with_hal_m(hal_m))?;
        exclusion.failures(hal_m, |bias_m| {
            let noise = normal(scene.sights.len(), chance);
            let verdict = self.report(&noise, Some((exclusion.index, bias_m)))?.0.verdict;
            Ok(!matches!(verdict, Verdict::Protected(_)))
        })
    }
}

fn monitor(requirements: Requirements) -> Result<Monitor<f32, CAPACITY>> {
    let mut monitor = Monitor::new(requirements)?;
    monitor.set_strategy(Strategy::DEFAULT.with_levels(Levels::Bound))?;
    monitor.disable_continuity();
    Ok(monitor)
}

/// Returns the horizontal level of the satellites in view without noise, m.
fn level_m(requirements: &Requirements, site: &Site, scene: &Scene) -> Result<Option<f64>> {
    let epoch: Epoch<CAPACITY> = epoch(0.0, &scene.sights, &scene.geometry.rows)?;
    let mut memory = Box::new(MonitorMemory::new());
    let monitor = monitor(*requirements)?;
    let report = &monitor.judge(&epoch, site.position, Search::Anew, None, &mut memory).report;
    Ok(report.protection.map(|levels| levels.hpl_m))
}

fn sections(counts: &[Counts], requirements: &Requirements) -> Vec<Section> {
    let P { alarm, missed } = P::of(requirements);
    let column = |of: &dyn Fn(&Counts) -> f64| counts.iter().map(of).collect::<Vec<f64>>();
    let heaviest = counts.iter().map(|counts| counts.heaviest).fold(0.0, f64::max);
    let mut rows = vec![
        rate(
            "false detection, over P_fa",
            &column(&|counts| counts.false_detection),
            (alarm, heaviest),
            FAMILY,
        ),
        rate("false alert, over P_fa", &column(&|counts| counts.false_alert), (alarm, heaviest), FAMILY),
    ];
    for (index, size) in SIZES.iter().enumerate() {
        let what = |event: &str| format!("{event}, bias {size} of the one behind √λ, over P_md");
        rows.push(rate(
            &what("missed alert"),
            &column(&|counts| counts.missed[index]),
            (missed, 2.0),
            FAMILY,
        ));
        rows.push(rate(
            &what("of these wrong exclusion"),
            &column(&|counts| counts.wrong[index]),
            (missed, 2.0),
            FAMILY,
        ));
    }
    let closed_form = counts.iter().map(|counts| counts.closed_form).fold(0.0, f64::max);
    rows.push(
        Row::new(
            "largest risk of any geometry and size in closed form, over P_md",
            "",
            Finding::exact(closed_form, 3),
            Judgement::Ours,
        )
        .holding("at most 1", closed_form <= 1.0),
    );
    vec![
        Section { title: "Detection: the limit is what the level just meets".into(), rows },
        Section {
            title: "Exclusion: the limit is what the exclusion level just meets".into(),
            rows: exclusion::rows(&counts.iter().map(|counts| counts.failed).collect::<Vec<_>>(), FAMILY),
        },
    ]
}

/// Required probabilities.
struct P {
    alarm: f64,
    missed: f64,
}

impl P {
    fn of(requirements: &Requirements) -> Self {
        Self { alarm: requirements.false_alarm.get(), missed: requirements.missed_detection.get() }
    }
}

/// Returns a row with the mean weight over the requirement. With fewer than [`FEW`] events the
/// upper end is at least as large as if every expected event had the largest weight, because the
/// deviation of so few shows nothing.
pub(super) fn rate(what: &str, weights: &[f64], (asked, heaviest): (f64, f64), family: usize) -> Row {
    let relative: Vec<f64> = weights.iter().map(|weight| weight / asked).collect();
    let value = relative.iter().sum::<f64>() / relative.len() as f64;
    let hits = weights.iter().filter(|&&weight| weight > 0.0).count();
    let sampled = Interval::of_mean(&relative);
    let at_most = Interval::of_count(hits).high * heaviest / asked / relative.len() as f64;
    let high = if hits < FEW { sampled.high.max(at_most) } else { sampled.high };
    let interval = Interval { low: sampled.low.max(0.0), high };
    Row::new(what, "", Finding::Number { value, decimals: 3, interval: Some(interval) }, Judgement::Ours)
        .because(format!("{hits} of {} draws", weights.len()))
        .holding("interval not above 1", sampled.as_one_in(family).low <= 1.0)
}
