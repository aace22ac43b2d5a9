//! Final verdicts of epochs in the light of those before: series of reports whose right ends follow
//! from the rules.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod another;
mod silence;

use raim_core::frame::Geodetic;
use raim_core::internals::continuity::{Continuity, ContinuityError, ContinuitySettings, Recovery};
use raim_core::report::{
    Alert, Protected, ProtectionLevels, Report, Solution, TestStatistic, Unavailable, Verdict,
};

const OK: Verdict = Verdict::Protected(Protected::Ok);
const EXCLUDED: Verdict = Verdict::Protected(Protected::Excluded);
const FAULT: Verdict = Verdict::Alert(Alert::Fault);
const JUMP: Verdict = Verdict::Alert(Alert::Jump);
const RECOVERING: Verdict = Verdict::Unavailable(Unavailable::Recovering);
const PLACE: Verdict = Verdict::Unavailable(Unavailable::Place);

/// Metres of a degree of latitude at 45 degrees.
const DEGREE_M: f64 = 111_132.0;

/// One epoch: its own verdict and its position.
#[derive(Clone, Copy)]
struct Reported {
    verdict: Verdict,
    north_m: f64,
    height_m: f64,
    dof: u8,
    hpl_m: f64,
}

const HERE: Reported = Reported { verdict: OK, north_m: 0.0, height_m: 100.0, dof: 5, hpl_m: 20.0 };

fn north(north_m: f64) -> Reported {
    Reported { north_m, ..HERE }
}

fn verdict(verdict: Verdict) -> Reported {
    Reported { verdict, ..HERE }
}

fn report(reported: Reported) -> Report<4> {
    let latitude_rad = (45.0 + reported.north_m / DEGREE_M).to_radians();
    let geodetic = Geodetic { latitude_rad, longitude_rad: 0.1, height_m: reported.height_m };
    {
        let mut report = Report::nothing();
        report.verdict = reported.verdict;
        report.solution = Some({
            let mut solution = Solution::at(geodetic.to_ecef(), geodetic);
            solution.covariance_m2 = [1.0; 6];
            solution.hdop = 1.0;
            solution.vdop = 1.0;
            solution
        });
        report.test = Some(TestStatistic::new(1.0, 2.0, reported.dof));
        report.protection = Some(ProtectionLevels::new(reported.hpl_m, 30.0));
        report.residual_rms_m = 1.0;
        report.tracked = 4;
        report
    }
}

/// Returns the final verdicts of epochs at these times.
fn series(epochs: &[(f64, Reported)]) -> Vec<Verdict> {
    let mut continuity = Continuity::new();
    let settings = ContinuitySettings::anywhere();
    epochs
        .iter()
        .map(|(time_s, reported)| {
            continuity.conclude(&settings, *time_s, None, &report(*reported), None, false)
        })
        .collect()
}

fn last(epochs: &[(f64, Reported)]) -> Verdict {
    *series(epochs).last().unwrap()
}

#[test]
fn promise_returns_after_three_epochs_and_three_seconds() {
    let epochs = [(0.0, HERE), (1.0, verdict(FAULT)), (2.0, HERE), (3.0, HERE), (4.0, HERE), (5.0, HERE)];
    assert_eq!(series(&epochs), [OK, FAULT, RECOVERING, RECOVERING, RECOVERING, OK]);
    let slow = [(0.0, HERE), (30.0, verdict(FAULT)), (60.0, HERE), (90.0, HERE), (120.0, HERE)];
    assert_eq!(series(&slow), [OK, FAULT, RECOVERING, RECOVERING, OK]);
}

#[test]
fn single_agreements_among_alerts_promise_nothing() {
    let epochs: Vec<(f64, Reported)> = (0..300)
        .map(|second| (f64::from(second), if second % 3 == 0 { verdict(FAULT) } else { HERE }))
        .collect();
    assert!(series(&epochs).iter().all(|verdict| *verdict == FAULT || *verdict == RECOVERING));
}

#[test]
fn agreement_at_places_that_are_out_of_reach_of_each_other_is_none() {
    let scattered: Vec<(f64, Reported)> = (0..20)
        .map(|second| {
            (
                f64::from(second),
                if second == 0 { verdict(FAULT) } else { north(f64::from(second * 3000 % 7000)) },
            )
        })
        .collect();
    assert!(!series(&scattered).contains(&OK));
}

#[test]
fn another_place_at_the_same_time_is_no_agreement() {
    let two = |second: u32| [(f64::from(second), HERE), (f64::from(second), north(7000.0))];
    let epochs: Vec<(f64, Reported)> =
        [(0.0, verdict(FAULT))].into_iter().chain((1..60).flat_map(two)).collect();
    assert!(!series(&epochs).contains(&OK));
}

