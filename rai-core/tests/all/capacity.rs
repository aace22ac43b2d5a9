//! Capacities side by side in one program: the same satellites give the same report, and an epoch
//! may be full.

#![allow(clippy::unwrap_used)]

use raim_core::epoch::Observation;
use raim_core::internals::weighting::Ism;
use raim_core::monitor::{Isolation, Method, Monitor, Strategy};
use raim_core::report::{Protected, Report, Unavailable, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::Constellation::{self, Beidou, Galileo, Glonass, Gps};
use raim_core::satellite::SatelliteId;

use crate::sky::{METHODS, epoch_of, observe, satellite};

/// Error of the faulty satellite, m: far beyond any threshold, and far below what bends the
/// linearised ranges.
const BIAS_M: f64 = 400.0;

/// Returns satellites of constellations in turn, spread over the sky, without noise.
fn visible(constellations: &[Constellation], count: usize) -> Vec<Observation> {
    let systems = constellations.len();
    let sighted = |index: usize| {
        let direction = (137.5 * index as f64 % 360.0, 12.0 + 41.0 * index as f64 % 75.0);
        let id = satellite(constellations[index % systems], index / systems + 1);
        observe(id, direction, 1e5 - 4e4 * (index % systems) as f64)
    };
    (0..count).map(sighted).collect()
}

/// Returns the report of a monitor for at most `N` satellites.
fn judge<const N: usize>(method: Method, observations: &[Observation]) -> Report<N> {
    judge_by(Ism::RESEARCH, method, observations)
}

fn judge_by<const N: usize>(ism: Ism, method: Method, observations: &[Observation]) -> Report<N> {
    let mut monitor = Monitor::<f32, N>::new(Requirements::en_route()).unwrap();
    monitor.set_strategy(Strategy::CLASSIC.with_method(method)).unwrap();
    monitor.set_ism(ism);
    monitor.process(&epoch_of(0.0, observations))
}

/// Methods of classic RAIM, the other hybrid, and ARAIM.
fn methods() -> impl Iterator<Item = Method> {
    METHODS.into_iter().chain([Method::Parity(Isolation::HybridWithoutGrouping), Method::Araim])
}

fn is_named<const N: usize>(report: &Report<N>, faulty: SatelliteId) -> bool {
    report.excluded.iter().map(|suspect| suspect.satellite).eq([faulty])
}

#[test]
fn monitors_of_any_capacity_judge_twelve_satellites_alike() {
    for method in methods() {
        for bias_m in [0.0, BIAS_M] {
            let mut sky = visible(&[Gps, Galileo], 12);
            sky[4].range_m += bias_m;
            let report = judge::<16>(method, &sky);
            let how = if bias_m > 0.0 { Protected::Excluded } else { Protected::Ok };
            assert_eq!(report.verdict, Verdict::Protected(how), "{method:?}, {bias_m} m");
            assert!(bias_m == 0.0 || is_named(&report, sky[4].satellite), "{method:?}: {report:?}");
            // The text has every digit.
            let want = format!("{report:?}");
            assert_eq!(format!("{:?}", judge::<40>(method, &sky)), want, "{method:?}, {bias_m} m");
            assert_eq!(format!("{:?}", judge::<64>(method, &sky)), want, "{method:?}, {bias_m} m");
        }
    }
}

#[test]
fn full_epochs_have_room_for_every_search() {
    for method in methods() {
        let mut few = visible(&[Gps, Galileo], 16);
        few[9].range_m += BIAS_M;
        assert!(is_named(&judge::<16>(method, &few), few[9].satellite), "{method:?}, 16");
        let mut many = visible(&[Gps, Galileo, Beidou], 40);
        many[31].range_m += BIAS_M;
        let report = judge::<40>(method, &many);
        assert_eq!(report.verdict, Verdict::Protected(Protected::Excluded), "{method:?}, 40");
        assert!(is_named(&report, many[31].satellite), "{method:?}, 40");
    }
}

/// A search over pairs has memory for every row.
#[test]
fn the_last_two_satellites_of_a_full_epoch_are_found_together() {
    let mut sky = visible(&[Gps, Galileo, Beidou], 40);
    for faulty in &mut sky[38..] {
        faulty.range_m += BIAS_M;
    }
    for method in [Method::Auto, Method::Parity(Isolation::Grouping), Method::Ransac] {
        let report = judge::<40>(method, &sky);
        assert_eq!(report.verdict, Verdict::Protected(Protected::Excluded), "{method:?}");
        let is_excluded = |faulty: &Observation| {
            report.excluded.iter().any(|suspect| suspect.satellite == faulty.satellite)
        };
        assert!(report.excluded.len() == 2 && sky[38..].iter().all(is_excluded), "{method:?}: {report:?}");
    }
}

#[test]
fn the_largest_epoch_is_judged() {
    let mut sky = visible(&[Gps, Galileo, Beidou, Glonass], 64);
    sky[63].range_m += BIAS_M;
    for method in [Method::Auto, Method::Baarda, Method::Ransac] {
        let report = judge::<64>(method, &sky);
        assert_eq!(report.verdict, Verdict::Protected(Protected::Excluded), "{method:?}");
        assert!(is_named(&report, sky[63].satellite), "{method:?}");
    }
}

/// Rows and constellations of ARAIM share one word.
#[test]
fn araim_judges_sixty_satellites_and_refuses_more_by_name() {
    let sky = visible(&[Gps, Galileo, Beidou, Glonass], 61);
    // Faults so rare that the pairs need not be monitored, because they would be too many.
    let mut ism = Ism::RESEARCH;
    for support in &mut ism.constellations {
        (support.satellite_fault, support.constellation_fault) = (1e-7, 1e-8);
    }
    let judge = |count: usize| judge_by::<64>(ism, Method::Araim, &sky[..count]).verdict;
    assert_eq!(judge(60), Verdict::Protected(Protected::Ok));
    assert_eq!(judge(61), Verdict::Unavailable(Unavailable::Budget));
}
