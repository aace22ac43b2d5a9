//! The global test and its report.
#![allow(clippy::unwrap_used, clippy::float_cmp)]

use raim_core::internals::integrity::raim::detection::Detection;
use raim_core::report::Solution;
use raim_core::requirements::{Requirements, RequirementsError};

fn detection(sse: f64, threshold: f64) -> Detection<f64> {
    Detection { sse, threshold, dof: 4 }
}

#[test]
fn a_sum_at_the_threshold_is_a_fault_and_so_is_one_that_is_no_number() {
    assert!(!detection(8.9, 9.0).fault());
    assert!(detection(9.0, 9.0).fault());
    assert!(detection(9.1, 9.0).fault());
    assert!(detection(f64::NAN, 9.0).fault());
    assert!(detection(1.0, f64::NAN).fault());
}

#[test]
fn the_statistic_is_a_root_mean_square() {
    let have = detection(36.0, 64.0).statistic();
    assert_eq!((have.statistic, have.threshold, have.dof), (3.0, 4.0, 4));
}

#[test]
fn dilutions_add_in_squares() {
    let mut solution = {
        let mut solution = Solution::at(
            raim_core::frame::Ecef::CENTRE,
            raim_core::frame::Geodetic { latitude_rad: 0.0, longitude_rad: 0.0, height_m: 0.0 },
        );
        solution.covariance_m2 = [0.0; 6];
        solution.hdop = 3.0;
        solution.vdop = 4.0;
        solution
    };
    assert_eq!(solution.pdop(), 5.0);
    solution.vdop = 0.0;
    assert_eq!(solution.pdop(), 3.0);
}

#[test]
fn requirements_end_where_they_say() {
    use RequirementsError::{GuardFraction, HorizontalAlertLimit, TimeToAlert, VerticalAlertLimit};
    let good = Requirements::lpv200();
    let refused = |requirements: Requirements| requirements.validate().err();
    for (limit_m, refuses) in
        [(0.0, true), (-1.0, true), (f64::NAN, true), (1e6, false), (1.1e6, true), (1e-3, false)]
    {
        let have = refused(good.with_hal_m(limit_m));
        assert_eq!(matches!(have, Some(HorizontalAlertLimit(_))), refuses, "HAL {limit_m}");
        assert_eq!(have.is_some(), refuses);
        let have = refused(good.with_val_m(Some(limit_m)));
        assert_eq!(matches!(have, Some(VerticalAlertLimit(_))), refuses, "VAL {limit_m}");
        assert_eq!(have.is_some(), refuses);
    }
    for (time_to_alert_s, refuses) in
        [(0.0, true), (-1.0, true), (f64::NAN, true), (3600.0, false), (3601.0, true)]
    {
        let have = refused(good.with_time_to_alert_s(time_to_alert_s));
        assert_eq!(matches!(have, Some(TimeToAlert(_))), refuses, "time to alert {time_to_alert_s}");
        assert_eq!(have.is_some(), refuses);
    }
    for (guard_fraction, refuses) in [(0.0, true), (-0.1, true), (f64::NAN, true), (1.0, false), (1.01, true)]
    {
        let have = refused(good.with_guard_fraction(guard_fraction));
        assert_eq!(matches!(have, Some(GuardFraction(_))), refuses, "fraction {guard_fraction}");
        assert_eq!(have.is_some(), refuses);
    }
}
