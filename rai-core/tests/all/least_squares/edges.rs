//! Rows that stand alone, rows that are left out, and directions that only one row measures.
#![allow(clippy::float_cmp)] // Exactly nothing and exactly all are meant.

use nalgebra::Vector3;
use raim_core::internals::least_squares::equations::{LinearEpoch, RowError};
use raim_core::internals::least_squares::{Snapshot, SnapshotError};
use raim_core::satellite::Constellation;

use crate::solved::solved;

use super::oracle::{self, Range};

fn range(azimuth_deg: f64, up: f64, constellation: Constellation, sigma_m: f64) -> Range {
    let (level, azimuth) = ((1.0_f64 - up * up).sqrt(), azimuth_deg.to_radians());
    let line_of_sight = [level * azimuth.sin(), level * azimuth.cos(), up];
    Range { line_of_sight, constellation, residual_m: 7.0 * azimuth.sin(), sigma_m }
}

fn solve<T: raim_core::internals::numeric::real::Real>(
    ranges: &[Range],
) -> Result<Snapshot<'static, T>, SnapshotError> {
    let mut epoch = LinearEpoch::new();
    for range in ranges {
        let line_of_sight = Vector3::from(range.line_of_sight);
        epoch.satellite(range.constellation, line_of_sight, range.residual_m, range.sigma_m).unwrap();
    }
    solved(epoch)
}

/// Returns seven ranges of GPS, well spread, of differing quality.
fn seven() -> Vec<Range> {
    let places =
        [(0.0, 0.2), (60.0, 0.7), (110.0, 0.3), (170.0, 0.5), (230.0, 0.9), (280.0, 0.25), (330.0, 0.6)];
    let sigmas_m = [1.0, 2.0, 3.0, 1.5, 2.5, 4.0, 0.7];
    places
        .iter()
        .zip(sigmas_m)
        .map(|(&(azimuth_deg, up), sigma_m)| range(azimuth_deg, up, Constellation::Gps, sigma_m))
        .collect()
}

#[test]
fn exactly_nothing_is_left_to_test_of_a_lone_satellite() {
    for step in 0..200_u8 {
        let sigma_m = 0.7 + 0.0317 * f64::from(step);
        let mut ranges = seven();
        ranges.push(range(33.0, 0.43, Constellation::Galileo, sigma_m));
        let (wide, narrow) = (solve::<f64>(&ranges).unwrap(), solve::<f32>(&ranges).unwrap());
        assert_eq!(wide.row(7).unwrap().1.redundancy, 0.0, "sigma {sigma_m} m");
        assert_eq!(narrow.row(7).unwrap().1.redundancy, 0.0, "sigma {sigma_m} m");
    }
}

#[test]
fn bias_of_a_row_left_out_shows_whole_even_beside_a_lone_one() {
    let mut ranges = seven();
    ranges.push(range(33.0, 0.43, Constellation::Galileo, 2.0));
    ranges.push(range(203.0, 0.63, Constellation::Galileo, 2.0));
    let mut snapshot = solve::<f64>(&ranges).unwrap();
    snapshot.leave_out(8).unwrap();
    assert_eq!(snapshot.row(8).unwrap().1.redundancy, 1.0);
    assert_eq!(snapshot.row(7).unwrap().1.redundancy, 0.0, "the other one is alone now");
}

#[test]
fn a_constellation_that_is_left_out_has_no_clock() {
    let mut ranges = seven();
    ranges.push(range(33.0, 0.43, Constellation::Galileo, 2.0));
    let mut snapshot = solve::<f64>(&ranges).unwrap();
    assert!(snapshot.clock_m(Constellation::Galileo).is_some());
    snapshot.leave_out(7).unwrap();
    for absent in [Constellation::Galileo, Constellation::Beidou] {
        assert!(!snapshot.determines(absent));
        assert_eq!((snapshot.clock_m(absent), snapshot.clock_variance(absent)), (None, None));
    }
}

#[test]
fn dilutions_are_those_of_the_rows_that_take_part() {
    let ranges = seven();
    for index in 0..7 {
        let mut snapshot = solve::<f64>(&ranges).unwrap();
        snapshot.leave_out(index).unwrap();
        let (want, (hdop, vdop)) = (oracle::solve_without(&ranges, &[index]).unwrap(), snapshot.dilutions());
        assert!((hdop / want.hdop - 1.0).abs() < 1e-9, "{index}: have {hdop}, want {}", want.hdop);
        assert!((vdop / want.vdop - 1.0).abs() < 1e-9, "{index}: have {vdop}, want {}", want.vdop);
    }
}

#[test]
fn a_row_that_a_position_needs_is_known_by_how_far_it_moves() {
    // Six on a cone of 64° elevation, and one below the horizon: half a metre per metre of its
    // bias, and needed.
    let mut ranges: Vec<Range> =
        (0..6_u8).map(|step| range(60.0 * f64::from(step), 0.9, Constellation::Gps, 1.0)).collect();
    ranges.push(range(20.0, -0.6, Constellation::Gps, 1.0));
    let snapshot = solve::<f64>(&ranges).unwrap();
    assert_eq!(snapshot.hdop_without(6), Some(f64::INFINITY));
    let one_of_the_cone = snapshot.hdop_without(2).unwrap();
    let want = oracle::solve_without(&ranges, &[2]).unwrap().hdop;
    assert!((one_of_the_cone / want - 1.0).abs() < 1e-9, "have {one_of_the_cone}, want {want}");
}

#[test]
fn a_singular_geometry_is_no_better_for_good_ranges() {
    // All but on a cone: the unweighted trace is beyond 2e5, the bound in f32, whatever the sigma.
    for sigma_m in [0.03, 0.1, 1.0, 10.0] {
        let on_cone = |step: u8| {
            let up = if step == 0 { 0.6 + 1.5e-3 } else { 0.6 };
            range(51.0 * f64::from(step), up, Constellation::Gps, sigma_m)
        };
        let ranges: Vec<Range> = (0..7).map(on_cone).collect();
        let trace = oracle::solve(&ranges).unwrap().covariance_m2.trace() / (sigma_m * sigma_m);
        assert!((4e5..4e7).contains(&trace), "{trace}");
        assert_eq!(solve::<f32>(&ranges).map(|_| ()), Err(SnapshotError::Singular), "sigma {sigma_m} m");
        assert!(solve::<f64>(&ranges).is_ok());
    }
}

#[test]
fn a_sigma_whose_weight_the_scalar_cannot_hold_is_refused() {
    let mut epoch = LinearEpoch::<f32, 20>::new();
    for sigma_m in [0.0, -1.0, 1e-30, 1e30, f64::NAN, f64::INFINITY, 1e-50, 1e50] {
        let have = epoch.satellite(Constellation::Gps, Vector3::z(), 0.0, sigma_m);
        assert_eq!(have, Err(RowError::Sigma), "{sigma_m}");
    }
    for sigma_m in [1e-15, 1.0, 1e15] {
        assert_eq!(epoch.satellite(Constellation::Gps, Vector3::z(), 0.0, sigma_m), Ok(()), "{sigma_m}");
    }
    assert_eq!(epoch.rows().len(), 3);
}
