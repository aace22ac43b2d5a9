//! Isolation in parity space, on skies whose faults are known by construction.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

use nalgebra::Vector3;
use proptest::prelude::*;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::isolation::exclusion::{
    Exclusion, ExclusionOutcome, Unidentified,
};
use raim_core::internals::integrity::raim::isolation::parity::{
    Isolation, MAX_SETS, ParityFinding, SearchLimits, correlation_threshold, exclude, grouping, hybrid,
    hybrid_without_grouping, sequential, simultaneous,
};
use raim_core::internals::least_squares::Snapshot;
use raim_core::internals::least_squares::equations::{LinearEpoch, MAX_ROWS};
use raim_core::internals::numeric::probability::Probability;
use raim_core::internals::numeric::real::Real;
use raim_core::satellite::Constellation;

use crate::sky::DIRECTIONS;
use crate::solved::{copied, solved};

type Sky<T> = Snapshot<'static, T>;

const METHODS: [Isolation; 5] = [
    Isolation::Simultaneous,
    Isolation::Sequential,
    Isolation::HybridWithoutGrouping,
    Isolation::Hybrid,
    Isolation::Grouping,
];

/// Two more, low.
const LOW: [(f64, f64); 2] = [(80.0, 10.0), (225.0, 8.0)];

/// Noise of some metres, which is not a fault.
const NOISE_M: [f64; 10] = [1.3, -2.1, 0.4, 3.0, -1.7, 0.9, -0.6, 2.2, -2.8, 1.1];

fn thresholds() -> Thresholds<'static> {
    let probability = |tail| Probability::new(tail).unwrap();
    Thresholds::from_tables(probability(5e-3), probability(1e-3)).unwrap()
}

fn direction(azimuth_deg: f64, elevation_deg: f64) -> Vector3<f64> {
    let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
    Vector3::new(elevation.cos() * azimuth.sin(), elevation.cos() * azimuth.cos(), elevation.sin())
}

/// Returns the first `count` directions with their noise, sigma 3 m, and biases on some.
fn sky<T: Real>(count: usize, biases_m: &[(usize, f64)]) -> Sky<T> {
    let mut epoch = LinearEpoch::new();
    for (index, ((azimuth, elevation), noise_m)) in
        DIRECTIONS.into_iter().chain(LOW).zip(NOISE_M).take(count).enumerate()
    {
        let bias_m: f64 = biases_m.iter().filter(|(row, _)| *row == index).map(|(_, bias_m)| bias_m).sum();
        let clock = if index % 2 == 0 { Constellation::Gps } else { Constellation::Beidou };
        epoch.satellite(clock, direction(azimuth, elevation), noise_m + bias_m, 3.0).unwrap();
    }
    solved(epoch).unwrap()
}

fn named<T: Real>(finding: &ParityFinding<T>) -> Result<Vec<usize>, Unidentified> {
    let mut rows: Vec<usize> = match &finding.set {
        Ok(removal) => removal.rows().iter().map(|row| row.index).collect(),
        Err(why) => return Err(*why),
    };
    rows.sort_unstable();
    Ok(rows)
}

fn rows<T>(exclusion: &Exclusion<T>) -> Vec<usize> {
    exclusion.rows.iter().map(|excluded| excluded.index).collect()
}

#[test]
fn threshold_equals_the_quantiles_of_student() {
    // t(0.995, m) of printed tables: Abramowitz & Stegun, table 26.10.
    let printed = [(1, 63.657), (2, 9.925), (3, 5.841), (4, 4.604), (7, 3.499), (10, 3.169), (30, 2.750)];
    for (m, t) in printed {
        let have = correlation_threshold::<f64>(Probability::new(0.01).unwrap(), m + 1).unwrap();
        let want = t / (f64::from(m as u32) + t * t).sqrt();
        assert!((have / want - 1.0).abs() < 2e-4, "{m}: have {have}, want {want}");
    }
}

#[test]
fn threshold_has_the_closed_forms_of_small_dimensions() {
    for alpha in [0.4, 0.05, 0.01, 1e-4, 1e-6] {
        let threshold = |dof| correlation_threshold::<f64>(Probability::new(alpha).unwrap(), dof).unwrap();
        let arc = (alpha * core::f64::consts::FRAC_PI_2).cos();
        assert!((threshold(2) / arc - 1.0).abs() < 1e-12, "a circle: the angle is uniform");
        assert!((threshold(3) / (1.0 - alpha) - 1.0).abs() < 1e-12, "a sphere: the height is uniform");
    }
    assert_eq!(correlation_threshold::<f64>(Probability::new(0.01).unwrap(), 1), None);
    assert_eq!(correlation_threshold::<f64>(Probability::new(0.01).unwrap(), 0), None);
}

