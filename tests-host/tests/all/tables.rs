//! The committed threshold tables against their generator and the gold values.

use oracle::tables;
use oracle::vectors;
use raim_core::internals::integrity::raim::detection::threshold::{self, Thresholds};
use raim_core::internals::numeric::probability::Probability;

#[test]
fn committed_table_is_what_its_generator_writes() {
    let committed = std::fs::read_to_string(tables::committed_path()).expect("the table is committed");
    tables::check_committed(&committed).expect("the generator writes the committed table");
}

#[test]
fn thresholds_of_the_core_agree_with_the_gold_values() {
    let lookup = |dof, false_alarm, missed_detection: Option<f64>| {
        let missed = Probability::new(missed_detection.unwrap_or(1e-3))?;
        let thresholds = Thresholds::from_tables(Probability::new(false_alarm)?, missed).ok()?;
        if missed_detection.is_some() { thresholds.lambda(dof) } else { thresholds.tau1(dof) }
    };
    let have = tables::compare_with_gold(&vectors::path("gold"), &lookup).expect("readable gold values");
    assert_eq!(have.values, 1400);
    assert!(have.worst_relative <= tables::TOLERANCE, "have {:e}", have.worst_relative);
}

#[test]
fn w_test_thresholds_leave_the_false_alarm_in_two_normal_tails() {
    for &false_alarm in threshold::false_alarms() {
        let thresholds =
            Thresholds::from_tables(false_alarm, threshold::missed_detections()[0]).expect("a listed pair");
        for tests in 1..=threshold::MAX_TESTS {
            let w_test: f64 = thresholds.w_test(tests).expect("in the table");
            let have = tests as f64 * libm::erfc(w_test / libm::sqrt(2.0));
            let want = false_alarm.get();
            assert!((have / want - 1.0).abs() < 1e-12, "{tests} tests: have {have:e}, want {want:e}");
        }
    }
}

#[test]
fn every_pair_of_listed_probabilities_has_thresholds_that_grow_with_redundancy() {
    for &false_alarm in threshold::false_alarms() {
        for &missed_detection in threshold::missed_detections() {
            let rows = Thresholds::from_tables(false_alarm, missed_detection).expect("a listed pair");
            for dof in 1..threshold::MAX_DOF {
                assert!(rows.tau1::<f64>(dof) < rows.tau1::<f64>(dof + 1), "tau1 at {dof}");
                assert!(rows.lambda::<f64>(dof) < rows.lambda::<f64>(dof + 1), "lambda at {dof}");
            }
        }
    }
}

/// Many seconds each.
mod at_length {
    use super::*;

    #[test]
    fn a_changed_digit_in_the_committed_table_is_found() {
        let changed = tables::render().replacen("10.8275", "10.8276", 1);
        let error = tables::check_committed(&changed).expect_err("the table was changed");
        assert!(error.to_string().contains("10.8276"), "have `{error}`");
        tables::check_committed(tables::render().trim_end()).expect_err("the table was cut");
    }
}
