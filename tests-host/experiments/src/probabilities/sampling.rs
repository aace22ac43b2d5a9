//! Importance sampling: rare events are drawn often, and weighted with their true relative
//! probability.
//!
//! ```text
//! S z        part of the noise z ~ N(0, I) that the residuals show; dimension ν
//! false      z' = z + (s − 1) S z           w = s^ν exp(−(s² − 1) |S z|²/2)      s² = max(τ1/ν, 1)
//! missed     z' = z − δ u                   w = exp(δ u·z − δ²/2)                δ = b v − √max(τ1 − ν, 0)
//! P̂          mean of w over the draws in which it happens
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `S` | [`Geometry::parity`], of dense least squares | – |
//! | `u` | [`Geometry::signature`] of the satellite with the largest slope | – |
//! | `v` | [`Geometry::visibility`] of it | 1/m |
//! | `b` | bias that moves the position by the core's HPL, `HPL / |A_i|` | m |
//! | `τ1`, `λ` | committed tables | – |
//!
//! The weights are exact and come from the drawn noise alone, not from the core's result. The core
//! decides the outcome from ranges, in both scalars with the same noise.

use anyhow::{Context as _, Result};
use nalgebra::DVector;
use raim::in_order::Together as _;
use raim::signal::sky::linear::{Row, equations};
use raim_core::internals::integrity::raim::detection::detect;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::levels::largest_slopes;
use raim_core::internals::least_squares::Workspace;
use raim_core::internals::numeric::real::Real;
use rand::rngs::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

use super::CAPACITY;
use super::geometry::{Geometry, Worst};
use crate::draw::generator;

/// Weights by draw, 0 if the event did not happen: in `f32` and in `f64`.
pub(super) struct Sample {
    pub(super) weights: [Vec<f64>; 2],
}

impl Sample {
    /// Makes `draws` draws, from the geometries in turn.
    fn draw(
        geometries: usize,
        draws: usize,
        seed: u64,
        draw: impl Fn(usize, &mut ChaCha8Rng) -> Result<[f64; 2]> + Sync,
    ) -> Result<Self> {
        let of = |number: usize| draw(number % geometries, &mut generator(seed, number as u64));
        let pairs: Vec<[f64; 2]> = (0..draws).together(of).collect::<Result<_>>()?;
        let column = |column: usize| pairs.iter().map(|pair| pair[column]).collect();
        Ok(Self { weights: [column(0), column(1)] })
    }

    /// Returns the number of draws in which the event happened, in a scalar.
    pub(super) fn hits(&self, scalar: usize) -> usize {
        self.weights[scalar].iter().filter(|&&weight| weight > 0.0).count()
    }

    /// Returns the number of draws in which it happened in one scalar only.
    pub(super) fn disagreements(&self) -> usize {
        let [single, double] = &self.weights;
        single.iter().zip(double).filter(|&(&single, &double)| (single > 0.0) != (double > 0.0)).count()
    }
}

/// Samples false alarms.
pub(super) fn false_alarms(
    geometries: &[Geometry],
    thresholds: &Thresholds<'_>,
    draws: usize,
    seed: u64,
) -> Result<Sample> {
    Sample::draw(geometries.len(), draws, seed, |index, generator| {
        let geometry = &geometries[index];
        let Alarming { noise, weight, .. } = alarming(geometry, thresholds, generator)?;
        let rows = geometry.noisy(&noise, None);
        let weigh = |alarm: bool| if alarm { weight } else { 0.0 };
        Ok([weigh(alarms::<f32>(&rows, thresholds)?), weigh(alarms::<f64>(&rows, thresholds)?)])
    })
}

/// Noise that alarms about every other time.
pub(super) struct Alarming {
    pub(super) noise: DVector<f64>,
    pub(super) weight: f64,
    /// Largest weight of any noise that alarms: that at the threshold.
    pub(super) heaviest: f64,
}