#[test]
fn one_degree_of_freedom_has_to_agree_ten_times() {
    let weak = Reported { dof: 1, ..HERE };
    let mut epochs = vec![(0.0, verdict(FAULT))];
    epochs.extend((1..=10).map(|second| (f64::from(second), weak)));
    assert_eq!(last(&epochs), RECOVERING, "ten epochs, nine seconds");
    epochs.push((11.0, weak));
    assert_eq!(last(&epochs), OK);
    let strong_in_between = [(0.0, verdict(FAULT)), (1.0, weak), (2.0, HERE), (3.0, HERE), (4.0, HERE)];
    assert_eq!(last(&strong_in_between), RECOVERING);
}

#[test]
fn one_degree_of_freedom_alone_is_no_first_promise_but_goes_on_with_one() {
    let weak = Reported { dof: 1, ..HERE };
    assert_eq!(last(&[(0.0, weak)]), RECOVERING);
    assert_eq!(last(&[(0.0, HERE), (1.0, weak)]), OK);
}

#[test]
fn exclusion_that_leaves_one_degree_of_freedom_is_no_recovery() {
    let reduced = Reported { verdict: EXCLUDED, dof: 1, ..HERE };
    let mut epochs = vec![(0.0, verdict(FAULT))];
    epochs.extend((1..=60).map(|second| (f64::from(second), reduced)));
    assert!(!series(&epochs).contains(&EXCLUDED));
    let redundant = Reported { verdict: EXCLUDED, ..HERE };
    let mut epochs = vec![(0.0, verdict(FAULT))];
    epochs.extend((1..=4).map(|second| (f64::from(second), redundant)));
    assert_eq!(last(&epochs), EXCLUDED);
}

#[test]
fn levels_too_large_for_a_while_neither_help_nor_hurt() {
    let wide = verdict(Verdict::Unavailable(Unavailable::Hpl));
    let epochs = [(0.0, verdict(FAULT)), (1.0, HERE), (2.0, HERE), (3.0, wide), (4.0, HERE)];
    assert_eq!(last(&epochs), OK);
    let none = verdict(Verdict::Unavailable(Unavailable::Redundancy));
    let epochs = [(0.0, verdict(FAULT)), (1.0, HERE), (2.0, HERE), (3.0, none), (4.0, HERE)];
    assert_eq!(last(&epochs), RECOVERING);
}

#[test]
fn position_farther_than_the_highest_speed_is_a_jump_until_time_has_made_it_reachable() {
    // 515 m/s and two levels of 20 m: 555 m in a second.
    assert_eq!(last(&[(0.0, HERE), (1.0, north(550.0))]), OK);
    assert_eq!(last(&[(0.0, HERE), (1.0, north(560.0))]), JUMP);
    // 400 km take 777 s.
    let at = |seconds: f64| last(&[(0.0, HERE), (1.0, north(400e3)), (seconds, north(400e3))]);
    assert_eq!(at(770.0), JUMP);
    assert_eq!(at(780.0), RECOVERING);
    let mut epochs = vec![(0.0, HERE), (1.0, north(400e3))];
    epochs.extend((0..=3).map(|second| (780.0 + f64::from(second), north(400e3))));
    assert_eq!(last(&epochs), OK);
    // Back at the old place it is no jump, but an alert it was.
    assert_eq!(last(&[(0.0, HERE), (1.0, north(400e3)), (2.0, HERE)]), RECOVERING);
}

#[test]
fn leap_in_height_is_a_jump_too() {
    // 515 m and two levels of 30 m.
    assert_eq!(last(&[(0.0, HERE), (1.0, Reported { height_m: 670.0, ..HERE })]), OK);
    assert_eq!(last(&[(0.0, HERE), (1.0, Reported { height_m: 680.0, ..HERE })]), JUMP);
}

#[test]
fn host_that_says_forget_allows_any_place() {
    let (mut continuity, settings) = (Continuity::new(), ContinuitySettings::anywhere());
    let conclude = |continuity: &mut Continuity, time_s, reported| {
        continuity.conclude(&settings, time_s, None, &report(reported), None, false)
    };
    assert_eq!(conclude(&mut continuity, 0.0, HERE), OK);
    continuity.forget();
    assert_eq!(conclude(&mut continuity, 1.0, north(400e3)), OK);
    assert_eq!(conclude(&mut continuity, 2.0, HERE), JUMP);
    continuity.forget();
    assert_eq!(conclude(&mut continuity, 3.0, HERE), RECOVERING, "an alert is not forgotten with the place");
}

