//! The tail of the normal distribution and its inverse, against values computed with fifty digits.

#![allow(clippy::expect_used, reason = "a test may panic")]

use raim_core::internals::numeric::normal::{quantile, tail};
use raim_core::internals::numeric::real::Real;

/// The file describes the computation of its values.
const GOLD: &str = include_str!("../../../tests-host/vectors/normal.csv");

/// Returns the argument and value of one function.
fn gold(function: &str) -> Vec<(f64, f64)> {
    let rows = GOLD.lines().filter_map(|line| line.strip_prefix(function)?.strip_prefix(','));
    let numbers = |row: &str| {
        let (argument, value) = row.split_once(',').expect("two columns");
        (argument.parse().expect("a number"), value.parse().expect("a number"))
    };
    rows.map(numbers).collect()
}

/// Compares every value within a relative error; prints the largest.
fn agree<T: Real>(function: &str, within: f64, have: impl Fn(T) -> T) {
    let rows = gold(function);
    assert!(rows.len() > 150, "{} values of {function}", rows.len());
    let mut worst = 0f64;
    for (argument, want) in rows {
        let have = have(T::narrow(argument)).widen();
        let error = ((have - want) / want).abs();
        assert!(error <= within, "{function}({argument:e}): have {have:e}, want {want:e}");
        worst = worst.max(error);
    }
    println!("{function}: relative error at most {worst:.1e}");
}

#[test]
fn tails_keep_their_digits_in_both_precisions() {
    agree::<f64>("tail", 1e-13, |u| tail(u).probability);
    agree::<f32>("tail", 1e-6, |u| tail(u).probability);
}

#[test]
fn quantiles_keep_their_digits_in_both_precisions() {
    agree::<f64>("quantile", 1e-13, quantile);
    agree::<f32>("quantile", 1e-6, quantile);
}

/// The density is the closed form `exp(−u²/2)/√(2π)`.
#[test]
fn the_density_is_that_of_the_closed_form() {
    for step in 0..=88 {
        let u = f64::from(step) / 8.0;
        let want = (-0.5 * u * u).exp() / (2.0 * std::f64::consts::PI).sqrt();
        let (double, single) = (tail(u).density, f64::from(tail(u as f32).density));
        assert!((double / want - 1.0).abs() < 1e-13, "φ({u}): have {double:e}, want {want:e}");
        assert!((single / want - 1.0).abs() < 1e-6, "φ({u}): have {single:e}, want {want:e}");
    }
}

#[test]
fn what_is_outside_fails_safe() {
    for u in [f32::NAN, -1.0, f32::NEG_INFINITY] {
        assert!((tail(u).probability - 0.5).abs() < 1e-7, "Q({u}) = {}", tail(u).probability);
    }
    for u in [13.0, 1e9, f32::INFINITY] {
        assert!(tail(u).probability.abs() < f32::MIN_POSITIVE);
    }
    for p in [0.0, -1.0, f32::NAN] {
        assert!(quantile(p).is_infinite(), "Q⁻¹({p}) = {}", quantile(p));
    }
    for p in [0.5, 0.7, 1.0, f32::INFINITY] {
        assert!(quantile(p).abs() < f32::MIN_POSITIVE, "Q⁻¹({p}) = {}", quantile(p));
    }
}

/// At the seam of two expressions, one does not fall below the other.
#[test]
fn tails_fall_from_each_single_to_the_next() {
    let mut last = tail(0.0f32).probability;
    for step in 1..=12_800 {
        let u = step as f32 / 1000.0;
        let here = tail(u).probability;
        assert!(here < last, "Q({u}) = {here:e}, before it {last:e}");
        last = here;
    }
}
