//! False alarms at the edge of availability, by every setting of the receiver's noise.
//!
//! The geometries are those of [`edge`](super::edge), and so are the draws. The noise has the
//! variance that the setting states:
//!
//! ```text
//! y = κ^(1/2) σ z        κ = 1 GEODETIC, 12.5 CONSUMER, 139 PHONE; AUTO learns it
//! ```
//!
//! | row | the monitor has seen before |
//! |---|---|
//! | `GEODETIC`, `CONSUMER`, `PHONE`, `AUTO` at start | nothing |
//! | `AUTO`, quiet | ten minutes and more of a third of the noise, as it is in the epoch |
//! | `AUTO`, noisy | a minute of twice the noise, as it is in the epoch |
//!
//! A false detection is a test that fails, a false alert one after which nothing is promised. Without
//! a past both are drawn. What a past has taught is a factor `κ̂`, and the probability with it follows
//! in closed form, because the residuals of the epoch are independent of those before. It is averaged
//! over pasts, and false alerts are at most as likely:
//!
//! ```text
//! P(χ²(ν) > τ1 κ̂/κ)        max(κ̂, 1) instead of κ̂: if lowered sigmas fail, those of the start judge
//! ```
//!
//! Levels that grow with the residuals of the epoch itself raise no alert, and are not counted here.

use std::ops::RangeInclusive;

use anyhow::{Context as _, Result, ensure};
use indicatif::ProgressBar;
use nalgebra::DVector;
use raim::in_order::Together as _;
use raim::second_opinion::chi_square::noncentral_lower_tail;
use raim::signal::sky::Site;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::levels::Levels;
use raim_core::monitor::{Monitor, MonitorMemory, Noise, Strategy};
use raim_core::report::{Report, Verdict};
use raim_core::requirements::Requirements;
use rand::rngs::ChaCha8Rng;

use super::CAPACITY;
use super::edge::{ABOVE, rate, sky};
use super::geometry::epoch;
use super::sampling::{Alarming, alarming, normal};
use super::skies::Scene;
use crate::draw::generator;
use crate::{Effort, Experiment, Finding, Interval, Judgement, Outcome, Row, Section};

/// Entry for the command line.
pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "noise",
    about: "false alarms at the edge of availability, by every setting NOISE",
    run,
};

/// Seed of all random choices.
const SEED: u64 = 9100;

/// Time between the epochs of a rest and of a minute, s.
const STEPS_S: [f64; 2] = [5.0, 1.0];

/// Degrees of freedom from which quiet minutes lower the noise.
const LEAST_DOF: usize = 600;

/// Setting, name, factor on the variance, and what the monitor has seen before.
const SETTINGS: [(Noise, &str, f64, Past); 6] = [
    (Noise::Geodetic, "GEODETIC", 1.0, Past::Nothing),
    (Noise::Consumer, "CONSUMER", 12.5, Past::Nothing),
    (Noise::Phone, "PHONE", 25.0 / 0.18, Past::Nothing),
    (Noise::Auto, "AUTO, at start", 1.0, Past::Nothing),
    (Noise::Auto, "AUTO, after quiet minutes with a third of the noise", 1.0 / 9.0, Past::Rest),
    (Noise::Auto, "AUTO, after a minute with twice the noise", 4.0, Past::Minute),
];

/// Degrees of freedom of the rows after the noisy minute.
const DOFS: [RangeInclusive<usize>; 5] = [1..=1, 2..=2, 3..=3, 4..=6, 7..=12];

/// Number of rates that must hold together.
const FAMILY: usize = 2 * SETTINGS.len();

/// What a monitor has seen before the epoch.
#[derive(Clone, Copy, PartialEq)]
enum Past {
    Nothing,
    Minute,
    Rest,
}

/// Weights of one geometry.
#[derive(Clone, Copy)]
struct Weights {
    detection: f64,
    alert: f64,
    heaviest: f64,
    dof: usize,
}

