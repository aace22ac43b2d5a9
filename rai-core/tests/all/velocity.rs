//! Velocity from range rates: the true one, the excluded satellites, and cases without a velocity.
#![allow(clippy::expect_used, clippy::indexing_slicing)]

use nalgebra::Vector3;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::levels::KFactors;
use raim_core::internals::least_squares::Workspace;
use raim_core::internals::numeric::probability::Probability;
use raim_core::internals::numeric::real::Real;
use raim_core::internals::velocity::{RangeRate, Velocity, VelocityError, estimate};
use raim_core::satellite::{Constellation, SatelliteId};

use crate::sky::CAPACITY;

/// Ten satellites all around: azimuth and elevation in degrees.
const SKY: [(f64, f64); 10] = [
    (10.0, 20.0),
    (55.0, 65.0),
    (80.0, 15.0),
    (130.0, 35.0),
    (165.0, 70.0),
    (200.0, 25.0),
    (235.0, 50.0),
    (270.0, 12.0),
    (310.0, 40.0),
    (345.0, 80.0),
];

const VELOCITY: [f64; 3] = [12.5, -7.25, 0.5];
const DRIFT: f64 = -143.0;
const SIGMA: f64 = 0.05;

fn thresholds() -> Thresholds<'static> {
    let tail = |value| Probability::new(value).expect("a tail");
    Thresholds::from_tables(tail(3.33e-7), tail(1e-3)).expect("in the tables")
}

fn factors<T: Real>() -> KFactors<T> {
    let tail = |value| Probability::new(value).expect("a tail");
    KFactors::new(tail(1e-3), tail(1e-7))
}

fn direction(azimuth_deg: f64, elevation_deg: f64) -> Vector3<f64> {
    let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
    Vector3::new(azimuth.sin() * elevation.cos(), azimuth.cos() * elevation.cos(), elevation.sin())
}

/// Rates of the satellites, with a noise that is small against sigma, and systems that take turns.
fn rates(count: usize) -> Vec<RangeRate> {
    let systems = [Constellation::Gps, Constellation::Galileo, Constellation::Beidou];
    let noise = [0.3, -0.5, 0.1, 0.6, -0.2, -0.4, 0.5, 0.0, -0.6, 0.2];
    (0..count)
        .map(|index| {
            let line_of_sight = direction(SKY[index].0, SKY[index].1);
            let residual_m_s = DRIFT - line_of_sight.dot(&Vector3::from(VELOCITY)) + SIGMA * noise[index];
            let satellite = SatelliteId::new(systems[index % 3], index as u8 + 1).expect("a number");
            RangeRate { satellite, line_of_sight, residual_m_s, sigma_m_s: SIGMA }
        })
        .collect()
}

fn solve(rates: Vec<RangeRate>) -> Result<Velocity, VelocityError> {
    solve_and_show(rates).0
}

/// Returns the velocity, and the speed that the rates show although they fail the test, m/s.
fn solve_and_show(rates: Vec<RangeRate>) -> (Result<Velocity, VelocityError>, f32) {
    let single = |rate: RangeRate| RangeRate {
        satellite: rate.satellite,
        line_of_sight: rate.line_of_sight.map(|component| component as f32),
        residual_m_s: rate.residual_m_s as f32,
        sigma_m_s: rate.sigma_m_s as f32,
    };
    let (rates, mut shown_m_s) = (rates.into_iter().map(single), 0.0);
    let workspace = &mut Workspace::<f32, CAPACITY>::new();
    let velocity = estimate(workspace, rates, &thresholds(), &factors(), &mut shown_m_s);
    (velocity, shown_m_s)
}

#[track_caller]
fn assert_true(have: &Velocity) {
    for (have, want) in have.east_north_up_m_s.iter().zip(VELOCITY) {
        assert!((have - want).abs() < 0.1, "have {have}, want {want}");
    }
    assert!((have.drift_m_s - DRIFT).abs() < 0.1, "drift {}", have.drift_m_s);
}

#[test]
fn the_velocity_behind_the_rates_is_found_with_one_drift_for_all_systems() {
    let have = solve(rates(10)).expect("a velocity");
    assert_true(&have);
    assert_eq!((have.test.dof, have.excluded.len()), (6, 0), "ten rates less three components and one drift");
}

/// Compared with the dense least squares of the textbook: `(HᵀWH)⁻¹HᵀWy` with four unknowns.
#[test]
fn it_is_the_least_squares_of_the_textbook() {
    let rates = rates(9);
    let mut normal = nalgebra::Matrix4::zeros();
    let mut right = nalgebra::Vector4::zeros();
    for rate in &rates {
        let e = rate.line_of_sight;
        let row = nalgebra::Vector4::new(-e.x, -e.y, -e.z, 1.0);
        normal += row * row.transpose() / (rate.sigma_m_s * rate.sigma_m_s);
        right += row * rate.residual_m_s / (rate.sigma_m_s * rate.sigma_m_s);
    }
    let covariance = normal.try_inverse().expect("regular");
    let want = covariance * right;
    let workspace = &mut Workspace::<f64, CAPACITY>::new();
    let have = estimate(workspace, rates, &thresholds(), &factors(), &mut 0.0).expect("a velocity");
    for (index, have) in have.east_north_up_m_s.iter().enumerate() {
        assert!((have - want[index]).abs() < 1e-9, "have {have}, want {}", want[index]);
    }
    assert!((have.drift_m_s - want[3]).abs() < 1e-9);
    let diagonal = [have.covariance_m2_s2[0], have.covariance_m2_s2[3], have.covariance_m2_s2[5]];
    for (index, have) in diagonal.iter().enumerate() {
        let want = covariance[(index, index)];
        assert!((have / want - 1.0).abs() < 1e-9, "have {have}, want {want}");
    }
}

