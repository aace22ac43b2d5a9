//! The coasting clock: forecasts of clocks whose law is known, windows with gaps and jumps, hostile
//! input.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

use crate::noise::Noise;
use proptest::prelude::*;
use raim_core::internals::clock::{
    Autoregression, CoastingClock, Forecast, HOLD_OVER_STEPS, INFLATION, MIN_VALUES, Observed, WINDOW,
};
use raim_core::internals::numeric::real::Real;

/// Returns the levels of a clock each second, with a drift of 300 m/s and a noise of 1 m in each
/// second, measured exactly.
fn crystal(seed: u64, values: usize) -> Vec<f64> {
    let mut noise = Noise(seed);
    let mut level_m = 299_792_458.0;
    (0..values)
        .map(|_| {
            level_m += 300.0 + noise.normal();
            level_m
        })
        .collect()
}

/// Returns a clock that has seen `levels_m` at 0 s, 1 s, …
fn after<T: Real>(levels_m: &[f64]) -> CoastingClock<T> {
    let mut clock = CoastingClock::new();
    for (second, &level_m) in levels_m.iter().enumerate() {
        clock.observe(second as f64, level_m, 1.0);
    }
    clock
}

fn assert_close(have: f64, want: f64, tolerance: f64) {
    assert!((have - want).abs() <= tolerance, "have {have}, want {want} within {tolerance}");
}

/// Checks that the continuation of a steady clock, which is a straight line, is exact, whatever the
/// level.
fn steady_clock_is_continued<T: Real>() {
    let at = |second: f64| 299_792_458.0 + 300.0 * second;
    let levels_m: Vec<f64> = (0..WINDOW).map(|second| at(second as f64)).collect();
    let clock = after::<T>(&levels_m);
    for steps in [1, 10, HOLD_OVER_STEPS] {
        let time_s = (WINDOW - 1 + steps) as f64;
        let have = clock.forecast(time_s).expect("a full window");
        assert_eq!(have.steps, steps);
        assert_close(have.value_m, at(time_s), 1e-6);
        assert_close(have.sigma_predict_m, 0.0, 1e-6);
        assert_close(have.sigma_m, 1.0, 1e-6);
    }
}

#[test]
fn steady_clock_of_a_second_is_continued_exactly_in_both_precisions() {
    steady_clock_is_continued::<f64>();
    steady_clock_is_continued::<f32>();
}

/// Checks that a harmonic process is found. `cos ωt` obeys `1 − 2 cos ω z + z²` forwards and
/// backwards, and `(−1)^t` obeys `1 + z`, so that their sum obeys the product of both.
fn harmonic_process_is_found<T: Real>(tolerance: f64) {
    let omega = core::f64::consts::TAU * 7.0 / 60.0;
    let series: Vec<Option<T>> =
        (0..60).map(|t| Some(T::narrow((omega * f64::from(t)).cos() + f64::from(1 - t % 2 * 2)))).collect();
    let process = Autoregression::fit(series.iter().copied());
    let sum = 2.0 * omega.cos() - 1.0;
    for (have, want) in process.coefficients().into_iter().zip([sum, sum, -1.0]) {
        assert_close(have.widen(), want, tolerance);
    }
    assert_eq!(process.rows(), 57);
    assert_close(process.variance().widen(), 0.0, tolerance * tolerance);
}

#[test]
fn process_that_runs_alike_in_both_directions_is_found_exactly() {
    harmonic_process_is_found::<f64>(1e-12);
    harmonic_process_is_found::<f32>(1e-5);
}

#[test]
fn single_and_double_precision_forecast_alike() {
    let levels_m = crystal(3, WINDOW);
    for steps in [1, 5, 30] {
        let time_s = (WINDOW - 1 + steps) as f64;
        let want = after::<f64>(&levels_m).forecast(time_s).expect("a full window");
        let have = after::<f32>(&levels_m).forecast(time_s).expect("a full window");
        assert_close(have.value_m, want.value_m, 1e-3);
        assert_close(have.sigma_predict_m, want.sigma_predict_m, 1e-3 * want.sigma_predict_m);
    }
}

/// Errors of many one-step forecasts over their standard deviations, as a root mean square.
fn one_step_error_ratio(values: usize) -> f64 {
    let runs = 2000;
    let squares: f64 = (0..runs)
        .map(|seed| {
            let levels_m = crystal(seed, values + 1);
            let forecast = after::<f32>(&levels_m[..values]).forecast(values as f64).expect("enough values");
            let ratio = (levels_m[values] - forecast.value_m) / forecast.sigma_predict_m;
            ratio * ratio
        })
        .sum();
    (squares / runs as f64).sqrt()
}

#[test]
fn actual_one_step_error_is_what_the_inflation_covers() {
    let ratio = one_step_error_ratio(WINDOW);
    println!("one-step error / sigma_predict, {WINDOW} values: {ratio:.3}");
    assert!((1.0..INFLATION).contains(&ratio), "{ratio}");
}

