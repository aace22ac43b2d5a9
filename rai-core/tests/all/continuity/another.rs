//! Another receiver on the line, by its place and the times of its epochs.

use super::*;

/// Returns the verdicts of epochs at these times and places after a minute at 1 Hz.
fn after_a_minute(rest: &[(f64, f64)]) -> std::vec::Vec<Verdict> {
    let mut epochs: std::vec::Vec<(f64, Reported)> =
        (0..60).map(|second| (f64::from(second), HERE)).collect();
    epochs.extend(rest.iter().map(|(time_s, north_m)| (*time_s, north(*north_m))));
    series(&epochs).split_off(60)
}

#[test]
fn another_place_at_another_part_of_the_second_is_another_receiver() {
    for gap_s in [5.5, 21.5, 600.5] {
        let other: std::vec::Vec<(f64, f64)> =
            (0..3000).map(|second| (59.0 + gap_s + f64::from(second), 12_000.0)).collect();
        assert!(after_a_minute(&other).iter().all(|verdict| *verdict == JUMP), "{gap_s} s");
        // The first receiver is known by its part of the second and its place.
        let own: std::vec::Vec<(f64, f64)> =
            other.into_iter().take(40).chain((700..710).map(|second| (f64::from(second), 5.0))).collect();
        assert_eq!(*after_a_minute(&own).last().unwrap(), OK, "{gap_s} s");
    }
}

#[test]
fn receiver_that_restarts_where_it_can_be_expected_is_the_same() {
    // 12.5 s after its last epoch, at most 125 m and both levels away, at another rate.
    let restarted: std::vec::Vec<(f64, f64)> =
        (0..100).map(|fifth| (71.5 + 0.2 * f64::from(fifth), 100.0)).collect();
    assert!(after_a_minute(&restarted).iter().all(|verdict| *verdict == OK));
}

#[test]
fn receiver_whose_step_does_not_fit_a_second_is_never_another() {
    for step_s in [0.06, 0.08, 0.15, 0.3, 0.4, 0.7, 1.5, 2.5] {
        for gap in [2, 7, 31, 333] {
            let mut epochs: std::vec::Vec<(f64, Reported)> =
                (0..60).map(|index| (step_s * f64::from(index), HERE)).collect();
            let north_m = 40.0 + 500.0 * step_s * f64::from(gap);
            epochs.extend((0..100).map(|index| (step_s * f64::from(60 + gap + index), north(north_m))));
            assert!(!series(&epochs).contains(&JUMP), "{step_s} s, gap of {gap} epochs");
        }
    }
}

#[test]
fn fast_receiver_in_a_gap_of_any_length_keeps_its_rhythm() {
    for hertz in [1.0, 3.0, 4.0, 5.0, 7.0, 10.0, 12.0, 18.0, 20.0, 30.0] {
        for gap in [2, 7, 31, 599] {
            let time_s = |index: i32| (1e3 * f64::from(index) / hertz).round() * 1e-3;
            let mut epochs: std::vec::Vec<(f64, Reported)> =
                (0..60).map(|index| (time_s(index), HERE)).collect();
            // Within reach at the highest speed, but not expected of a receiver at rest.
            let north_m = 40.0 + 500.0 * time_s(gap);
            epochs.extend((0..100).map(|index| (time_s(60 + gap + index), north(north_m))));
            let have = series(&epochs);
            assert!(!have.contains(&JUMP), "{hertz} Hz, gap of {gap} epochs");
        }
    }
}
