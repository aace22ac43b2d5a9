//! Two systems that agree within themselves on places far apart, one of them with two satellites:
//! no exclusion decides between them.

use std::prelude::rust_2024::*;
use std::println;

use nalgebra::Vector3;

use super::super::{Allocation, AraimOutcome, Prior, Priors, ROWS, judge};
use super::Dice;
use crate::least_squares::Workspace;
use crate::least_squares::equations::LinearEpoch;
use crate::numeric::real::Real;
use crate::satellite::Constellation;

/// Distance between the places, m.
const APART_M: f64 = 4e5;

/// Returns the outcome of a sky in which eight GPS satellites agree on another place than the
/// others do, of which there are so many of Galileo and of `BeiDou`.
fn outcome<T: Real>(seed: u64, galileo: usize, beidou: usize, odd_m: f64) -> AraimOutcome<T> {
    let mut dice = Dice(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let direction = dice.roll() * core::f64::consts::TAU;
    let away_m = Vector3::new(APART_M * direction.sin(), APART_M * direction.cos(), 0.0);
    let mut epoch = LinearEpoch::<T, ROWS>::new();
    let systems =
        [(Constellation::Gps, 8), (Constellation::Galileo, galileo), (Constellation::Beidou, beidou)];
    let mut priors = Vec::new();
    for (constellation, count) in systems {
        for index in 0..count {
            let (azimuth, up) = (dice.roll() * core::f64::consts::TAU, 0.2 + 0.8 * dice.roll());
            let level = (1.0 - up * up).sqrt();
            let sight = Vector3::new(level * azimuth.sin(), level * azimuth.cos(), up);
            let noise_m = dice.roll() + dice.roll() + dice.roll() - 1.5;
            let moved_m = match constellation {
                Constellation::Gps if odd_m == 0.0 => -sight.dot(&away_m),
                Constellation::Galileo if index == 0 => odd_m,
                _ => 0.0,
            };
            epoch.satellite(constellation, sight, noise_m + moved_m, 1.5).expect("a row");
            priors.push(Prior { accuracy_m: T::narrow(1.2), bias_m: T::zero(), fault: T::narrow(1e-5) });
        }
    }
    let mut workspace = Workspace::of(epoch);
    let mut snapshot = workspace.solve().expect("a position");
    let priors = Priors { satellites: &priors, constellations: [1e-8, 1e-4, 1e-4, 1e-4].map(T::narrow) };
    judge(&mut snapshot, &priors, &Allocation::horizontal()).expect("a judgement").outcome
}

/// Returns the number of skies, of 100, in which something is left out.
fn left_out<T: Real>(galileo: usize, beidou: usize, odd_m: f64) -> usize {
    let is_left_out =
        |&seed: &u64| matches!(outcome::<T>(seed, galileo, beidou, odd_m), AraimOutcome::Excluded { .. });
    (0..100).filter(is_left_out).count()
}

/// With three satellites or more the support message decides, which holds GPS for a thousand times
/// likelier to be right.
#[test]
fn two_satellites_of_a_system_are_not_outvoted_by_another_system() {
    let counts = [left_out::<f32>(2, 0, 0.0), left_out::<f64>(2, 0, 0.0)];
    println!("eight GPS satellites elsewhere, two of Galileo: {counts:?} of 100 skies promised");
    assert_eq!(counts, [0, 0]);
}

#[test]
fn a_third_system_decides() {
    for galileo in 2..=3 {
        let counts = [left_out::<f32>(galileo, 8, 300.0), left_out::<f64>(galileo, 8, 300.0)];
        println!(
            "one of {galileo} Galileo satellites 300 m off, GPS and BeiDou agree: {counts:?} of 100 skies"
        );
        assert!(counts.iter().all(|&count| count >= 95), "{counts:?}");
    }
}
