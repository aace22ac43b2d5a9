//! Integrity risk: the probability that the core in `f32` promises a position beyond its level, by
//! importance sampling.
//!
//! ```text
//! share = Σ_k p_k Σ_outcomes max over b of P(|x_q| > L_q, outcome not alarmed | k, b) / PHMI
//! ```
//!
//! The outcomes are: no satellite left out; the right set left out; one of the sets that are most
//! easily confused with it. Noise is drawn about the most likely noise that causes the outcome, and
//! each draw is weighted with its true relative probability:
//!
//! ```text
//! z* = the shortest z with a·z ≥ α and d·z ≤ β           w = exp(|z*|²/2 − z*·z)
//! a = (S C^½)_q      α = L_q − S_q f b        d = ((S − S^k) C^½)_q      β = T_k,q − S_q f b
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | `S`, `S^k` | gains with the satellites that the outcome keeps, and without mode `k` besides; of dense least squares |
//! | `f`, `b` | a range of the satellite, or a shift of the constellation along the axis; its size, about `T_k,q` |
//! | `C` | variances for integrity; nominal biases have their worst signs |
//! | `L`, `T` | levels and thresholds of the core |
//!
//! The core decides the outcome from ranges; the dense part only chooses where to sample. A poor
//! choice makes the interval wide, not the estimate wrong.

mod aim;
mod estimate;

use anyhow::Result;
use nalgebra::DVector;
use raim::in_order::Together as _;
use raim::signal::sky::Site;
use raim_core::internals::integrity::araim::{Allocation, AraimJudgement, AraimOutcome, Priors, judge};
use raim_core::internals::least_squares::Workspace;
use raim_core::internals::weighting::Ism;
use raim_core::satellite::Constellation;
use rand::rngs::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

use super::scene::Scene;
use super::{Effort, Judgement, Row, Section};
use crate::draw::generator;

use aim::Aim;
use estimate::Estimate;

/// Prior below which a constellation fault is not monitored.
const WATCHED: f64 = 1e-7;

/// Sizes of the fault, as multiples of the one that moves the position by the threshold.
const SIZES: [f64; 4] = [0.6, 0.9, 1.2, 1.6];

/// Multiples of that size at which the fault is left out.
const EXCLUDED: [f64; 2] = [1.6, 2.5];

/// Bias beyond every test, m.
const FAR_M: f64 = 2000.0;

/// Returns the site of the skies.
pub(super) fn site() -> Site {
    Site::geodetic(48.0, 11.0, 500.0)
}

/// A fault mode.
#[derive(Clone, Debug)]
pub(super) struct Mode {
    /// Indices of its satellites.
    pub(super) taken: Vec<usize>,
    probability: f64,
    constellation: Option<Constellation>,
}

/// Returns the monitored modes: single satellites, and whole constellations.
pub(super) fn hypotheses(scene: &Scene) -> Vec<Mode> {
    let single = |(index, one): (usize, &super::scene::Sighted)| Mode {
        taken: vec![index],
        probability: one.fault,
        constellation: None,
    };
    let singles = scene.satellites.iter().enumerate().map(single);
    let whole = Constellation::ALL.into_iter().zip(scene.constellations);
    let whole = whole.filter(|(constellation, p)| *p > WATCHED && !scene.members(*constellation).is_empty());
    let whole = whole.map(|(constellation, probability)| Mode {
        taken: scene.members(constellation),
        probability,
        constellation: Some(constellation),
    });
    singles.chain(whole).collect()
}

/// Draws normalised noise.
pub(super) fn normal(count: usize, generator: &mut ChaCha8Rng) -> DVector<f64> {
    DVector::from_fn(count, |_, _| StandardNormal.sample(generator))
}

/// A sky under one allocation, with the axis of the error.
struct Trial<'s> {
    scene: &'s Scene,
    allocation: Allocation,
    is_vertical: bool,
    draws: u64,
    modes: Vec<Mode>,
    factors: [f64; 3],
}

/// Returns the sections.
pub(super) fn sections(effort: Effort) -> Result<Vec<Section>> {
    [
        ("vertical, LPV-200", Allocation::vertical_guidance(), true),
        ("horizontal", Allocation::horizontal(), false),
    ]
    .into_iter()
    .map(|(name, allocation, is_vertical)| section(effort, name, allocation, is_vertical))
    .collect()
}

