//! Every method under its worst fault: counted rate at which the whole monitor promises a position
//! beyond its level.
//!
//! [`super::worst`] computes this for positions that no test contradicts. If a test does, a method
//! searches, and the satellites that it leaves out may be healthy. That depends on the method and
//! has no closed form.
//!
//! ```text
//! P̂(b) = promised and beyond / draws          worst = max over b, over the requirement
//! ```
//!
//! | methods | requirement with a fault | without a fault |
//! |---|---|---|
//! | those that test residuals | `P_md`, for each axis | `P_ff` |
//! | `SEPARATION` | `PHMI_H / P_sat`, horizontally, with the likeliest satellite fault of all constellations | – |
//!
//! `b` is a multiple of the bias that corresponds to `√λ`, on the satellites with the largest
//! slopes. The limits are those of non-precision approach, and limits that the levels without
//! exclusions just reach. Without a fault a healthy satellite is left out only after a false alarm,
//! which [`sampling::alarming`] draws often and weights.
//!
//! Requirement: no interval lies above 1, all of them together with 95 % (Bonferroni). A zero of
//! some hundred draws shows little; the full form has enough to bring the upper ends below 1.
//!
//! All methods and both limits receive the same ranges. Levels are `BOUND`, and every epoch is
//! judged independently.

use anyhow::{Context as _, Result, ensure};
use nalgebra::DVector;
use raim::in_order::Together as _;
use raim::signal::sky::Site;
use raim_core::epoch::Epoch;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::isolation::parity::Isolation;
use raim_core::internals::weighting::Ism;
use raim_core::monitor::{Method, Monitor, MonitorMemory, Search, Strategy};
use raim_core::report::{Protected, Report, Verdict};
use raim_core::requirements::Requirements;

use super::CAPACITY;
use super::geometry::epoch;
use super::sampling::{Alarming, alarming, normal};
use super::skies::{KINDS, Scene, scene, steepest, systems_in_words};
use super::worst::FAULT_FREE;
use crate::draw::generator;
use crate::{Effort, Finding, Interval, Judgement, Row, Section};

/// Methods by their words in the command `METHOD`.
const METHODS: [(&str, Method); 8] = [
    ("AUTO", Method::Auto),
    ("BAARDA", Method::Baarda),
    ("SIMULTANEOUS", Method::Parity(Isolation::Simultaneous)),
    ("SEQUENTIAL", Method::Parity(Isolation::Sequential)),
    ("HYBRID", Method::Parity(Isolation::Hybrid)),
    ("GROUPING", Method::Parity(Isolation::Grouping)),
    ("RANSAC", Method::Ransac),
    ("SEPARATION", Method::Araim),
];

/// Sizes of the bias, as multiples of the one that corresponds to `√λ`: from those missed by chance
/// to those surely found.
const SIZES: [f64; 8] = [0.5, 0.65, 0.8, 1.0, 1.25, 1.5, 2.0, 4.0];

/// Alert limits by name.
const LIMITS: [&str; 2] = ["NPA", "limits at the levels"];

/// Ratio of an alert limit to its level, so that small changes of the level stay below it.
const ABOVE: f64 = 1.02;

/// Number of required rates: for each row every size and axis, and those without a fault.
const FAMILY: usize = KINDS.len() * METHODS.len() * (LIMITS.len() * SIZES.len() * 2 + 1);

/// Seed of all random choices.
const SEED: u64 = 4000;

/// A sky with a monitor for every method and limit.
struct Watched {
    site: Site,
    scene: Scene,
    faulty: Vec<usize>,
    monitors: Vec<[Monitor<f32, CAPACITY>; LIMITS.len()]>,
}

/// Counts of the draws of one size, by one method within one limit.
#[derive(Clone, Copy, Debug, Default)]
struct Count {
    draws: usize,
    promised: usize,
    horizontal: usize,
    vertical: usize,
}

impl Count {
    fn add(self, other: Self) -> Self {
        Self {
            draws: self.draws + other.draws,
            promised: self.promised + other.promised,
            horizontal: self.horizontal + other.horizontal,
            vertical: self.vertical + other.vertical,
        }
    }