/// Draws noise whose share in the residuals is `s` times too large.
pub(super) fn alarming(
    geometry: &Geometry,
    thresholds: &Thresholds<'_>,
    generator: &mut ChaCha8Rng,
) -> Result<Alarming> {
    let dof = geometry.dof() as f64;
    let tau: f64 = thresholds.tau1(geometry.dof()).context("beyond the tables")?;
    let scale = (tau / dof).max(1.0).sqrt();
    let noise = normal(geometry.rows.len(), generator);
    let shown = geometry.parity(&noise);
    let weight = |shown: f64| (dof * scale.ln() - (scale * scale - 1.0) * shown / 2.0).exp();
    Ok(Alarming {
        weight: weight(shown.norm_squared()),
        heaviest: weight(tau / (scale * scale)),
        noise: noise + shown * (scale - 1.0),
    })
}

/// Samples misses of the bias that moves the position by the protection level.
pub(super) fn missed_detections(
    geometries: &[Geometry],
    thresholds: &Thresholds<'_>,
    draws: usize,
    seed: u64,
) -> Result<Sample> {
    let faults: Vec<Fault> =
        geometries.iter().map(|geometry| Fault::of(geometry, thresholds)).collect::<Result<_>>()?;
    Sample::draw(geometries.len(), draws, seed, |index, generator| {
        let (geometry, fault) = (&geometries[index], &faults[index]);
        let noise = normal(geometry.rows.len(), generator);
        let [single_m, double_m] = fault.biases_m;
        Ok([
            fault.miss::<f32>(geometry, thresholds, &noise, single_m)?,
            fault.miss::<f64>(geometry, thresholds, &noise, double_m)?,
        ])
    })
}

/// Fault of the worst satellite of a geometry, with the effect of the protection level.
struct Fault {
    worst: Worst,
    signature: DVector<f64>,
    visibility: f64,
    /// Distance from the origin of parity space at which about half of the draws are missed.
    boundary: f64,
    /// Biases in `f32` and in `f64`, m.
    biases_m: [f64; 2],
}

impl Fault {
    fn of(geometry: &Geometry, thresholds: &Thresholds<'_>) -> Result<Self> {
        let worst = geometry.worst().context("a testable satellite")?;
        let tau: f64 = thresholds.tau1(geometry.dof()).context("beyond the tables")?;
        let moved = worst.moved.norm();
        Ok(Self {
            worst,
            signature: geometry.signature(worst.index),
            visibility: geometry.visibility(worst.index),
            boundary: (tau - geometry.dof() as f64).max(0.0).sqrt(),
            biases_m: [
                hpl_m::<f32>(geometry, thresholds)? / moved,
                hpl_m::<f64>(geometry, thresholds)? / moved,
            ],
        })
    }

    fn miss<T: Real>(
        &self,
        geometry: &Geometry,
        thresholds: &Thresholds<'_>,
        noise: &DVector<f64>,
        bias_m: f64,
    ) -> Result<f64> {
        let shift = bias_m * self.visibility - self.boundary;
        let exponent = shift * self.signature.dot(noise) - shift * shift / 2.0;
        let noise = noise - &self.signature * shift;
        let rows = geometry.noisy(&noise, Some((self.worst.index, bias_m)));
        Ok(if alarms::<T>(&rows, thresholds)? { 0.0 } else { exponent.exp() })
    }
}

/// Draws normalised noise.
pub(super) fn normal(count: usize, generator: &mut ChaCha8Rng) -> DVector<f64> {
    DVector::from_fn(count, |_, _| StandardNormal.sample(generator))
}

fn alarms<T: Real>(rows: &[Row], thresholds: &Thresholds<'_>) -> Result<bool> {
    let detection = detect(&pose::<T>(rows)?.solve()?, thresholds).context("beyond the tables")?;
    Ok(detection.fault())
}

fn hpl_m<T: Real>(geometry: &Geometry, thresholds: &Thresholds<'_>) -> Result<f64> {
    let lambda = thresholds.lambda(geometry.dof()).context("beyond the tables")?;
    Ok(largest_slopes(&pose::<T>(&geometry.rows)?.solve()?).protect(lambda).hpl_m)
}

fn pose<T: Real>(rows: &[Row]) -> Result<Workspace<T, CAPACITY>> {
    Ok(Workspace::of(equations(rows)?))
}