#[test]
fn what_one_epoch_led_to_gives_way_to_what_ten_agree_on() {
    let far = 6000e3;
    let mut epochs = vec![(0.0, north(far))];
    epochs.extend((1..=12).map(|second| (f64::from(second), HERE)));
    let reported = series(&epochs);
    assert_eq!(reported[0], OK);
    assert!(reported[1..11].iter().all(|verdict| *verdict == JUMP), "{reported:?}");
    assert_eq!(reported[11..], [OK, OK], "ten seconds and more than ten epochs");
    // Nine and then alerts, repeatedly, are not ten.
    let mut broken = vec![(0.0, north(far))];
    broken.extend(
        (1..100).map(|second| (f64::from(second), if second % 10 == 0 { verdict(FAULT) } else { HERE })),
    );
    assert!(!series(&broken)[1..].contains(&OK));
}

#[test]
fn what_ten_epochs_have_led_to_gives_way_to_time_alone() {
    let mut epochs: Vec<(f64, Reported)> = (0..=10).map(|second| (f64::from(second), HERE)).collect();
    // A gap and an alert take nothing from it.
    epochs.extend([(400.0, HERE), (401.0, verdict(FAULT)), (402.0, HERE), (403.0, HERE), (405.0, HERE)]);
    epochs.extend((406..1000).map(|second| (f64::from(second), north(400e3))));
    let reported = series(&epochs);
    assert_eq!(reported[15], OK);
    assert!(reported[16..].iter().all(|verdict| *verdict == JUMP));
}

/// A longer recovery after an alert must not make the anchor easier to replace.
#[test]
fn longer_recovery_takes_nothing_from_what_was_firm() {
    let mut continuity = Continuity::new();
    let start = ContinuitySettings::anywhere();
    for second in 0..=11 {
        assert_eq!(continuity.conclude(&start, f64::from(second), None, &report(HERE), None, false), OK);
    }
    let longer = start.with_recovery(Recovery { epochs: 20, seconds: 30.0 });
    for second in 12..120 {
        let reported =
            continuity.conclude(&longer, f64::from(second), None, &report(north(400e3)), None, false);
        assert_eq!(reported, JUMP, "{second} s");
    }
}

#[test]
fn no_receiver_is_below_the_ground_or_among_the_satellites() {
    for height_m in [-3e6, -501.0, 20_001.0, 2e7, f64::NAN] {
        let epochs = [(0.0, Reported { height_m, ..HERE })];
        assert_eq!(last(&epochs), PLACE, "{height_m} m");
    }
    assert_eq!(last(&[(0.0, Reported { height_m: -499.0, ..HERE })]), OK);
}

#[test]
fn time_that_goes_back_makes_nothing_reachable() {
    assert_eq!(last(&[(0.0, HERE), (1.0, HERE), (-3600.0, north(10e3))]), JUMP);
    // As old as it was: nothing before, ten seconds after.
    assert_eq!(last(&[(1000.0, HERE), (900.0, HERE), (910.0, north(5100.0))]), OK);
    assert_eq!(last(&[(1000.0, HERE), (900.0, HERE), (910.0, north(5300.0))]), JUMP);
}

#[test]
fn time_that_is_no_number_stands_still() {
    for time_s in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(last(&[(10.0, HERE), (time_s, north(1e6))]), JUMP, "{time_s}");
        assert_eq!(last(&[(10.0, HERE), (time_s, HERE), (11.0, HERE)]), OK, "{time_s}");
    }
}

#[test]
fn clock_of_the_callers_own_bounds_what_a_leap_of_the_time_tag_makes_reachable() {
    let (mut continuity, settings) = (Continuity::new(), ContinuitySettings::anywhere());
    let mut conclude = |time_s, own_s, reported| {
        continuity.conclude(&settings, time_s, Some(own_s), &report(reported), None, false)
    };
    assert_eq!(conclude(0.0, 100.0, HERE), OK);
    assert_eq!(conclude(3600.0, 101.0, north(400e3)), JUMP);
    assert_eq!(conclude(3600.0 + 86_401.0, 102.0, north(400e3)), JUMP, "nor is the place forgotten");
    assert_eq!(last(&[(0.0, HERE), (3600.0, north(400e3))]), OK, "without one it cannot be told");
}

#[test]
fn epochs_that_come_at_once_are_no_seconds_of_agreement() {
    let settings = ContinuitySettings::anywhere();
    let judge = |own_step_s: f64| {
        let mut continuity = Continuity::new();
        let _ = continuity.conclude(&settings, 0.0, Some(0.0), &report(verdict(FAULT)), None, false);
        let conclude = |second: u32| {
            let second = f64::from(second);
            continuity.conclude(&settings, second, Some(second * own_step_s), &report(HERE), None, false)
        };
        (1..=5).map(conclude).collect::<Vec<_>>()
    };
    assert_eq!(judge(0.1), [RECOVERING; 5]);
    assert_eq!(judge(1.0), [RECOVERING, RECOVERING, RECOVERING, OK, OK]);
}