fn section(effort: Effort, name: &str, allocation: Allocation, is_vertical: bool) -> Result<Section> {
    let draws = effort.pick(60, 2000);
    let mut rows = Vec::new();
    for (promise, ism) in [("RESEARCH", Ism::RESEARCH), ("ICAO", Ism::ICAO)] {
        for (constellations, t_s) in [(2, 7200.0), (2, 30_000.0), (3, 7200.0)] {
            let scene = Scene::above(&site(), constellations, t_s, &ism);
            let words =
                format!("{promise}, {} satellites of {constellations} systems", scene.satellites.len());
            rows.extend(trial(&scene, allocation, is_vertical, draws, &words)?);
        }
    }
    Ok(Section {
        title: format!(
            "Risk, {name}: promised and beyond the level over PHMI, {draws} draws for each fault and outcome"
        ),
        rows,
    })
}

fn trial(
    scene: &Scene,
    allocation: Allocation,
    is_vertical: bool,
    draws: u64,
    words: &str,
) -> Result<Vec<Row>> {
    let mut trial =
        Trial { scene, allocation, is_vertical, draws, modes: hypotheses(scene), factors: [0.0; 3] };
    let (judged, _) = trial.judge(&DVector::zeros(scene.satellites.len()))?;
    trial.factors = judged.whole.factors.map(f64::from);
    let budget = if is_vertical { allocation.integrity_vertical } else { allocation.integrity_horizontal };
    let healthy = trial.fault_free(&judged)?.times(1.0 / budget);
    let (mut satellite, mut constellation, mut total) = (Estimate::default(), Estimate::default(), healthy);
    for mode in &trial.modes {
        let share = trial.risk_of(mode, &judged)?.times(mode.probability / budget);
        total = total.plus(share);
        match mode.constellation {
            None => satellite = satellite.larger(share),
            Some(_) => constellation = constellation.larger(share),
        }
    }
    let row = |what: &str, estimate: Estimate| {
        let high = estimate.mean + 1.96 * estimate.variance.sqrt();
        Row::new(format!("{words}: {what}"), "", estimate.finding(), Judgement::Ours)
            .holding("interval below 1", high < 1.0)
    };
    let unwatched = f64::from(judged.whole.unmonitored_probability) / allocation.integrity();
    let mut rows =
        if is_vertical { vec![against_the_closed_form(&trial, &judged, words)?] } else { Vec::new() };
    rows.extend([
        row("no fault", healthy),
        row("the worst satellite", satellite),
        row("the worst constellation", constellation),
        row("all of them", total).because(format!("beside what is not watched, {unwatched:.3} of PHMI")),
    ]);
    Ok(rows)
}

/// Checks the weights: without a fault the height is normal, and `P(|x_U| > L) = 2 Q((L − b)/σ)`.
fn against_the_closed_form(trial: &Trial<'_>, judged: &AraimJudgement<f32>, words: &str) -> Result<Row> {
    /// Half-width of the test in deviations: none of six rows of this kind may fail by chance.
    const WIDE: f64 = 4.0;
    let gains = trial.scene.gains(&[])?;
    let bias_m = gains.row(2).dot(&trial.nominal(&gains, 2).transpose());
    let beyond = (f64::from(judged.whole.levels_m[2]) - bias_m) / trial.noise_gain(&gains, 2).norm();
    let exact = libm::erfc(beyond / std::f64::consts::SQRT_2);
    let ratio = trial.fault_free(judged)?.times(1.0 / exact);
    let holds = (ratio.mean - 1.0).abs() <= WIDE * ratio.variance.sqrt();
    let row = Row::new(
        format!("{words}: no fault, sampled over closed form"),
        "",
        ratio.finding(),
        Judgement::Ours,
    );
    Ok(row.holding("1 within four sigmas", holds))
}

