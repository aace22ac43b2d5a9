//! Rates that contradict each other, in single epochs and for long.

use super::*;

/// Returns the alerts of a series whose rates are refused where `is_refused` says so, with their
/// times, s.
fn contradictions_refused(
    epochs: impl IntoIterator<Item = Epoch>,
    is_refused: impl Fn(&Epoch) -> bool,
) -> std::vec::Vec<(f64, Alert)> {
    let mut motion = Motion::new();
    let judged = epochs.into_iter().filter_map(|epoch| {
        let velocity = velocity(epoch);
        let rates = if is_refused(&epoch) { Err(VelocityError::Fault) } else { Ok(&velocity) };
        motion.judge(epoch.time_s, &report(epoch), rates).map(|alert| (epoch.time_s, alert))
    });
    judged.collect()
}

#[test]
fn a_position_far_from_where_its_rates_fit_is_an_alert() {
    // Rates that contradict each other give no velocity; a car may brake and turn meanwhile.
    let mut motion = Motion::new();
    for epoch in drive(100) {
        assert_eq!(motion.judge(epoch.time_s, &report(epoch), Ok(&velocity(epoch))), None);
    }
    let at =
        |time_s: f64, east_m: f64| Epoch { time_s, east_m, clock_m: 1e5 + 30.0 * time_s, ..Epoch::default() };
    let mut judge = |epoch: Epoch| motion.judge(epoch.time_s, &report(epoch), Err(VelocityError::Fault));
    assert_eq!(judge(at(110.0, 1980.0)), None, "stopped at once: 200 m short");
    assert_eq!(judge(at(110.0, 1980.0 + 800.0)), Some(Alert::Track));
    assert_eq!(judge(at(800.0, 60e3)), Some(Alert::Track));
}

#[test]
fn a_walk_that_is_seen_stays_seen_when_its_rates_fit_no_velocity() {
    // Some kilometres from the true place, true rates contradict each other.
    for begin_s in [30.0, 300.0] {
        let way_m = |epoch: &Epoch| 20.0 * (epoch.time_s - begin_s).max(0.0);
        let walked = drive(1500).map(|epoch| Epoch { east_m: epoch.east_m + way_m(&epoch), ..epoch });
        let seen = contradictions_refused(walked, |epoch| way_m(epoch) > 2000.0);
        let refused = begin_s as u32 + 101;
        assert!(is_alert_throughout(&seen, refused..1500), "from {begin_s} s: {} alerts", seen.len());
    }
}

#[test]
fn a_clock_that_leaps_while_rates_are_refused_is_an_alert() {
    let leapt = drive(400).map(|epoch| {
        let leap_m = if epoch.time_s < 300.0 { 0.0 } else { 3000.0 };
        Epoch { clock_m: epoch.clock_m + leap_m, ..epoch }
    });
    let seen = contradictions_refused(leapt, |epoch| epoch.time_s >= 300.0);
    assert_eq!(seen.first(), Some(&(300.0, Alert::Clock)));
}

/// Returns true in every tenth second.
fn is_refused_s(time_s: f64) -> bool {
    time_s as u32 % 10 == 5
}

/// Returns the alerts of a drive in which every tenth epoch has refused rates, and the clock leaps at
/// these times, s.
fn contradictions_of_starts(starts_s: &[f64]) -> std::vec::Vec<(f64, Alert)> {
    let started = drive(900).map(|epoch| {
        let count = starts_s.iter().filter(|start_s| epoch.time_s >= **start_s).count();
        Epoch { clock_m: epoch.clock_m + 36_900.0 * count as f64, ..epoch }
    });
    contradictions_refused(started, |epoch| is_refused_s(epoch.time_s))
}

#[test]
fn the_clock_of_a_start_is_one_alert() {
    assert_eq!(contradictions_of_starts(&[300.0]), [(300.0, Alert::Clock)]);
    assert_eq!(contradictions_of_starts(&[300.0, 600.0]), [(300.0, Alert::Clock), (600.0, Alert::Clock)]);
}

#[test]
fn rates_that_are_refused_for_moments_do_not_teach_that_a_position_has_no_noise() {
    let noisy = (0..40_000).map(|second| {
        let east_m = 8.0 * noise_m(second);
        Epoch { time_s: f64::from(second), east_m, clock_m: noise_m(second + 7919), ..Epoch::default() }
    });
    let seen = contradictions_refused(noisy, |epoch| epoch.time_s as u32 % 40 < 4);
    assert_eq!(seen.first(), None);
}

/// Returns the first second in which rates that are refused from 300 s on are no promise, of a receiver
/// that moves to the east from then on.
fn first_without_promise(way_m: impl Fn(f64) -> f64) -> Option<f64> {
    let mut motion = Motion::new();
    (0..1200).map(f64::from).find(|time_s| {
        let east_m = noise_m(*time_s as u32) + way_m(time_s - 300.0);
        let epoch = Epoch { time_s: *time_s, east_m, ..Epoch::default() };
        let velocity = velocity(epoch);
        let rates = if *time_s < 300.0 { Ok(&velocity) } else { Err(VelocityError::Fault) };
        assert_eq!(motion.judge(*time_s, &report(epoch), rates), None, "{time_s} s");
        motion.is_refused_for_long(*time_s)
    })
}

#[test]
fn rates_that_are_refused_where_the_receiver_rested_are_to_blame() {
    assert_eq!(first_without_promise(|_| 0.0), None);
    let walked = first_without_promise(|since_s| since_s.max(0.0));
    assert!(walked.is_some_and(|time_s| (306.0..310.0).contains(&time_s)), "{walked:?}");
    let leapt = first_without_promise(|since_s| if since_s < 0.0 { 0.0 } else { 20.0 });
    assert_eq!(leapt, Some(306.0));
}

#[test]
fn a_clock_that_leaps_again_soon_is_kept_in_mind() {
    let seen = contradictions_of_starts(&[300.0, 400.0]);
    assert_eq!(&seen[..2], [(300.0, Alert::Clock), (400.0, Alert::Clock)]);
    assert!(seen[2..].iter().all(|(time_s, alert)| is_refused_s(*time_s) && *alert == Alert::Track));
    assert!(seen.len() > 10, "{seen:?}");
}
