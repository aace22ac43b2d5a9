//! Position and clock against velocity and drift: made series whose right verdict follows from how
//! they were made.
#![allow(clippy::unwrap_used)]

mod kinds;
mod refused;
mod steering;
mod without_rates;

use raim_core::frame::{Enu, Geodetic, LocalFrame, SPEED_OF_LIGHT_M_S};
use raim_core::internals::continuity::Motion;
use raim_core::internals::velocity::{Velocity, VelocityError};
use raim_core::report::{Alert, Protected, ProtectionLevels, Report, Solution, TestStatistic, Verdict};
use raim_core::satellite::{Constellation, SatelliteId};

use without_rates::{contradictions_without_rates, quartz};

/// `HPL + VPL`, m.
const LEVEL_M: f64 = 25.0;

/// A receiver's epoch: true motion, and what is wrong with it.
#[derive(Clone, Copy, Default)]
struct Epoch {
    time_s: f64,
    east_m: f64,
    speed_m_s: f64,
    clock_m: f64,
    drift_m_s: f64,
}

fn solution(epoch: Epoch) -> Solution {
    let geodetic = Geodetic { latitude_rad: 0.8, longitude_rad: 0.1, height_m: 100.0 };
    let origin = geodetic.to_ecef();
    let away = LocalFrame::at(origin).unrotate(Enu { east: epoch.east_m, north: 0.0, up: 0.0 });
    {
        let mut solution = Solution::at(origin + away, geodetic);
        solution.covariance_m2 = [1.0; 6];
        solution.clocks_m = [Some(epoch.clock_m), None, None, None];
        solution.hdop = 1.0;
        solution.vdop = 1.0;
        solution
    }
}

fn report(epoch: Epoch) -> Report<4> {
    let mut report = Report::nothing();
    report.verdict = Verdict::Protected(Protected::Ok);
    report.solution = Some(solution(epoch));
    report.test = Some(TestStatistic::new(1.0, 2.0, 5));
    report.protection = Some(ProtectionLevels::new(10.0, LEVEL_M - 10.0));
    report.residual_rms_m = 1.0;
    report.tracked = 4;
    report
}

fn velocity(epoch: Epoch) -> Velocity {
    // The way is straight, so that east where it began is not quite east where it ends.
    let begin = Geodetic { latitude_rad: 0.8, longitude_rad: 0.1, height_m: 100.0 }.to_ecef();
    let along = LocalFrame::at(begin).unrotate(Enu { east: epoch.speed_m_s, north: 0.0, up: 0.0 });
    let Enu { east, north, up } = LocalFrame::at(solution(epoch).position).rotate(along);
    let mut velocity = Velocity::zero(TestStatistic::new(1.0, 2.0, 5), ProtectionLevels::new(0.5, 1.0));
    velocity.east_north_up_m_s = [east, north, up];
    velocity.covariance_m2_s2 = [0.01; 6];
    velocity.drift_m_s = epoch.drift_m_s;
    velocity
}

/// Returns the contradictions of a series with their times, s.
fn contradictions(epochs: impl IntoIterator<Item = Epoch>) -> std::vec::Vec<(f64, Alert)> {
    let mut motion = Motion::new();
    let judged = epochs.into_iter().filter_map(|epoch| {
        let alert = motion.judge(epoch.time_s, &report(epoch), Ok(&velocity(epoch)));
        alert.map(|alert| (epoch.time_s, alert))
    });
    judged.collect()
}

/// Returns noise of about a metre, other for each second: the fractions of a chaotic product.
fn noise_m(second: u32) -> f64 {
    let seed = f64::from(second) * 78.233;
    2.0 * ((seed.sin() * 43758.5453).fract().abs() - 0.5)
}

/// Returns a vehicle at 20 m/s with a clock that drifts 30 m/s, noisy by a metre, once a second.
fn drive(seconds: u32) -> impl Iterator<Item = Epoch> + Clone {
    (0..seconds).map(|second| {
        let time_s = f64::from(second);
        Epoch {
            time_s,
            east_m: 20.0 * time_s + noise_m(second),
            speed_m_s: 20.0,
            clock_m: 1e5 + 30.0 * time_s + noise_m(second + 7919),
            drift_m_s: 30.0,
        }
    })
}

