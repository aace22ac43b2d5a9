//! All satellites of a constellation wrong at once, so that they agree on another position.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use crate::noise::Noise;
use crate::sky::{CAPACITY, METHODS, epoch_of, observe, receiver, satellite};
use raim_core::epoch::Observation;
use raim_core::monitor::{Method, Monitor, Strategy};
use raim_core::report::{Alert, Protected, Report, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::Constellation::{self, Beidou, Galileo, Gps};

const EACH: usize = 7;

/// Returns azimuth and elevation, °.
fn direction(index: usize) -> (f64, f64) {
    (137.5 * index as f64 % 360.0, 12.0 + 41.0 * index as f64 % 75.0)
}

/// Returns seven satellites each of GPS and Galileo without noise; the position of Galileo's is
/// `shift_m` farther east.
fn sky(shift_m: f64) -> Vec<Observation> {
    sky_of(&[Gps, Galileo], shift_m)
}

/// Returns seven satellites of each constellation without noise; the position of Galileo's is
/// `shift_m` farther east.
fn sky_of(constellations: &[Constellation], shift_m: f64) -> Vec<Observation> {
    let seen = (0..constellations.len() * EACH).map(|index| {
        let constellation = constellations[index / EACH];
        let clock_m = 1e5 - 4e4 * (index / EACH) as f64;
        let sighted = observe(satellite(constellation, index % EACH + 1), direction(index), clock_m);
        let (azimuth, elevation) = direction(index);
        let along_m = shift_m * elevation.to_radians().cos() * azimuth.to_radians().sin();
        let range_m = sighted.range_m - if constellation == Galileo { along_m } else { 0.0 };
        Observation { range_m, sigma_m: 1.5, ..sighted }
    });
    seen.collect()
}

fn judge(method: Method, observations: &[Observation]) -> Report<CAPACITY> {
    let epoch = epoch_of(0.0, observations);
    let mut monitor = Monitor::<f32, CAPACITY>::new(Requirements::non_precision_approach()).unwrap();
    monitor.set_strategy(Strategy::DEFAULT.with_method(method)).unwrap();
    monitor.process(&epoch)
}

#[test]
fn constellation_at_a_place_of_its_own_is_no_few_satellites_fault() {
    for method in METHODS {
        for shift_m in [20.0, 30.0, 50.0, 100.0, 300.0, 1000.0] {
            let report = judge(method, &sky(shift_m));
            assert!(matches!(report.verdict, Verdict::Alert(_)), "{method:?}, {shift_m} m: {report:?}");
        }
    }
}

/// Returns the probability that `χ²` with three degrees of freedom exceeds `x`, in closed form.
fn tail_of_three(x: f64) -> f64 {
    libm::erfc((x / 2.0).sqrt()) + (2.0 * x / std::f64::consts::PI).sqrt() * (-x / 2.0).exp()
}

/// Noise in nine degrees of freedom and more explains this sum of squares, noise in three does so
/// with a hundredth of the permitted probability.
#[test]
fn shift_that_passes_the_global_test_is_compared_with_the_noise_of_its_own_unknowns() {
    let requirements = Requirements::non_precision_approach();
    let rare = requirements.false_alarm.get() / 100.0;
    let (mut limit, mut above) = (0.0, 100.0);
    while above - limit > 1e-6 {
        let middle = 0.5 * (limit + above);
        if tail_of_three(middle) > rare { limit = middle } else { above = middle }
    }
    for constellations in [&[Gps, Galileo][..], &[Gps, Galileo, Beidou], &[Galileo, Gps, Beidou]] {
        let mut noticed = 0;
        for tenths in 0..400 {
            let report = judge(Method::Auto, &sky_of(constellations, 0.1 * f64::from(tenths)));
            // The remaining rows after an exclusion are not the whole.
            let Some(test) = report.test.filter(|_| report.excluded.is_empty()) else { continue };
            let sse = test.statistic * test.statistic * f64::from(test.dof);
            // Without noise nothing else is in the residuals.
            if sse < 0.99 * limit {
                assert_eq!(report.verdict, Verdict::Protected(Protected::Ok), "{tenths}");
            }
            if sse > 1.01 * limit && test.statistic < test.threshold {
                assert_eq!(report.verdict, Verdict::Alert(Alert::Ambiguous), "{tenths}");
                noticed += 1;
            }
        }
        assert!(noticed > 5, "{noticed}");
    }
}

#[test]
fn wrong_satellites_of_a_constellation_are_left_out_nevertheless() {
    for method in METHODS {
        for faulty in [&[9][..], &[1], &[9, 11], &[2, 9]] {
            let mut sky = sky(0.0);
            for (&index, bias_m) in faulty.iter().zip([400.0, -900.0]) {
                sky[index].range_m += bias_m;
            }
            let report = judge(method, &sky);
            // Not every method leaves out two.
            if report.verdict == Verdict::Alert(Alert::Fault) && faulty.len() > 1 {
                continue;
            }
            assert_eq!(report.verdict, Verdict::Protected(Protected::Excluded), "{method:?} {faulty:?}");
            assert_eq!(report.excluded.len(), faulty.len());
            assert!(report.solution.unwrap().position.distance_m(receiver()) < 0.1);
        }
    }
}

/// Five satellites at another position explain most of one satellite's fault; the fault explains it
/// better.
#[test]
fn satellite_that_passes_the_global_test_is_no_shift() {
    let mut passed = 0;
    for faulty in EACH..EACH + 5 {
        for tenths in 0..300 {
            let mut sky = sky(0.0);
            sky.truncate(EACH + 5);
            sky[faulty].range_m += 0.1 * f64::from(tenths);
            let report = judge(Method::Auto, &sky);
            let test = report.test.unwrap();
            if report.excluded.is_empty() && test.statistic < test.threshold {
                assert_eq!(report.verdict, Verdict::Protected(Protected::Ok), "{faulty}, {tenths}");
                passed += 1;
            }
        }
    }
    assert!(passed > 200, "{passed}");
}

/// Four satellites always agree on a position: others, of which five agree, are not faulty.
#[test]
fn nobody_is_left_out_for_four_satellites_that_stand_elsewhere() {
    let mut promised = 0;
    for seed in 0..200_u64 {
        let mut noise = Noise((seed + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let away_m = 20.0 * 50_f64.powf(noise.uniform());
        let observations: Vec<Observation> = (0..EACH + 2)
            .map(|index| {
                let (constellation, is_shifted) = if index < 5 { (Gps, false) } else { (Galileo, true) };
                let direction = (360.0 * noise.uniform(), 8.0 + 70.0 * noise.uniform());
                let sighted = observe(satellite(constellation, index + 1), direction, 1e5);
                let along_m = away_m * direction.1.to_radians().cos() * direction.0.to_radians().sin();
                let range_m = sighted.range_m + 1.5 * noise.normal() - if is_shifted { along_m } else { 0.0 };
                Observation { range_m, sigma_m: 1.5, ..sighted }
            })
            .collect();
        let report = judge(Method::Auto, &observations);
        let is_protected = matches!(report.verdict, Verdict::Protected(_));
        let blames_others = report.excluded.iter().any(|suspect| suspect.satellite.constellation() == Gps);
        assert!(!(is_protected && blames_others), "seed {seed}, {away_m} m: {report:?}");
        promised += usize::from(is_protected);
    }
    assert!(promised > 20, "{promised}");
}
