//! Limits of a geometry: singular or not, untestable or not, with and without a satellite.

use nalgebra::Vector3;
use proptest::prelude::*;
use raim_core::internals::integrity::raim::levels::{hdop_change_limit, largest_hdop_change, largest_slopes};
use raim_core::internals::least_squares::equations::LinearEpoch;
use raim_core::internals::least_squares::{Snapshot, SnapshotError};
use raim_core::internals::numeric::real::Real;
use raim_core::satellite::Constellation;

use crate::solved::solved;

use super::oracle::{self, Range};

fn range((azimuth, up): (f64, f64), constellation: Constellation, sigma_m: f64) -> Range {
    let level = (1.0 - up * up).sqrt();
    Range {
        line_of_sight: [level * azimuth.sin(), level * azimuth.cos(), up],
        constellation,
        residual_m: 0.0,
        sigma_m,
    }
}

fn solve<T: Real>(ranges: &[Range]) -> Result<Snapshot<'static, T>, SnapshotError> {
    let mut epoch = LinearEpoch::new();
    for range in ranges {
        let line_of_sight = Vector3::from(range.line_of_sight);
        epoch.satellite(range.constellation, line_of_sight, range.residual_m, range.sigma_m).unwrap();
    }
    solved(epoch)
}

/// Satellites on a cone, one of which stands off it by `off` in the sine of its elevation.
fn nearly_a_cone(off: f64, constellations: usize, sigmas_m: &[f64]) -> Vec<Range> {
    let of = |(index, &sigma_m): (usize, &f64)| {
        let up = if index == 0 { 0.6 + off } else { 0.6 };
        range((0.83 * index as f64, up), Constellation::ALL[index % constellations], sigma_m)
    };
    sigmas_m.iter().enumerate().map(of).collect()
}

/// Returns `tr (HᵀH)⁻¹`, clocks included.
fn gdop_squared(ranges: &[Range]) -> f64 {
    let plain: Vec<Range> = ranges.iter().map(|range| Range { sigma_m: 1.0, ..*range }).collect();
    oracle::solve(&plain).map_or(f64::INFINITY, |solution| solution.covariance_m2.trace())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn a_geometry_is_singular_beyond_its_bound_whatever_the_weights(
        exponent in -3.5f64..-0.7,
        constellations in 1usize..=2,
        sigmas_m in prop::collection::vec(0.02f64..30.0, 7..10),
    ) {
        let ranges = nearly_a_cone(10f64.powf(exponent), constellations, &sigmas_m);
        let want = gdop_squared(&ranges);
        // 2e5 is the bound in f32, whose rounding may decide nearby.
        prop_assume!(!(0.8..1.25).contains(&(want / 2e5)));
        let have = solve::<f32>(&ranges).map(|_| ());
        prop_assert_eq!(have, if want < 2e5 { Ok(()) } else { Err(SnapshotError::Singular) }, "{}", want);
        prop_assert!(solve::<f64>(&ranges).is_ok(), "far from the bound in f64, 1e12");
    }

    #[test]
    fn slopes_are_those_of_the_gain_and_the_projection(
        directions in prop::collection::vec((0.0..std::f64::consts::TAU, 0.1f64..1.0, 0.5f64..9.0), 6..14),
    ) {
        let ranges: Vec<Range> =
            directions.into_iter().map(|(azimuth, up, sigma_m)| range((azimuth, up), Constellation::Gps, sigma_m)).collect();
        let dense = oracle::solve(&ranges);
        prop_assume!(dense.as_ref().is_some_and(|dense| dense.covariance_m2[(2, 2)] < 1e4));
        let (dense, snapshot) = (dense.unwrap(), solve::<f64>(&ranges).unwrap());
        let slope = |row: usize, axes: std::ops::Range<usize>| {
            let moved: f64 = axes.map(|axis| dense.gain[(axis, row)].powi(2)).sum();
            moved.sqrt() * ranges[row].sigma_m / dense.projection[(row, row)].sqrt()
        };
        let least = (0..ranges.len()).map(|row| dense.projection[(row, row)]).fold(1.0, f64::min);
        // The dense projection is off by some 1e-10, which counts by the smallest of it; rows that
        // are hardly tested at all are held to closed forms, in the properties of precision.
        prop_assume!(least > 1e-3);
        let largest = |axes: &dyn Fn(usize) -> f64| (0..ranges.len()).map(axes).fold(0.0, f64::max);
        let (want_h, want_v) = (largest(&|row| slope(row, 0..2)), largest(&|row| slope(row, 2..3)));
        let have = largest_slopes(&snapshot);
        prop_assert!((have.horizontal / want_h - 1.0).abs() < 1e-6, "{} {}", have.horizontal, want_h);
        prop_assert!((have.vertical / want_v - 1.0).abs() < 1e-6, "{} {}", have.vertical, want_v);
    }

    #[test]
    fn the_change_of_hdop_is_that_of_leaving_out(
        directions in prop::collection::vec((0.0..std::f64::consts::TAU, 0.1f64..1.0), 6..14),
    ) {
        let ranges: Vec<Range> =
            directions.into_iter().map(|direction| range(direction, Constellation::Gps, 3.0)).collect();
        let without = |index: usize| oracle::solve_without(&ranges, &[index]).map(|dense| dense.hdop);
        let all: Option<Vec<f64>> = (0..ranges.len()).map(without).collect();
        prop_assume!(all.as_ref().is_some_and(|all| all.iter().all(|hdop| *hdop < 50.0)));
        let (all, full) = (all.unwrap(), oracle::solve(&ranges).unwrap().hdop);
        let want = all.iter().map(|hdop| (hdop * hdop - full * full).sqrt()).fold(0.0, f64::max);
        let have = largest_hdop_change(&solve::<f64>(&ranges).unwrap());
        prop_assert!((have / want - 1.0).abs() < 1e-6, "{} {}", have, want);
    }
}

