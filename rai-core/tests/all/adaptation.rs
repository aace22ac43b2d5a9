//! Adaptive sigmas: their factor, their delay and their bounds.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::noise::Noise;
use crate::sky::{CAPACITY, DIRECTIONS, SIGMA_M, observe, satellite};
use raim_core::epoch::Epoch;
use raim_core::monitor::{Monitor, Strategy};
use raim_core::report::{Report, Unavailable, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::{Constellation, SatelliteId};
use raim_core::weighting::adaptation::{Adaptation, LEAST_DOF, Residuals};

/// Returns one epoch a second with ten degrees of freedom, each with this SSE/dof.
fn after(epochs: u32, factor: f32) -> Adaptation {
    let mut adaptation = Adaptation::new();
    for second in 0..epochs {
        adaptation.learn(f64::from(second), Residuals { sse: 10.0 * factor, dof: 10 });
    }
    adaptation
}

#[test]
fn nothing_is_scaled_before_600_degrees_of_freedom() {
    let few = LEAST_DOF / 10 - 1;
    assert_eq!(after(few, 0.25).scale(f64::from(few)).to_bits(), 1_f64.to_bits());
    assert!(after(few + 1, 0.25).scale(f64::from(few + 1)) < 1.0);
}

#[test]
fn scale_is_the_upper_bound_of_the_residuals() {
    // χ² at a probability of 0.1 %, for 600 and 6000 degrees of freedom: bisected on the series of
    // the incomplete gamma function.
    for (epochs, quantile) in [(60, 498.622_873_5), (600, 5_667.173_441)] {
        let dof = f64::from(epochs) * 10.0;
        let have = after(epochs, 0.5).scale(f64::from(epochs) - 1.0);
        let want = (0.5 * dof / quantile).sqrt();
        assert!((have / want - 1.0).abs() < 1e-4, "{epochs} epochs: have {have}, want {want}");
    }
}

#[test]
fn scale_stays_between_a_half_and_three() {
    for (factor, want) in [(0.01, 0.5), (100.0, 3.0)] {
        let have = after(100, factor).scale(99.0);
        assert!((have - want).abs() < 1e-15, "have {have}, want {want}");
    }
}

#[test]
fn what_is_older_than_ten_minutes_is_forgotten() {
    let mut adaptation = after(100, 4.0);
    assert!(adaptation.scale(99.0) > 1.9);
    assert_eq!(adaptation.scale(800.0).to_bits(), 1_f64.to_bits());
    for second in 800..900 {
        adaptation.learn(f64::from(second), Residuals { sse: 2.5, dof: 10 });
    }
    assert!(adaptation.scale(899.0) < 0.7, "{}", adaptation.scale(899.0));
}

#[test]
fn time_that_goes_back_begins_anew_and_nonsense_is_not_learned() {
    let mut adaptation = after(100, 0.25);
    adaptation.learn(99.0, Residuals { sse: f32::NAN, dof: 10 });
    adaptation.learn(f64::NAN, Residuals { sse: 1.0, dof: 10 });
    assert!(adaptation.scale(99.0) < 1.0);
    adaptation.learn(-1000.0, Residuals { sse: 1.0, dof: 10 });
    assert_eq!(adaptation.scale(99.0).to_bits(), 1_f64.to_bits());
}

#[test]
fn no_sigma_falls_below_that_of_the_broadcast_orbit_or_of_the_ionosphere() {
    // 0.7 m for Galileo, 1.2 m for GPS (weighting); what was below already stays.
    for (constellation, sigma_m, common_m, scale, want) in [
        (Constellation::Galileo, 4.0, 0.0, 0.5, 2.0),
        (Constellation::Galileo, 1.0, 0.0, 0.5, 0.7),
        (Constellation::Gps, 1.5, 0.0, 0.5, 1.2),
        (Constellation::Gps, 1.0, 0.0, 0.5, 1.0),
        (Constellation::Gps, 1.0, 0.0, 2.0, 2.0),
        (Constellation::Gps, 5.0, 1.6, 0.5, 2.5),
        (Constellation::Gps, 2.2, 1.6, 0.5, 2.0),
        (Constellation::Gps, 5.0, 4.5, 2.0, 10.0),
    ] {
        let satellite = SatelliteId::new(constellation, 20).unwrap();
        let have = Adaptation::sigma_m(scale, satellite, sigma_m, common_m);
        assert!((have - want).abs() < 1e-6, "{constellation:?}: have {have}, want {want}");
    }
}

#[test]
fn one_noisy_minute_ends_a_scale_below_one() {
    let mut adaptation = after(540, 0.25);
    assert!(adaptation.scale(539.0) < 0.7);
    for second in 540..550 {
        adaptation.learn(f64::from(second), Residuals { sse: 10.0, dof: 10 });
    }
    assert_eq!(adaptation.scale(549.0).to_bits(), 1_f64.to_bits());
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
    let adapted = Strategy { sigma_adapt: true, ..Strategy::DEFAULT };
    let lost = |report: &&Report<CAPACITY>| !matches!(report.verdict, Verdict::Protected(_));
    let epochs = (1..=20).flat_map(|seed| quiet_then(adapted, 1.0, 100, seed)).collect::<Vec<_>>();
    let count = epochs.iter().filter(lost).count();
    assert!(count * 20 < epochs.len(), "{count} of {}", epochs.len());
}

#[test]
fn noise_beyond_the_sigmas_promises_nothing() {
    let is_refuted = |report: &Report<CAPACITY>| report.verdict == Verdict::Unavailable(Unavailable::Sigmas);
    let reports = quiet_then(Strategy::DEFAULT, 2.0, 120, 7);
    assert!(reports.iter().skip(60).all(|report| !matches!(report.verdict, Verdict::Protected(_))));
    assert!(reports.iter().any(is_refuted));
    assert!(reports.iter().filter(|report| is_refuted(report)).all(|report| report.protection.is_none()));
}
