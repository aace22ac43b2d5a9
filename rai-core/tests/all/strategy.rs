//! Policies and clock aiding as the monitor uses them, on skies whose truth is known by
//! construction.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

use crate::sky::{CAPACITY, epoch_of, observe, receiver, satellite};
use raim_core::epoch::{Aiding, Epoch, Observation};
use raim_core::frame::LocalFrame;
use raim_core::internals::integrity::raim::detection::threshold::policy::Policy;
use raim_core::internals::integrity::raim::isolation::parity;
use raim_core::monitor::{Method, Monitor, Strategy};
use raim_core::report::{Alert, Protected, Report, Unavailable, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::{Constellation, SatelliteId};

/// Azimuth and elevation in degrees.
const DIRECTIONS: [(f64, f64); 7] =
    [(0.0, 80.0), (30.0, 25.0), (150.0, 30.0), (270.0, 20.0), (100.0, 50.0), (210.0, 45.0), (330.0, 40.0)];

/// Returns the first `count` satellites, with a clock.
fn visible(count: usize, clock_m: f64) -> Vec<Observation> {
    let directions = DIRECTIONS.into_iter().take(count).enumerate();
    directions
        .map(|(index, direction)| observe(satellite(Constellation::Gps, index + 1), direction, clock_m))
        .collect()
}

fn judge(
    monitor: &mut Monitor<f32, CAPACITY>,
    time_s: f64,
    observations: &[Observation],
) -> Report<CAPACITY> {
    let epoch = epoch_of(time_s, observations);
    monitor.process(&epoch)
}

/// Returns a clock that drifts by 30 m a second and has a wobble for the prediction to follow.
fn clock_m(second: u32) -> f64 {
    1e5 + 30.0 * f64::from(second) + 0.5 * (f64::from(second) * 0.7).sin()
}

/// Returns a monitor with clock aiding that has seen a minute and a half of seven satellites.
fn coasting() -> (Monitor<f32, CAPACITY>, u32) {
    let mut monitor = Monitor::new(Requirements::non_precision_approach()).unwrap();
    monitor.set_strategy(Strategy::CLASSIC.with_clock_aid(true)).unwrap();
    for second in 0..90 {
        let report = judge(&mut monitor, f64::from(second), &visible(7, clock_m(second)));
        assert_eq!(report.verdict, Verdict::Protected(Protected::Ok), "second {second}");
    }
    (monitor, 90)
}

#[test]
fn four_satellites_and_a_predicted_clock_notice_a_step() {
    let (mut monitor, now) = coasting();
    let healthy = judge(&mut monitor.clone(), f64::from(now), &visible(4, clock_m(now)));
    assert!(!matches!(healthy.verdict, Verdict::Alert(_)), "{:?}", healthy.verdict);
    assert_eq!(healthy.test.unwrap().dof, 1);
    let mut faulty = visible(4, clock_m(now));
    faulty[1].range_m += 100.0;
    let report = judge(&mut monitor, f64::from(now), &faulty);
    assert_eq!(report.verdict, Verdict::Alert(Alert::Fault));
}

#[test]
fn five_satellites_and_a_predicted_clock_name_the_satellite() {
    let (mut monitor, now) = coasting();
    let mut faulty = visible(5, clock_m(now));
    faulty[4].range_m += 100.0;
    let report = judge(&mut monitor, f64::from(now), &faulty);
    let named: Vec<SatelliteId> = report.excluded.iter().map(|suspect| suspect.satellite).collect();
    assert_eq!(named, [faulty[4].satellite], "{:?}", report.verdict);
}

/// A millisecond shows in every satellite's test, which only some methods see through.
#[test]
fn a_jump_of_the_clock_is_no_satellites_fault_by_any_method() {
    use parity::Isolation::{Grouping, Hybrid, HybridWithoutGrouping, Sequential, Simultaneous};
    let parity = [Simultaneous, Sequential, HybridWithoutGrouping, Hybrid, Grouping].map(Method::Parity);
    for method in [Method::Baarda, Method::Ransac].into_iter().chain(parity) {
        for jump_m in [300.0, -238_668.0] {
            let (mut monitor, now) = coasting();
            monitor.disable_continuity();
            monitor.set_strategy(Strategy::CLASSIC.with_method(method).with_clock_aid(true)).unwrap();
            for second in now..now + 20 {
                let sky = visible(7, clock_m(second) + jump_m);
                let report = judge(&mut monitor, f64::from(second), &sky);
                assert_eq!(
                    report.verdict,
                    Verdict::Protected(Protected::Ok),
                    "{method:?}, {jump_m} m, {second} s"
                );
                assert!(report.excluded.is_empty());
            }
        }
    }
}

#[test]
fn a_jump_of_the_clock_is_no_satellites_fault() {
    let (mut monitor, now) = coasting();
    monitor.disable_continuity();
    let report = judge(&mut monitor, f64::from(now), &visible(7, clock_m(now) + 300.0));
    assert_eq!(report.verdict, Verdict::Protected(Protected::Ok));
    assert!(report.excluded.is_empty());
    let error_m = report.solution.unwrap().position.distance_m(receiver());
    assert!(error_m < 0.1, "{error_m} m");
}

/// No satellite is blamed, but another clock may be that of another receiver.
#[test]
fn a_jump_of_the_clock_contradicts_its_past() {
    let (mut monitor, now) = coasting();
    let report = judge(&mut monitor, f64::from(now), &visible(7, clock_m(now) + 300.0));
    assert_eq!(report.verdict, Verdict::Alert(Alert::Clock));
    assert!(report.excluded.is_empty());
}

#[test]
fn a_jump_of_the_clock_is_the_clocks_beside_a_known_height_too() {
    let (mut monitor, now) = coasting();
    monitor.disable_continuity();
    let method = Method::Parity(parity::Isolation::Hybrid);
    monitor.set_strategy(Strategy::CLASSIC.with_method(method).with_clock_aid(true)).unwrap();
    let mut epoch = Epoch::new(f64::from(now));
    for observation in visible(7, clock_m(now) - 238_668.0) {
        epoch.push(observation).unwrap();
    }
    let value_m = LocalFrame::at(receiver()).height_m();
    epoch.aid(Aiding::Height { value_m, sigma_m: 5.0 }).unwrap();
    let report = monitor.process(&epoch);
    assert_eq!(report.verdict, Verdict::Protected(Protected::Ok));
    assert_eq!((report.used.len(), report.excluded.len()), (7, 0));
}

#[test]
fn without_aiding_four_satellites_stay_untested() {
    let mut monitor = Monitor::new(Requirements::non_precision_approach()).unwrap();
    let report = judge(&mut monitor, 0.0, &visible(4, 0.0));
    assert_eq!(report.verdict, Verdict::Unavailable(Unavailable::Redundancy));
}

/// Requirements whose alert limit leaves room between the two risks.
fn generous() -> Requirements {
    Requirements::non_precision_approach().with_hal_m(150.0)
}

#[test]
fn a_higher_threshold_passes_a_fault_that_the_limit_can_bear() {
    let thresholds = [Policy::T1, Policy::TOp, Policy::T2].map(|policy| {
        let mut monitor = Monitor::new(generous()).unwrap();
        monitor.set_strategy(Strategy::CLASSIC.with_policy(policy)).unwrap();
        let report = judge(&mut monitor, 0.0, &visible(7, 0.0));
        assert_eq!(report.verdict, Verdict::Protected(Protected::Ok), "{policy:?}");
        (report.test.unwrap().threshold, report.protection.unwrap().hpl_m)
    });
    assert!(thresholds.is_sorted_by(|(a, _), (b, _)| a < b), "T1 < T_OP < T2: {thresholds:?}");
    assert!(
        thresholds.is_sorted_by(|(_, a), (_, b)| a < b),
        "and so their protection levels: {thresholds:?}"
    );
    // Under T2 the protection level fills its share of the alert limit.
    let [_, _, (_, hpl_m)] = thresholds;
    assert!((hpl_m - 0.95 * 150.0).abs() < 0.1, "{hpl_m}");
}

#[test]
fn no_threshold_between_the_risks_is_an_unavailability() {
    let tight = generous().with_hal_m(12.0);
    for (policy, want) in
        [(Policy::T1, Unavailable::Hpl), (Policy::TOp, Unavailable::Risk), (Policy::T2, Unavailable::Risk)]
    {
        let mut monitor = Monitor::new(tight).unwrap();
        monitor.set_strategy(Strategy::CLASSIC.with_policy(policy)).unwrap();
        let report = judge(&mut monitor, 0.0, &visible(7, 0.0));
        assert_eq!(report.verdict, Verdict::Unavailable(want), "{policy:?}");
    }
}