#[test]
fn threshold_in_single_precision_is_that_in_double() {
    for alpha in [0.3, 0.01, 1e-3].map(|alpha| Probability::new(alpha).unwrap()) {
        for dof in 2..=60 {
            let want = correlation_threshold::<f64>(alpha, dof).unwrap();
            let have = f64::from(correlation_threshold::<f32>(alpha, dof).unwrap());
            assert!((have / want - 1.0).abs() < 5e-5, "{alpha:?} {dof}: have {have}, want {want}");
        }
    }
}

#[test]
fn nothing_detected_names_nothing() {
    let (sky, thresholds, limits) = (sky::<f64>(10, &[]), thresholds(), SearchLimits::published());
    for finding in [
        sequential(&sky, &thresholds, &limits),
        hybrid_without_grouping(&sky, &thresholds, &limits),
        hybrid(&sky, &thresholds, &limits),
        grouping(&sky, &thresholds, &limits),
    ] {
        assert_eq!(named(&finding), Ok(vec![]));
        assert_eq!(finding.sets, 0);
    }
    assert!(simultaneous(&sky, &thresholds, &limits).is_empty());
    for method in METHODS {
        let have = exclude(method, &mut copied(&sky), &thresholds, &limits);
        assert_eq!((rows(&have), have.outcome), (vec![], ExclusionOutcome::Passed));
    }
}

#[test]
fn one_fault_is_named_by_every_method_in_both_precisions() {
    fn check<T: Real>() {
        for method in METHODS {
            let mut sky = sky::<T>(10, &[(6, 120.0)]);
            let have = exclude(method, &mut sky, &thresholds(), &SearchLimits::published());
            assert_eq!((rows(&have), have.outcome), (vec![6], ExclusionOutcome::Isolated), "{method:?}");
            assert_eq!(sky.used(), 9);
        }
    }
    check::<f64>();
    check::<f32>();
}

#[test]
fn a_fault_of_a_thousand_kilometres_is_named_in_single_precision() {
    for method in METHODS {
        let have =
            exclude(method, &mut sky::<f32>(10, &[(6, 1e6)]), &thresholds(), &SearchLimits::published());
        assert_eq!((rows(&have), have.outcome), (vec![6], ExclusionOutcome::Isolated), "{method:?}");
    }
}

#[test]
fn grouping_finds_the_smallest_set_that_brute_force_finds() {
    for biases_m in [[(1, 90.0), (7, -110.0)], [(0, 60.0), (4, 80.0)], [(3, 200.0), (5, 70.0)]] {
        let (sky, thresholds) = (sky::<f64>(10, &biases_m), thresholds());
        let have = named(&grouping(&sky, &thresholds, &SearchLimits::published()));
        let mut best = (f64::INFINITY, vec![]);
        for first in 0..10 {
            for second in first + 1..10 {
                let mut rest = copied(&sky);
                rest.leave_out(first).unwrap();
                rest.leave_out(second).unwrap();
                if rest.sse() < best.0 {
                    best = (rest.sse(), vec![first, second]);
                }
            }
        }
        assert!(best.0 < thresholds.tau1(3).unwrap());
        assert_eq!(have, Ok(best.1));
    }
}

#[test]
fn three_faults_are_grouped() {
    let mut sky = sky::<f64>(10, &[(0, 150.0), (4, -220.0), (7, 300.0)]);
    let mut have = exclude(Isolation::Grouping, &mut sky, &thresholds(), &SearchLimits::published());
    have.rows.sort_unstable_by_key(|excluded| excluded.index);
    assert_eq!((rows(&have), have.outcome), (vec![0, 4, 7], ExclusionOutcome::Isolated));
}

#[test]
fn grouping_finds_what_hides_from_the_sequential_method() {
    // Two biases that look most like a third row's: the sky is searched for such a pair, the truth
    // is known.
    let (thresholds, limits) = (thresholds(), SearchLimits { rows: 2, ..SearchLimits::published() });
    let mut hidden = 0;
    for first in 0..10 {
        for second in first + 1..10 {
            for sign in [-1.0, 1.0] {
                let sky = sky::<f64>(10, &[(first, 100.0), (second, sign * 100.0)]);
                let truth = Ok(vec![first, second]);
                if named(&sequential(&sky, &thresholds, &limits)).is_err() {
                    let have = named(&grouping(&sky, &thresholds, &limits));
                    hidden += usize::from(have == truth);
                    assert_eq!(named(&hybrid(&sky, &thresholds, &limits)), have);
                }
            }
        }
    }
    assert!(hidden >= 3, "{hidden} pairs");
}