/// Returns the time since an attack began.
fn since(epoch: Epoch) -> f64 {
    (epoch.time_s - 300.0).max(0.0)
}

#[test]
fn a_vehicle_whose_rates_are_true_contradicts_nothing() {
    assert_eq!(contradictions(drive(1800)), []);
}

#[test]
fn noise_that_grows_within_an_epoch_is_no_drift_at_any_rate() {
    // A satellite that has just risen may be five times as noisy as all others together.
    for rate_hz in [1_u32, 2, 5, 10, 20] {
        let epochs = (0..1200 * rate_hz).map(|number| {
            let time_s = f64::from(number) / f64::from(rate_hz);
            let size = if time_s < 300.0 { 0.6 } else { 3.0 };
            let [east_m, clock_m] = [number, number + 7919].map(|seed| size * noise_m(seed));
            Epoch { time_s, east_m, clock_m, ..Epoch::default() }
        });
        assert_eq!(contradictions(epochs), [], "{rate_hz} Hz");
    }
}

#[test]
fn a_quartz_that_wanders_between_distant_epochs_is_no_drift() {
    // Random departures from the trapezoid, as large as those of a quartz: 1.1 m (1 σ) in 5 s.
    let mut clock_m = 0.0;
    let epochs = (0..40_000_u32).map(|number| {
        clock_m += 1.9 * noise_m(number);
        Epoch { time_s: 5.0 * f64::from(number), clock_m, ..Epoch::default() }
    });
    assert_eq!(contradictions(epochs), []);
}

#[test]
fn a_drag_off_of_the_clock_is_seen_within_a_minute() {
    let attacked = drive(600).map(|epoch| Epoch { clock_m: epoch.clock_m + 0.2 * since(epoch), ..epoch });
    let seen = contradictions(attacked);
    let (first_s, alert) = seen[0];
    assert_eq!(alert, Alert::Clock);
    assert!((300.0..=360.0).contains(&first_s), "at {first_s} s");
    assert!(seen.len() > 200, "{} of 300 epochs", seen.len());
}

#[test]
fn a_position_that_walks_off_is_seen_within_a_minute() {
    for (speed_m_s, within_s) in [(0.2, 60.0), (1.0, 25.0), (10.0, 15.0), (500.0, 1.0)] {
        let attacked =
            drive(600).map(|epoch| Epoch { east_m: epoch.east_m + speed_m_s * since(epoch), ..epoch });
        let (first_s, alert) = contradictions(attacked)[0];
        assert_eq!(alert, Alert::Track, "{speed_m_s} m/s");
        assert!((300.0..=300.0 + within_s).contains(&first_s), "{speed_m_s} m/s: at {first_s} s");
    }
}

#[test]
fn a_leap_within_the_levels_after_a_gap_is_no_drift() {
    // Reflections move the position and the clock at once. With few marks a leap looks like a line.
    for gap_s in 5..15 {
        for leap_m in [10.0, 20.0, 30.0, 40.0] {
            let is_there = |epoch: &Epoch| !(0.0..f64::from(gap_s)).contains(&(epoch.time_s - 296.0));
            let leapt = drive(600).filter(is_there).map(|epoch| {
                let leap_m = if epoch.time_s < 296.0 { 0.0 } else { leap_m };
                Epoch { clock_m: epoch.clock_m + leap_m, ..epoch }
            });
            assert_eq!(contradictions(leapt), [], "{leap_m} m after {gap_s} s");
        }
    }
}

/// Returns the first contradiction of an attacked drive with levels of 400 m together, and the time
/// since the attack began, s.
fn first_within_400_m(attacked: impl Fn(Epoch) -> Epoch) -> Option<(f64, Alert)> {
    let mut motion = Motion::new();
    drive(700).map(attacked).find_map(|epoch| {
        let mut report = report(epoch);
        report.protection = Some(ProtectionLevels::new(150.0, 250.0));
        motion.judge(epoch.time_s, &report, Ok(&velocity(epoch))).map(|alert| (since(epoch), alert))
    })
}

