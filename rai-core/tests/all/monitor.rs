//! Reports of the monitor on small skies whose truth is known by construction.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

use crate::sky::{self, CAPACITY, DIRECTIONS, epoch_of, receiver, satellite};
use raim_core::epoch::{Epoch, Observation};
use raim_core::frame::Ecef;
use raim_core::monitor::Monitor;
use raim_core::report::{Alert, Protected, Report, Unavailable, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::{Constellation, SatelliteId};

const CLOCKS_M: [f64; 4] = [1234.5, -271_828.0, 31.4, 0.0];

/// Returns a satellite in a direction, with its constellation's clock.
fn observe(id: SatelliteId, azimuth_deg: f64, elevation_deg: f64) -> Observation {
    sky::observe(id, (azimuth_deg, elevation_deg), CLOCKS_M[id.constellation() as usize])
}

/// Returns the first `count` directions, all of one constellation.
fn single_system(count: usize) -> Vec<Observation> {
    let directions = DIRECTIONS.iter().take(count).enumerate();
    directions
        .map(|(index, &(azimuth, elevation))| {
            observe(satellite(Constellation::Gps, index + 1), azimuth, elevation)
        })
        .collect()
}

fn judge_from(start: Ecef, observations: &[Observation]) -> Report<CAPACITY> {
    let epoch = epoch_of(0.0, observations);
    let mut monitor = Monitor::<f32, CAPACITY>::new(Requirements::non_precision_approach()).unwrap();
    monitor.start_from(start);
    monitor.process(&epoch)
}

fn judge(observations: &[Observation]) -> Report<CAPACITY> {
    judge_from(Ecef::CENTRE, observations)
}

fn error_m(report: &Report<CAPACITY>) -> f64 {
    report.solution.as_ref().expect("a position").position.distance_m(receiver())
}

#[test]
fn agreeing_satellites_are_protected_wherever_the_fix_starts() {
    let near = receiver() + Ecef::new(600.0, -500.0, 400.0);
    let opposite = Ecef::CENTRE - receiver();
    for start in [Ecef::CENTRE, near, opposite, Ecef::new(3e7, 0.0, 0.0)] {
        let report = judge_from(start, &single_system(8));
        assert_eq!(report.verdict, Verdict::Protected(Protected::Ok), "from {start:?}");
        assert!(error_m(&report) < 0.01, "error {} m from {start:?}", error_m(&report));
        assert_eq!(report.used.len(), 8);
    }
}

#[test]
fn the_clock_of_each_constellation_is_found() {
    let mut observations = single_system(6);
    observations.extend(
        (1..=3).map(|number| {
            observe(satellite(Constellation::Beidou, number), 40.0 + 100.0 * number as f64, 35.0)
        }),
    );
    let solution = judge(&observations).solution.unwrap();
    let want = [Some(CLOCKS_M[0]), Some(CLOCKS_M[1]), None, None];
    for (have, want) in solution.clocks_m.iter().zip(want) {
        assert_eq!(have.is_some(), want.is_some());
        assert!((have.unwrap_or(0.0) - want.unwrap_or(0.0)).abs() < 0.05, "have {have:?}, want {want:?}");
    }
}

#[test]
fn a_biased_satellite_is_left_out_by_name() {
    for faulty in 0..8 {
        let mut observations = single_system(8);
        observations[faulty].range_m += 150.0;
        let report = judge(&observations);
        assert_eq!(report.verdict, Verdict::Protected(Protected::Excluded), "fault in {faulty}");
        assert_eq!(report.excluded.len(), 1);
        assert_eq!(report.excluded[0].satellite, observations[faulty].satellite);
        assert!((report.excluded[0].bias_m - 150.0).abs() < 0.1, "bias {}", report.excluded[0].bias_m);
        assert!(error_m(&report) < 0.01);
    }
}

#[test]
fn a_gross_fault_is_left_out_although_it_bends_the_linearisation() {
    for bias_m in [1e4, -1e5, 1e6] {
        let mut observations = single_system(8);
        observations[2].range_m += bias_m;
        let report = judge(&observations);
        assert_eq!(report.verdict, Verdict::Protected(Protected::Excluded), "bias {bias_m}");
        assert_eq!(report.excluded[0].satellite, observations[2].satellite);
        assert!(error_m(&report) < 0.01, "error {} m", error_m(&report));
    }
}

#[test]
fn two_faults_are_both_left_out() {
    let mut observations = single_system(8);
    observations.extend((1..=6).map(|number| {
        observe(
            satellite(Constellation::Beidou, number),
            25.0 + 60.0 * number as f64,
            30.0 + 5.0 * number as f64,
        )
    }));
    observations[1].range_m += 200.0;
    observations[9].range_m -= 120.0;
    let report = judge(&observations);
    assert_eq!(report.verdict, Verdict::Protected(Protected::Excluded));
    let mut have: Vec<SatelliteId> = report.excluded.iter().map(|suspect| suspect.satellite).collect();
    have.sort();
    assert_eq!(have, [observations[1].satellite, observations[9].satellite]);
}

#[test]
fn five_satellites_detect_but_cannot_name() {
    let mut observations = single_system(5);
    observations[3].range_m += 300.0;
    let report = judge(&observations);
    assert_eq!(report.verdict, Verdict::Alert(Alert::Fault));
    assert!(report.excluded.is_empty());
}

#[test]
fn four_satellites_fix_but_cannot_test_and_three_do_not_fix() {
    let report = judge(&single_system(4));
    assert_eq!(report.verdict, Verdict::Unavailable(Unavailable::Redundancy));
    assert!(error_m(&report) < 0.01);
    assert!(report.test.is_none() && report.protection.is_none() && report.suspect.is_none());

    let report = judge(&single_system(3));
    assert_eq!(report.verdict, Verdict::Unavailable(Unavailable::NoFix));
    assert!(report.solution.is_none());
    assert_eq!(judge(&[]).verdict, Verdict::Unavailable(Unavailable::NoFix));
}

#[test]
fn satellites_on_a_cone_are_a_geometry_problem() {
    let observations: Vec<Observation> = (0u8..7)
        .map(|index| {
            observe(satellite(Constellation::Gps, index as usize + 1), 50.0 * f64::from(index), 40.0)
        })
        .collect();
    assert_eq!(judge_from(receiver(), &observations).verdict, Verdict::Unavailable(Unavailable::Geometry));
}

#[test]
fn lone_satellite_of_a_constellation_cannot_be_tested_and_does_no_harm() {
    let mut observations = single_system(8);
    let mut lone = observe(satellite(Constellation::Galileo, 1), 80.0, 50.0);
    lone.range_m += 5_000.0;
    observations.push(lone);
    let report = judge(&observations);
    assert_eq!(report.verdict, Verdict::Protected(Protected::Ok));
    assert!(error_m(&report) < 0.01);
}

#[test]
fn two_satellites_that_cannot_be_told_apart_are_ambiguous() {
    // Six satellites, two of them almost in line: a fault of either is explained by the exclusion
    // of either.
    let mut observations = single_system(5);
    observations.push(observe(satellite(Constellation::Gps, 20), 111.5, 45.5));
    observations[2].range_m += 120.0;
    let report = judge(&observations);
    assert_eq!(report.verdict, Verdict::Alert(Alert::Ambiguous));
}

#[test]
fn a_poor_geometry_exceeds_the_alert_limit() {
    let mut requirements = Requirements::lpv200();
    requirements.hal_m = 5.0;
    let mut monitor = Monitor::<f32, CAPACITY>::new(requirements).unwrap();
    let mut epoch = Epoch::new(0.0);
    for observation in single_system(6) {
        epoch.push(observation).unwrap();
    }
    let report = monitor.process(&epoch);
    assert_eq!(report.verdict, Verdict::Unavailable(Unavailable::Hpl));
    let hpl_m = report.protection.unwrap().hpl_m;
    assert!(hpl_m.is_finite() && hpl_m > 5.0);
}

#[test]
fn sigma_check_is_small_for_exact_ranges_and_large_for_noisy_ones() {
    let mut monitor = Monitor::<f64, CAPACITY>::new(Requirements::non_precision_approach()).unwrap();
    for (noise_m, want) in [(0.0, 0.0..0.01), (4.0, 0.3..4.0)] {
        let mut have = None;
        for step in 0..80 {
            let mut epoch = Epoch::new(f64::from(step));
            for (index, mut observation) in single_system(8).into_iter().enumerate() {
                let sign = if (index + step as usize).is_multiple_of(2) { 1.0 } else { -1.0 };
                observation.range_m += sign * noise_m;
                epoch.push(observation).unwrap();
            }
            have = monitor.process(&epoch).sigma_check;
        }
        assert!(want.contains(&have.unwrap()), "noise {noise_m} m: have {have:?}, want {want:?}");
    }
}

#[test]
fn requirements_out_of_range_make_no_monitor() {
    let good = Requirements::non_precision_approach();
    for bad in [
        good.with_hal_m(0.0),
        good.with_hal_m(f64::NAN),
        good.with_val_m(Some(-1.0)),
        good.with_time_to_alert_s(f64::INFINITY),
        good.with_guard_fraction(1.5),
    ] {
        assert!(Monitor::<f32, CAPACITY>::new(bad).is_err(), "{bad:?}");
    }
}