    fn of(fate: &Fate) -> Self {
        Self {
            draws: 1,
            promised: usize::from(fate.promise.is_some()),
            horizontal: usize::from(fate.promise.is_some() && fate.beyond[0]),
            vertical: usize::from(fate.promise.is_some() && fate.beyond[1]),
        }
    }
}

/// Counts of one size, by limit and method.
type Counts = [[Count; METHODS.len()]; LIMITS.len()];

/// Outcome of one epoch.
struct Fate {
    /// Promise with or without exclusions; `None` if nothing is promised.
    promise: Option<Protected>,
    /// True if the error is beyond the level, horizontally and vertically.
    beyond: [bool; 2],
}

/// Returns the sections with a fault, and without.
pub(super) fn sections(effort: Effort, site: &Site) -> Result<Vec<Section>> {
    let (skies, draws) = effort.pick((1, 400), (4, 20_000));
    let (mut faulty, mut fault_free) = (Vec::new(), Vec::new());
    for (constellations, counts) in KINDS {
        let watched = watched(site, constellations, counts, skies)?;
        let by_size = judged_with_fault(&watched, draws)?;
        let without_fault = judged_without_fault(&watched, draws * 5)?;
        for (number, (name, method)) in METHODS.iter().enumerate() {
            let who = format!("{name}, {}", systems_in_words(constellations));
            for (limit, name) in LIMITS.iter().enumerate() {
                let by_size: Vec<Count> = by_size.iter().map(|counts| counts[limit][number]).collect();
                faulty.push(row(&format!("{who}, {name}"), &asked(*method), &by_size));
            }
            if *method != Method::Araim {
                let FaultFree { weights, heaviest } = &without_fault;
                fault_free.push(row_without_fault(who, &weights[number], *heaviest));
            }
        }
    }
    Ok(vec![
        Section {
            title: format!(
                "Promised and beyond the level over what was asked, every method with BOUND, at the worst of {} sizes of \
                 the bias, {draws} draws each, 6 to 40 satellites",
                SIZES.len()
            ),
            rows: faulty,
        },
        Section {
            title: format!(
                "A healthy satellite left out, promised and beyond the level, over P_ff {FAULT_FREE:e}, every method \
                 with BOUND"
            ),
            rows: fault_free,
        },
    ])
}

/// Returns skies of each number of satellites.
fn watched(site: &Site, constellations: usize, counts: &[usize], skies: u64) -> Result<Vec<Watched>> {
    let numbers = counts.iter().flat_map(|&count| (0..skies).map(move |number| (count, number)));
    let scenes = numbers.filter_map(|(count, number)| scene(site, constellations, count, number));
    let watched: Vec<Watched> = scenes.map(|scene| Watched::new(*site, scene)).collect::<Result<_>>()?;
    ensure!(!watched.is_empty(), "no sky of {constellations} systems");
    Ok(watched)
}

/// Returns a monitor that judges each epoch independently, about a start.
fn monitor(requirements: Requirements, method: Method) -> Result<Monitor<f32, CAPACITY>> {
    let mut monitor = Monitor::new(requirements)?;
    monitor.set_strategy(Strategy::CLASSIC.with_method(method))?;
    Ok(monitor)
}

impl Watched {
    fn new(site: Site, scene: Scene) -> Result<Self> {
        let noiseless = epoch(0.0, &scene.sights, &scene.geometry.rows)?;
        let monitors = METHODS.iter().map(|&(_, method)| {
            let approach = Requirements::non_precision_approach();
            let usual = monitor(approach, method)?;
            let mut memory = MonitorMemory::new();
            let report = &usual.judge(&noiseless, site.position, Search::Anew, None, &mut memory).report;
            let levels = report.protection.context("a sky with levels")?;
            let limit = |level_m: f64| (level_m * ABOVE / approach.guard_fraction).min(approach.hal_m);
            let (hal_m, val_m) = (limit(levels.hpl_m), Some(limit(levels.vpl_m)));
            Ok([usual, monitor(approach.with_hal_m(hal_m).with_val_m(val_m), method)?])
        });
        let monitors = monitors.collect::<Result<_>>()?;
        Ok(Self { faulty: steepest(&scene.geometry, 1), site, scene, monitors })
    }

