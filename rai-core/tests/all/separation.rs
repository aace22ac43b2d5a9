//! ARAIM behind the monitor: skies whose truth is known by construction, one satellite or a whole
//! constellation wrong.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

use crate::sky::{epoch_of, observe, receiver, satellite};
use proptest::prelude::*;
use raim_core::epoch::{Epoch, Observation};
use raim_core::internals::weighting::Ism;
use raim_core::monitor::{Method, Monitor, Strategy as Pursuit};
use raim_core::report::{Alert, Protected, Report, Unavailable, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::Constellation::{self, Beidou, Galileo, Gps};

/// Room for whatever the property below draws, as for the largest epoch of all.
const CAPACITY: usize = 64;

/// Returns azimuth and elevation in degrees of some satellites, spread over the sky.
fn direction(index: usize) -> (f64, f64) {
    (137.5 * index as f64 % 360.0, 12.0 + 41.0 * index as f64 % 75.0)
}

/// Satellites of constellations with clocks of their own, without noise.
fn visible(constellations: &[Constellation], count: usize) -> Vec<Observation> {
    let satellites = constellations.iter().enumerate();
    let each = satellites
        .flat_map(|(system, &constellation)| (0..count).map(move |index| (system, constellation, index)));
    each.map(|(system, constellation, index)| {
        let clock_m = 1e5 - 4e4 * system as f64;
        let sighted = observe(satellite(constellation, index + 1), direction(system + index * 3), clock_m);
        Observation { sigma_m: 1.5, ..sighted }
    })
    .collect()
}

fn monitor(requirements: Requirements) -> Monitor<f32, CAPACITY> {
    let mut monitor = Monitor::new(requirements).unwrap();
    monitor.set_strategy(Pursuit::CLASSIC.with_method(Method::Araim)).unwrap();
    monitor.set_ism(Ism::RESEARCH);
    monitor
}

fn judge(requirements: Requirements, observations: &[Observation]) -> Report<CAPACITY> {
    let epoch = epoch_of(0.0, observations);
    monitor(requirements).process(&epoch)
}

fn lpv() -> Requirements {
    Requirements::lpv200()
}

#[test]
fn two_healthy_constellations_are_protected_and_say_what_makes_the_levels() {
    let report = judge(lpv(), &visible(&[Gps, Galileo], 10));
    assert_eq!(report.verdict, Verdict::Protected(Protected::Ok), "{:?}", report.protection);
    let separation = report.araim.unwrap();
    assert!(separation.modes >= 21 && separation.share < 0.05, "{separation:?}");
    // Galileo as a whole is the likeliest fault, and leaves the fewest satellites.
    assert_eq!(separation.vertical.constellations, 1 << Galileo as u8, "{separation:?}");
    let test = report.test.unwrap();
    assert!(test.statistic < 0.01 && (test.threshold - 1.0).abs() < 1e-9, "{test:?}");
}

#[test]
fn each_limit_that_fails_is_the_reason() {
    let sky = visible(&[Gps, Galileo], 10);
    let report = judge(lpv(), &sky);
    let (araim, levels) = (report.araim.unwrap(), report.protection.unwrap());
    let with = |val_m: f64, emt_m: f64, accuracy_m: f64| {
        let mut requirements = lpv().with_val_m(Some(val_m));
        requirements.allocation.emt_limit_m = Some(emt_m);
        requirements.allocation.accuracy_limit_m = Some(accuracy_m);
        judge(requirements, &sky).verdict
    };
    let (emt_m, accuracy_m) = (araim.effective_monitor_threshold_m, araim.accuracy_m);
    let (above, below) = (1.001, 0.999);
    let ok = with(levels.vpl_m * above, emt_m * above, accuracy_m * above);
    assert_eq!(ok, Verdict::Protected(Protected::Ok), "VPL {}, {araim:?}", levels.vpl_m);
    let have = with(levels.vpl_m * above, emt_m * below, accuracy_m * above);
    assert_eq!(have, Verdict::Unavailable(Unavailable::Emt));
    let have = with(levels.vpl_m * above, emt_m * above, accuracy_m * below);
    assert_eq!(have, Verdict::Unavailable(Unavailable::Accuracy));
    // A level beyond its limit is named first.
    let have = with(levels.vpl_m * below, emt_m * below, accuracy_m * below);
    assert_eq!(have, Verdict::Unavailable(Unavailable::Vpl));
}

#[test]
fn the_error_stays_below_the_levels_as_a_satellite_drifts_away() {
    let mut excluded = 0;
    for step in 0..60 {
        let mut sky = visible(&[Gps, Galileo], 10);
        sky[4].range_m += 2.0 * f64::from(step);
        let report = judge(lpv(), &sky);
        let error_m = report.solution.as_ref().unwrap().position.distance_m(receiver());
        if let (Verdict::Protected(_), Some(levels)) = (report.verdict, report.protection) {
            let level_m = levels.hpl_m.hypot(levels.vpl_m);
            assert!(error_m < level_m, "step {step}: {error_m} m, levels {levels:?}");
        }
        if let [suspect] = report.excluded.as_slice() {
            assert_eq!(suspect.satellite, sky[4].satellite, "step {step}");
            assert!((suspect.bias_m - 2.0 * f64::from(step)).abs() < 0.1, "step {step}: {}", suspect.bias_m);
            excluded += 1;
        }
    }
    assert!(excluded > 30, "excluded in {excluded} of 60 epochs");
}

/// A clock common to a constellation is the receiver's to estimate: it moves nothing.
#[test]
fn a_constellations_clock_is_harmless() {
    let mut sky = visible(&[Gps, Galileo], 10);
    sky.iter_mut()
        .filter(|seen| seen.satellite.constellation() == Galileo)
        .for_each(|seen| seen.range_m += 500.0);
    let report = judge(lpv(), &sky);
    assert_eq!(report.verdict, Verdict::Protected(Protected::Ok));
    assert!(report.solution.unwrap().position.distance_m(receiver()) < 0.1);
}

/// All ranges of a constellation fit a place 60 m away: each satellite is as plausible as the next.
#[test]
fn a_constellation_that_is_shifted_as_one_is_seen_at_once_and_never_misleads() {
    for (east_m, up_m) in [(60.0, 0.0), (0.0, 60.0), (40.0, -45.0)] {
        let mut sky = visible(&[Gps, Galileo], 10);
        for (index, seen) in sky.iter_mut().enumerate().filter(|(index, _)| *index >= 10) {
            let (azimuth, elevation) = direction(1 + (index - 10) * 3);
            let (azimuth, elevation) = (azimuth.to_radians(), elevation.to_radians());
            seen.range_m -= east_m * elevation.cos() * azimuth.sin() + up_m * elevation.sin();
        }
        let report = judge(lpv(), &sky);
        let error_m = report.solution.as_ref().unwrap().position.distance_m(receiver());
        let seen = !matches!(report.verdict, Verdict::Protected(Protected::Ok));
        assert!(seen, "{east_m} m east, {up_m} m up: {:?}", report.verdict);
        if let Verdict::Protected(_) = report.verdict {
            let levels = report.protection.unwrap();
            assert!(error_m < levels.hpl_m.hypot(levels.vpl_m), "{error_m} m, {levels:?}");
        }
    }
}

#[test]
fn with_three_constellations_the_shifted_one_is_left_out_as_a_whole() {
    let mut sky = visible(&[Gps, Galileo, Beidou], 9);
    for (index, seen) in sky.iter_mut().enumerate().filter(|(index, _)| (9..18).contains(index)) {
        let (_, elevation) = direction(1 + (index - 9) * 3);
        seen.range_m -= 80.0 * elevation.to_radians().sin();
    }
    let report = judge(Requirements::non_precision_approach(), &sky);
    let lost = report.araim.map(|separation| separation.excluded_constellations);
    assert_eq!(lost, Some(1 << Galileo as u8), "{:?}", report.verdict);
    assert_eq!(report.used.len(), 18);
    assert!(report.solution.unwrap().position.distance_m(receiver()) < 0.1);
}

#[test]
fn a_constellation_alone_that_may_fail_as_a_whole_has_no_level() {
    let report = judge(lpv(), &visible(&[Galileo], 12));
    assert_eq!(report.verdict, Verdict::Unavailable(Unavailable::Risk));
}

#[test]
fn without_redundancy_nothing_is_promised() {
    let report = judge(lpv(), &visible(&[Gps], 4));
    assert_eq!(report.verdict, Verdict::Unavailable(Unavailable::Redundancy));
    assert!(report.araim.is_none());
}

#[test]
fn two_faults_of_one_epoch_that_cannot_be_told_alarm() {
    let mut sky = visible(&[Gps, Galileo], 6);
    sky[0].range_m += 90.0;
    sky[7].range_m -= 120.0;
    let report = judge(lpv(), &sky);
    assert_eq!(report.verdict, Verdict::Alert(Alert::Fault));
}

/// An unmonitored fault shows in the residuals alone.
#[test]
fn fault_that_is_promised_never_to_happen_is_an_alert_of_the_global_test() {
    let mut ism = Ism::RESEARCH;
    for support in &mut ism.constellations {
        (support.satellite_fault, support.constellation_fault) = (0.0, 0.0);
    }
    for (bias_m, want) in [(0.0, Verdict::Protected(Protected::Ok)), (1000.0, Verdict::Alert(Alert::Fault))] {
        let mut sky = visible(&[Gps, Galileo], 10);
        sky[4].range_m += bias_m;
        let mut epoch = Epoch::new(0.0);
        for seen in &sky {
            epoch.push(*seen).unwrap();
        }
        let mut monitor = monitor(lpv());
        monitor.set_ism(ism);
        let report = monitor.process(&epoch);
        assert_eq!(report.verdict, want);
        let test = report.test.unwrap();
        assert_eq!(test.statistic >= test.threshold, bias_m > 0.0, "{test:?}");
    }
}

#[test]
fn a_promise_that_is_no_number_changes_nothing() {
    let mut monitor = monitor(lpv());
    let mut worse = Ism::RESEARCH;
    worse.constellations[0].ura_m = f64::NAN;
    monitor.set_ism(worse);
    assert_eq!(*monitor.ism(), Ism::RESEARCH);
}

proptest! {
    /// For all ranges, sigmas and constellations: no level is NaN, and a protected position has
    /// levels within the limits.
    #[test]
    fn levels_are_numbers_and_hold_the_limits(
        seen in prop::collection::vec((0usize..4, 0.0..360.0f64, 5.0..90.0f64, -200.0..200.0f64, 0.1..20.0f64), 0..45),
        icao in any::<bool>(),
    ) {
        let mut epoch = Epoch::<CAPACITY>::new(0.0);
        for (number, &(constellation, azimuth, elevation, error_m, sigma_m)) in seen.iter().enumerate() {
            let id = satellite(Constellation::ALL[constellation], number + 1);
            let sighted = observe(id, (azimuth, elevation), 1e5);
            let error_m = if number % 7 == 0 { error_m } else { error_m / 200.0 };
            epoch.push(Observation { range_m: sighted.range_m + error_m, sigma_m, ..sighted }).unwrap();
        }
        let requirements = lpv();
        let mut monitor = monitor(requirements);
        monitor.set_ism(if icao { Ism::ICAO } else { Ism::RESEARCH });
        let report = monitor.process(&epoch);
        if let Some(levels) = report.protection {
            prop_assert!(!levels.hpl_m.is_nan() && !levels.vpl_m.is_nan(), "{levels:?}");
            if matches!(report.verdict, Verdict::Protected(_)) {
                prop_assert!(levels.hpl_m <= 40.0 && levels.vpl_m <= 35.0, "{levels:?}");
                let separation = report.araim.expect("a judgement");
                prop_assert!(separation.effective_monitor_threshold_m <= 15.0 && separation.accuracy_m <= 1.87);
            }
        }
        if let Some(separation) = report.araim {
            prop_assert!(separation.unmonitored_probability >= 0.0 && separation.ratio >= 0.0, "{separation:?}");
        }
    }
}