impl Trial<'_> {
    /// Returns the core's result for these ranges, and the position.
    fn judge(&self, ranges_m: &DVector<f64>) -> Result<(AraimJudgement<f32>, [f64; 3])> {
        let mut workspace = Workspace::of(self.scene.epoch::<f32>(ranges_m)?);
        let mut snapshot = workspace.solve()?;
        let priors = Priors {
            satellites: &self.scene.priors::<f32>(),
            constellations: self.scene.constellations.map(|p| p as f32),
        };
        let judged = judge(&mut snapshot, &priors, &self.allocation)?;
        let position = snapshot.correction();
        Ok((judged, [0, 1, 2].map(|axis| f64::from(position[axis]))))
    }

    /// Returns the axes along which a fault is aimed.
    fn axes(&self) -> &'static [usize] {
        if self.is_vertical { &[2] } else { &[0, 1] }
    }

    /// Returns true if the position is beyond the level.
    fn is_beyond(&self, position_m: [f64; 3], levels_m: [f32; 3]) -> bool {
        let [east, north, up] = position_m;
        let [level_e, level_n, level_u] = levels_m.map(f64::from);
        if self.is_vertical { up.abs() > level_u } else { east.hypot(north) > level_e.hypot(level_n) }
    }

    /// Returns the level that an error along an axis must exceed, m.
    fn level_m(&self, levels_m: [f32; 3]) -> f64 {
        let [east, north, up] = levels_m.map(f64::from);
        if self.is_vertical { up } else { east.hypot(north) }
    }

    fn fault_free(&self, judged: &AraimJudgement<f32>) -> Result<Estimate> {
        let gains = self.scene.gains(&[])?;
        let mut largest = Estimate::default();
        for &axis in self.axes() {
            let towards = self.noise_gain(&gains, axis);
            let nominal = self.nominal(&gains, axis);
            let missing_m = self.level_m(judged.whole.levels_m) - gains.row(axis).dot(&nominal.transpose());
            let centre = &towards * (missing_m / towards.norm_squared());
            let aim = Aim { fault_m: nominal, centre, left_out: 0 };
            // The factor accounts for both sides.
            largest = largest.larger(self.estimate(&aim, axis as u64)?.times(2.0));
        }
        Ok(largest)
    }

    /// Returns the sum over all outcomes of a mode, each at its worst size of the fault.
    fn risk_of(&self, mode: &Mode, judged: &AraimJudgement<f32>) -> Result<Estimate> {
        let mut largest = Estimate::default();
        for &axis in self.axes() {
            let mut sum = self.largest(mode, &[], judged.whole.levels_m, axis, &SIZES)?;
            for left_out in self.likely_exclusions(mode, axis)? {
                if let Some(levels_m) = self.levels_without(&left_out)? {
                    let sizes = if left_out == mode.taken { &EXCLUDED[..] } else { &SIZES[1..] };
                    sum = sum.plus(self.largest(mode, &left_out, levels_m, axis, sizes)?);
                }
            }
            largest = largest.larger(sum);
        }
        Ok(largest)
    }

    /// Returns the largest estimate over the size of the fault, for one outcome.
    fn largest(
        &self,
        mode: &Mode,
        left_out: &[usize],
        levels_m: [f32; 3],
        axis: usize,
        sizes: &[f64],
    ) -> Result<Estimate> {
        let mut largest = Estimate::default();
        for (number, &size) in (0..).zip(sizes) {
            let Some(aim) = self.aim(mode, left_out, levels_m, axis, size)? else { continue };
            largest = largest.larger(self.estimate(&aim, number << 8 | axis as u64)?);
        }
        Ok(largest)
    }

    /// Returns the core's levels after it has left out a set, if it does.
    fn levels_without(&self, left_out: &[usize]) -> Result<Option<[f32; 3]>> {
        let mut ranges_m = DVector::zeros(self.scene.satellites.len());
        for &index in left_out {
            // One satellite has a large error; several agree on a distant place.
            let along = if left_out.len() == 1 { 1.0 } else { -self.scene.satellites[index].direction.x };
            ranges_m[index] = FAR_M * along;
        }
        let (judged, _) = self.judge(&ranges_m)?;
        Ok(match judged.outcome {
            AraimOutcome::Excluded { rows, finding, .. } if rows == set(left_out) => Some(finding.levels_m),
            _ => None,
        })
    }

    /// Draws about the centre, and counts the core's outcomes.
    fn estimate(&self, aim: &Aim, stream: u64) -> Result<Estimate> {
        let count = self.scene.satellites.len();
        let half = aim.centre.norm_squared() / 2.0;
        let weight = |number: u64| -> Result<f64> {
            let drawn = normal(count, &mut generator(6000 + stream, number)) + &aim.centre;
            let noise =
                DVector::from_fn(count, |index, _| drawn[index] * self.scene.satellites[index].sigma_m);
            let (judged, position_m) = self.judge(&(noise + &aim.fault_m))?;
            let (left_out, levels_m) = match &judged.outcome {
                AraimOutcome::Passed => (0, judged.whole.levels_m),
                AraimOutcome::Excluded { rows, finding, .. } => (*rows, finding.levels_m),
                AraimOutcome::NotIsolated | AraimOutcome::Ambiguous => return Ok(0.0),
            };
            let counts = left_out == aim.left_out && self.is_beyond(position_m, levels_m);
            Ok(if counts { (half - aim.centre.dot(&drawn)).exp() } else { 0.0 })
        };
        let weights: Vec<f64> = (0..self.draws).together(weight).collect::<Result<_>>()?;
        Ok(Estimate::of(&weights))
    }
}

/// Returns a set with one bit per row.
fn set(rows: &[usize]) -> u64 {
    rows.iter().fold(0, |set, index| set | 1 << index)
}
