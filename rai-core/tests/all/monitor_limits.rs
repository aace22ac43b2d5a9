//! State of the monitor between epochs, and the limits of its verdicts.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

use crate::sky::{CAPACITY, DIRECTIONS, SIGMA_M, epoch_of, observe, receiver, satellite};
use raim_core::epoch::{Aiding, Epoch, Observation};
use raim_core::frame::{Ecef, LocalFrame};
use raim_core::monitor::{Method, Monitor, Strategy};
use raim_core::report::{Alert, Protected, Report, Unavailable, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::Constellation;

fn seen(directions: &[(f64, f64)], clock_m: f64) -> Vec<Observation> {
    let numbered = directions.iter().enumerate();
    numbered
        .map(|(index, direction)| observe(satellite(Constellation::Gps, index + 1), *direction, clock_m))
        .collect()
}

fn epoch<const N: usize>(time_s: f64, observations: &[Observation]) -> Epoch<N> {
    epoch_of(time_s, observations)
}

fn monitor(requirements: Requirements) -> Monitor<f64, CAPACITY> {
    Monitor::new(requirements).unwrap()
}

fn judge(requirements: Requirements, observations: &[Observation]) -> Report<CAPACITY> {
    monitor(requirements).process(&epoch(0.0, observations))
}

fn npa() -> Requirements {
    Requirements::non_precision_approach()
}

const OK: Verdict = Verdict::Protected(Protected::Ok);

#[test]
fn requirements_are_replaced_or_refused_whole() {
    let mut monitor = monitor(npa());
    let bad = npa().with_hal_m(-1.0);
    assert!(monitor.set_requirements(bad).is_err());
    assert_eq!(*monitor.requirements(), npa());
    monitor.set_requirements(Requirements::lpv200()).unwrap();
    assert_eq!(*monitor.requirements(), Requirements::lpv200());
}

#[test]
fn the_next_fix_starts_where_the_last_good_one_was() {
    let mut monitor = monitor(npa());
    assert_eq!(monitor.start(), Ecef::CENTRE);
    let near = receiver() + Ecef::new(300.0, 0.0, -200.0);
    monitor.start_from(near);
    monitor.start_from(Ecef::new(f64::NAN, 0.0, 0.0));
    assert_eq!(monitor.start(), near);
    let report = monitor.process(&epoch(0.0, &seen(&DIRECTIONS, 0.0)));
    assert_eq!(monitor.start(), report.solution.unwrap().position);
}

#[test]
fn a_position_under_alert_is_no_start() {
    let mut monitor = monitor(npa());
    monitor.start_from(receiver());
    let mut observations = seen(&DIRECTIONS[..5], 0.0);
    observations[3].range_m += 300.0;
    let report = monitor.process(&epoch(0.0, &observations));
    assert_eq!(report.verdict, Verdict::Alert(Alert::Fault));
    assert_eq!((monitor.start(), report.sigma_check), (receiver(), None));
}

/// Returns a clock with a wobble for the prediction to follow.
fn clock_m(second: u32) -> f64 {
    1e5 + 30.0 * f64::from(second) + 0.5 * (f64::from(second) * 0.7).sin()
}

/// Returns a monitor with clock aiding that has seen a minute and a half of the first `count`
/// satellites.
fn coasting<const N: usize>(count: usize) -> Monitor<f64, N> {
    let mut monitor = Monitor::new(npa()).unwrap();
    monitor.set_strategy(Strategy::CLASSIC.with_clock_aid(true)).unwrap();
    for second in 0..90 {
        let observations = seen(&DIRECTIONS[..count], clock_m(second));
        assert_eq!(monitor.process(&epoch(f64::from(second), &observations)).verdict, OK, "{second} s");
    }
    monitor
}

#[test]
fn clocks_are_forgotten_where_aiding_changes_and_only_there() {
    let mut monitor = coasting::<CAPACITY>(8);
    let four = epoch(90.0, &seen(&DIRECTIONS[..4], clock_m(90)));
    let aided = Strategy::CLASSIC.with_clock_aid(true);
    monitor.set_strategy(aided.with_method(Method::Ransac)).unwrap();
    assert!(monitor.clone().process(&four).test.is_some(), "with the forecast there is something to test");
    monitor.set_strategy(Strategy::CLASSIC).unwrap();
    assert!(monitor.clone().process(&four).test.is_none());
    monitor.set_strategy(aided).unwrap();
    assert!(monitor.process(&four).test.is_none(), "forgotten in between");
}

#[test]
fn an_epoch_without_room_for_the_forecast_is_judged_without_it() {
    let verdict = coasting::<8>(8).process(&epoch(90.0, &seen(&DIRECTIONS, clock_m(90)))).verdict;
    assert_eq!(verdict, OK);
    // Seven satellites and a known height fill eight places.
    let mut full = epoch(90.0, &seen(&DIRECTIONS[..7], clock_m(90)));
    full.aid(Aiding::Height { value_m: LocalFrame::at(receiver()).height_m(), sigma_m: 5.0 }).unwrap();
    assert_eq!(coasting::<8>(7).process(&full).verdict, OK);
}

#[test]
fn a_known_height_is_where_the_position_is() {
    let height_m = LocalFrame::at(receiver()).height_m() + 0.5;
    let mut known = epoch::<CAPACITY>(0.0, &seen(&DIRECTIONS, 0.0));
    known.aid(Aiding::Height { value_m: height_m, sigma_m: 1e-2 }).unwrap();
    let mut monitor = monitor(npa());
    monitor.start_from(receiver());
    let report = monitor.process(&known);
    assert_eq!(report.verdict, OK);
    let have_m = report.solution.unwrap().geodetic.height_m;
    assert!((have_m - height_m).abs() < 1e-3, "have {have_m}, want {height_m}");
}

#[test]
fn a_level_is_held_to_its_share_of_the_limit() {
    let observations = seen(&DIRECTIONS, 0.0);
    let levels = judge(npa(), &observations).protection.unwrap();
    let horizontal = |share: f64| npa().with_hal_m(levels.hpl_m / share);
    assert_eq!(judge(horizontal(0.94), &observations).verdict, OK);
    assert_eq!(judge(horizontal(0.96), &observations).verdict, Verdict::Unavailable(Unavailable::Hpl));
    let vertical = |share: f64| npa().with_val_m(Some(levels.vpl_m / share));
    assert_eq!(judge(vertical(0.94), &observations).verdict, OK);
    assert_eq!(judge(vertical(0.96), &observations).verdict, Verdict::Unavailable(Unavailable::Vpl));
}

#[test]
fn a_fault_that_never_shows_is_a_geometry_problem() {
    // Five in the plane of east and up, and one alone that measures the north.
    let plane = [(90.0, 20.0), (90.0, 50.0), (90.0, 80.0), (270.0, 65.0), (270.0, 15.0), (0.0, 40.0)];
    let verdict = judge(npa(), &seen(&plane, 0.0)).verdict;
    assert_eq!(verdict, Verdict::Unavailable(Unavailable::Geometry));
    // Six on a cone about the vertical, and one alone that separates up from the clock:
    // horizontally irrelevant.
    let mut cone: Vec<(f64, f64)> = (0..6).map(|step| (60.0 * f64::from(step), 35.0)).collect();
    cone.push((0.0, 90.0));
    let mut start = monitor(npa().with_val_m(Some(500.0)));
    start.start_from(receiver());
    let report = start.process(&epoch(0.0, &seen(&cone, 0.0)));
    assert_eq!(report.verdict, Verdict::Unavailable(Unavailable::Geometry), "{:?}", report.protection);
}

/// Errors of the ranges, m: more than nothing and less than a fault.
const NOISE_M: [f64; 8] = [4.0, -3.0, 2.0, 5.0, -4.5, 1.0, -2.5, 3.5];

fn noisy(scale: f64) -> Vec<Observation> {
    let mut observations = seen(&DIRECTIONS, 77.0);
    observations
        .iter_mut()
        .zip(NOISE_M)
        .for_each(|(observation, off_m)| observation.range_m += scale * off_m);
    observations
}

#[test]
fn sigma_check_is_the_mean_of_what_was_tested() {
    let mut monitor = monitor(npa());
    let mut squares = Vec::new();
    for (second, scale) in [1.0, 0.3, 1.4, 0.8].into_iter().enumerate() {
        let report = monitor.process(&epoch(second as f64, &noisy(scale)));
        assert_eq!(report.verdict, OK);
        squares.push(report.test.unwrap().statistic.powi(2));
        let want = squares.iter().sum::<f64>() / squares.len() as f64;
        let have = report.sigma_check.unwrap();
        assert!((have / want - 1.0).abs() < 1e-5, "have {have}, want {want}");
    }
}

#[test]
fn residuals_add_up_to_the_statistic() {
    // All sigmas alike: SSE = Σ v² / σ².
    let report = judge(npa(), &noisy(1.0));
    let test = report.test.unwrap();
    let want = SIGMA_M * test.statistic * (f64::from(test.dof) / report.used.len() as f64).sqrt();
    assert!((report.residual_rms_m / want - 1.0).abs() < 1e-9, "{} {want}", report.residual_rms_m);
}

#[test]
fn the_suspect_of_an_epoch_that_passes_has_its_bias() {
    for faulty in 0..8 {
        let mut observations = seen(&DIRECTIONS, 0.0);
        observations[faulty].range_m -= 6.0;
        let report = judge(npa(), &observations);
        assert_eq!(report.verdict, OK);
        let suspect = report.suspect.unwrap();
        assert_eq!(suspect.satellite, observations[faulty].satellite);
        assert!((suspect.bias_m + 6.0).abs() < 1e-4, "{suspect:?}");
        // A w-test is a bias over its standard deviation.
        assert!((suspect.w_test.abs() * suspect.bias_sigma_m - 6.0).abs() < 1e-4, "{suspect:?}");
    }
}

/// Returns an epoch with a fault of 150 m in its second satellite.
fn with_fault(directions: &[(f64, f64)], height: bool) -> Epoch<CAPACITY> {
    let mut observations = seen(directions, 0.0);
    observations[1].range_m += 150.0;
    let mut epoch = epoch(1.0, &observations);
    if height {
        epoch.aid(Aiding::Height { value_m: LocalFrame::at(receiver()).height_m(), sigma_m: 5.0 }).unwrap();
    }
    epoch
}

#[test]
fn consensus_of_another_sky_is_not_that_of_this_one() {
    let fresh = || {
        let mut monitor = monitor(npa());
        monitor.set_strategy(Strategy::CLASSIC.with_method(Method::Ransac)).unwrap();
        monitor.start_from(receiver());
        monitor
    };
    let skies = [
        (&DIRECTIONS[..], false),
        (&DIRECTIONS[..], true),
        (&DIRECTIONS[..7], false),
        (&DIRECTIONS[..7], true),
    ];
    for first in skies {
        for second in skies {
            let mut monitor = fresh();
            monitor.process(&with_fault(first.0, first.1));
            monitor.start_from(receiver());
            let (have, want) = (
                monitor.process(&with_fault(second.0, second.1)),
                fresh().process(&with_fault(second.0, second.1)),
            );
            assert_eq!(want.excluded.len(), 1);
            assert_eq!((have.verdict, have.excluded, have.used), (want.verdict, want.excluded, want.used));
        }
    }
}
