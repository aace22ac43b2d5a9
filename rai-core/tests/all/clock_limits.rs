//! Values that continue the window of a coasting clock and values that restart it: just within each
//! bound, and just beyond.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use raim_core::internals::clock::{CoastingClock, Observed};

/// Returns a clock that has seen `values` of a steady drift of 300 m a second, with standard
/// deviation `sigma_m`.
fn steady(spacing_s: f64, values: u32, sigma_m: f64) -> CoastingClock<f64> {
    let mut clock = CoastingClock::new();
    for value in 0..values {
        let time_s = spacing_s * f64::from(value);
        clock.observe(time_s, 300.0 * time_s, sigma_m);
    }
    clock
}

#[track_caller]
fn check(clock: &CoastingClock<f64>, (time_s, level_m, sigma_m): (f64, f64, f64), want: Observed) {
    assert_eq!(clock.clone().observe(time_s, level_m, sigma_m), want);
}

#[test]
fn a_jump_is_5_33_sigma_of_forecast_and_reading_together() {
    // 5.33 · √(2² + 3²) = 19.22 m; a steady clock's process adds nothing.
    let clock = steady(1.0, 30, 2.0);
    for sign in [1.0, -1.0] {
        check(&clock, (30.0, 9000.0 + sign * 19.1, 3.0), Observed::Continued);
        check(&clock, (30.0, 9000.0 + sign * 19.3, 3.0), Observed::Restarted);
    }
}

#[test]
fn before_anything_is_forecast_a_jump_is_0_1_ppm_beyond_the_noise() {
    // Per step: 30 · 1 + 5.33 · (2 + 3) = 56.65 m, and 30 · 2 + 26.65 = 86.65 m where steps are of
    // two seconds.
    for (spacing_s, limit_m) in [(1.0, 56.65), (2.0, 86.65)] {
        let clock = steady(spacing_s, 4, 2.0);
        let time_s = 4.0 * spacing_s;
        for sign in [1.0, -1.0] {
            let level_m = |off_m: f64| 300.0 * time_s + sign * (limit_m + off_m);
            check(&clock, (time_s, level_m(-0.1), 3.0), Observed::Continued);
            check(&clock, (time_s, level_m(0.1), 3.0), Observed::Restarted);
        }
    }
}

#[test]
fn before_anything_is_forecast_a_change_of_rate_is_from_the_mean_rate() {
    // Rates of 300, 320 and 340 m/s: their mean is 320.
    let mut clock = CoastingClock::<f64>::new();
    for (time_s, level_m) in [(0.0, 0.0), (1.0, 300.0), (2.0, 620.0), (3.0, 960.0)] {
        clock.observe(time_s, level_m, 2.0);
    }
    check(&clock, (4.0, 960.0 + 320.0 + 56.5, 3.0), Observed::Continued);
    check(&clock, (4.0, 960.0 + 320.0 + 56.8, 3.0), Observed::Restarted);
    check(&clock, (4.0, 960.0 + 320.0 - 56.5, 3.0), Observed::Continued);
    check(&clock, (4.0, 960.0 + 320.0 - 56.8, 3.0), Observed::Restarted);
}

#[test]
fn steps_are_counted_in_the_windows_own_spacing() {
    let clock = steady(30.0, 20, 1.0);
    let forecast = clock.forecast(19.0 * 30.0 + 120.0).unwrap();
    assert_eq!(forecast.steps, 4);
    assert!((forecast.value_m - 300.0 * (19.0 * 30.0 + 120.0)).abs() < 1e-6, "{}", forecast.value_m);
    check(&clock, (21.0 * 30.0, 300.0 * 21.0 * 30.0, 1.0), Observed::Continued);
}

#[test]
fn a_millisecond_is_no_spacing() {
    let mut clock = CoastingClock::<f64>::new();
    clock.observe(0.0, 0.0, 1.0);
    check(&clock, (0.001, 0.3, 1.0), Observed::Restarted);
    check(&clock, (0.0011, 0.33, 1.0), Observed::Continued);
}

#[test]
fn a_forecast_is_no_surer_than_the_last_value() {
    for sigma_m in [0.5, 3.0, 900.0] {
        let forecast = steady(1.0, 30, sigma_m).forecast(30.0).unwrap();
        assert!((forecast.sigma_m - sigma_m).abs() < 1e-6, "have {}, want {sigma_m}", forecast.sigma_m);
    }
    assert_eq!(steady(1.0, 30, 1001.0).forecast(30.0), None, "beyond a kilometre there is none");
}

/// Differences of 300 m with a wobble that three coefficients describe exactly, and that cancels
/// over 40.
fn wobbling(values: u32) -> Vec<f64> {
    let difference = |step: u32| {
        let (angle, sign) = (f64::from(step) * std::f64::consts::TAU / 10.0, f64::from(step % 2) * 2.0 - 1.0);
        300.0 + 2.0 * angle.cos() + sign
    };
    let next = |level_m: &mut f64, step: u32| {
        *level_m += difference(step);
        Some(*level_m)
    };
    (0..values).scan(0.0, next).collect()
}

#[test]
fn a_wobble_is_continued_through_an_outage() {
    let levels_m = wobbling(60);
    let mut clock = CoastingClock::<f64>::new();
    for (second, &level_m) in levels_m.iter().enumerate().take(41) {
        clock.observe(second as f64, level_m, 1.0);
    }
    for second in 41..60 {
        let have = clock.forecast(second as f64).unwrap().value_m;
        let want = *levels_m.get(second).unwrap();
        assert!((have - want).abs() < 1e-6, "{second} s: have {have}, want {want}");
    }
}

#[test]
fn variance_of_a_forecast_is_that_of_the_summed_responses() {
    // Any differences serve: the response of the fitted process to an impulse is computed from its
    // coefficients.
    let mut clock = CoastingClock::<f64>::new();
    let mut level_m = 0.0;
    for second in 0..60 {
        level_m += 300.0 + (1.3 * f64::from(second)).sin() + 0.7 * (0.4 * f64::from(second * second)).cos();
        clock.observe(f64::from(second), level_m, 1.0);
    }
    let ([a1, a2, a3], variance) = (clock.process().coefficients(), clock.process().variance());
    let (mut responses, mut level, mut sum) = ([1.0, 0.0, 0.0], 1.0, 0.0);
    for steps in 1..=20 {
        sum += level * level;
        let have = clock.forecast(59.0 + f64::from(steps)).unwrap().sigma_predict_m;
        let want = (sum * variance).sqrt();
        assert!((have / want - 1.0).abs() < 1e-9, "{steps} steps: have {have}, want {want}");
        let [r1, r2, r3] = responses;
        let response = a1 * r1 + a2 * r2 + a3 * r3;
        responses = [response, r1, r2];
        level += response;
    }
}