#[test]
fn a_clock_that_drifts_deep_within_the_levels_is_no_alert() {
    let seen = |speed_m_s: f64| {
        first_within_400_m(|epoch| Epoch { clock_m: epoch.clock_m + speed_m_s * since(epoch), ..epoch })
    };
    // An eighth of 400 m in a minute is 0.83 m/s.
    assert_eq!(seen(0.7), None);
    let seen = seen(1.0);
    assert!(matches!(seen, Some((..60.0, Alert::Clock))), "{seen:?}");
}

#[test]
fn a_slow_walk_deep_within_its_level_is_no_alert_and_a_faster_one_is_before_it_ends() {
    let seen = |speed_m_s: f64| {
        first_within_400_m(|epoch| Epoch { east_m: epoch.east_m + speed_m_s * since(epoch), ..epoch })
    };
    // A quarter of 400 m in a minute is 1.7 m/s.
    assert_eq!(seen(1.0), None);
    for speed_m_s in [2.0, 5.0, 10.0] {
        let Some((after_s, Alert::Track)) = seen(speed_m_s) else { panic!("{speed_m_s} m/s is not seen") };
        assert!(speed_m_s * after_s < 150.0, "{speed_m_s} m/s is seen after {after_s} s");
    }
}

#[test]
fn a_second_receiver_contradicts_the_first_at_once() {
    let other = |epoch: Epoch| Epoch { clock_m: epoch.clock_m + 400.0, ..epoch };
    let mixed = drive(100).map(|epoch| if epoch.time_s < 50.0 { epoch } else { other(epoch) });
    assert_eq!(contradictions(mixed)[0], (50.0, Alert::Clock));
}

#[test]
fn whole_milliseconds_of_the_clock_are_no_contradiction() {
    let millisecond_m = SPEED_OF_LIGHT_M_S * 1e-3;
    let steered = drive(600).map(|epoch| {
        let milliseconds = (epoch.time_s / 45.0).floor();
        Epoch { clock_m: epoch.clock_m - milliseconds * millisecond_m, ..epoch }
    });
    assert_eq!(contradictions(steered), []);
}

#[test]
fn a_clock_is_compared_across_a_tunnel() {
    let gap = |epoch: Epoch| (100.0..400.0).contains(&epoch.time_s);
    let tunnel = drive(600).filter(|epoch| !gap(*epoch));
    assert_eq!(contradictions(tunnel.clone()), []);
    // A counterfeit clock 100 km away from the true one, where a quartz wanders 9 km.
    let counterfeit = tunnel.map(|epoch| {
        let error_m = if epoch.time_s < 400.0 { 0.0 } else { 100e3 };
        Epoch { clock_m: epoch.clock_m + error_m, ..epoch }
    });
    assert_eq!(contradictions(counterfeit), [(400.0, Alert::Clock)]);
}

#[test]
fn a_logger_at_rest_in_a_tower_may_turn_between_two_epochs() {
    // Every 30 s: the velocity of the moment says nothing of the way in between.
    let slow = (0..200).map(|step| {
        let time_s = f64::from(30 * step);
        Epoch { time_s, east_m: if step % 2 == 0 { 0.0 } else { 300.0 }, ..Epoch::default() }
    });
    assert_eq!(contradictions(slow), []);
}

#[test]
fn values_that_are_not_numbers_contradict() {
    let broken = |epoch: Epoch| Epoch { drift_m_s: f64::NAN, ..epoch };
    let seen =
        contradictions(drive(100).map(|epoch| if epoch.time_s < 50.0 { epoch } else { broken(epoch) }));
    assert_eq!(seen.first(), Some(&(50.0, Alert::Clock)));
}