#[test]
fn a_fault_of_two_metres_a_second_is_found_whoever_has_it() {
    for faulty in 0..10 {
        let mut rates = rates(10);
        rates[faulty].residual_m_s += 2.0;
        let satellite = rates[faulty].satellite;
        let have = solve(rates).expect("a velocity without it");
        assert_eq!(have.excluded.as_slice(), [satellite]);
        assert_true(&have);
    }
}

/// With five satellites a fault is detected, but its satellite cannot be identified.
#[test]
fn what_cannot_be_isolated_gives_no_velocity() {
    let mut rates = rates(5);
    rates[2].residual_m_s += 5.0;
    assert_eq!(solve(rates), Err(VelocityError::Fault));
}

/// With six it is found, and the remaining five agree by chance too easily.
#[test]
fn exclusion_that_leaves_one_degree_of_freedom_gives_no_velocity() {
    for faulty in 0..6 {
        let mut rates = rates(6);
        rates[faulty].residual_m_s += 50.0;
        assert_eq!(solve(rates), Err(VelocityError::Fault), "row {faulty}");
    }
}

/// Returns the rates of a receiver, each wrong by this many sigmas, with the signs of a pattern.
fn noisy_rates(velocity_m_s: [f64; 3], sigmas: f64, signs: u32) -> Vec<RangeRate> {
    let slower = Vector3::from(VELOCITY) - Vector3::from(velocity_m_s);
    let mut rates = rates(10);
    for (index, rate) in rates.iter_mut().enumerate() {
        let error = if signs >> index & 1 == 1 { SIGMA } else { -SIGMA };
        rate.residual_m_s += rate.line_of_sight.dot(&slower) + sigmas * error;
    }
    rates
}

#[test]
fn noise_of_a_receiver_that_moves_is_no_fault_and_at_rest_it_is() {
    let count = |velocity_m_s, sigmas, error| {
        let refused = |signs: &u32| solve(noisy_rates(velocity_m_s, sigmas, *signs)).err() == Some(error);
        (0..1024).filter(refused).count()
    };
    let moving = |error| count(VELOCITY, 3.5, error);
    let at_rest = |error| count([0.0; 3], 3.5, error);
    assert_eq!(moving(VelocityError::Fault), 0);
    assert_eq!(at_rest(VelocityError::Noise), 0);
    assert!(moving(VelocityError::Noise) > 300);
    assert!(at_rest(VelocityError::Fault) > 300);
    assert!(count(VELOCITY, 40.0, VelocityError::Fault) > count(VELOCITY, 40.0, VelocityError::Noise));
}

#[test]
fn rates_that_fail_show_the_speed_that_their_errors_do_not_explain() {
    assert!(solve_and_show(rates(10)).1 <= 0.0, "they pass");
    let shown_m_s = |velocity_m_s, signs| solve_and_show(noisy_rates(velocity_m_s, 20.0, signs)).1;
    let speed_m_s = Vector3::from(VELOCITY).norm() as f32;
    let mut explained = 0;
    for signs in 0..1024 {
        let (moving_m_s, at_rest_m_s) = (shown_m_s(VELOCITY, signs), shown_m_s([0.0; 3], signs));
        // Those with equal signs have another drift, and pass.
        let passes = solve(noisy_rates(VELOCITY, 20.0, signs)).is_ok_and(|have| have.excluded.is_empty());
        assert!(passes || (moving_m_s - speed_m_s).abs() < 5.0, "{moving_m_s} of {signs:b}");
        assert!(at_rest_m_s < 5.0, "{at_rest_m_s} of {signs:b}");
        explained += usize::from(at_rest_m_s <= 0.0);
    }
    assert!(explained > 512, "{explained}");
}

#[test]
fn velocity_beyond_the_highest_speed_and_its_level_is_no_receiver_s() {
    let have = solve(rates(10)).expect("a velocity");
    let ground_m_s = VELOCITY[0].hypot(VELOCITY[1]);
    assert!(have.is_within(ground_m_s));
    assert!(!have.is_within(ground_m_s - have.levels_m_s.hpl_m - 0.1));
    let climbs = |up_m_s: f64| {
        let mut climbing = have.clone();
        climbing.east_north_up_m_s = [0.0, 0.0, up_m_s];
        climbing
    };
    assert!(climbs(-515.0).is_within(515.0) && !climbs(-520.0).is_within(515.0));
    assert!(!climbs(f64::NAN).is_within(515.0));
}

#[test]
fn four_rates_cannot_be_tested_and_three_determine_nothing() {
    assert_eq!(solve(rates(4)), Err(VelocityError::Redundancy));
    assert_eq!(solve(rates(3)), Err(VelocityError::Geometry));
    assert_eq!(solve(Vec::new()), Err(VelocityError::Geometry));
}

#[test]
fn what_is_no_number_is_left_aside() {
    for poison in [f64::NAN, f64::INFINITY] {
        let mut rates = rates(10);
        rates[0].residual_m_s = poison;
        rates[1].sigma_m_s = poison;
        rates[2].line_of_sight.x = poison;
        let have = solve(rates).expect("a velocity of the other seven");
        assert_true(&have);
        assert_eq!(have.test.dof, 3);
    }
}