#[test]
fn sigma_is_that_of_the_last_clock_and_the_inflated_forecast() {
    let Forecast { sigma_predict_m, sigma_m, .. } =
        after::<f64>(&crystal(1, WINDOW)).forecast(WINDOW as f64).expect("a full window");
    assert_close(sigma_m, (1.0 + (1.2 * sigma_predict_m).powi(2)).sqrt(), 1e-12);
}

#[test]
fn nothing_is_forecast_from_fewer_than_twelve_values() {
    let levels_m = crystal(1, MIN_VALUES);
    assert_eq!(after::<f32>(&levels_m[..MIN_VALUES - 1]).forecast(MIN_VALUES as f64), None);
    assert!(after::<f32>(&levels_m).forecast(MIN_VALUES as f64).is_some());
}

#[test]
fn only_the_last_window_counts() {
    let levels_m = crystal(5, 100);
    let have = after::<f64>(&levels_m).forecast(100.0).expect("a full window");
    let want = after::<f64>(&levels_m[100 - WINDOW..]).forecast(WINDOW as f64).expect("a full window");
    // The differences are kept relative to another first one: equal to rounding.
    assert_close(have.value_m, want.value_m, 1e-6);
    assert_close(have.sigma_m, want.sigma_m, 1e-6);
}

#[test]
fn forecasts_grow_less_sure_through_an_outage_and_then_end() {
    let clock = after::<f32>(&crystal(7, WINDOW));
    let ahead: Vec<Forecast> = (0..HOLD_OVER_STEPS)
        .map(|step| clock.forecast((WINDOW + step) as f64).expect("within the hold-over"))
        .collect();
    assert!(ahead.windows(2).all(|pair| pair[0].sigma_m < pair[1].sigma_m));
    assert_eq!(clock.forecast((WINDOW + HOLD_OVER_STEPS) as f64), None);
    // Noise of the rate of 1 m per step walks away with the root of the steps.
    let last = ahead[HOLD_OVER_STEPS - 1].sigma_predict_m;
    assert!((3.0..16.0).contains(&last), "{last} m after a minute");
}

#[test]
fn window_continues_after_an_outage_as_if_it_had_been_forecast() {
    let levels_m = crystal(11, WINDOW + 21);
    let mut clock = after::<f64>(&levels_m[..WINDOW]);
    let time_s = (WINDOW + 19) as f64;
    assert_eq!(clock.observe(time_s, levels_m[WINDOW + 19], 1.0), Observed::Continued);
    let have = clock.forecast(time_s + 1.0).expect("the window goes on");
    assert_eq!(have.steps, 1);
    assert_close(have.value_m, levels_m[WINDOW + 20], 4.0);
}

#[test]
fn window_full_of_gaps_is_not_surer_than_one_without() {
    // Two values, two missing: no four differences in a row, so nothing can be fitted at all.
    let (mut thin, mut dense) = (CoastingClock::<f32>::new(), CoastingClock::<f32>::new());
    for (second, level_m) in crystal(13, 240).into_iter().enumerate() {
        if second % 4 < 2 {
            assert_ne!(thin.observe(second as f64, level_m, 1.0), Observed::Refused);
        }
        // Twelve values, one missing.
        if second % 13 < 12 {
            dense.observe(second as f64, level_m, 1.0);
        }
    }
    assert_eq!(thin.forecast(240.0), None);
    let sigma_m = dense.forecast(240.0).expect("enough values in a row").sigma_predict_m;
    assert!((0.6..1.6).contains(&sigma_m), "{sigma_m} m where the noise is 1 m");
}

#[test]
fn outage_longer_than_the_hold_over_restarts_the_window() {
    let mut clock = after::<f32>(&crystal(1, WINDOW));
    let time_s = (WINDOW + HOLD_OVER_STEPS) as f64;
    assert_eq!(clock.observe(time_s, 299_828_000.0, 1.0), Observed::Restarted);
    assert_eq!(clock.forecast(time_s + 1.0), None);
}

#[test]
fn time_that_goes_back_or_stands_still_restarts_the_window() {
    for time_s in [WINDOW as f64 - 1.0, 3.0, -1e9] {
        let levels_m = crystal(1, WINDOW);
        let mut clock = after::<f32>(&levels_m);
        assert_eq!(clock.forecast(time_s), None);
        assert_eq!(clock.observe(time_s, levels_m[WINDOW - 1], 1.0), Observed::Restarted, "{time_s} s");
    }
}

#[test]
fn interval_that_is_no_multiple_of_the_spacing_restarts_the_window() {
    let levels_m = crystal(1, WINDOW);
    let mut clock = after::<f32>(&levels_m);
    assert_eq!(clock.forecast(WINDOW as f64 + 0.5), None);
    assert_eq!(clock.observe(WINDOW as f64 + 0.5, levels_m[WINDOW - 1] + 450.0, 1.0), Observed::Restarted);
}

