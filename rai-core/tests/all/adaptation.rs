//! Adaptive sigmas: their factor, their delay and their bounds.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::noise::Noise;
use crate::sky::{CAPACITY, DIRECTIONS, SIGMA_M, observe, receiver, satellite};
use raim_core::epoch::Epoch;
use raim_core::internals::weighting::adaptation::{Adaptation, LEAST_DOF, LEAST_NOISE, Residuals};
use raim_core::monitor as strategy;
use raim_core::monitor::{Monitor, Strategy};
use raim_core::report::{Report, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::Constellation;

/// Returns epochs with ten degrees of freedom and this SSE/dof, `step_s` apart.
fn after(epochs: u32, step_s: f64, factor: f32) -> Adaptation {
    let mut adaptation = Adaptation::new();
    for index in 0..epochs {
        adaptation.learn(step_s * f64::from(index), Residuals { sse: 10.0 * factor, dof: 10 });
    }
    adaptation
}

fn is_none(noise: f32) -> bool {
    noise.to_bits() == 1_f32.to_bits()
}

#[test]
fn nothing_is_lowered_before_ten_minutes_and_300_degrees_of_freedom() {
    assert!(is_none(after(600, 1.0, 0.25).noise(599.0)));
    assert!(after(601, 1.0, 0.25).noise(600.0) < 0.5);
    // Every half minute it takes a quarter of an hour.
    let few = LEAST_DOF / 10 - 1;
    assert!(is_none(after(few, 30.0, 0.25).noise(30.0 * f64::from(few))));
    assert!(after(few + 1, 30.0, 0.25).noise(30.0 * f64::from(few)) < 0.5);
}

#[test]
fn noise_is_the_upper_bound_of_the_residuals() {
    // χ² at a probability of 0.1 %, for 600 and 6000 degrees of freedom: bisected on the series of
    // the incomplete gamma function.
    for (epochs, step_s, quantile) in [(60, 11.0, 498.622_873_5), (600, 1.1, 5_667.173_441)] {
        let dof = f64::from(epochs) * 10.0;
        let have = f64::from(after(epochs, step_s, 0.5).noise(650.0));
        let want = 0.5 * dof / quantile;
        assert!((have / want - 1.0).abs() < 1e-4, "{epochs} epochs: have {have}, want {want}");
    }
}

#[test]
fn noise_stays_between_a_ninth_and_one() {
    assert_eq!(after(700, 1.0, 0.01).noise(699.0).to_bits(), LEAST_NOISE.to_bits());
    assert!(is_none(after(700, 1.0, 100.0).noise(699.0)));
}

#[test]
fn what_is_older_than_an_hour_is_forgotten() {
    let mut adaptation = after(700, 1.0, 4.0);
    for second in 700..4700 {
        adaptation.learn(f64::from(second), Residuals { sse: 2.5, dof: 10 });
        assert_eq!(is_none(adaptation.noise(f64::from(second))), second < 3960, "{second}");
    }
}

#[test]
fn time_that_goes_back_begins_anew_and_nonsense_is_not_learned() {
    let mut adaptation = after(700, 1.0, 0.25);
    adaptation.learn(699.0, Residuals { sse: f32::NAN, dof: 10 });
    adaptation.learn(f64::NAN, Residuals { sse: 1.0, dof: 10 });
    assert!(adaptation.noise(699.0) < 1.0);
    assert!(is_none(adaptation.noise(f64::NAN)));
    adaptation.learn(-10_000.0, Residuals { sse: 1.0, dof: 10 });
    assert!(is_none(adaptation.noise(-9_000.0)));
}

#[test]
fn a_few_noisy_epochs_end_a_noise_below_one() {
    let mut adaptation = after(1000, 1.0, 0.25);
    assert!(adaptation.noise(999.0) < 0.5);
    for second in 1000..1100 {
        adaptation.learn(f64::from(second), Residuals { sse: 10.0, dof: 10 });
    }
    assert!(is_none(adaptation.noise(1099.0)));
}

/// Reports of a quarter of an hour at this share of the sigmas, and of `epochs` at another.
fn quiet_then(strategy: Strategy, noise_after: f64, epochs: u32, seed: u64) -> Vec<Report<CAPACITY>> {
    const QUIET: u32 = 900;
    let mut monitor = Monitor::<f64, CAPACITY>::new(Requirements::non_precision_approach()).unwrap();
    monitor.set_strategy(strategy).unwrap();
    let mut chance = Noise(seed);
    let mut judge = |second: u32| {
        let sigmas = if second < QUIET { 0.45 } else { noise_after };
        let mut epoch = Epoch::new(f64::from(second));
        for (index, direction) in DIRECTIONS.into_iter().enumerate() {
            let mut seen = observe(satellite(Constellation::Gps, index + 1), direction, 0.0);
            seen.range_m += sigmas * SIGMA_M * chance.normal();
            epoch.push(seen).unwrap();
        }
        monitor.process(&epoch)
    };
    (0..QUIET + epochs).map(&mut judge).skip(QUIET as usize).collect()
}

#[test]
fn noise_that_returns_after_a_quiet_quarter_of_an_hour_costs_few_epochs() {
    let lost = |report: &&Report<CAPACITY>| !matches!(report.verdict, Verdict::Protected(_));
    let epochs = (1..=20).flat_map(|seed| quiet_then(Strategy::DEFAULT, 1.0, 100, seed)).collect::<Vec<_>>();
    let count = epochs.iter().filter(lost).count();
    assert!(count * 20 < epochs.len(), "{count} of {}", epochs.len());
}

/// Levels in the last epoch of a quarter of an hour of a third of the noise, after which the
/// satellites and the place may be others.
fn last_hpl_m(noise: strategy::Noise, change: impl Fn(&mut Epoch<CAPACITY>)) -> f64 {
    const LAST: u32 = 900;
    let mut monitor = Monitor::<f64, CAPACITY>::new(Requirements::non_precision_approach()).unwrap();
    monitor.set_strategy(Strategy::DEFAULT.with_noise(noise)).unwrap();
    let (mut chance, mut hpl_m) = (Noise(5), f64::NAN);
    for second in 0..=LAST {
        let mut epoch = Epoch::new(f64::from(second));
        for (index, direction) in DIRECTIONS.into_iter().enumerate() {
            let mut seen = observe(satellite(Constellation::Gps, index + 1), direction, 0.0);
            seen.range_m += 0.3 * SIGMA_M * chance.normal();
            epoch.push(seen).unwrap();
        }
        if second == LAST {
            change(&mut epoch);
        }
        hpl_m = monitor.process(&epoch).protection.unwrap().hpl_m;
    }
    hpl_m
}

/// Returns the observations of an epoch with other ranges.
fn again(epoch: &mut Epoch<CAPACITY>, error_m: impl Fn(usize) -> Option<f64>) {
    let observations = epoch.observations().to_vec();
    epoch.restart(epoch.time_s());
    for (index, mut observation) in observations.into_iter().enumerate() {
        if let Some(error_m) = error_m(index) {
            observation.range_m += error_m;
            epoch.push(observation).unwrap();
        }
    }
}

#[test]
fn what_quiet_minutes_lowered_is_taken_back_in_the_epoch_that_changes() {
    let plain_m = last_hpl_m(strategy::Noise::Geodetic, |_| {});
    let quiet_m = last_hpl_m(strategy::Noise::Auto, |_| {});
    assert!((0.3..0.45).contains(&(quiet_m / plain_m)), "{quiet_m} of {plain_m}");
    // A satellite is missing.
    let fewer = |epoch: &mut Epoch<CAPACITY>| again(epoch, |index| (index != 3).then_some(0.0));
    assert!(last_hpl_m(strategy::Noise::Auto, fewer) >= last_hpl_m(strategy::Noise::Geodetic, fewer));
    // A range is wrong by what the larger sigmas allow.
    let wrong = |epoch: &mut Epoch<CAPACITY>| again(epoch, |index| Some(if index == 3 { 12.0 } else { 0.0 }));
    assert!(last_hpl_m(strategy::Noise::Auto, wrong) >= last_hpl_m(strategy::Noise::Geodetic, wrong));
    // The receiver is elsewhere: 20 m higher.
    let higher = |epoch: &mut Epoch<CAPACITY>| {
        again(epoch, |index| {
            DIRECTIONS.get(index).map(|(_, elevation_deg)| -20.0 * elevation_deg.to_radians().sin())
        });
    };
    assert!(last_hpl_m(strategy::Noise::Auto, higher) >= last_hpl_m(strategy::Noise::Geodetic, higher));
}

#[test]
fn noise_beyond_the_sigmas_raises_the_levels() {
    let median_hpl_m = |noise: f64| {
        let fixed = Strategy::DEFAULT.with_noise(strategy::Noise::Geodetic);
        let reports = quiet_then(fixed, noise, 120, 7);
        let promised = |report: &&Report<CAPACITY>| matches!(report.verdict, Verdict::Protected(_));
        let mut levels: Vec<_> = reports.iter().skip(60).filter(promised).collect();
        assert!(levels.len() >= 57, "{noise}: {} of 60", levels.len());
        let error_m =
            |report: &Report<CAPACITY>| report.solution.as_ref().unwrap().position.distance_m(receiver());
        assert!(levels.iter().all(|report| {
            let levels = report.protection.as_ref().unwrap();
            error_m(report) < levels.hpl_m.hypot(levels.vpl_m)
        }));
        levels.sort_by(|a, b| {
            a.protection.as_ref().unwrap().hpl_m.total_cmp(&b.protection.as_ref().unwrap().hpl_m)
        });
        levels[levels.len() / 2].protection.as_ref().unwrap().hpl_m
    };
    let plain_m = median_hpl_m(0.5);
    for noise in [1.5, 2.0, 4.0] {
        let grown = median_hpl_m(noise) / plain_m;
        // At least by the noise; by a third more at most, because the noisiest span counts.
        assert!((noise..1.4 * noise).contains(&grown), "{noise}: levels grow by {grown}");
    }
}

#[test]
fn noise_that_no_receiver_can_track_promises_nothing() {
    let reports = quiet_then(Strategy::DEFAULT, 150.0, 120, 7);
    assert!(!reports.iter().any(|report| matches!(report.verdict, Verdict::Protected(_))));
}
