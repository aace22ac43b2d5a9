//! Angles of unit vectors against those that the vectors were made of.

use core::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use proptest::prelude::*;
use rai_core::numeric::angle::of_unit_vector;

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