    /// Returns the epoch with this noise, and with a bias on one satellite.
    fn epoch(&self, noise: &DVector<f64>, bias: Option<(usize, f64)>) -> Result<Epoch<CAPACITY>> {
        epoch(0.0, &self.scene.sights, &self.scene.geometry.noisy(noise, bias))
    }

    fn judge(
        &self,
        method: usize,
        limit: usize,
        epoch: &Epoch<CAPACITY>,
        memory: &mut MonitorMemory<f32, CAPACITY>,
    ) -> Fate {
        let monitor = &self.monitors[method][limit];
        self.fate(&monitor.judge(epoch, self.site.position, Search::Anew, None, memory).report)
    }

    fn fate(&self, report: &Report<CAPACITY>) -> Fate {
        let error = report
            .solution
            .as_ref()
            .map(|solution| self.site.frame.rotate(solution.position - self.site.position));
        let beyond = error.zip(report.protection).map_or([false; 2], |(error, levels)| {
            [error.horizontal() > levels.hpl_m, error.up.abs() > levels.vpl_m]
        });
        let promise = match report.verdict {
            Verdict::Protected(promise) => Some(promise),
            Verdict::Alert(_) | Verdict::Unavailable(_) => None,
        };
        Fate { promise, beyond }
    }

    /// Counts draws with a bias of one size, on the satellites with the largest slopes in turn.
    fn counts(
        &self,
        thresholds: &Thresholds<'_>,
        size: usize,
        draws: impl Iterator<Item = usize>,
    ) -> Result<Counts> {
        let Scene { geometry, .. } = &self.scene;
        let root = thresholds.lambda::<f64>(geometry.dof()).context("beyond the tables")?.sqrt();
        let mut memory = core::array::from_fn::<_, { METHODS.len() }, _>(|_| MonitorMemory::new());
        let mut counts = Counts::default();
        for (draw, &index) in draws.zip(self.faulty.iter().cycle()) {
            let bias_m = SIZES[size] * root / geometry.visibility(index);
            let mut chance = generator(SEED + size as u64, draw as u64);
            let epoch = self.epoch(&normal(geometry.rows.len(), &mut chance), Some((index, bias_m)))?;
            for (limit, counts) in counts.iter_mut().enumerate() {
                for (method, (count, memory)) in counts.iter_mut().zip(&mut memory).enumerate() {
                    *count = count.add(Count::of(&self.judge(method, limit, &epoch, memory)));
                }
            }
        }
        Ok(counts)
    }
}

/// Judges `draws` draws of every size, shared among the skies.
fn judged_with_fault(watched: &[Watched], draws: usize) -> Result<Vec<Counts>> {
    let thresholds = thresholds()?;
    let places: Vec<(usize, usize)> =
        (0..SIZES.len()).flat_map(|size| (0..watched.len()).map(move |sky| (size, sky))).collect();
    let of_place = |&(size, sky): &(usize, usize)| {
        watched[sky].counts(&thresholds, size, (sky..draws).step_by(watched.len()))
    };
    let each: Vec<Counts> = places.iter().together(of_place).collect::<Result<_>>()?;
    let mut sums = vec![Counts::default(); SIZES.len()];
    for ((size, _), counts) in places.iter().zip(&each) {
        let sum = sums[*size].as_flattened_mut().iter_mut();
        sum.zip(counts.as_flattened()).for_each(|(sum, count)| *sum = sum.add(*count));
    }
    Ok(sums)
}

/// Returns the thresholds of non-precision approach.
fn thresholds() -> Result<Thresholds<'static>> {
    let approach = Requirements::non_precision_approach();
    Ok(Thresholds::from_tables(approach.false_alarm, approach.missed_detection)?)
}

/// Weights of draws without a fault.
struct FaultFree {
    /// Weights by method, zero unless a healthy satellite is left out and the promised position is
    /// beyond a level.
    weights: [Vec<f64>; METHODS.len()],
    /// Largest possible weight.
    heaviest: f64,
}