/// Returns whether a series has an alert in every second of a range.
fn is_alert_throughout(seen: &[(f64, Alert)], seconds: core::ops::Range<u32>) -> bool {
    seconds.into_iter().all(|second| seen.iter().any(|(time_s, _)| (*time_s - f64::from(second)).abs() < 0.1))
}

#[test]
fn a_leap_below_the_levels_stays_an_alert_until_the_place_returns() {
    for leap_m in [15.0, 20.0, 30.0, 60.0, 100.0, 500.0] {
        let away = |epoch: &Epoch| (300.0..1000.0).contains(&epoch.time_s);
        let leapt = drive(1200).map(|epoch| {
            let leap_m = if away(&epoch) { leap_m } else { 0.0 };
            Epoch { east_m: epoch.east_m + leap_m, ..epoch }
        });
        let seen = contradictions(leapt);
        assert_eq!(seen.first(), Some(&(300.0, Alert::Track)), "{leap_m} m");
        assert!(is_alert_throughout(&seen, 300..1000), "{leap_m} m: {} alerts", seen.len());
        assert!(!is_alert_throughout(&seen, 1100..1101), "{leap_m} m: the place is right again");
    }
}

#[test]
fn stairs_and_a_walk_that_ends_are_not_believed_either() {
    let stairs = |epoch: Epoch| 30.0 * (since(epoch) / 60.0).ceil();
    let walk = |epoch: Epoch| 2.0 * since(epoch).min(60.0);
    let shifts: [&dyn Fn(Epoch) -> f64; 2] = [&stairs, &walk];
    for shift_m in shifts {
        let shifted = drive(1200).map(|epoch| Epoch { east_m: epoch.east_m + shift_m(epoch), ..epoch });
        assert!(is_alert_throughout(&contradictions(shifted), 315..1200));
    }
}

#[test]
fn a_walk_in_the_first_minutes_does_not_teach_its_own_bound() {
    for speed_m_s in [0.3, 0.5, 0.8] {
        let walked = drive(1200).map(|epoch| {
            let way_m = speed_m_s * (epoch.time_s - 30.0).max(0.0);
            Epoch { east_m: epoch.east_m + way_m, ..epoch }
        });
        assert!(is_alert_throughout(&contradictions(walked), 240..1200), "{speed_m_s} m/s");
    }
}

#[test]
fn a_leap_shows_in_the_epoch_that_lacks_the_system_of_the_clock() {
    let mut motion = Motion::new();
    let mut seen = std::vec::Vec::new();
    for epoch in drive(400) {
        let is_after = epoch.time_s >= 300.0;
        let epoch = Epoch { east_m: epoch.east_m + if is_after { 500.0 } else { 0.0 }, ..epoch };
        let mut report = report(epoch);
        if is_after {
            let solution = report.solution.as_mut().unwrap();
            solution.clocks_m = [None; Constellation::COUNT];
            solution.clocks_m[Constellation::Beidou as usize] = Some(epoch.clock_m + 20.0);
            let other = SatelliteId::new(Constellation::Beidou, 1).unwrap();
            let _ = report.used.push(other);
        }
        if motion.judge(epoch.time_s, &report, Ok(&velocity(epoch))).is_some() {
            seen.push(epoch.time_s);
        }
    }
    assert_eq!(seen.first(), Some(&300.0));
}

#[test]
fn a_clock_that_sways_with_its_temperature_is_no_drift_between_distant_epochs() {
    // 25 ppb within 20 s to 5 minutes.
    for step_s in [10_u32, 20, 30] {
        for period_s in [20.0, 33.0, 60.0, 120.0, 300.0_f64] {
            let turn = core::f64::consts::TAU / period_s;
            let epochs = (0..600).map(|number| {
                let time_s = f64::from(number * step_s);
                let clock_m = 7.5 / turn * (1.0 - (turn * time_s + 0.7).cos());
                let drift_m_s = 7.5 * (turn * time_s + 0.7).sin();
                Epoch { time_s, clock_m: clock_m + noise_m(number), drift_m_s, ..Epoch::default() }
            });
            assert_eq!(contradictions(epochs), [], "every {step_s} s, {period_s} s");
        }
    }
}

