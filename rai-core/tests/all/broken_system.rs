//! A system whose satellites are all wrong, each by an error of its own, beside systems that agree.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use crate::noise::Noise;
use crate::sky::{CAPACITY, METHODS, epoch_of, observe, receiver, satellite};
use raim_core::epoch::Observation;
use raim_core::monitor::{Method, Monitor, Strategy};
use raim_core::report::{Protected, Report, Unavailable, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::Constellation::{self, Beidou, Galileo, Glonass, Gps};

/// Returns so many satellites of each system, with noise of 1 m. Those of the systems in `broken`
/// are wrong by 100 m to 2 km, each by another error.
fn sky(seed: u64, systems: &[(Constellation, usize)], broken: &[Constellation]) -> Vec<Observation> {
    let mut noise = Noise((seed + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let each = systems.iter().flat_map(|&(system, count)| (1..=count).map(move |number| (system, number)));
    each.enumerate()
        .map(|(index, (system, number))| {
            let direction = (137.5 * index as f64 % 360.0, 12.0 + 41.0 * index as f64 % 75.0);
            let sighted = observe(satellite(system, number), direction, 1e5);
            let sign = if noise.uniform() < 0.5 { -1.0 } else { 1.0 };
            let error_m = sign * 100.0 * 20_f64.powf(noise.uniform());
            let error_m = if broken.contains(&system) { error_m } else { 0.0 };
            Observation { range_m: sighted.range_m + noise.normal() + error_m, sigma_m: 1.5, ..sighted }
        })
        .collect()
}

fn monitor(method: Method) -> Monitor<f32, CAPACITY> {
    let mut monitor = Monitor::new(Requirements::non_precision_approach()).unwrap();
    monitor.set_strategy(Strategy::DEFAULT.with_method(method)).unwrap();
    monitor
}

fn process(
    monitor: &mut Monitor<f32, CAPACITY>,
    time_s: f64,
    observations: &[Observation],
) -> Report<CAPACITY> {
    let epoch = epoch_of(time_s, observations);
    monitor.process(&epoch)
}

fn judge(method: Method, observations: &[Observation]) -> Report<CAPACITY> {
    process(&mut monitor(method), 0.0, observations)
}

fn has(report: &Report<CAPACITY>, system: Constellation) -> bool {
    report.used.iter().any(|used| used.constellation() == system)
}

#[test]
fn broken_system_is_left_out_if_two_others_agree() {
    for method in METHODS {
        for size in [4, 6, 8] {
            let systems = [(Gps, 7), (Galileo, 5), (Beidou, size)];
            let mut left_out = 0;
            for seed in 0..30 {
                let report = judge(method, &sky(seed, &systems, &[Beidou]));
                let Verdict::Protected(_) = report.verdict else { continue };
                assert_eq!(report.verdict, Verdict::Protected(Protected::Excluded), "{method:?}, {seed}");
                let levels = report.protection.unwrap();
                let error_m = report.solution.as_ref().unwrap().position.distance_m(receiver());
                assert!(
                    error_m < levels.hpl_m.hypot(levels.vpl_m),
                    "{method:?}, {size}, {seed}: {error_m} m"
                );
                left_out += usize::from(!has(&report, Beidou));
            }
            // Four wrong satellites may look like one, or like none if their errors are alike.
            assert!(left_out >= 25, "{method:?}: {left_out} of 30 with {size} satellites");
        }
    }
}

#[test]
fn fourth_system_that_agrees_is_no_hindrance() {
    let systems = [(Gps, 6), (Galileo, 4), (Beidou, 5), (Glonass, 4)];
    for seed in 0..20 {
        let report = judge(Method::Auto, &sky(seed, &systems, &[Glonass]));
        assert_eq!(report.verdict, Verdict::Protected(Protected::Excluded), "{seed}");
        assert!(has(&report, Gps) && has(&report, Galileo) && has(&report, Beidou), "{seed}");
    }
}

/// With two systems each explains the data by the other's fault, and a lone satellite agrees with
/// any place.
#[test]
fn none_is_left_out_if_only_two_systems_contradict() {
    for third in 0..=1 {
        let systems = [(Gps, 8), (Galileo, third), (Beidou, 7)];
        for seed in 0..30 {
            let report = judge(Method::Auto, &sky(seed, &systems, &[Beidou]));
            assert!(matches!(report.verdict, Verdict::Alert(_)), "{third}, {seed}: {:?}", report.verdict);
        }
    }
}

#[test]
fn none_is_left_out_if_two_of_three_are_broken() {
    let systems = [(Gps, 8), (Galileo, 6), (Beidou, 7)];
    for seed in 0..30 {
        let report = judge(Method::Auto, &sky(seed, &systems, &[Galileo, Beidou]));
        assert!(matches!(report.verdict, Verdict::Alert(_)), "{seed}: {:?}", report.verdict);
    }
}

/// Without the broken system the others must still be able to contradict each other: here four
/// satellites each, of which three degrees of freedom remain.
#[test]
fn few_satellites_of_the_others_suffice_only_if_they_are_tested() {
    for (each, wanted) in [(3, false), (4, true)] {
        let systems = [(Gps, each), (Galileo, each), (Beidou, 9)];
        let left_out = (0..30).filter(|&seed| {
            let report = judge(Method::Auto, &sky(seed, &systems, &[Beidou]));
            matches!(report.verdict, Verdict::Protected(_)) && !has(&report, Beidou)
        });
        assert_eq!(left_out.count() > 20, wanted, "{each}");
    }
}

/// The system is kept out after three exclusions, so that one other system is enough, until the
/// system has agreed for ten epochs.
#[test]
fn system_that_is_excluded_again_and_again_is_kept_out_until_it_agrees() {
    let three = [(Gps, 8), (Galileo, 5), (Beidou, 7)];
    let two = [(Gps, 8), (Galileo, 0), (Beidou, 7)];
    let mut monitor = monitor(Method::Auto);
    let mut now_s = 0.0;
    let mut next = |systems: &[(Constellation, usize)], broken: &[Constellation]| {
        now_s += 1.0;
        process(&mut monitor, now_s, &sky(now_s as u64, systems, broken))
    };
    for epoch in 0..2 {
        assert_eq!(next(&three, &[Beidou]).verdict, Verdict::Protected(Protected::Excluded), "{epoch}");
    }
    assert!(has(&next(&three, &[]), Beidou));
    assert_eq!(next(&three, &[Beidou]).verdict, Verdict::Protected(Protected::Excluded));
    for epoch in 0..20 {
        let report = next(&two, &[Beidou]);
        assert_eq!(report.verdict, Verdict::Protected(Protected::Excluded), "{epoch}");
        assert!(!has(&report, Beidou));
    }
    for epoch in 0..11 {
        assert!(!has(&next(&three, &[]), Beidou), "{epoch}");
    }
    assert!(has(&next(&three, &[]), Beidou));
    assert!(matches!(next(&two, &[Beidou]).verdict, Verdict::Alert(_)));
}

/// Without the others a system that is kept out is not trusted.
#[test]
fn system_that_is_kept_out_does_not_make_a_promise_alone() {
    let three = [(Gps, 8), (Galileo, 5), (Beidou, 7)];
    let mut monitor = monitor(Method::Auto);
    for second in 0..3_u32 {
        let sky = sky(u64::from(second), &three, &[Beidou]);
        assert!(matches!(process(&mut monitor, second.into(), &sky).verdict, Verdict::Protected(_)));
    }
    let report = process(&mut monitor, 3.0, &sky(3, &[(Gps, 2), (Galileo, 0), (Beidou, 9)], &[]));
    assert_eq!(report.verdict, Verdict::Unavailable(Unavailable::Redundancy));
    monitor.forget_position();
    let report = process(&mut monitor, 4.0, &sky(4, &[(Gps, 2), (Galileo, 0), (Beidou, 9)], &[]));
    assert_eq!(report.verdict, Verdict::Protected(Protected::Ok));
}