fn judged_without_fault(watched: &[Watched], draws: usize) -> Result<FaultFree> {
    let thresholds = thresholds()?;
    let of_sky = |sky: usize| -> Result<Vec<([f64; METHODS.len()], f64)>> {
        let mut memory = core::array::from_fn::<_, { METHODS.len() }, _>(|_| MonitorMemory::new());
        let of_draw = |draw: usize| {
            let mut chance = generator(SEED + SIZES.len() as u64, draw as u64);
            let drawn = alarming(&watched[sky].scene.geometry, &thresholds, &mut chance)?;
            let Alarming { noise, weight, heaviest } = drawn;
            let epoch = watched[sky].epoch(&noise, None)?;
            let mut weights = [0.0; METHODS.len()];
            for (method, (weighed, memory)) in weights.iter_mut().zip(&mut memory).enumerate() {
                let fate = watched[sky].judge(method, 0, &epoch, memory);
                if matches!(fate.promise, Some(Protected::Excluded | Protected::Covered))
                    && fate.beyond != [false; 2]
                {
                    *weighed = weight;
                }
            }
            Ok((weights, heaviest))
        };
        (sky..draws).step_by(watched.len()).map(of_draw).collect()
    };
    let each: Vec<_> = (0..watched.len()).together(of_sky).collect::<Result<_>>()?;
    let drawn = || each.iter().flatten();
    Ok(FaultFree {
        weights: std::array::from_fn(|method| drawn().map(|(weights, _)| weights[method]).collect()),
        heaviest: drawn().map(|&(_, heaviest)| heaviest).fold(0.0, f64::max),
    })
}

/// Returns the requirement on a method under a fault, horizontally and vertically; `None` without a
/// requirement.
fn asked(method: Method) -> [Option<f64>; 2] {
    let Requirements { missed_detection, allocation, .. } = Requirements::non_precision_approach();
    if method != Method::Araim {
        return [Some(missed_detection.get()); 2];
    }
    let likeliest =
        Ism::ICAO.constellations.iter().map(|support| support.satellite_fault).fold(0.0, f64::max);
    [Some(allocation.integrity_horizontal / likeliest), None]
}

/// Returns the largest rate of all sizes and axes, over the requirement.
fn row(who: &str, asked: &[Option<f64>; 2], by_size: &[Count]) -> Row {
    let rates = SIZES.iter().zip(by_size).flat_map(|(size, count)| {
        let axes = [count.horizontal, count.vertical].into_iter().zip(["horizontally", "vertically"]);
        asked.iter().zip(axes).filter_map(move |(asked, (hits, axis))| {
            Some((hits, (*asked)? * count.draws as f64, *size, axis, count.promised))
        })
    });
    // Among equal rates that of the most promises counts.
    let most = rates.max_by(|one, other| {
        (one.0 as f64 / one.1).total_cmp(&(other.0 as f64 / other.1)).then(one.4.cmp(&other.4))
    });
    let (hits, expected, size, axis, promised) = most.unwrap_or((0, f64::NAN, f64::NAN, "", 0));
    let Interval { low, high } = Interval::of_count(hits);
    let interval = Some(Interval { low: low / expected, high: high / expected });
    let ours = Finding::Number { value: hits as f64 / expected, decimals: 3, interval };
    let holds = Interval::of_one_count_in(FAMILY, hits).low <= expected;
    Row::new(who, "", ours, Judgement::Ours)
        .because(format!("{hits} {axis} at {size} of the bias behind √λ, of {promised} promised"))
        .holding("interval not above 1", holds)
}

/// Returns the mean weight. Its upper end is at least as large as if every expected draw had the
/// largest weight, because without a hit the sample's deviation shows nothing.
fn row_without_fault(who: String, weights: &[f64], heaviest: f64) -> Row {
    let relative: Vec<f64> = weights.iter().map(|weight| weight / FAULT_FREE).collect();
    let value = relative.iter().sum::<f64>() / relative.len() as f64;
    let hits = weights.iter().filter(|&&weight| weight > 0.0).count();
    let at_most = Interval::of_count(hits).high * heaviest / FAULT_FREE / relative.len() as f64;
    let sampled = Interval::of_mean(&relative);
    let interval = Interval { low: sampled.low.max(0.0), high: sampled.high.max(at_most) };
    Row::new(who, "", Finding::Number { value, decimals: 3, interval: Some(interval) }, Judgement::Ours)
        .because(format!("{hits} of {} draws", weights.len()))
        .holding("interval not above 1", sampled.as_one_in(FAMILY).low <= 1.0)
}
