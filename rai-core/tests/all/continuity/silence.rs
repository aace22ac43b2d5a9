//! The first positions after a silence.

use super::*;

/// Returns the verdicts of epochs each second after a silence from 0 s on, at a distance to the
/// north of the last position; the receiver's speed before was `speed_m_s`.
fn after_silence(silence_s: f64, north_m: f64, speed_m_s: Option<f64>, seconds: u32) -> Vec<Verdict> {
    let mut continuity = Continuity::new();
    let settings = ContinuitySettings::anywhere();
    let _ = continuity.conclude(&settings, 0.0, None, &report(HERE), speed_m_s, false);
    continuity.interrupt();
    (0..seconds)
        .map(|second| {
            let time_s = silence_s + f64::from(second);
            continuity.conclude(&settings, time_s, None, &report(north(north_m)), Some(0.0), false)
        })
        .collect()
}

#[test]
fn a_silence_makes_no_place_good_that_the_receiver_is_not_expected_at() {
    // 300 km in 600 s are within 515 m/s; a receiver at rest is not expected there. It must agree
    // for the 300 km / 515 m/s = 583 s of the way.
    let at_rest = after_silence(600.0, 300e3, Some(0.0), 600);
    assert!(at_rest[..580].iter().all(|verdict| *verdict == RECOVERING));
    assert_eq!(at_rest[590], OK);
    // An aircraft at 250 m/s is expected there, and a car 1 km away after ten minutes.
    assert_eq!(after_silence(900.0, 300e3, Some(250.0), 1), [OK]);
    assert_eq!(after_silence(600.0, 1e3, Some(0.0), 1), [OK]);
    // Of a receiver without Doppler frequencies 50 m/s are expected, and 10 more.
    assert_eq!(after_silence(600.0, 40e3, None, 1), [OK]);
    assert_eq!(after_silence(600.0, 80e3, None, 1), [RECOVERING]);
}

/// A clock that leaps across the silence is an alert, after which the way to the place must still
/// be waited for.
#[test]
fn an_alert_after_a_silence_makes_no_place_good_either() {
    let mut continuity = Continuity::new();
    let settings = ContinuitySettings::anywhere();
    assert_eq!(continuity.conclude(&settings, 0.0, None, &report(HERE), Some(0.0), false), OK);
    continuity.interrupt();
    let leaping = {
        let mut report = report(north(300e3));
        report.verdict = Verdict::Alert(Alert::Clock);
        report
    };
    let _ = continuity.conclude(&settings, 600.0, None, &leaping, Some(0.0), false);
    for second in 1..=580 {
        let time_s = 600.0 + f64::from(second);
        let have = continuity.conclude(&settings, time_s, None, &report(north(300e3)), Some(0.0), false);
        assert_eq!(have, RECOVERING, "{second} s");
    }
}

#[test]
fn true_place_after_a_counterfeit_one_waits_for_nothing() {
    let mut continuity = Continuity::new();
    let settings = ContinuitySettings::anywhere();
    assert_eq!(continuity.conclude(&settings, 0.0, None, &report(HERE), Some(0.0), false), OK);
    continuity.interrupt();
    let mut conclude = |time_s: f64, reported: Reported| {
        continuity.conclude(&settings, time_s, None, &report(reported), Some(0.0), false)
    };
    assert_eq!(conclude(600.0, north(300e3)), RECOVERING);
    let back: Vec<Verdict> = (1..6).map(|second| conclude(600.0 + f64::from(second), HERE)).collect();
    assert_eq!(back, [RECOVERING, RECOVERING, RECOVERING, OK, OK]);
}
