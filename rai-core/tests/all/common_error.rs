//! An error that all ranges share: the levels grow by its effect on the position.
#![allow(clippy::unwrap_used)]

use crate::sky::CAPACITY as N;
use raim_core::epoch::{Epoch, EpochError, Observation};
use raim_core::frame::{Ecef, Enu, Geodetic, LocalFrame};
use raim_core::internals::weighting::shared::SharedError;
use raim_core::monitor::Monitor;
use raim_core::report::Report;
use raim_core::requirements::Requirements;
use raim_core::satellite::{Constellation, SatelliteId};

/// Azimuth and elevation in degrees: more satellites in the south than in the north.
const SKY: [(f64, f64); 10] = [
    (10.0, 75.0),
    (80.0, 25.0),
    (120.0, 12.0),
    (150.0, 40.0),
    (180.0, 15.0),
    (200.0, 55.0),
    (230.0, 20.0),
    (280.0, 35.0),
    (300.0, 11.0),
    (350.0, 30.0),
];

fn receiver() -> Ecef {
    Geodetic { latitude_rad: 0.5, longitude_rad: 1.0, height_m: 100.0 }.to_ecef()
}

/// Returns a delay that grows towards the horizon, m.
fn delay_m(elevation_deg: f64) -> f64 {
    5.0 / (elevation_deg.to_radians().sin() + 0.3)
}

/// Returns the sky, delayed by a multiple of the common error, with or without its declaration.
fn epoch(multiple: f64, is_told: bool) -> Epoch<N> {
    let (receiver, mut epoch) = (receiver(), Epoch::new(0.0));
    let frame = LocalFrame::at(receiver);
    for (number, (azimuth_deg, elevation_deg)) in (1..).zip(SKY) {
        let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
        let direction = Enu {
            east: elevation.cos() * azimuth.sin(),
            north: elevation.cos() * azimuth.cos(),
            up: elevation.sin(),
        };
        let sight = frame.unrotate(direction);
        let position = Ecef::new(
            receiver.x_m + 2e7 * sight.x_m,
            receiver.y_m + 2e7 * sight.y_m,
            receiver.z_m + 2e7 * sight.z_m,
        );
        let rotation_m =
            7.2921151467e-5 / 299_792_458.0 * (position.x_m * receiver.y_m - position.y_m * receiver.x_m);
        let constellation = if number % 2 == 0 { Constellation::Gps } else { Constellation::Galileo };
        let observation = Observation {
            satellite: SatelliteId::new(constellation, number).unwrap(),
            position,
            range_m: 2e7 + rotation_m + multiple * delay_m(elevation_deg),
            sigma_m: 3.0 + delay_m(elevation_deg),
        };
        let common_m = if is_told { delay_m(elevation_deg) as f32 } else { 0.0 };
        epoch.push_sharing(observation, SharedError { common_m, slope_m: 0.0 }).unwrap();
    }
    epoch
}

fn judged(epoch: &Epoch<N>) -> Report<N> {
    let mut monitor = Monitor::<f64, N>::new(Requirements::non_precision_approach()).unwrap();
    monitor.start_from(receiver());
    monitor.process(epoch)
}

#[test]
fn levels_grow_by_three_times_what_one_sigma_moves_the_position() {
    let (silent, told) = (judged(&epoch(0.0, false)), judged(&epoch(0.0, true)));
    let moved = judged(&epoch(1.0, false)).solution.unwrap().position - silent.solution.unwrap().position;
    let moved = LocalFrame::at(receiver()).rotate(moved);
    let (before, after) = (silent.protection.unwrap(), told.protection.unwrap());
    let (horizontal_m, vertical_m) = (after.hpl_m - before.hpl_m, after.vpl_m - before.vpl_m);
    // The position is found in two steps, each linearised: a millimetre.
    assert!((horizontal_m - 3.0 * moved.horizontal()).abs() < 3e-3, "have {horizontal_m}, want {moved:?}");
    assert!((vertical_m - 3.0 * moved.up.abs()).abs() < 3e-3, "have {vertical_m}, want {moved:?}");
    assert!(vertical_m > 5.0, "it lifts: {vertical_m}");
}

/// Returns the move of the position by these errors of the ranges, m.
fn moved(errors_m: impl Fn(usize) -> f64) -> Enu {
    let mut displaced = Epoch::<N>::new(0.0);
    for (index, one) in epoch(0.0, false).observations().iter().enumerate() {
        displaced.push(Observation { range_m: one.range_m + errors_m(index), ..*one }).unwrap();
    }
    let from = judged(&epoch(0.0, false)).solution.unwrap().position;
    LocalFrame::at(receiver()).rotate(judged(&displaced).solution.unwrap().position - from)
}

#[test]
fn levels_cover_an_offset_and_two_slopes_within_three_sigmas() {
    let slope_m = |index: usize| 0.1 * (index as f64 + 1.0);
    let level = |index: usize| (SKY[index].0.to_radians(), SKY[index].1.to_radians().cos());
    let moves = [
        moved(|index| delay_m(SKY[index].1)),
        moved(|index| slope_m(index) * level(index).1 * level(index).0.sin()),
        moved(|index| slope_m(index) * level(index).1 * level(index).0.cos()),
    ];
    let mut told = Epoch::<N>::new(0.0);
    for (index, one) in epoch(0.0, false).observations().iter().enumerate() {
        let shared = SharedError { common_m: delay_m(SKY[index].1) as f32, slope_m: slope_m(index) as f32 };
        told.push_sharing(*one, shared).unwrap();
    }
    let (before, after) = (judged(&epoch(0.0, false)).protection.unwrap(), judged(&told).protection.unwrap());
    // The largest of all directions, to a degree.
    let along = |degrees: u32| {
        let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
        moves.iter().map(|moved| (moved.east * sine + moved.north * cosine).powi(2)).sum::<f64>().sqrt()
    };
    let horizontal_m = (0..180).map(along).fold(0.0, f64::max);
    let vertical_m = moves.iter().map(|moved| moved.up.powi(2)).sum::<f64>().sqrt();
    let (have, want) = (after.hpl_m - before.hpl_m, 3.0 * horizontal_m);
    assert!((have / want - 1.0).abs() < 1e-3, "have {have}, want {want}");
    let (have, want) = (after.vpl_m - before.vpl_m, 3.0 * vertical_m);
    assert!((have / want - 1.0).abs() < 1e-3, "have {have}, want {want}");
}

#[test]
fn a_shared_error_changes_neither_the_position_nor_the_test() {
    let (silent, told) = (judged(&epoch(0.7, false)), judged(&epoch(0.7, true)));
    assert_eq!(silent.solution, told.solution);
    assert_eq!(silent.test, told.test);
}

#[test]
fn a_shared_error_that_is_none_is_refused() {
    let observation = *epoch(0.0, false).observations().first().unwrap();
    for common_m in [-1.0, f32::NAN, f32::INFINITY] {
        let mut epoch = Epoch::<N>::new(0.0);
        for shared in
            [SharedError { common_m, slope_m: 0.0 }, SharedError { common_m: 0.0, slope_m: common_m }]
        {
            let refused = epoch.push_sharing(observation, shared);
            assert!(matches!(refused, Err(EpochError::Sigma(_))), "{common_m}");
            assert!(epoch.observations().is_empty() && epoch.shared().is_empty());
        }
    }
}
