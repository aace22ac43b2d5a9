//! χ² distributions against values of multiple precision, at every kind of argument.
//!
//! The values come from the Poisson mixture of central distributions and bisection, in 35 digits,
//! with another program (mpmath); the densities of the crossings from the hypergeometric function
//! ₀F₁.
#![allow(clippy::unwrap_used, clippy::excessive_precision)]

use raim_core::internals::numeric::chi_square::ChiSquare;
use raim_core::internals::numeric::probability::Probability;
use raim_core::internals::numeric::real::Real;

/// The relative errors that the functions declare, in double and in single precision.
const DECLARED: (f64, f64) = (3e-11, 3e-5);

/// Degrees of freedom, non-centrality, probability, statistic below which it stays.
const QUANTILES: [(usize, f64, f64, f64); 15] = [
    (1, 0.5, 1e-3, 2.5898064337737435e-6),
    (1, 60.0, 1e-3, 21.675862675282918),
    (1, 900.0, 1e-6, 637.3895841303345),
    (2, 0.01, 1e-4, 0.00020101255484108874),
    (2, 25.0, 1e-3, 4.25703899620198),
    (3, 10.0, 1e-5, 0.031012479045517852),
    (4, 80.0, 1e-3, 36.69035325178227),
    (5, 40.0, 1e-6, 4.420481291120956),
    (7, 0.2, 1e-3, 0.6158231994789207),
    (10, 100.0, 1e-4, 46.5699536187222),
    (16, 30.0, 1e-3, 15.961213531106822),
    (25, 250.0, 1e-5, 153.8205981658085),
    (40, 60.0, 1e-3, 52.61849987289458),
    (60, 3.0, 1e-6, 22.51020668803301),
    (60, 500.0, 1e-3, 426.1617337460065),
];

/// Degrees of freedom, statistic, probability of staying below, non-centrality.
const NONCENTRALITIES: [(usize, f64, f64, f64); 12] = [
    (1, 26.0, 1e-3, 67.06384536745227),
    (1, 8.0, 1e-6, 57.48447116071365),
    (2, 30.0, 1e-3, 72.1559096612076),
    (3, 12.0, 1e-4, 48.75218124148472),
    (4, 39.5, 1e-3, 84.23872117297809),
    (6, 45.0, 1e-5, 114.05188594066635),
    (10, 20.0, 1e-3, 45.464537994736006),
    (16, 70.0, 1e-6, 153.41537894001192),
    (25, 40.0, 1e-3, 59.168551998753394),
    (40, 120.0, 1e-4, 170.08978934870012),
    (60, 150.0, 1e-3, 168.99834654675874),
    (60, 61.0, 1e-6, 82.2554699716148),
];

/// Degrees of freedom, non-centrality, logarithm of the ratio of the densities, statistic where
/// they have it.
const CROSSINGS: [(usize, f64, f64, f64); 10] = [
    (1, 4.0, 0.0, 1.8070571243385865),
    (1, 900.0, 0.0, 225.69368101724208),
    (2, 30.0, 1.5, 11.88334403958444),
    (3, 0.5, 0.0, 3.150628921080958),
    (5, 60.0, -2.0, 20.089333054243372),
    (10, 100.0, 0.0, 40.695576831076565),
    (16, 9.0, 0.7, 23.38174200151326),
    (30, 250.0, 0.0, 109.84529875420174),
    (60, 40.0, -5.0, 54.84191444070265),
    (60, 2000.0, 3.0, 627.2667992973373),
];

fn of<T: Real>(dof: usize) -> ChiSquare<T> {
    ChiSquare::new(dof).unwrap()
}

fn probability(tail: f64) -> Probability {
    Probability::new(tail).unwrap()
}

fn assert_close(what: &str, double: f64, single: f64, want: f64) {
    for (have, declared) in [(double, DECLARED.0), (single, DECLARED.1)] {
        assert!((have / want - 1.0).abs() <= declared, "{what}: have {have:e}, want {want:e}");
    }
}

#[test]
fn quantiles_are_as_good_as_declared() {
    for (dof, noncentrality, tail, want) in QUANTILES {
        let tail = probability(tail);
        let (double, single) =
            (of::<f64>(dof).quantile(tail, noncentrality), of::<f32>(dof).quantile(tail, noncentrality));
        assert_close(&format!("{dof} {noncentrality}"), double, single.widen(), want);
    }
}

#[test]
fn noncentralities_are_as_good_as_declared() {
    for (dof, statistic, tail, want) in NONCENTRALITIES {
        let tail = probability(tail);
        let (double, single) =
            (of::<f64>(dof).noncentrality(statistic, tail), of::<f32>(dof).noncentrality(statistic, tail));
        assert_close(&format!("{dof} {statistic}"), double, single.widen(), want);
    }
}

#[test]
fn crossings_are_as_good_as_declared() {
    for (dof, noncentrality, ln_ratio, want) in CROSSINGS {
        let (double, single) = (
            of::<f64>(dof).crossing(noncentrality, ln_ratio),
            of::<f32>(dof).crossing(noncentrality, ln_ratio),
        );
        assert_close(&format!("{dof} {noncentrality}"), double, single.widen(), want);
    }
}
