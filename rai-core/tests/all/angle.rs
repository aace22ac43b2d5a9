//! Angles of unit vectors compared with those that the vectors were made of.

use core::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use proptest::prelude::*;
use raim_core::internals::numeric::angle::{arc_sine, of_unit_vector, sine};
use raim_core::internals::numeric::real::Real as _;

/// Less than 10 µm on the ground.
const WITHIN_RAD: f64 = 1.6e-12;

proptest! {
    #[test]
    fn an_angle_comes_back_from_its_sine_and_cosine(angle_rad in -PI..PI) {
        let have_rad = of_unit_vector(angle_rad.sin(), angle_rad.cos());
        prop_assert!((have_rad - angle_rad).abs() < WITHIN_RAD, "{have_rad} for {angle_rad}");
    }

    #[test]
    fn whatever_comes_in_there_is_an_answer(sine in any::<f64>(), cosine in any::<f64>()) {
        let _ = of_unit_vector(sine, cosine);
    }
}

#[test]
fn a_sine_is_that_of_a_quarter_turn_at_most() {
    for step in -1000..=1000 {
        let angle_rad = step as f32 * 1e-3 * core::f32::consts::FRAC_PI_2;
        let want = f64::from(angle_rad).sin();
        assert!((f64::from(sine(angle_rad)) - want).abs() <= 2e-7 * want.abs(), "{angle_rad}");
        if step >= 0 {
            let (_, cosine) = angle_rad.sine_and_cosine();
            let want = f64::from(angle_rad).cos();
            assert!((f64::from(cosine) - want).abs() <= 2e-7 * want.abs(), "{angle_rad}");
        }
    }
    assert_eq!((sine(7.0), sine(-1e30)), (sine(core::f32::consts::FRAC_PI_2), -sine(f32::INFINITY)));
    assert!(sine(f32::NAN).is_nan());
}

#[test]
fn an_arc_sine_is_that_of_a_sine_between_both_ends() {
    for step in -100_000..=100_000 {
        let sine = step as f32 * 1e-5;
        let want = f64::from(sine).asin();
        assert!((f64::from(arc_sine(sine)) - want).abs() <= 2e-7, "{sine}");
    }
    assert_eq!((arc_sine(1.5), arc_sine(f32::NEG_INFINITY)), (arc_sine(1.0), -arc_sine(1.0)));
    assert!(arc_sine(f32::NAN).is_nan());
}

#[test]
fn borders_of_octants_and_of_known_directions() {
    for eighth in -8..=8 {
        let border_rad = f64::from(eighth) * FRAC_PI_4;
        for aside_rad in [-1e-9, 0.0, 1e-9] {
            let angle_rad = border_rad + aside_rad;
            let turned = of_unit_vector(angle_rad.sin(), angle_rad.cos()) - angle_rad;
            assert!((turned - (turned / (2.0 * PI)).round() * 2.0 * PI).abs() < WITHIN_RAD, "{angle_rad}");
        }
    }
    for half_step in 0..=64 {
        let angle_rad = f64::from(half_step) * PI / 64.0;
        assert!(
            (of_unit_vector(angle_rad.sin(), angle_rad.cos()) - angle_rad).abs() < WITHIN_RAD,
            "{angle_rad}"
        );
    }
}

#[test]
fn the_axes_are_exact() {
    assert_eq!(of_unit_vector(0.0, 1.0).to_bits(), 0.0_f64.to_bits());
    assert_eq!(of_unit_vector(1.0, 0.0).to_bits(), FRAC_PI_2.to_bits());
    assert_eq!(of_unit_vector(0.0, -1.0).to_bits(), PI.to_bits());
    assert_eq!(of_unit_vector(-1.0, 0.0).to_bits(), (-FRAC_PI_2).to_bits());
}