fn run(effort: Effort, bar: &ProgressBar) -> Result<Outcome> {
    let (count, learning) = effort.pick((500, 60), (100_000, 10_000));
    bar.set_length(SETTINGS.iter().map(|setting| drawn(setting.3, count, learning)).sum());
    let requirements = Requirements::non_precision_approach();
    let thresholds = Thresholds::from_tables(requirements.false_alarm, requirements.missed_detection)?;
    let asked = requirements.false_alarm.get();
    let (mut rows, mut geometries, mut by_dof) = (Vec::new(), Vec::new(), Vec::new());
    for (noise, name, factor, past) in SETTINGS {
        let judged = |number: u64| {
            let weights = judged(&thresholds, number, (noise, factor, past));
            bar.inc(1);
            weights
        };
        let weights: Vec<Weights> = (0..drawn(past, count, learning))
            .together(judged)
            .filter_map(Result::transpose)
            .collect::<Result<_>>()?;
        ensure!(!weights.is_empty(), "no geometry has a level within the limit with {name}");
        let heaviest = weights.iter().map(|weights| weights.heaviest).fold(0.0, f64::max);
        let column = |of: fn(&Weights) -> f64| weights.iter().map(of).collect::<Vec<f64>>();
        let row = |event: &str, weights: &[f64]| {
            rate(&format!("{event}, {name}"), weights, (asked, heaviest), FAMILY)
        };
        rows.push(row("false detection", &column(|weights| weights.detection)));
        rows.push(row("false alert", &column(|weights| weights.alert)));
        geometries.push(weights.len().to_string());
        if past == Past::Minute {
            by_dof = DOFS.iter().filter_map(|dofs| of_dof(dofs, &weights, asked)).collect();
        }
    }
    Ok(Outcome {
        name: EXPERIMENT.name,
        title: "False alarms at the edge of availability, by every setting of the noise".into(),
        setup: format!(
            "{} geometries by setting, of those of the experiment `fde` that have a level within 556 m with it; the \
             alert limit of each is {ABOVE} times its own level. The noise is Gaussian, with the variance that the setting \
             states; AUTO has seen nothing, or 601 s and {LEAST_DOF} degrees of freedom, or 61 s. Rates over P_fa {asked:e}, \
             by importance sampling, after a past in closed form. Held: no interval lies above 1, {FAMILY} intervals together at 95 % (Bonferroni).",
            geometries.join(", ")
        ),
        sections: vec![
            Section { title: "Rates over P_fa".into(), rows },
            Section {
                title: "The last of these by degrees of freedom; no requirement of its own".into(),
                rows: by_dof,
            },
        ],
        pictures: vec![],
    })
}

/// Returns the rate of the geometries with these degrees of freedom; `None` without any.
fn of_dof(dofs: &RangeInclusive<usize>, weights: &[Weights], asked: f64) -> Option<Row> {
    let of = weights.iter().filter(|weights| dofs.contains(&weights.dof));
    let relative: Vec<f64> = of.map(|weights| weights.detection / asked).collect();
    let interval = (relative.len() > 1).then(|| Interval::of_mean(&relative))?;
    let value = relative.iter().sum::<f64>() / relative.len() as f64;
    let finding = Finding::Number { value, decimals: 3, interval: Some(interval) };
    let what = format!("detection with {} to {} degrees of freedom", dofs.start(), dofs.end());
    Some(Row::new(what, "", finding, Judgement::Ours).because(format!("{} geometries", relative.len())))
}

/// Returns the number of geometries to draw.
fn drawn(past: Past, count: u64, learning: u64) -> u64 {
    if past == Past::Nothing { count } else { learning }
}

