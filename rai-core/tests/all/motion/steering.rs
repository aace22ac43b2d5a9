//! A receiver that steers its clock, while its range rates show the oscillator.

use super::*;

/// Rates of steering, m/s: from a tenth of a metre to more than a cheap quartz is off.
const STEERED_M_S: [f64; 9] = [0.1, 0.3, 1.0, 2.0, 5.0, 20.0, 100.0, 265.7, 1000.0];

/// Returns a vehicle whose rates say that the clock drifts by `steered_m_s` more than it does.
fn steered(seconds: u32, steered_m_s: f64) -> impl Iterator<Item = Epoch> + Clone {
    drive(seconds).map(move |epoch| Epoch { drift_m_s: epoch.drift_m_s + steered_m_s, ..epoch })
}

#[test]
fn a_clock_that_is_steered_in_every_epoch_is_no_contradiction() {
    for steered_m_s in STEERED_M_S {
        for sign in [1.0, -1.0] {
            assert_eq!(contradictions(steered(1800, sign * steered_m_s)), [], "{steered_m_s} m/s");
        }
    }
}

#[test]
fn ranges_with_the_clock_applied_and_rates_of_the_oscillator_are_no_contradiction() {
    for drift_m_s in STEERED_M_S {
        // The oscillator's drift walks by some metres a second in half an hour.
        let applied = quartz(1.0, 1800).zip(drive(1800)).map(|(oscillator, epoch)| Epoch {
            clock_m: epoch.clock_m - 1e5 - 30.0 * epoch.time_s,
            drift_m_s: drift_m_s + oscillator.drift_m_s - 30.0,
            ..epoch
        });
        assert_eq!(contradictions(applied), [], "{drift_m_s} m/s");
    }
}

#[test]
fn a_clock_that_is_set_back_once_in_several_epochs_is_no_contradiction() {
    for (rate_hz, period_s) in [(5, 1.0), (10, 1.0), (10, 2.0), (1, 2.0)] {
        for steered_m_s in [5.0, 100.0, 265.7] {
            let set_back = (0..1800 * rate_hz).map(|index| {
                let time_s = f64::from(index) / f64::from(rate_hz);
                let since_s = time_s - period_s * (time_s / period_s + 1e-9).floor();
                let clock_m = steered_m_s * since_s + noise_m(index);
                Epoch { time_s, clock_m, drift_m_s: steered_m_s, ..Epoch::default() }
            });
            assert_eq!(contradictions(set_back), [], "{steered_m_s} m/s at {rate_hz} Hz every {period_s} s");
        }
    }
}

#[test]
fn a_steered_clock_is_not_compared_with_its_rates_across_a_tunnel() {
    let tunnel = |epoch: &Epoch| !(300.0..700.0).contains(&epoch.time_s);
    assert_eq!(contradictions(steered(1000, 265.7).filter(tunnel)), []);
    let elsewhere = steered(1000, 265.7).filter(tunnel).map(|epoch| {
        let error_m = if epoch.time_s < 300.0 { 0.0 } else { 100e3 };
        Epoch { clock_m: epoch.clock_m + error_m, ..epoch }
    });
    assert_eq!(contradictions(elsewhere), [(700.0, Alert::Clock)]);
}

#[test]
fn a_receiver_that_steers_still_shows_a_repeater_and_a_walk() {
    for steered_m_s in STEERED_M_S {
        let repeated = steered(600, steered_m_s).map(|epoch| {
            let delay_m = if epoch.time_s < 300.0 { 0.0 } else { 500.0 };
            Epoch { clock_m: epoch.clock_m + delay_m, ..epoch }
        });
        assert_eq!(contradictions(repeated).first(), Some(&(300.0, Alert::Clock)), "{steered_m_s} m/s");
        let walked =
            steered(600, steered_m_s).map(|epoch| Epoch { east_m: epoch.east_m + since(epoch), ..epoch });
        let seen = contradictions(walked);
        let (first_s, alert) = seen[0];
        assert_eq!(alert, Alert::Track, "{steered_m_s} m/s");
        assert!((300.0..=325.0).contains(&first_s), "{steered_m_s} m/s: at {first_s} s");
    }
}