#[test]
fn a_simultaneous_set_that_is_not_minimal_is_not_taken() {
    let limits = SearchLimits { alpha: Probability::new(0.3).unwrap(), ..SearchLimits::published() };
    let mut larger_than_the_truth = 0;
    for faulty in 0..8 {
        let sky = sky::<f64>(8, &[(faulty, 500.0)]);
        let at_once = simultaneous(&sky, &thresholds(), &limits);
        larger_than_the_truth += usize::from((2..=3).contains(&at_once.len()));
        assert_eq!(named(&hybrid_without_grouping(&sky, &thresholds(), &limits)), Ok(vec![faulty]));
    }
    assert!(larger_than_the_truth >= 2, "{larger_than_the_truth} sets");
}

#[test]
fn without_redundancy_nothing_is_searched() {
    let sky = sky::<f64>(5, &[(2, 500.0)]);
    assert_eq!(sky.dof(), 0);
    for method in METHODS {
        let have = exclude(method, &mut copied(&sky), &thresholds(), &SearchLimits::published());
        assert_eq!(have.outcome, ExclusionOutcome::NotIsolated(Unidentified::NoRedundancy), "{method:?}");
    }
}

#[test]
fn with_one_degree_of_freedom_no_row_can_be_named() {
    let sky = sky::<f64>(6, &[(2, 500.0)]);
    assert_eq!(sky.dof(), 1);
    for method in METHODS {
        let have = exclude(method, &mut copied(&sky), &thresholds(), &SearchLimits::published());
        assert_eq!(have.outcome, ExclusionOutcome::NotIsolated(Unidentified::NoSet), "{method:?}");
    }
}

#[test]
fn a_budget_that_is_used_up_is_said() {
    let sky = sky::<f64>(10, &[(0, 150.0), (4, -220.0), (7, 300.0)]);
    let limits = SearchLimits { sets: 10 + 45 + 119, ..SearchLimits::published() };
    let have = grouping(&sky, &thresholds(), &limits);
    assert_eq!((named(&have), have.sets), (Err(Unidentified::Budget), limits.sets));
    let enough = SearchLimits { sets: limits.sets + 1, ..limits };
    let have = grouping(&sky, &thresholds(), &enough);
    assert_eq!((named(&have), have.sets), (Ok(vec![0, 4, 7]), enough.sets));
}

#[test]
fn the_lone_satellite_of_a_constellation_is_never_named() {
    let mut epoch = LinearEpoch::<f64, MAX_ROWS>::new();
    for (index, (azimuth, elevation)) in DIRECTIONS.into_iter().chain(LOW).enumerate() {
        let clock = if index == 3 { Constellation::Galileo } else { Constellation::Gps };
        let bias_m = [0.0, 0.0, 150.0, 900.0][index.min(3)] * f64::from(u8::from(index < 4));
        epoch.satellite(clock, direction(azimuth, elevation), bias_m, 3.0).unwrap();
    }
    let sky = solved(epoch).unwrap();
    for method in METHODS {
        let have = exclude(method, &mut copied(&sky), &thresholds(), &SearchLimits::published());
        assert_eq!((rows(&have), have.outcome), (vec![2], ExclusionOutcome::Isolated), "{method:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn whatever_is_isolated_passes_and_work_is_bounded(
        biases_m in prop::collection::vec((0usize..10, -1e5f64..1e5), 0..5),
        count in 6usize..=10,
    ) {
        for method in METHODS {
            let mut sky = sky::<f32>(count, &biases_m);
            let have = exclude(method, &mut sky, &thresholds(), &SearchLimits::published());
            let passes = thresholds().tau1(sky.dof()).is_some_and(|tau1| f64::from(sky.sse()) < tau1);
            let isolated = matches!(have.outcome, ExclusionOutcome::Isolated | ExclusionOutcome::Passed);
            prop_assert_eq!(isolated, passes);
            prop_assert_eq!(sky.used() + have.rows.len(), count);
        }
        let work = grouping(&sky::<f32>(count, &biases_m), &thresholds(), &SearchLimits::published()).sets;
        prop_assert!(work <= MAX_SETS);
    }
}
