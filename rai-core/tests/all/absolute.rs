//! Lengths on the grid beside `f32`, against exact integers, over the whole range of what a
//! position or a range can be.

#![allow(clippy::float_cmp, reason = "steps of the grid are exact")]

use proptest::prelude::*;
use raim_core::internals::numeric::absolute::{Absolute, Grid};

/// Step of the grid, m.
const STEP_M: f64 = 1.0 / 16_384.0;

/// Returns the root of a sum of squares of multiples of the step, to a thousandth of one: by
/// integers of 128 bits.
fn length_m(coordinates: [f64; 3]) -> f64 {
    const FINER: f64 = 1024.0;
    let squares = coordinates.map(|metres| ((metres / STEP_M * FINER) as i128).pow(2));
    squares.iter().sum::<i128>().isqrt() as f64 / FINER * STEP_M
}

fn on_grid(metres: f64) -> f64 {
    (metres / STEP_M).round() * STEP_M
}

fn length_on_grid_m(coordinates: [f64; 3]) -> f64 {
    let length = Grid::length(coordinates.map(Grid::of));
    length.whole.widen() + f64::from(length.rest)
}

/// Returns the tolerance, m: the rounding of the rest, 2⁻²⁴ of some metres, and `ρ²/2D`.
fn tolerance_m(length_m: f64) -> f64 {
    let rest_m = 0.125 + 8e-7 * length_m;
    2e-7 * rest_m + rest_m * rest_m / (2.0 * length_m) + 2e-6
}

proptest! {
    #[test]
    fn a_length_is_that_of_exact_integers(
        x in -1.15e8..1.15e8_f64,
        y in -1.15e8..1.15e8_f64,
        z in -1.15e8..1.15e8_f64,
    ) {
        let vector = [x, y, z].map(on_grid);
        let want_m = length_m(vector);
        prop_assume!(want_m > 1e3);
        let have_m = length_on_grid_m(vector);
        prop_assert!((have_m - want_m).abs() <= tolerance_m(want_m), "{have_m} for {want_m}");
    }

    #[test]
    fn a_satellites_distance_is_right_to_a_hundredth_of_a_millimetre(
        direction in prop::array::uniform3(-1.0..1.0_f64),
        length_m in 1.9e7..4.8e7_f64,
    ) {
        let norm = direction.iter().map(|part| part * part).sum::<f64>().sqrt();
        prop_assume!(norm > 0.1);
        let vector = direction.map(|part| on_grid(part / norm * length_m));
        prop_assert!((length_on_grid_m(vector) - self::length_m(vector)).abs() < 1e-5);
    }

    #[test]
    fn a_number_is_rounded_to_the_nearest_step(metres in -1e9..1e9_f64) {
        prop_assert!((Grid::of(metres).widen() - metres).abs() <= STEP_M / 2.0);
        prop_assert_eq!(Grid::of(-metres).widen(), -Grid::of(metres).widen());
    }

    #[test]
    fn a_vector_is_in_metres_and_its_units_are_what_they_say(
        coordinates in prop::array::uniform3(-1.15e8..1.15e8_f64),
    ) {
        /// Error of a coordinate: its step, and the rounding to 24 digits.
        const ERROR_M: f64 = 0.125 + 1.15e8 / (1 << 24) as f64;
        let vector = coordinates.map(Grid::of);
        let unit_m = <Grid as Absolute<f32>>::UNIT_M;
        let parts = Grid::vector(vector).into_iter().zip(Grid::units(vector));
        for ((part_m, units), want_m) in parts.zip(coordinates) {
            prop_assert!((f64::from(part_m) - want_m).abs() <= ERROR_M, "{part_m} for {want_m}");
            prop_assert_eq!(units * unit_m, part_m);
        }
        let length = Grid::length(vector);
        let length_m = f64::from(length.rounded * unit_m);
        prop_assert!((length_m - length.whole.widen()).abs() <= ERROR_M, "{length:?}");
    }

    #[test]
    fn whatever_comes_in_is_some_number(bits in prop::array::uniform3(any::<u64>())) {
        let vector = bits.map(f64::from_bits).map(Grid::of);
        let length = Grid::length(vector);
        prop_assert!(length.whole.widen().is_finite() && length.rest.is_finite());
        prop_assert!(Grid::vector(vector).iter().all(|part| part.is_finite()));
        let [a, b, _] = vector;
        prop_assert!(a.less(b).narrow().is_finite());
    }
}

#[test]
fn the_longest_vectors_do_not_wrap() {
    let side_m = Grid::LONGEST_M / f64::sqrt(3.0);
    for vector in [[Grid::LONGEST_M, 0.0, 0.0], [0.0, -Grid::LONGEST_M, 0.0], [side_m, -side_m, side_m]] {
        let vector = vector.map(on_grid);
        let want_m = length_m(vector);
        assert!((length_on_grid_m(vector) - want_m).abs() <= tolerance_m(want_m), "{vector:?}");
    }
}

#[test]
fn borders_of_the_grid() {
    assert_eq!(Grid::of(0.0).widen(), 0.0);
    assert_eq!(Grid::of(STEP_M).widen(), STEP_M);
    assert_eq!(Grid::of(STEP_M / 2.0).widen(), STEP_M, "halves go away from zero");
    assert_eq!(Grid::of(STEP_M / 2.0 - 1e-12).widen(), 0.0);
    assert_eq!(Grid::of(f64::MIN_POSITIVE).widen(), 0.0);
    assert_eq!(Grid::of(4.9e-324).widen(), 0.0, "subnormal");
    let largest_m = Grid::of(f64::MAX).widen();
    assert!(largest_m > 1e11);
    assert_eq!(Grid::of(f64::INFINITY).widen(), largest_m);
    assert_eq!(Grid::of(f64::NEG_INFINITY).widen(), -largest_m);
    assert_eq!(Grid::of(f64::NAN).widen().abs(), largest_m);
    // The last number below saturation, and the first of it.
    assert_eq!(Grid::of(largest_m - STEP_M).widen(), largest_m - STEP_M);
    assert_eq!(Grid::of(largest_m).widen(), largest_m);
    assert_eq!(Grid::of(largest_m * 1.5).widen(), largest_m);
}

#[test]
fn doubles_stay_what_they_are() {
    assert_eq!(<f64 as Absolute<f64>>::of(0.1), 0.1);
    assert_eq!(f64::length([3.0, 4.0, 12.0]).whole, 13.0);
    assert_eq!(f64::length([3.0, 4.0, 12.0]).rest, 0.0);
}

proptest! {
    #[test]
    fn a_finer_multiple_becomes_the_nearest_of_the_grid(units in -(1_i64 << 62)..1 << 62, digits in 15_u32..40) {
        let step = 1_i128 << (digits - 14);
        let want = (i128::from(units) + step / 2).div_euclid(step);
        let have = Grid::of_multiple(units, digits).widen() / STEP_M;
        // Doubles hold 53 bits of it.
        prop_assert!((have - want as f64).abs() <= want.unsigned_abs() as f64 * f64::EPSILON, "{have}, not {want}");
    }

    #[test]
    fn every_length_of_the_grid_is_exact_in_metres(steps in -(1_i64 << 52)..1 << 52, bits in 0..52) {
        let steps = steps >> bits;
        let have_m = Grid::of_multiple(steps << 1, 15).widen();
        prop_assert_eq!(have_m.to_bits(), (steps as f64 * STEP_M).to_bits());
    }
}
