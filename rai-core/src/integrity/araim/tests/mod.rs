//! Tests of internals: the worked example, random skies against dense least squares and against
//! the rules read literally. Here is what they share.

mod choice;
mod contradictions;
mod dense;
mod order;
mod random_skies;
mod systems_apart;
mod worked_example;

use std::ops::ControlFlow;
use std::prelude::rust_2024::*;

use nalgebra::Vector3;

use super::exclusion::choose;
use super::modes::{Mode, PriorOdds, ROWS, Visitor};
use super::monitored::MonitoredModes;
use super::subsets::SubsetSolutions;
use super::{Allocation, Prior, Priors, View};
use crate::least_squares::Snapshot;
use crate::least_squares::equations::LinearEpoch;
use crate::satellite::Constellation;

type Epoch = LinearEpoch<f64, ROWS>;

/// Calls a function for each mode.
struct Each<F>(F);

impl<T, F: FnMut(&Mode<T>) -> ControlFlow<()>> Visitor<T> for Each<F> {
    fn visit(&mut self, mode: &Mode<T>) -> ControlFlow<()> {
        (self.0)(mode)
    }
}

fn close(what: &str, have: f64, want: f64, within: f64) {
    assert!((have - want).abs() <= within, "{what}: have {have:.9}, want {want:.9}");
}

/// Returns the chosen modes.
fn watched<'a>(
    snapshot: &Snapshot<'_, f64, ROWS>,
    priors: &Priors<'_, f64>,
    allocation: &'a Allocation,
) -> MonitoredModes<'a, f64> {
    let mut monitored = MonitoredModes::nothing(priors.constellations, allocation);
    let odds = Box::leak(Box::<PriorOdds<f64, ROWS>>::default());
    choose(&mut monitored, odds, &View::of(snapshot), priors).expect("a choice");
    monitored
}

/// Returns solutions that are ready for the modes.
fn solutions<'s>(
    snapshot: &'s Snapshot<'_, f64, ROWS>,
    priors: &[Prior<f64>],
) -> SubsetSolutions<'s, f64, ROWS> {
    let mut solutions =
        SubsetSolutions::of(View::of(snapshot), std::boxed::Box::leak(std::boxed::Box::default()));
    solutions.prepare(priors);
    solutions
}

/// Pseudo-random numbers between 0 and 1 with a fixed seed.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A sky of three or four constellations with clocks of a kilometre.
struct Sky {
    epoch: Epoch,
    priors: Vec<Prior<f64>>,
    constellations: Vec<usize>,
}

fn sky(dice: &mut Dice, count: usize) -> Sky {
    let (mut epoch, mut priors, mut constellations) = (Epoch::new(), Vec::new(), Vec::new());
    let systems = 3 + (dice.roll() * 2.0) as usize;
    for index in 0..count {
        let (azimuth, up) = (dice.roll() * core::f64::consts::TAU, 0.1 + 0.9 * dice.roll());
        let level = (1.0 - up * up).sqrt();
        let constellation = index % systems;
        let sight = Vector3::new(level * azimuth.sin(), level * azimuth.cos(), up);
        let residual_m = 1000.0 * constellation as f64 + 4.0 * (dice.roll() - 0.5);
        let sigma_m = 0.5 + 2.0 * dice.roll();
        epoch.satellite(Constellation::ALL[constellation], sight, residual_m, sigma_m).expect("a row");
        priors.push(Prior { accuracy_m: 0.3 + dice.roll(), bias_m: dice.roll(), fault: 1e-5 });
        constellations.push(constellation);
    }
    Sky { epoch, priors, constellations }
}