#[test]
fn a_drag_off_that_begins_after_half_a_minute_is_no_steering() {
    for begin_s in [40.0, 60.0, 120.0, 240.0, 1000.0] {
        for drift_m_s in [0.5, 1.0, 10.0, 100.0, 500.0] {
            let dragged = drive(1800).map(|epoch| {
                let error_m = drift_m_s * (epoch.time_s - begin_s).max(0.0);
                Epoch { clock_m: epoch.clock_m + error_m, ..epoch }
            });
            let seen = contradictions(dragged);
            let about = std::format!("{drift_m_s} m/s from {begin_s} s");
            let Some(&(first_s, alert)) = seen.first() else { panic!("{about}: nothing is seen") };
            assert_eq!(alert, Alert::Clock, "{about}");
            let latest_s = (begin_s + 60.0).max(250.0);
            assert!((begin_s..=latest_s).contains(&first_s), "{about}: at {first_s} s");
            let clock = seen.iter().filter(|(time_s, _)| *time_s > 1200.0).count();
            assert!(clock >= 5, "{about}: {clock} alerts in the last ten minutes");
        }
    }
}

#[test]
fn a_repeater_of_the_first_seconds_is_seen_within_the_time_to_alert() {
    for begin_s in [2.0, 5.0, 9.0, 20.0, 100.0] {
        for delay_m in [200.0, 3000.0, 50e3] {
            let repeated = drive(300).map(|epoch| {
                let delay_m = if epoch.time_s < begin_s { 0.0 } else { delay_m };
                Epoch { clock_m: epoch.clock_m + delay_m, ..epoch }
            });
            let seen = contradictions(repeated);
            assert_eq!(seen.len(), 1, "{delay_m} m at {begin_s} s: {seen:?}");
            let late_s = seen[0].0 - begin_s;
            assert!((0.0..10.0).contains(&late_s), "{delay_m} m at {begin_s} s: {late_s} s late");
        }
    }
}

#[test]
fn a_clock_that_is_held_from_later_on_is_a_contradiction_once() {
    // The receiver begins to apply its clock to the ranges.
    let held = drive(900).map(|epoch| Epoch { clock_m: epoch.clock_m - 30.0 * since(epoch), ..epoch });
    let seen = contradictions(held);
    assert_eq!(seen.iter().map(|(_, alert)| *alert).collect::<std::vec::Vec<_>>(), [Alert::Clock]);
}

#[test]
fn steering_that_begins_later_is_a_contradiction() {
    // It cannot be told from a drag-off.
    let seen = contradictions(
        drive(900).zip(steered(900, 20.0)).map(
            |(before, after)| {
                if before.time_s < 300.0 { before } else { after }
            },
        ),
    );
    assert!(seen.first().is_some_and(|(first_s, alert)| *first_s <= 310.0 && *alert == Alert::Clock));
}

#[test]
fn a_station_whose_rates_are_off_by_little_for_hours_still_shows_a_drag_off() {
    // A steered maser: the clock stays within a metre, and the rates are off by 14 mm/s.
    let dragged = (0..8000).map(|second| {
        let time_s = f64::from(second);
        let clock_m = 0.5 * noise_m(second) + 0.5 * (time_s - 7200.0).max(0.0);
        Epoch { time_s, clock_m, drift_m_s: 0.014, ..Epoch::default() }
    });
    let seen = contradictions(dragged);
    assert!(
        seen.first()
            .is_some_and(|(first_s, alert)| { (7200.0..7260.0).contains(first_s) && *alert == Alert::Clock })
    );
    assert!(seen.len() > 600, "{} of 800 epochs", seen.len());
}