/// Judges a draw without a fault; returns `None` if the level is beyond the limit.
fn judged(
    thresholds: &Thresholds<'_>,
    number: u64,
    (noise, factor, past): (Noise, f64, Past),
) -> Result<Option<Weights>> {
    let Some((site, scene)) = sky(number) else { return Ok(None) };
    let mut chance = generator(SEED, number);
    let mut trial = Trial::new(&site, &scene, noise, factor)?;
    match past {
        Past::Nothing => trial.monitor.disable_continuity(),
        Past::Minute => trial.learn((61.0, STEPS_S[1]), 0, &mut chance)?,
        Past::Rest => trial.learn((601.0, STEPS_S[0]), LEAST_DOF + scene.geometry.dof(), &mut chance)?,
    }
    let Some(requirements) = trial.edge()? else { return Ok(None) };
    if past != Past::Nothing {
        let learned = f64::from(trial.monitor.noise(trial.time_s)).max(1.0);
        let dof = scene.geometry.dof();
        let tau: f64 = thresholds.tau1(dof).context("beyond the tables")?;
        let fails = (1.0 - noncentral_lower_tail(tau * learned / factor, dof, 0.0).0).max(0.0);
        return Ok(Some(Weights { detection: fails, alert: fails, heaviest: fails, dof }));
    }
    trial.monitor.set_requirements(requirements)?;
    let Alarming { noise, weight, heaviest } = alarming(&scene.geometry, thresholds, &mut chance)?;
    let report = trial.report(&noise)?;
    let is_promised = matches!(report.verdict, Verdict::Protected(_));
    let fails = report.test.as_ref().is_some_and(|test| test.statistic > test.threshold);
    let is_detected = fails || !report.excluded.is_empty() || matches!(report.verdict, Verdict::Alert(_));
    let weigh = |happened: bool| if happened { weight } else { 0.0 };
    let (detection, alert) = (weigh(is_detected), weigh(is_detected && !is_promised));
    Ok(Some(Weights { detection, alert, heaviest, dof: scene.geometry.dof() }))
}

/// A monitor above one sky.
struct Trial<'s> {
    site: &'s Site,
    scene: &'s Scene,
    monitor: Monitor<f32, CAPACITY>,
    memory: Box<MonitorMemory<f32, CAPACITY>>,
    /// Standard deviation of the noise over that of the ranges.
    scale: f64,
    time_s: f64,
}

impl<'s> Trial<'s> {
    fn new(site: &'s Site, scene: &'s Scene, noise: Noise, factor: f64) -> Result<Self> {
        let mut monitor = Monitor::new(approach())?;
        monitor.set_strategy(Strategy::DEFAULT.with_levels(Levels::Bound).with_noise(noise))?;
        monitor.start_from(site.position);
        let memory = Box::new(MonitorMemory::new());
        Ok(Self { site, scene, monitor, memory, scale: factor.sqrt(), time_s: 0.0 })
    }

    /// Judges ranges with this normalised noise, and learns from the verdict.
    fn report(&mut self, noise: &DVector<f64>) -> Result<&Report<CAPACITY>> {
        let rows = self.scene.geometry.noisy(&(noise * self.scale), None);
        let epoch = epoch(self.time_s, &self.scene.sights, &rows)?;
        Ok(self.monitor.process_in(&mut self.memory, &epoch))
    }

    /// Learns from epochs for this time, and until they have so many degrees of freedom.
    fn learn(
        &mut self,
        (time_s, step_s): (f64, f64),
        least_dof: usize,
        chance: &mut ChaCha8Rng,
    ) -> Result<()> {
        let geometry = &self.scene.geometry;
        let mut dof = 0;
        while self.time_s <= time_s || dof < least_dof {
            self.report(&normal(geometry.rows.len(), chance))?;
            self.time_s += step_s;
            dof += geometry.dof();
        }
        Ok(())
    }

    /// Returns the requirements with the limit that the level just meets; `None` if that is beyond
    /// the limit of the approach.
    fn edge(&mut self) -> Result<Option<Requirements>> {
        let epoch = epoch(self.time_s, &self.scene.sights, &self.scene.geometry.rows)?;
        let noise = self.monitor.noise(self.time_s);
        let levels = self
            .monitor
            .levels(&epoch, self.site.position, noise, &mut self.memory)
            .context("a sky with redundancy has levels")?;
        let hal_m = levels.hpl_m * ABOVE;
        Ok((hal_m < approach().hal_m).then(|| approach().with_hal_m(hal_m)))
    }
}

fn approach() -> Requirements {
    Requirements::non_precision_approach().with_guard_fraction(1.0)
}