#[test]
fn spacing_learned_across_a_gap_is_learned_anew() {
    let levels_m = crystal(17, 40);
    let mut clock = CoastingClock::<f32>::new();
    for (second, &level_m) in levels_m.iter().enumerate().filter(|&(second, _)| second != 1) {
        clock.observe(second as f64, level_m, 1.0);
    }
    assert_close(clock.forecast(40.0).expect("a window").value_m, levels_m[39] + 300.0, 5.0);
}

#[test]
fn window_of_thirty_seconds_between_values_is_as_good() {
    let levels_m = crystal(19, WINDOW);
    let mut clock = CoastingClock::<f64>::new();
    for (index, &level_m) in levels_m.iter().enumerate() {
        assert_ne!(clock.observe(30.0 * index as f64, level_m, 1.0), Observed::Refused);
    }
    let want = after::<f64>(&levels_m).forecast(WINDOW as f64);
    assert_eq!(clock.forecast(30.0 * WINDOW as f64), want);
}

#[test]
fn jump_of_a_millisecond_or_of_a_steering_step_restarts_the_window() {
    for (values, jump_m) in
        [(WINDOW, 299_792.458), (WINDOW, -299_792.458), (WINDOW, 300.0), (6, 299_792.458), (2, 1e8)]
    {
        let mut levels_m = crystal(23, values + 40);
        let mut clock = after::<f32>(&levels_m[..values]);
        levels_m[values..].iter_mut().for_each(|level_m| *level_m += jump_m);
        let uptake: Vec<Observed> =
            (values..values + 40).map(|second| clock.observe(second as f64, levels_m[second], 1.0)).collect();
        assert_eq!(uptake[0], Observed::Restarted, "{jump_m} m after {values} values");
        assert!(uptake[1..].iter().all(|&uptake| uptake == Observed::Continued));
        let have = clock.forecast((values + 40) as f64).expect("a new window");
        assert_close(have.value_m, levels_m[values + 39] + 300.0, 5.0);
        assert!(have.sigma_predict_m < 2.0, "{} m: the jump is in the window", have.sigma_predict_m);
    }
}

#[test]
fn value_out_of_bounds_changes_nothing() {
    let clock = after::<f32>(&crystal(29, WINDOW));
    let want = clock.forecast(WINDOW as f64);
    let nan = f64::NAN;
    for (time_s, level_m, sigma_m) in [
        (nan, 3e8, 1.0),
        (60.0, nan, 1.0),
        (60.0, 1e10, 1.0),
        (60.0, 3e8, nan),
        (60.0, 3e8, 0.0),
        (60.0, 3e8, 1e9),
    ] {
        let mut clock = clock.clone();
        assert_eq!(clock.observe(time_s, level_m, sigma_m), Observed::Refused);
        assert_eq!(clock.forecast(WINDOW as f64), want);
    }
    assert_eq!(clock.forecast(nan), None);
    assert_eq!(clock.forecast(f64::INFINITY), None);
}

#[test]
fn unstable_fit_forecasts_no_farther_than_its_variance_allows() {
    // Differences that grow threefold each step: a process that no hold-over can follow.
    let mut level_m = 0.0;
    let mut clock = CoastingClock::<f32>::new();
    for second in 0..12 {
        clock.observe(f64::from(second), level_m, 1e6);
        level_m += 1e-2 * 3f64.powi(second) + f64::from(second % 3);
    }
    let sound = |forecast: Forecast| forecast.value_m.is_finite() && forecast.sigma_m <= 1000.0;
    assert!((0..80).filter_map(|step| clock.forecast(12.0 + f64::from(step))).all(sound));
}

/// Returns any sequence of steps in time and of levels, most of them sensible.
fn observations() -> impl Strategy<Value = Vec<(f64, f64, f64)>> {
    let elapsed_s = prop_oneof![6 => Just(1.0), 1 => Just(2.0), 1 => -2.0..90.0, 1 => any::<f64>()];
    let step_m = prop_oneof![6 => -5.0..5.0, 1 => -1e9..1e9, 1 => any::<f64>()];
    let sigma_m = prop_oneof![6 => 0.1..10.0, 1 => any::<f64>()];
    prop::collection::vec((elapsed_s, step_m, sigma_m), 1..200)
}

proptest! {
    #[test]
    fn whatever_comes_in_no_forecast_is_other_than_a_number(observations in observations()) {
        let mut clock = CoastingClock::<f32>::new();
        let (mut time_s, mut level_m) = (0.0, 0.0);
        for (elapsed_s, step_m, sigma_m) in observations {
            let (next_s, next_m) = (time_s + elapsed_s, level_m + step_m);
            if clock.observe(next_s, next_m, sigma_m) != Observed::Refused {
                (time_s, level_m) = (next_s, next_m);
            }
            for steps in [1.0, 2.0, 59.0, 61.0] {
                if let Some(forecast) = clock.forecast(time_s + steps) {
                    prop_assert!(forecast.value_m.is_finite());
                    prop_assert!(forecast.sigma_predict_m >= 0.0 && forecast.sigma_m > 0.0 && forecast.sigma_m <= 1000.0);
                }
            }
        }
    }
}