/// Returns four satellites and one above of another constellation. Without one of the four there is
/// no position.
fn barely_enough() -> Vec<Range> {
    let corners = [(0.0, 0.3), (1.6, 0.5), (3.2, 0.2), (4.7, 0.4)];
    let mut ranges: Vec<Range> = corners.map(|corner| range(corner, Constellation::Gps, 2.0)).to_vec();
    ranges.push(range((1.0, 0.9), Constellation::Beidou, 2.0));
    ranges
}

fn check_satellites_that_cannot_be_tested<T: Real>() {
    let snapshot = solve::<T>(&barely_enough()).unwrap();
    let (hdop, _) = snapshot.dilutions();
    for index in 0..4 {
        assert_eq!(snapshot.hdop_without(index).map(Real::widen), Some(f64::INFINITY), "{index} is needed");
    }
    // The lone satellite takes its clock with it.
    let lone = snapshot.hdop_without(4).unwrap();
    assert!((lone / hdop - T::one()).abs() < T::narrow(1e-6), "{lone} {hdop}");
    assert_eq!(snapshot.hdop_without(5), None);
    let slopes = largest_slopes(&snapshot);
    assert!(slopes.horizontal.widen().is_infinite() && slopes.vertical.widen().is_infinite());
}

#[test]
fn who_is_needed_has_an_infinite_slope_and_who_is_alone_none() {
    check_satellites_that_cannot_be_tested::<f64>();
    check_satellites_that_cannot_be_tested::<f32>();
}

#[test]
fn a_row_left_out_has_no_hdop_without_it() {
    let mut snapshot = solve::<f64>(&nearly_a_cone(0.3, 1, &[2.0; 8])).unwrap();
    assert!(snapshot.hdop_without(3).is_some());
    snapshot.leave_out(3).unwrap();
    assert_eq!(snapshot.hdop_without(3), None);
}

#[test]
fn the_limit_on_the_change_of_hdop_is_that_of_the_paper() {
    // 556 m over 5 m times 4.
    assert!((hdop_change_limit(556.0, 5.0, 16.0) - 27.8).abs() < 1e-12);
}

/// Satellites whose directions all lie in the plane across `normal`, and one that does not.
fn plane_and_one(normal: Vector3<f64>) -> Vec<Range> {
    let (across, along) = (normal.cross(&Vector3::z()).normalize(), normal);
    let in_plane = [20.0_f64, 50.0, 80.0, 110.0, 160.0].map(f64::to_radians);
    let mut ranges: Vec<Range> =
        in_plane.map(|angle| of_direction(across * angle.cos() + Vector3::z() * angle.sin())).to_vec();
    ranges.push(of_direction(along * 0.8 + Vector3::z() * 0.6));
    ranges
}

fn of_direction(direction: Vector3<f64>) -> Range {
    Range {
        line_of_sight: direction.into(),
        constellation: Constellation::Gps,
        residual_m: 0.0,
        sigma_m: 2.0,
    }
}

#[test]
fn a_bias_that_never_shows_has_an_infinite_slope_whichever_way_it_moves() {
    // Only the last satellite measures across the plane: its bias goes there undetected.
    for normal in [Vector3::x(), Vector3::y(), Vector3::new(-0.6, 0.8, 0.0)] {
        let slopes = largest_slopes(&solve::<f64>(&plane_and_one(normal)).unwrap());
        assert!(slopes.horizontal.is_infinite(), "{normal}: {}", slopes.horizontal);
    }
}

#[test]
fn a_bias_that_never_shows_and_hardly_moves_has_an_infinite_slope_too() {
    // On a cone about an axis that leans by 0.1 mrad, up and clock together move by that much to
    // the side.
    let axis = Vector3::new(1e-4, 0.0, 1.0).normalize();
    let (a, b) = (axis.cross(&Vector3::y()).normalize(), Vector3::y());
    let on_cone = |step: u32| {
        let angle = f64::from(step) * std::f64::consts::FRAC_PI_3;
        of_direction((axis * 0.5 + (a * angle.cos() + b * angle.sin()) * 0.75_f64.sqrt()).normalize())
    };
    let mut ranges: Vec<Range> = (0..6).map(on_cone).collect();
    ranges.push(of_direction(axis));
    let slopes = largest_slopes(&solve::<f64>(&ranges).unwrap());
    assert!(slopes.vertical.is_infinite() && slopes.horizontal.is_infinite(), "{}", slopes.horizontal);
}
