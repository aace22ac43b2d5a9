//! Single precision protects no more than double precision does. It may protect less, and gives up
//! first.

use nalgebra::Vector3;
use proptest::prelude::*;
use raim_core::internals::integrity::raim::levels::largest_slopes;
use raim_core::internals::least_squares::Snapshot;
use raim_core::internals::least_squares::equations::{LinearEpoch, MAX_ROWS};
use raim_core::internals::numeric::real::Real;
use raim_core::satellite::Constellation;

use crate::solved::solved;

use super::skies::{Sky, any_sky};

/// Largest slope that is compared, m: a protection level of some 700 m.
const LARGEST_SLOPE_M: f64 = 100.0;

/// Largest relative error of a sum of squares: as near a threshold no decision is compared.
const LARGEST_ERROR: f64 = 2e-2;

fn slopes_are_not_understated(sky: &Sky) -> Result<(), TestCaseError> {
    let single = solved::<f32>(sky.linearised(1.0));
    let double = solved::<f64>(sky.linearised(1.0));
    let (Ok(single), Ok(double)) = (single, double) else { return Ok(()) };
    let (hdop, vdop) = double.dilutions();
    if double.dof() == 0 || hdop.max(vdop) > 20.0 {
        return Ok(());
    }
    let (have, want) = (largest_slopes(&single), largest_slopes(&double));
    let slopes = [(have.horizontal, want.horizontal), (have.vertical, want.vertical)];
    for (have, want) in slopes.map(|(have, want)| (f64::from(have), want)) {
        let is_understated = want < LARGEST_SLOPE_M && have < 0.97 * want;
        prop_assert!(!is_understated, "have {}, want {}", have, want);
    }
    Ok(())
}

/// One satellite: its offset from the axis of a cone, `ln σ`, its noise in units of sigma, its
/// system.
type Draw = ([f64; 3], f64, f64, usize);

/// Returns satellites within a cone, so that the geometry is arbitrarily bad, some at one place.
///
/// The second one is wrong.
fn in_a_cone<T: Real>(draws: &[Draw], width: f64, bias_m: f64, systems: usize) -> LinearEpoch<T, MAX_ROWS> {
    let mut epoch = LinearEpoch::new();
    for (index, ([x, y, z], ln_sigma, noise, system)) in draws.iter().enumerate() {
        let direction = (Vector3::new(0.5, 0.3, 0.8) + Vector3::new(*x, *y, *z) * width).normalize();
        let sigma_m = ln_sigma.exp();
        let residual_m = noise * sigma_m + if index == 1 { bias_m } else { 0.0 };
        epoch.satellite(Constellation::ALL[system % systems], direction, residual_m, sigma_m).unwrap();
    }
    epoch
}

fn any_draws() -> impl Strategy<Value = Vec<Draw>> {
    let offset = prop_oneof![Just([0.5; 3]), [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0]];
    proptest::collection::vec((offset, -0.7..3.4_f64, -2.0..2.0_f64, 0..4_usize), 4..14)
}

/// Checks that a sum of squares has its digits wherever a level bounds every satellite.
///
/// Without a bound nothing is promised, because the geometry is unavailable.
fn sums_have_their_digits(
    draws: &[Draw],
    width: f64,
    bias_m: f64,
    systems: usize,
) -> Result<(), TestCaseError> {
    let single = solved::<f32>(in_a_cone(draws, width, bias_m, systems));
    let double = solved::<f64>(in_a_cone(draws, width, bias_m, systems));
    let (Ok(single), Ok(double)) = (single, double) else { return Ok(()) };
    let slopes = largest_slopes(&single);
    if single.dof() == 0 || !(slopes.horizontal.is_finite() && slopes.vertical.is_finite()) {
        return Ok(());
    }
    let (have, want) = (f64::from(single.sse()), double.sse());
    prop_assert!((have - want).abs() <= LARGEST_ERROR * want.max(1.0), "have {}, want {}", have, want);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn sums_of_squares_in_single_precision_have_their_digits(
        draws in any_draws(), decades in -4.0..0.3_f64, bias_decades in 0.0..5.0_f64, systems in 1..4_usize,
    ) {
        sums_have_their_digits(&draws, 10_f64.powf(decades), 10_f64.powf(bias_decades) - 1.0, systems)?;
    }

    #[test]
    fn slopes_in_single_precision_are_not_understated(sky in any_sky(0)) {
        slopes_are_not_understated(&sky)?;
    }
}

/// Returns two satellites that are good to 0.5 m among four that are good to 30 m.
fn two_precise_ones<T: Real>() -> Snapshot<'static, T> {
    let directions_deg = [
        (10.0, 75.0, 30.0),
        (50.0, 20.0, 0.5),
        (110.0, 45.0, 30.0),
        (160.0, 15.0, 30.0),
        (200.0, 60.0, 30.0),
        (250.0, 25.0, 0.5),
    ];
    let mut epoch = LinearEpoch::new();
    for (azimuth_deg, elevation_deg, sigma_m) in directions_deg {
        let (azimuth, elevation) = (f64::to_radians(azimuth_deg), f64::to_radians(elevation_deg));
        let (east, north) = (azimuth.sin() * elevation.cos(), azimuth.cos() * elevation.cos());
        let direction = Vector3::new(east, north, elevation.sin());
        epoch.satellite(Constellation::Gps, direction, 0.0, sigma_m).unwrap();
    }
    solved(epoch).unwrap()
}

/// The redundancy numbers must not be `1 − h`: in single precision, a difference of 2e-5 made the
/// slope a fifth too small.
#[test]
fn a_precise_satellite_that_is_hardly_tested_has_its_whole_slope() {
    let have = f64::from(largest_slopes(&two_precise_ones::<f32>()).horizontal);
    let want = largest_slopes(&two_precise_ones::<f64>()).horizontal;
    assert!((59.0..60.0).contains(&want), "{want} m");
    assert!((have / want - 1.0).abs() < 1e-4, "have {have}, want {want}");
}
