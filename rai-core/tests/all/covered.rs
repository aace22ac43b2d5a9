//! One fault that several satellites may have: the levels hold whichever of them it is.
//!
//! Random skies of few satellites, one of them off by 10 to 400 m. The truth is known by
//! construction, and the position without the faulty satellite is that of a sky that lacks it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

use crate::noise::Noise;
use crate::sky::{self, CAPACITY, SIGMA_M, receiver, satellite};
use raim_core::epoch::Observation;
use raim_core::frame::{Ecef, Enu, LocalFrame};
use raim_core::monitor::{Monitor, Strategy};
use raim_core::report::{Alert, Protected, Report, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::Constellation;

const SKIES: u64 = 24_000;
const CLOCKS_M: [f64; 2] = [1234.5, -271.8];

/// Returns six to twelve satellites of one or two systems, and which of them is faulty.
fn drawn(seed: u64) -> (Vec<Observation>, usize) {
    let mut noise = Noise(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0xC0);
    let (count, systems) = (6 + noise.index(7), 1 + noise.index(2));
    let faulty = noise.index(count);
    let observe = |index: usize| {
        let lowest = 10_f64.to_radians().sin();
        let elevation_deg = (lowest + noise.uniform() * (1.0 - lowest)).asin().to_degrees();
        let direction = (360.0 * noise.uniform(), elevation_deg);
        let constellation = [Constellation::Gps, Constellation::Galileo][index % systems];
        let clock_m = CLOCKS_M[index % systems];
        let mut observation = sky::observe(satellite(constellation, index + 1), direction, clock_m);
        observation.range_m += SIGMA_M * noise.normal();
        if index == faulty {
            let size_m = 10.0 * 40_f64.powf(noise.uniform());
            observation.range_m += if noise.uniform() < 0.5 { size_m } else { -size_m };
        }
        observation
    };
    ((0..count).map(observe).collect(), faulty)
}

fn judged(observations: &[Observation], hal_m: f64) -> Report<CAPACITY> {
    let requirements = Requirements::non_precision_approach().with_hal_m(hal_m);
    let mut monitor = Monitor::<f32, CAPACITY>::new(requirements).unwrap();
    monitor.set_strategy(Strategy::CLASSIC).unwrap();
    monitor.start_from(receiver());
    monitor.process(&sky::epoch_of(0.0, observations))
}

fn position(report: &Report<CAPACITY>) -> Ecef {
    report.solution.as_ref().expect("a position").position
}

fn apart(one: Ecef, other: Ecef) -> Enu {
    LocalFrame::at(receiver()).rotate(one - other)
}

#[test]
fn levels_reach_to_the_end_of_those_without_the_faulty_satellite() {
    let (mut covered, mut wrong) = (0, 0);
    for seed in 0..SKIES {
        let (mut observations, faulty) = drawn(seed);
        let report = judged(&observations, 556.0);
        if report.verdict != Verdict::Protected(Protected::Covered) {
            continue;
        }
        let levels = report.protection.expect("levels");
        let error = apart(position(&report), receiver());
        assert!(error.horizontal() < levels.hpl_m && error.up.abs() < levels.vpl_m, "seed {seed}");
        covered += 1;
        let culprit = observations.remove(faulty);
        let without = judged(&observations, 1e6);
        let is_culprit = report.excluded.iter().any(|suspect| suspect.satellite == culprit.satellite);
        if is_culprit || without.verdict != Verdict::Protected(Protected::Ok) {
            continue;
        }
        wrong += 1;
        let (apart, its) = (apart(position(&report), position(&without)), without.protection.unwrap());
        let reaches = |level_m: f64, apart_m: f64, its_m: f64| level_m > (apart_m + its_m) * (1.0 - 1e-3);
        assert!(reaches(levels.hpl_m, apart.horizontal(), its.hpl_m), "seed {seed}: {levels:?}");
        assert!(reaches(levels.vpl_m, apart.up.abs(), its.vpl_m), "seed {seed}: {levels:?}");
    }
    assert!(covered > 500 && wrong > 50, "{covered} covered, {wrong} of them without the faulty satellite");
}

/// The same fault under a smaller limit: there is no room for every explanation.
#[test]
fn levels_beyond_the_limit_are_the_alert_that_they_were() {
    let mut alerts = 0;
    for seed in 0..SKIES / 4 {
        let (observations, _) = drawn(seed);
        let report = judged(&observations, 556.0);
        let Some(levels) = report.protection else { continue };
        if report.verdict == Verdict::Protected(Protected::Covered) {
            let narrow = judged(&observations, 0.9 * levels.hpl_m).verdict;
            assert_eq!(narrow, Verdict::Alert(Alert::Ambiguous), "seed {seed}");
            alerts += 1;
        }
    }
    assert!(alerts > 100, "{alerts}");
}