#[test]
fn a_clock_that_trembles_hides_no_walk() {
    // From one epoch to the next it leaps by 8 m and back, which no healthy satellite explains for long.
    let trembling = (0..6000_u32).map(|number| {
        let time_s = f64::from(number) / 10.0;
        let leap_m = if number % 2 == 0 { 4.0 } else { -4.0 };
        let away_m = if time_s < 300.0 { 0.0 } else { 0.5 * (time_s - 300.0) + leap_m };
        Epoch { time_s, east_m: 0.6 * noise_m(number), clock_m: away_m, ..Epoch::default() }
    });
    let seen = contradictions(trembling);
    assert!(matches!(seen.first(), Some(&(300.0..360.0, Alert::Clock))), "{:?}", seen.first());
}

#[test]
fn a_silence_of_a_fast_receiver_is_no_contradiction() {
    for rate_hz in [1_u32, 5, 10, 20] {
        for gap_s in [1_u32, 2, 5, 10, 15, 20, 30, 45, 59, 61, 90, 120] {
            // Silences at other times, so that other noise is hit.
            for begin_s in (40..200).step_by(10) {
                let begin_s = f64::from(begin_s);
                let silence = begin_s..begin_s + f64::from(gap_s);
                let clock = quartz(1.0 / f64::from(rate_hz), (begin_s as u32 + gap_s + 60) * rate_hz);
                let heard: std::vec::Vec<Epoch> =
                    clock.filter(|epoch| !silence.contains(&epoch.time_s)).collect();
                let about = std::format!("{rate_hz} Hz, {gap_s} s from {begin_s} s");
                assert_eq!(contradictions_without_rates(heard.iter().copied()), [], "{about}");
                assert_eq!(contradictions(heard), [], "{about}, with rates");
            }
        }
    }
}

#[test]
fn small_leaps_add_up() {
    // Steps from mark to mark are 2 m in the mean, so that one of 30 m is none that tells.
    let stairs = drive(1500).map(|epoch| {
        let leaps_m = 30.0 * (since(epoch) / 60.0).floor();
        Epoch { east_m: epoch.east_m + 2.5 * noise_m(epoch.time_s as u32 + 1) + leaps_m, ..epoch }
    });
    let have = contradictions(stairs);
    let (first_s, alert) = *have.first().unwrap();
    assert!(alert == Alert::Track && first_s < 300.0 + 300.0, "{alert:?} at {first_s} s");
    // It stays, because the place does not return.
    assert_eq!(have.len(), (1500.0 - first_s) as usize);
}

#[test]
fn rates_that_are_wrong_by_five_centimetres_add_up_to_nothing() {
    let slow = drive(3600).map(|epoch| Epoch { speed_m_s: 20.05, ..epoch });
    assert_eq!(contradictions(slow), []);
}

#[test]
fn a_velocity_that_may_be_wrong_is_no_leap_after_a_gap() {
    // Before a gap of 7 s the velocity is wrong by 20 m/s, which makes 70 m of the trapezoid.
    let seen = |level_m_s: f64| {
        let mut motion = Motion::new();
        let is_there = |epoch: &Epoch| !(301.0..307.0).contains(&epoch.time_s);
        let alerts = drive(400).filter(is_there).filter_map(|epoch| {
            let is_wrong = epoch.time_s > 299.0 && epoch.time_s < 301.0;
            let wrong_m_s = if is_wrong { 20.0 } else { 0.0 };
            let mut velocity = velocity(Epoch { speed_m_s: epoch.speed_m_s + wrong_m_s, ..epoch });
            if is_wrong {
                velocity.levels_m_s = ProtectionLevels::new(level_m_s, level_m_s);
            }
            motion.judge(epoch.time_s, &report(epoch), Ok(&velocity))
        });
        alerts.count()
    };
    assert_eq!([20.0, 100.0, f64::INFINITY].map(seen), [0; 3]);
    assert!(seen(0.5) > 0);
}
