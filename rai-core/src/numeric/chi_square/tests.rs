//! Tests of the starting values: a step from them costs as much as an integral, so that they must
//! be accurate.

use super::*;

fn of(dof: usize) -> ChiSquare<f64> {
    ChiSquare::new(dof).expect("within the tables")
}

fn assert_close(what: &str, have: f64, want: f64, relative: f64) {
    assert!((have / want - 1.0).abs() <= relative, "{what}: have {have}, want {want}");
}

#[test]
fn normal_power_is_that_of_the_paper() {
    // [Sankaran1963], computed in 25 digits.
    let cases = [
        (3, 2.0, [7.0, 0.421_487_603_305_785_1, 0.942_696_433_344_154_4, 0.287_271_731_004_233_6]),
        (16, 5.0, [41.0, 0.428_986_838_077_747_2, 0.990_297_292_256_708_4, 0.120_598_482_231_064_3]),
    ];
    for (dof, mean, [expectation, power, centre, deviation]) in cases {
        let have = of(dof).nearly_normal(mean);
        assert_close("expectation", have.expectation, expectation, 1e-14);
        assert_close("power", have.power, power, 1e-14);
        assert_close("centre", have.centre, centre, 1e-14);
        assert_close("deviation", have.deviation, deviation, 1e-14);
    }
}

#[test]
fn normal_quantile_is_as_good_as_the_handbook_says() {
    let cases = [
        (0.1, 1.281_551_565_544_600_5),
        (1e-3, 3.090_232_306_167_813_5),
        (1e-6, 4.753_424_308_822_899),
        (1e-8, 5.612_001_244_174_789),
    ];
    for (tail, want) in cases {
        let have = normal_quantile(libm::log(tail));
        assert!((have - want).abs() < 4.5e-4, "{tail}: have {have}, want {want}");
    }
}

/// Relative accuracy of a guess, which two Newton steps in `f64`, one in `f32`, complete.
const NEAR: f64 = 1e-2;

/// Degrees of freedom, non-centrality, probability of staying below, statistic: as in the tests of
/// the crate.
const KNOWN: [(usize, f64, f64, f64); 8] = [
    (1, 60.0, 1e-3, 21.675_862_675_282_918),
    (2, 25.0, 1e-3, 4.257_038_996_201_98),
    (4, 80.0, 1e-3, 36.690_353_251_782_27),
    (10, 100.0, 1e-4, 46.569_953_618_722_2),
    (16, 30.0, 1e-3, 15.961_213_531_106_822),
    (25, 250.0, 1e-5, 153.820_598_165_808_5),
    (40, 60.0, 1e-3, 52.618_499_872_894_58),
    (60, 500.0, 1e-3, 426.161_733_746_006_5),
];

#[test]
fn by_the_normal_power_both_guesses_are_near() {
    for (dof, noncentrality, tail, statistic) in KNOWN {
        let (mean, root, ln_tail) = (libm::sqrt(noncentrality), libm::sqrt(statistic), libm::log(tail));
        assert_close("root", of(dof).root_guess(ln_tail, mean), root, NEAR);
        assert_close("mean", of(dof).mean_guess(ln_tail, root), mean, NEAR);
    }
}

#[test]
fn near_zero_the_leading_term_is_near() {
    let cases = [
        (1, 0.5, 1e-3, 2.589_806_433_773_743_5e-6, 1e-6),
        (2, 0.01, 1e-4, 2.010_125_548_410_887_3e-4, 1e-4),
        (3, 10.0, 1e-5, 3.101_247_904_551_785e-2, NEAR),
    ];
    for (dof, noncentrality, tail, statistic, near) in cases {
        let (mean, root) = (libm::sqrt(noncentrality), libm::sqrt(statistic));
        assert_close("root", of(dof).root_guess(libm::log(tail), mean), root, near);
    }
}
