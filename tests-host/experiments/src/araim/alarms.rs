//! False alarms of all tests together, by importance sampling of the core in `f32`.
//!
//! ```text
//! z ~ ¼M Σ_m Σ_± N(±K d_m/|d_m|, I)          w = 1 / mean of exp(z_m·z − |z_m|²/2)        P̂ = mean of w over the alarms
//! ```
//!
//! `d_m = C_acc^½ (S^k − S^0)_q` of each mode and axis. Half of the draws lie beyond the threshold
//! that they aim at. The weight is that of the mixture, whatever part a draw comes from, and no
//! larger than the number of its parts.

use anyhow::Result;
use nalgebra::DVector;
use raim::in_order::Together as _;
use raim_core::internals::integrity::araim::{Allocation, Priors, judge};
use raim_core::internals::least_squares::Workspace;
use raim_core::internals::weighting::Ism;
use rand::RngExt as _;

use super::risk::{hypotheses, normal, site};
use super::scene::Scene;
use super::{Effort, Finding, Interval, Judgement, Row, Section};
use crate::draw::generator;

/// Returns the section.
pub(super) fn section(effort: Effort) -> Result<Section> {
    let draws = effort.pick(1000, 40_000);
    let mut rows = Vec::new();
    for (name, allocation) in
        [("LPV-200", Allocation::vertical_guidance()), ("horizontal", Allocation::horizontal())]
    {
        for (promise, ism) in [("RESEARCH", Ism::RESEARCH), ("ICAO", Ism::ICAO)] {
            let scene = Scene::above(&site(), 2, 7200.0, &ism);
            let asked = allocation.alarm_vertical + allocation.alarm_horizontal;
            let weights = weights(&scene, &allocation, draws)?;
            let shares: Vec<f64> = weights.iter().map(|weight| weight / asked).collect();
            let share = shares.iter().sum::<f64>() / draws as f64;
            let interval = Interval::of_mean(&shares);
            let ours = Finding::Number { value: share, decimals: 3, interval: Some(interval) };
            rows.push(
                Row::new(
                    format!(
                        "{name}, {promise}, {} satellites: false alarms over P_FA",
                        scene.satellites.len()
                    ),
                    "",
                    ours,
                    Judgement::Ours,
                )
                .holding("at most 1", interval.low <= 1.0),
            );
        }
    }
    Ok(Section {
        title: format!(
            "False alarms over what was asked for, of {draws} draws each, with the accuracy's sigmas"
        ),
        rows,
    })
}

fn weights(scene: &Scene, allocation: &Allocation, draws: u64) -> Result<Vec<f64>> {
    let count = scene.satellites.len();
    let priors =
        Priors { satellites: &scene.priors::<f32>(), constellations: scene.constellations.map(|p| p as f32) };
    let mut workspace = Workspace::of(scene.epoch::<f32>(&DVector::zeros(count))?);
    let mut snapshot = workspace.solve()?;
    let factors = judge(&mut snapshot, &priors, allocation)?.whole.factors;
    let all = scene.gains(&[])?;
    let mut centres: Vec<DVector<f64>> = Vec::new();
    for hypothesis in hypotheses(scene) {
        let moved = scene.gains(&hypothesis.taken)? - &all;
        for axis in 0..3 {
            let towards =
                DVector::from_fn(count, |index, _| moved[(axis, index)] * scene.satellites[index].accuracy_m);
            centres.push(&towards * (f64::from(factors[axis]) / towards.norm()));
        }
    }
    (0..draws)
        .together(|number| {
            let mut chance = generator(5000, number);
            let centre = &centres[chance.random_range(0..centres.len())];
            let sign = if chance.random() { 1.0 } else { -1.0 };
            let drawn = normal(count, &mut chance) + centre * sign;
            let noise = DVector::from_fn(count, |index, _| drawn[index] * scene.satellites[index].accuracy_m);
            let mut workspace = Workspace::of(scene.epoch::<f32>(&noise)?);
            let mut snapshot = workspace.solve()?;
            if !judge(&mut snapshot, &priors, allocation)?.whole.alarm {
                return Ok(0.0);
            }
            let density = |centre: &DVector<f64>| {
                let half = centre.norm_squared() / 2.0;
                f64::midpoint((centre.dot(&drawn) - half).exp(), (-centre.dot(&drawn) - half).exp())
            };
            Ok(centres.len() as f64 / centres.iter().map(density).sum::<f64>())
        })
        .collect()
}
