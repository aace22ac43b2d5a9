//! Receivers that measure no Doppler frequencies.

use super::*;

/// Returns the contradictions of a series without range rates, with their times, s.
pub(super) fn contradictions_without_rates(
    epochs: impl IntoIterator<Item = Epoch>,
) -> std::vec::Vec<(f64, Alert)> {
    let mut motion = Motion::new();
    let judged = epochs.into_iter().filter_map(|epoch| {
        let alert = motion.judge(epoch.time_s, &report(epoch), Err(VelocityError::Redundancy));
        alert.map(|alert| (epoch.time_s, alert))
    });
    judged.collect()
}

/// Returns the clock of a quartz whose frequency walks at random, once in `step_s`, without noise
/// of the ranges. The walk is 0.2 m/s in a second, as that of an ordinary receiver.
pub(super) fn quartz(step_s: f64, epochs: u32) -> impl Iterator<Item = Epoch> {
    let (mut clock_m, mut drift_m_s) = (0.0, 30.0);
    (0..epochs).map(move |index| {
        // Twelve uniform numbers less six are nearly normal.
        let normal: f64 = (0..12).map(|part| 0.5 * noise_m(12 * index + part)).sum();
        drift_m_s += 0.2 * step_s.sqrt() * normal;
        clock_m += drift_m_s * step_s;
        let clock_m = clock_m + noise_m(index + 7919);
        Epoch { time_s: f64::from(index) * step_s, clock_m, drift_m_s, ..Epoch::default() }
    })
}

#[test]
fn a_place_is_compared_with_nothing() {
    let leaping = drive(100).map(|epoch| Epoch { east_m: 1e4 * epoch.time_s, ..epoch });
    assert_eq!(contradictions_without_rates(leaping), []);
}

#[test]
fn a_clock_that_its_past_explains_is_no_contradiction() {
    assert_eq!(contradictions_without_rates(drive(1800)), []);
    // Ten hours of a quartz at 1 Hz, and four days at 30 s and at 60 s.
    assert_eq!(contradictions_without_rates(quartz(1.0, 36_000)), []);
    assert_eq!(contradictions_without_rates(quartz(30.0, 11_520)), []);
    assert_eq!(contradictions_without_rates(quartz(60.0, 5760)), []);
    let millisecond_m = SPEED_OF_LIGHT_M_S * 1e-3;
    let shifted = quartz(1.0, 3600).map(|epoch| Epoch {
        clock_m: epoch.clock_m - (epoch.time_s / 45.0).floor() * millisecond_m,
        ..epoch
    });
    assert_eq!(contradictions_without_rates(shifted), []);
    // A receiver that moves its clock by up to 30 m at every epoch.
    let steered = (0..3600).map(|second| {
        let clock_m = 30.0 * noise_m(second);
        Epoch { time_s: f64::from(second), clock_m, ..Epoch::default() }
    });
    assert_eq!(contradictions_without_rates(steered), []);
}

#[test]
fn another_clock_is_seen_at_once() {
    for (step_s, other_m) in [(1.0, 150.0), (1.0, 1000.0), (30.0, 400.0)] {
        let other = |epoch: Epoch| {
            let error_m = if epoch.time_s < 60.0 * step_s { 0.0 } else { other_m };
            Epoch { clock_m: epoch.clock_m + error_m, ..epoch }
        };
        let seen = contradictions_without_rates(quartz(step_s, 120).map(other));
        assert_eq!(seen, [(60.0 * step_s, Alert::Clock)], "{other_m} m");
    }
    let infinite = |epoch: Epoch| {
        if epoch.time_s < 60.0 { epoch } else { Epoch { clock_m: f64::NAN, ..epoch } }
    };
    let seen = contradictions_without_rates(drive(100).map(infinite));
    assert_eq!(seen.first(), Some(&(60.0, Alert::Clock)));
}

/// A wild clock widens its bound by 150 m at most, beside two levels.
#[test]
fn a_wild_clock_does_not_hide_another() {
    let wild = |second: u32| {
        let swing_m = if second.is_multiple_of(2) { 40.0 } else { -40.0 };
        let other_m = if second < 200 { 0.0 } else { 600.0 };
        Epoch { time_s: f64::from(second), clock_m: swing_m + other_m, ..Epoch::default() }
    };
    let seen = contradictions_without_rates((0..201).map(wild));
    assert_eq!(seen, [(200.0, Alert::Clock)]);
}

#[test]
fn a_clock_is_compared_across_a_tunnel() {
    let tunnel = |epoch: &Epoch| !(100.0..400.0).contains(&epoch.time_s);
    assert_eq!(contradictions_without_rates(quartz(1.0, 600).filter(tunnel)), []);
    let counterfeit = quartz(1.0, 600).filter(tunnel).map(|epoch| {
        let error_m = if epoch.time_s < 400.0 { 0.0 } else { 100e3 };
        Epoch { clock_m: epoch.clock_m + error_m, ..epoch }
    });
    assert_eq!(contradictions_without_rates(counterfeit), [(400.0, Alert::Clock)]);
}
