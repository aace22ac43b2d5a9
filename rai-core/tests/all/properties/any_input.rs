//! For any input a protected position has its grounds.

use proptest::prelude::*;
use raim_core::epoch::{Aiding, Epoch};
use raim_core::internals::numeric::real::Real;
use raim_core::monitor::{Monitor, Strategy as Monitoring};
use raim_core::report::{Alert, Protected, Report, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::{Constellation, SatelliteId};

use super::skies::{CAPACITY, any_monitoring, any_observations, any_requirements, any_sky, epoch_of};

/// Conditions on every report.
fn has_grounds(
    report: &Report<CAPACITY>,
    epoch: &Epoch<CAPACITY>,
    requirements: &Requirements,
) -> Result<(), TestCaseError> {
    satellites_add_up(report, epoch)?;
    numbers_are_numbers(report)?;
    prop_assert_ne!(report.verdict, Verdict::Alert(Alert::Stale), "the core knows no time");
    if let Verdict::Protected(reason) = report.verdict {
        promise_is_kept(report, reason, requirements)?;
    }
    Ok(())
}

/// Checks that, if there is a solution, each satellite of the epoch is either used or excluded.
fn satellites_add_up(report: &Report<CAPACITY>, epoch: &Epoch<CAPACITY>) -> Result<(), TestCaseError> {
    let tracked: Vec<SatelliteId> =
        epoch.observations().iter().map(|observation| observation.satellite).collect();
    let excluded: Vec<SatelliteId> = report.excluded.iter().map(|suspect| suspect.satellite).collect();
    prop_assert_eq!(usize::from(report.tracked), tracked.len());
    let is_lost = |satellite: &SatelliteId| {
        report.excluded_constellations >> (satellite.constellation() as u8) & 1 != 0
    };
    let rest = tracked.iter().filter(|satellite| !excluded.contains(satellite) && !is_lost(satellite));
    if report.solution.is_some() {
        prop_assert!(report.used.iter().eq(rest), "used {:?}, excluded {:?}", report.used, excluded);
    } else {
        prop_assert!(report.used.is_empty() && excluded.is_empty());
    }
    prop_assert!(excluded.iter().all(|satellite| tracked.contains(satellite)));
    Ok(())
}

fn numbers_are_numbers(report: &Report<CAPACITY>) -> Result<(), TestCaseError> {
    if let Some(solution) = &report.solution {
        prop_assert!(solution.position.is_finite());
        prop_assert!(solution.covariance_m2.iter().all(|element| element.is_finite()));
        prop_assert!(solution.clocks_m.iter().flatten().all(|clock_m| clock_m.is_finite()));
        prop_assert!(solution.hdop >= 0.0 && solution.vdop >= 0.0 && solution.pdop().is_finite());
    }
    if let Some(test) = &report.test {
        prop_assert!(test.dof > 0 && test.threshold > 0.0 && test.statistic >= 0.0, "{:?}", test);
    }
    // A level may be infinite: a satellite that moves the position and cannot be tested.
    prop_assert!(report.protection.is_none_or(|levels| levels.hpl_m >= 0.0 && levels.vpl_m >= 0.0));
    let suspects = report.excluded.iter().chain(&report.suspect);
    prop_assert!(
        suspects.clone().all(|suspect| suspect.bias_m.is_finite() && suspect.bias_sigma_m > 0.0),
        "{:?}",
        suspects.collect::<Vec<_>>()
    );
    prop_assert!(report.residual_rms_m >= 0.0 && report.sigma_check.is_none_or(|mean| mean >= 0.0));
    Ok(())
}

fn promise_is_kept(
    report: &Report<CAPACITY>,
    reason: Protected,
    requirements: &Requirements,
) -> Result<(), TestCaseError> {
    prop_assert!(report.solution.is_some());
    let test = report.test.expect("the test that it rests on");
    prop_assert!(test.statistic < test.threshold, "{:?}", test);
    let levels = report.protection.expect("protection levels");
    prop_assert!(levels.hpl_m <= requirements.hal_m, "{:?}", levels);
    prop_assert!(requirements.val_m.is_none_or(|val_m| levels.vpl_m <= val_m), "{:?}", levels);
    let has_excluded = matches!(reason, Protected::Excluded | Protected::Covered);
    prop_assert_eq!(has_excluded, !report.excluded.is_empty());
    Ok(())
}

fn monitor<T: Real>(requirements: Requirements, monitoring: Monitoring) -> Monitor<T, CAPACITY> {
    let mut monitor = Monitor::new(requirements).expect("in the tables");
    monitor.set_strategy(monitoring).unwrap();
    monitor
}

fn every_report_has_grounds<T: Real>(
    epochs: &[Epoch<CAPACITY>],
    requirements: Requirements,
    monitoring: Monitoring,
) -> Result<(), TestCaseError> {
    let mut monitor = monitor::<T>(requirements, monitoring);
    epochs.iter().try_for_each(|epoch| has_grounds(&monitor.process(epoch), epoch, &requirements))
}

/// Returns any aiding, plausible or not.
fn any_aiding() -> impl Strategy<Value = Aiding> {
    let number = || prop_oneof![-1e6..1e6_f64, proptest::num::f64::ANY];
    prop_oneof![
        (number(), number()).prop_map(|(value_m, sigma_m)| Aiding::Height { value_m, sigma_m }),
        (number(), number()).prop_map(|(value_m, sigma_m)| Aiding::Clock {
            constellation: Constellation::Gps,
            value_m,
            sigma_m
        }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn no_promise_without_grounds_of_whatever_comes_in(
        observations in proptest::collection::vec(any_observations(), 1..4),
        aiding in proptest::option::of(any_aiding()),
        requirements in any_requirements(),
        monitoring in any_monitoring(),
    ) {
        let mut epochs: Vec<_> = observations.iter().map(|observations| epoch_of(observations)).collect();
        for epoch in &mut epochs {
            let _ = aiding.map(|aiding| epoch.aid(aiding));
        }
        every_report_has_grounds::<f32>(&epochs, requirements, monitoring)?;
        every_report_has_grounds::<f64>(&epochs, requirements, monitoring)?;
    }

    #[test]
    fn no_promise_without_grounds_of_a_faulty_sky(
        sky in any_sky(4),
        requirements in any_requirements(),
        monitoring in any_monitoring(),
    ) {
        every_report_has_grounds::<f32>(&[sky.epoch()], requirements, monitoring)?;
        every_report_has_grounds::<f64>(&[sky.epoch()], requirements, monitoring)?;
    }
}