#[test]
fn place_is_forgotten_after_a_day_and_agreement_after_a_gap() {
    let settings = ContinuitySettings::anywhere().with_max_speed_m_s(0.0);
    let judge = |time_s: f64| {
        let mut continuity = Continuity::new();
        let _ = continuity.conclude(&settings, 0.0, None, &report(HERE), None, false);
        continuity.conclude(&settings, time_s, None, &report(north(1000.0)), None, false)
    };
    assert_eq!(judge(86_399.0), JUMP);
    assert_eq!(judge(86_401.0), OK);
    let epochs = [(0.0, verdict(FAULT)), (1.0, HERE), (100.0, HERE), (1001.0, HERE), (1002.0, HERE)];
    assert_eq!(last(&epochs), RECOVERING);
}

/// One epoch in half a minute, or in five: longer than the time to alert, after which the
/// continuity restarts.
#[test]
fn receiver_that_is_slower_than_the_time_to_alert_recovers() {
    let settings = ContinuitySettings::anywhere();
    for step_s in [30.0, 300.0] {
        let mut continuity = Continuity::new();
        let _ = continuity.conclude(&settings, 0.0, Some(0.0), &report(verdict(FAULT)), None, false);
        let conclude = |epoch: u32| {
            continuity.interrupt();
            let time_s = f64::from(epoch) * step_s;
            continuity.conclude(&settings, time_s, Some(time_s), &report(HERE), None, false)
        };
        let reported: Vec<Verdict> = (1..=4).map(conclude).collect();
        assert_eq!(reported, [RECOVERING, RECOVERING, OK, OK], "{step_s} s");
    }
}

#[test]
fn protected_without_a_position_is_not_said() {
    let mut nowhere = report(HERE);
    nowhere.solution = None;
    let reported =
        Continuity::new().conclude(&ContinuitySettings::anywhere(), 0.0, None, &nowhere, None, false);
    assert_eq!(reported, Verdict::Unavailable(Unavailable::NoFix));
}

#[test]
fn settings_are_checked_by_name() {
    let start = ContinuitySettings::anywhere();
    assert_eq!(start.validate(), Ok(start));
    for max_speed_m_s in [-1.0, 1e6, f64::NAN] {
        let have = start.with_max_speed_m_s(max_speed_m_s).validate();
        assert!(matches!(have, Err(ContinuityError::Speed(_))), "{max_speed_m_s}");
    }
    for (min_height_m, max_height_m) in [(5.0, 5.0), (f64::NAN, 1.0), (0.0, f64::INFINITY), (9.0, 1.0)] {
        let have = start.with_min_height_m(min_height_m).with_max_height_m(max_height_m).validate();
        assert!(matches!(have, Err(ContinuityError::Height { .. })), "{min_height_m} {max_height_m}");
    }
    for recovery in [Recovery { epochs: 0, seconds: 1.0 }, Recovery { epochs: 1, seconds: f64::NAN }] {
        let have = start.with_recovery(recovery).validate();
        assert!(matches!(have, Err(ContinuityError::Recovery(_))), "{recovery:?}");
    }
}

/// Returns the seconds after an alert in which ten minutes of agreement are not yet a promise.
fn recovered_after_s(alert: Alert, speed_m_s: Option<f64>, is_doubted: bool) -> Option<u32> {
    let mut continuity = Continuity::new();
    let settings = ContinuitySettings::anywhere();
    let mut conclude = |second: u32, reported: Reported, is_doubted: bool| {
        continuity.conclude(&settings, f64::from(second), None, &report(reported), speed_m_s, is_doubted)
    };
    assert_eq!(conclude(0, HERE, false), OK);
    let _ = conclude(1, verdict(Verdict::Alert(alert)), is_doubted);
    (0..600).find(|second| conclude(2 + second, HERE, false) == OK)
}

#[test]
fn what_contradicts_the_rates_asks_for_more_than_a_leap_of_the_clock() {
    let speed_m_s = Some(0.0);
    assert_eq!(recovered_after_s(Alert::Clock, None, false), Some(3), "its own past, by one leap");
    assert_eq!(recovered_after_s(Alert::Clock, speed_m_s, false), Some(10), "its rates, by one leap");
    assert_eq!(recovered_after_s(Alert::Clock, speed_m_s, true), Some(130), "a drift, or leaps");
    assert_eq!(recovered_after_s(Alert::Track, speed_m_s, true), Some(130));
}
