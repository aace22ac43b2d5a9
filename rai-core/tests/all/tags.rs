//! A wrong time of all ranges, distinguished from faulty satellites.
#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use raim_core::epoch::Observation;
use raim_core::frame::LocalFrame;
use raim_core::internals::integrity::raim::detection::threshold::policy::Policy;
use raim_core::internals::integrity::raim::hypotheses::time_tag::RangeRates;
use raim_core::internals::integrity::raim::isolation::parity::Isolation;
use raim_core::monitor::{Method, Monitor, MonitorMemory, Search, Strategy};
use raim_core::report::{Alert, Protected, Report, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::{Constellation, SatelliteId};

use crate::sky::{CAPACITY, epoch_of, observe, receiver, satellite};

/// Azimuth and elevation of satellites in degrees, with their range rates, m/s.
const SATELLITES: [((f64, f64), f32); 12] = [
    ((10.0, 75.0), -120.0),
    ((50.0, 20.0), 640.0),
    ((110.0, 45.0), -410.0),
    ((160.0, 15.0), -700.0),
    ((200.0, 60.0), 260.0),
    ((250.0, 25.0), 530.0),
    ((300.0, 40.0), -330.0),
    ((340.0, 12.0), 90.0),
    ((80.0, 55.0), 370.0),
    ((135.0, 30.0), 20.0),
    ((225.0, 18.0), -590.0),
    ((285.0, 65.0), 450.0),
];

const METHODS: [Method; 5] = [
    Method::Auto,
    Method::Baarda,
    Method::Parity(Isolation::Hybrid),
    Method::Parity(Isolation::Grouping),
    Method::Araim,
];

fn rate_m_s(id: SatelliteId) -> Option<f32> {
    SATELLITES.get(usize::from(id.number()).checked_sub(1)?).map(|(_, rate_m_s)| *rate_m_s)
}

/// Returns all observations, tagged late by `late_s`, so that the satellites have moved since the
/// signals left.
fn tagged(late_s: f64) -> Vec<Observation> {
    let numbered = (1..).zip(SATELLITES);
    numbered
        .map(|(number, (direction, rate_m_s))| {
            let mut observation = observe(satellite(Constellation::Gps, number), direction, 1e4);
            observation.range_m -= late_s * f64::from(rate_m_s);
            observation
        })
        .collect()
}

fn judge(
    observations: &[Observation],
    strategy: Strategy,
    requirements: Requirements,
    rates: Option<&RangeRates<'_>>,
) -> Report<CAPACITY> {
    let epoch = epoch_of(0.0, observations);
    let mut monitor = Monitor::<f32, CAPACITY>::new(requirements).unwrap();
    monitor.set_strategy(strategy).unwrap();
    // A wrong time alone makes these residuals, which must not pass for noise of the receiver.
    monitor.disable_continuity();
    let mut memory = MonitorMemory::new();
    monitor.judge(&epoch, receiver(), Search::Anew, rates, &mut memory).report.clone()
}

fn judge_by(method: Method, observations: &[Observation]) -> Report<CAPACITY> {
    let strategy = Strategy::DEFAULT.with_method(method);
    judge(observations, strategy, Requirements::non_precision_approach(), Some(&rate_m_s))
}

#[test]
fn wrong_time_is_an_alert_of_its_own_and_no_satellites_fault() {
    for method in METHODS {
        for late_s in [-0.2, -0.08, 0.05, 0.08, 0.2] {
            let report = judge_by(method, &tagged(late_s));
            assert_eq!(report.verdict, Verdict::Alert(Alert::Time), "{method:?}, {late_s} s");
            assert_eq!((report.excluded.len(), report.used.len()), (0, SATELLITES.len()), "{method:?}");
        }
    }
}

#[test]
fn wrong_satellite_is_left_out_whatever_rates_say() {
    for method in METHODS {
        for faulty in 0..SATELLITES.len() {
            for bias_m in [80.0, -80.0, 5000.0] {
                let mut observations = tagged(0.0);
                observations[faulty].range_m += bias_m;
                let report = judge_by(method, &observations);
                assert_eq!(report.verdict, Verdict::Protected(Protected::Excluded), "{method:?} {faulty}");
                assert_eq!(report.excluded[0].satellite, observations[faulty].satellite);
                assert_eq!(report.excluded.len(), 1);
            }
        }
    }
}

#[test]
fn wrong_time_and_a_wrong_satellite_are_not_explained_by_satellites() {
    for method in METHODS {
        for faulty in 0..SATELLITES.len() {
            for late_s in [-0.05, 0.05, 0.1] {
                let mut observations = tagged(late_s);
                observations[faulty].range_m += 300.0;
                let report = judge_by(method, &observations);
                assert!(
                    matches!(report.verdict, Verdict::Alert(_)),
                    "{method:?} {faulty}: {:?}",
                    report.verdict
                );
            }
        }
    }
}

#[test]
fn policy_that_tolerates_satellites_does_not_tolerate_the_time() {
    let requirements = Requirements::non_precision_approach().with_hal_m(120.0);
    for policy in [Policy::T1, Policy::T2, Policy::TOp] {
        let strategy = Strategy::DEFAULT.with_policy(policy);
        let report = judge(&tagged(0.05), strategy, requirements, Some(&rate_m_s));
        assert_eq!(report.verdict, Verdict::Alert(Alert::Time), "{policy:?}");
        let report = judge(&tagged(0.0), strategy, requirements, Some(&rate_m_s));
        assert_eq!(report.verdict, Verdict::Protected(Protected::Ok), "{policy:?}");
    }
}

#[test]
fn rates_that_are_unknown_or_no_numbers_leave_what_is_said_without_them() {
    let mut observations = tagged(0.0);
    observations[4].range_m += 80.0;
    let requirements = Requirements::non_precision_approach;
    for epoch in [observations, tagged(0.1)] {
        let without = judge(&epoch, Strategy::DEFAULT, requirements(), None);
        let none = judge(&epoch, Strategy::DEFAULT, requirements(), Some(&|_| None));
        let no_number = judge(&epoch, Strategy::DEFAULT, requirements(), Some(&|_| Some(f32::NAN)));
        let endless = judge(&epoch, Strategy::DEFAULT, requirements(), Some(&|_| Some(f32::MAX)));
        assert_eq!(without, none);
        assert_eq!(without, no_number);
        assert_eq!(without, endless);
    }
}

/// Rates that a movement to the east mostly explains, as if most satellites rise on one side.
fn eastward_m_s(id: SatelliteId) -> Option<f32> {
    let index = usize::from(id.number()).checked_sub(1)?;
    let ((azimuth_deg, elevation_deg), rate_m_s) = SATELLITES.get(index)?;
    let east = azimuth_deg.to_radians().sin() * elevation_deg.to_radians().cos();
    Some(0.4 * rate_m_s - 700.0 * east as f32)
}

#[test]
fn level_bounds_what_a_wrong_time_does_that_is_not_seen() {
    let frame = LocalFrame::at(receiver());
    let (mut promised, mut beyond_a_satellites) = (0, 0);
    for late_ms in 1..60 {
        let late_s = 1e-3 * f64::from(late_ms);
        let mut late = tagged(0.0);
        for observation in &mut late {
            observation.range_m -= late_s * f64::from(eastward_m_s(observation.satellite).unwrap());
        }
        let levels_and_error = |rates| {
            let report = judge(&late, Strategy::DEFAULT, Requirements::non_precision_approach(), rates);
            let Verdict::Protected(Protected::Ok) = report.verdict else { return None };
            let error = frame.rotate(report.solution?.position - receiver());
            Some((report.protection?, error.horizontal(), error.up.abs()))
        };
        let Some((levels, horizontal_m, up_m)) = levels_and_error(Some(&eastward_m_s)) else { continue };
        assert!(
            horizontal_m < levels.hpl_m && up_m < levels.vpl_m,
            "{late_ms} ms: {horizontal_m} m, {levels:?}"
        );
        promised += 1;
        let (of_satellites, horizontal_m, _) = levels_and_error(None).unwrap();
        beyond_a_satellites += u32::from(horizontal_m > of_satellites.hpl_m);
    }
    assert!(promised > 10 && beyond_a_satellites > 0, "{promised} promised, {beyond_a_satellites} beyond");
}
