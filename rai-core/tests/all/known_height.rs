//! A known height beside the satellites: what it adds to test, search and levels, and that a wrong
//! one vouches for nothing.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

use crate::sky::{CAPACITY, observe, receiver, satellite};
use crate::solved::solved;
use nalgebra::{DMatrix, Vector3};
use raim_core::epoch::{Aiding, Epoch};
use raim_core::frame::{Ecef, LocalFrame};
use raim_core::internals::integrity::raim::levels::slopes;
use raim_core::internals::least_squares::equations::{LinearEpoch, MAX_ROWS};
use raim_core::monitor::{Method, Monitor, Strategy};
use raim_core::report::{Alert, Protected, Report, Unavailable, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::Constellation;

/// Azimuth and elevation in degrees. Beside a height, the first four and any four of the first five
/// test each other well.
const SKY: [(f64, f64); 8] = [
    (10.0, 75.0),
    (200.0, 60.0),
    (300.0, 40.0),
    (340.0, 12.0),
    (50.0, 20.0),
    (110.0, 45.0),
    (160.0, 15.0),
    (250.0, 25.0),
];

/// Returns an epoch of the first satellites, one of them faulty, with a height that is wrong by
/// `height_error_m`.
fn epoch(
    time_s: f64,
    satellites: usize,
    fault: Option<(usize, f64)>,
    height_error_m: Option<f64>,
) -> Epoch<CAPACITY> {
    let mut epoch = Epoch::new(time_s);
    for (index, &direction) in SKY[..satellites].iter().enumerate() {
        let mut observation = observe(satellite(Constellation::Gps, index + 1), direction, 1e4);
        observation.range_m += fault.filter(|fault| fault.0 == index).map_or(0.0, |fault| fault.1);
        epoch.push(observation).unwrap();
    }
    if let Some(error_m) = height_error_m {
        let value_m = LocalFrame::at(receiver()).height_m() + error_m;
        epoch.aid(Aiding::Height { value_m, sigma_m: 3.0 }).unwrap();
    }
    epoch
}

fn monitor(method: Method) -> Monitor<f32, CAPACITY> {
    let mut monitor = Monitor::new(Requirements::non_precision_approach()).unwrap();
    monitor.set_strategy(Strategy::DEFAULT.with_method(method)).unwrap();
    // A height says nothing at the centre of the earth, where a first fix would begin.
    monitor.start_from(receiver() + Ecef::new(2e3, -3e3, 1e3));
    monitor
}

/// Returns the last report of eleven seconds of the same sky: weak agreements need ten.
fn report_on(
    satellites: usize,
    fault: Option<(usize, f64)>,
    height_error_m: Option<f64>,
) -> Report<CAPACITY> {
    let mut monitor = monitor(Method::Auto);
    let mut process =
        |second: i32| monitor.process(&epoch(f64::from(second), satellites, fault, height_error_m));
    (0..10).for_each(|second| drop(process(second)));
    process(10)
}

fn error_m(report: &Report<CAPACITY>) -> f64 {
    report.solution.as_ref().unwrap().position.distance_m(receiver())
}

/// The reference solves all columns, clock included, with dense matrices.
#[test]
fn redundancy_and_slopes_are_those_of_dense_least_squares() {
    for satellites in 4..=8 {
        let (mut rows, mut design) = (LinearEpoch::<f64, MAX_ROWS>::new(), Vec::new());
        let sigma_of = |index: usize| 2.0 + 0.5 * index as f64;
        for (index, (azimuth, elevation)) in SKY[..satellites].iter().enumerate() {
            let (azimuth, elevation) = (azimuth.to_radians(), elevation.to_radians());
            let [east, north, up] =
                [elevation.cos() * azimuth.sin(), elevation.cos() * azimuth.cos(), elevation.sin()];
            rows.satellite(Constellation::Gps, Vector3::new(east, north, up), 0.0, sigma_of(index)).unwrap();
            design.push(([-east, -north, -up, 1.0], sigma_of(index)));
        }
        rows.height(0.0, 3.0).unwrap();
        design.push(([0.0, 0.0, 1.0, 0.0], 3.0));
        let snapshot = solved(rows).unwrap();

        let n = design.len();
        let a = DMatrix::from_fn(n, 4, |row, column| design[row].0[column] / design[row].1);
        let inverse = (a.transpose() * &a).try_inverse().unwrap();
        let gain = &inverse * a.transpose();
        let residual_matrix = DMatrix::identity(n, n) - &a * &gain;
        assert_eq!(snapshot.dof(), n - 4);
        for (index, (row, fit)) in snapshot.rows().enumerate() {
            let redundancy = residual_matrix[(index, index)];
            assert!((fit.redundancy - redundancy).abs() < 1e-9, "{satellites}, row {index}");
            let [east, north, up] = [0, 1, 2].map(|axis| gain[(axis, index)] / redundancy.sqrt());
            let have = slopes(row, fit);
            assert!((have.horizontal - east.hypot(north)).abs() < 1e-6, "{satellites}, row {index}");
            assert!((have.vertical - up.abs()).abs() < 1e-6, "{satellites}, row {index}");
        }
    }
}

#[test]
fn four_satellites_can_be_tested_beside_a_height() {
    let without = report_on(4, None, None);
    assert_eq!(without.verdict, Verdict::Unavailable(Unavailable::Redundancy));
    let with = report_on(4, None, Some(0.0));
    assert_eq!((with.verdict, with.test.unwrap().dof), (Verdict::Protected(Protected::Ok), 1));
    assert!(with.height.unwrap().is_needed);
}

/// Without a height, six are needed.
#[test]
fn of_five_satellites_beside_a_height_the_faulty_one_is_left_out() {
    for faulty in 0..5 {
        for size_m in [100.0, -1000.0] {
            let fault = Some((faulty, size_m));
            for height_error_m in [None, Some(0.0)] {
                let mut monitor = monitor(Method::Auto);
                for second in 0..20 {
                    let report = monitor.process(&epoch(f64::from(second), 5, None, height_error_m));
                    assert!(second < 10 || report.verdict == Verdict::Protected(Protected::Ok), "{second}");
                }
                let report = monitor.process(&epoch(20.0, 5, fault, height_error_m));
                if height_error_m.is_none() {
                    assert_eq!(report.verdict, Verdict::Alert(Alert::Fault), "{faulty}, {size_m} m");
                    continue;
                }
                assert_eq!(report.verdict, Verdict::Protected(Protected::Excluded), "{faulty}, {size_m} m");
                assert_eq!(report.excluded[0].satellite, satellite(Constellation::Gps, faulty + 1));
                assert!(error_m(&report) < 0.1, "{faulty}, {size_m} m: {} m", error_m(&report));
            }
        }
    }
}

/// A set that was chosen because it agrees with one degree of freedom proves nothing about a place
/// that was never promised.
#[test]
fn faulty_one_of_five_from_the_start_is_named_and_nothing_is_promised() {
    for faulty in 0..5 {
        let report = report_on(5, Some((faulty, 1000.0)), Some(0.0));
        assert_eq!(report.verdict, Verdict::Unavailable(Unavailable::Recovering), "{faulty}");
        assert_eq!(report.excluded[0].satellite, satellite(Constellation::Gps, faulty + 1));
    }
}

#[test]
fn height_that_is_wrong_by_100_m_is_left_out_and_moves_nothing() {
    for method in [Method::Auto, Method::Baarda] {
        // With fewer satellites, others may explain the contradiction nearly as well.
        let satellites = SKY.len();
        let report = monitor(method).process(&epoch(0.0, satellites, None, Some(100.0)));
        assert_eq!(report.verdict, Verdict::Protected(Protected::Ok), "{method:?}, {satellites}");
        let height = report.height.unwrap();
        assert!(!height.is_used && (height.difference_m - 100.0).abs() < 0.1, "{height:?}");
        assert!(error_m(&report) < 0.1, "{method:?}, {satellites}: {} m", error_m(&report));
        let alone = monitor(method).process(&epoch(0.0, satellites, None, None));
        let levels = [&report, &alone].map(|report| report.protection.unwrap());
        // The two solve about points that differ, in single precision.
        let is_same = |have_m: f64, want_m: f64| (have_m - want_m).abs() < 1e-4 * want_m;
        assert!(is_same(levels[0].hpl_m, levels[1].hpl_m), "{levels:?}");
        assert!(is_same(levels[0].vpl_m, levels[1].vpl_m), "{levels:?}");
    }
}

#[test]
fn height_that_is_wrong_by_100_m_vouches_for_no_four_satellites() {
    for satellites in [4, 5] {
        // The contradiction of earlier epochs may count as noise, so that the levels grow instead.
        let verdict = report_on(satellites, None, Some(100.0)).verdict;
        assert!(!matches!(verdict, Verdict::Protected(_)), "{satellites}: {verdict:?}");
    }
}

/// A height of any size that passes the test moves the position by less than the levels.
#[test]
fn levels_bound_every_wrong_height_that_passes() {
    for satellites in 4..=8 {
        let mut promised = 0;
        for step in 0..100 {
            let wrong_m = f64::from(step);
            let report = report_on(satellites, None, Some(wrong_m));
            promised += usize::from(matches!(report.verdict, Verdict::Protected(_)));
            if let (Verdict::Protected(_), Some(levels)) = (report.verdict, report.protection) {
                let error = LocalFrame::at(receiver()).rotate(report.solution.unwrap().position - receiver());
                assert!(error.horizontal() < levels.hpl_m, "{satellites}, {wrong_m} m");
                assert!(error.up.abs() < levels.vpl_m, "{satellites}, {wrong_m} m");
            }
        }
        assert!(promised >= 10, "{satellites}: {promised}");
    }
}

/// The same contradiction, in which either the height or the whole sky has moved.
#[test]
fn drift_of_a_height_that_agreed_is_ambiguous_and_a_step_is_its_own() {
    let mut drifting = monitor(Method::Auto);
    let mut first_s = None;
    for second in 0..120_u32 {
        let wrong_m = f64::from(second.saturating_sub(20));
        let report = drifting.process(&epoch(f64::from(second), 7, None, Some(wrong_m)));
        if matches!(report.verdict, Verdict::Alert(_)) {
            assert_eq!(report.verdict, Verdict::Alert(Alert::Ambiguous));
            first_s.get_or_insert(second);
        } else {
            assert_eq!(first_s, None, "{second} s: {:?}", report.verdict);
        }
    }
    assert!(first_s.is_some_and(|first_s| first_s < 60), "{first_s:?}");

    let mut stepping = monitor(Method::Auto);
    for second in 0..60_u32 {
        let wrong_m = if second < 20 { 0.0 } else { 100.0 };
        let report = stepping.process(&epoch(f64::from(second), 7, None, Some(wrong_m)));
        assert!(matches!(report.verdict, Verdict::Protected(_)), "{second} s: {:?}", report.verdict);
    }
}

#[test]
fn araim_has_no_mode_for_a_height_and_says_so() {
    assert!(!Method::Araim.allows_aiding() && Method::Auto.allows_aiding());
}
