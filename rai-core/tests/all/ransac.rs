//! Range consensus on skies whose faults are known by construction.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

use nalgebra::Vector3;
use proptest::prelude::*;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::isolation::exclusion::ExclusionOutcome;
use raim_core::internals::integrity::raim::isolation::ransac::{
    ConsensusLimits, MAX_SUBSETS, MAX_WORK, NoConsensus, Selection, consensus, exclude, refine,
};
use raim_core::internals::least_squares::equations::{LinearEpoch, MAX_ROWS};
use raim_core::internals::numeric::probability::Probability;
use raim_core::internals::numeric::real::Real;
use raim_core::satellite::Constellation;

use crate::solved::solved;

type Epoch<T> = LinearEpoch<T, MAX_ROWS>;

fn thresholds() -> Thresholds<'static> {
    let probability = |tail| Probability::new(tail).unwrap();
    Thresholds::from_tables(probability(1e-4), probability(1e-3)).unwrap()
}

/// Directions spread by the golden angle, evenly in height.
fn direction(index: usize, count: usize) -> Vector3<f64> {
    let up = 0.1 + 0.88 * (index as f64 + 0.5) / count as f64;
    let (sin, cos) = (2.399_963 * index as f64).sin_cos();
    let level = (1.0 - up * up).sqrt();
    Vector3::new(level * sin, level * cos, up)
}

/// Returns `count` satellites of `constellations` in turn, noise below 2 m, sigma 3 m, and biases
/// on some.
fn sky<T: Real>(count: usize, constellations: usize, biases_m: &[(usize, f64)]) -> Epoch<T> {
    let mut epoch = LinearEpoch::new();
    for index in 0..count {
        let bias_m: f64 = biases_m.iter().filter(|(row, _)| *row == index).map(|(_, bias_m)| bias_m).sum();
        let noise_m = 2.0 * (7.3 * index as f64).sin();
        let clock = Constellation::ALL[index % constellations];
        epoch.satellite(clock, direction(index, count), noise_m + bias_m, 3.0).unwrap();
    }
    epoch
}

fn members(selection: &Selection, subset: usize) -> Vec<usize> {
    (0..selection.rows()).filter(|&row| selection.contains(subset, row)).collect()
}

/// Returns six volumes of the tetrahedron, written out as a determinant.
fn volume(corners: [Vector3<f64>; 4]) -> f64 {
    let [a, b, c, d] = corners;
    nalgebra::Matrix3::from_columns(&[b - a, c - a, d - a]).determinant().abs()
}

fn largest_by_brute_force(directions: &[Vector3<f64>]) -> f64 {
    let mut largest = 0.0f64;
    for a in 0..directions.len() {
        for b in a + 1..directions.len() {
            for c in b + 1..directions.len() {
                for d in c + 1..directions.len() {
                    largest = largest.max(volume([a, b, c, d].map(|index| directions[index])));
                }
            }
        }
    }
    largest
}

fn any_direction() -> impl Strategy<Value = Vector3<f64>> {
    (0.0..core::f64::consts::TAU, 0.0f64..1.0).prop_map(|(azimuth, up)| {
        let level = (1.0 - up * up).sqrt();
        Vector3::new(level * azimuth.sin(), level * azimuth.cos(), up)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn the_first_subset_holds_the_largest_tetrahedron(
        directions in prop::collection::vec(any_direction(), 8..16),
    ) {
        let mut epoch = Epoch::<f64>::new();
        for &direction in &directions {
            epoch.satellite(Constellation::Gps, direction, 0.0, 1.0).unwrap();
        }
        let selection: Selection = Selection::choose(epoch.rows(), MAX_WORK);
        let rows = members(&selection, 0);
        let four: Vec<Vector3<f64>> = rows.iter().map(|&row| directions[row]).collect();
        let have = largest_by_brute_force(&four);
        let want = largest_by_brute_force(&directions);
        prop_assert!((have / want - 1.0).abs() < 1e-12, "have {}, want {}", have, want);
    }

    #[test]
    fn without_work_no_other_corner_makes_the_first_subset_larger(
        directions in prop::collection::vec(any_direction(), 8..30),
    ) {
        let mut epoch = Epoch::<f64>::new();
        for &direction in &directions {
            epoch.satellite(Constellation::Gps, direction, 0.0, 1.0).unwrap();
        }
        let selection: Selection = Selection::choose(epoch.rows(), 0);
        prop_assert_eq!(selection.subsets(), directions.len() / 4);
        // The rest is dealt to the smallest subset, so that the first has four or five.
        let rows = members(&selection, 0);
        let four = |rows: &[usize]| rows.iter().map(|&row| directions[row]).collect::<Vec<_>>();
        let have = largest_by_brute_force(&four(&rows));
        for place in 0..rows.len() {
            for row in 0..directions.len() {
                let mut changed = rows.clone();
                changed[place] = row;
                // 0.1 % is what an exchange has to bring.
                prop_assert!(rows.len() > 4 || largest_by_brute_force(&four(&changed)) <= 1.001 * have);
            }
        }
    }

    #[test]
    fn subsets_share_out_all_satellites(count in 8usize..=40, constellations in 1usize..=4) {
        let epoch = sky::<f32>(count, constellations, &[]);
        let selection: Selection = Selection::choose(epoch.rows(), MAX_WORK);
        prop_assert_eq!(selection.subsets(), count / (3 + constellations));
        prop_assert!(selection.subsets() <= MAX_SUBSETS && !selection.cut());
        prop_assert!(selection.work() <= MAX_WORK);
        let mut dealt: Vec<usize> = Vec::new();
        for subset in 0..selection.subsets() {
            let rows = members(&selection, subset);
            let mut clocks: Vec<usize> = rows.iter().map(|row| row % constellations).collect();
            clocks.sort_unstable();
            clocks.dedup();
            prop_assert_eq!(clocks.len(), constellations, "subset {} of {:?}", subset, &rows);
            dealt.extend(rows);
        }
        dealt.sort_unstable();
        prop_assert_eq!(dealt, if selection.subsets() > 0 { (0..count).collect() } else { vec![] });
    }

    #[test]
    fn whatever_is_isolated_passes(
        biases_m in prop::collection::vec((0usize..20, -1e5f64..1e5), 0..5),
        count in 5usize..=20,
    ) {
        let epoch = sky::<f32>(count, 2, &biases_m);
        let selection: Selection = Selection::choose(epoch.rows(), MAX_WORK);
        let mut solution = solved(epoch).unwrap();
        let have = exclude(&mut solution, &selection, &thresholds(), &ConsensusLimits::published().unwrap());
        let passes = thresholds().tau1(solution.dof()).is_some_and(|tau1| f64::from(solution.sse()) < tau1);
        if matches!(have.outcome, ExclusionOutcome::Isolated | ExclusionOutcome::Passed) {
            prop_assert!(passes);
        }
        prop_assert_eq!(solution.used() + have.rows.len(), count);
    }
}

#[test]
fn three_faults_among_twenty_are_named_in_both_precisions() {
    fn check<T: Real>() {
        let epoch = sky::<T>(20, 2, &[(3, 150.0), (8, -150.0), (17, 150.0)]);
        let selection: Selection = Selection::choose(epoch.rows(), MAX_WORK);
        let mut solution = solved(epoch).unwrap();
        let have = exclude(&mut solution, &selection, &thresholds(), &ConsensusLimits::published().unwrap());
        let mut rows: Vec<usize> = have.rows.iter().map(|excluded| excluded.index).collect();
        rows.sort_unstable();
        assert_eq!((rows, have.outcome), (vec![3, 8, 17], ExclusionOutcome::Isolated));
        assert_eq!(solution.used(), 17);
    }
    check::<f64>();
    check::<f32>();
}

#[test]
fn a_fault_too_small_for_a_subset_is_found_by_the_refinement() {
    let epoch = sky::<f64>(20, 1, &[(2, 30.0)]);
    let limits = ConsensusLimits::published().unwrap();
    let selection: Selection = Selection::choose(epoch.rows(), MAX_WORK);
    let snapshot = solved(epoch).unwrap();
    let found = consensus(snapshot.equations(), &selection, &limits).unwrap();
    let have = refine(snapshot.equations(), &selection, &found, &limits);
    assert_eq!((have.rows.to_vec(), have.passed), (vec![2], true));
}

#[test]
fn too_few_satellites_fall_back_to_sequential_exclusion() {
    let epoch = sky::<f64>(9, 2, &[(4, 200.0)]);
    let limits = ConsensusLimits::published().unwrap();
    let selection: Selection = Selection::choose(epoch.rows(), MAX_WORK);
    assert_eq!(selection.subsets(), 1);
    assert_eq!(consensus(epoch.rows(), &selection, &limits), Err(NoConsensus::TooFewSubsets));
    let mut solution = solved(epoch).unwrap();
    let have = exclude(&mut solution, &selection, &thresholds(), &limits);
    assert_eq!((have.rows[0].index, have.outcome), (4, ExclusionOutcome::Isolated));
}

#[test]
fn a_selection_for_other_rows_counts_as_none() {
    let selection: Selection = Selection::choose(sky::<f64>(20, 2, &[]).rows(), MAX_WORK);
    let have = consensus(sky::<f64>(19, 2, &[]).rows(), &selection, &ConsensusLimits::published().unwrap());
    assert_eq!(have, Err(NoConsensus::TooFewSubsets));
}

#[test]
fn work_that_is_used_up_is_said_and_leaves_as_many_subsets() {
    let epoch = sky::<f64>(20, 1, &[]);
    let enough: Selection = Selection::choose(epoch.rows(), MAX_WORK);
    let have: Selection = Selection::choose(epoch.rows(), enough.work() / 2);
    assert!(have.cut() && !enough.cut());
    assert_eq!(have.subsets(), enough.subsets());
    assert!(have.work() <= enough.work() / 2);
    assert!(<Selection>::choose(epoch.rows(), 0).cut());
    assert!(!<Selection>::choose(epoch.rows(), enough.work()).cut());
}

#[test]
fn aiding_rows_are_in_no_subset() {
    let mut epoch = sky::<f64>(12, 1, &[]);
    epoch.clock(Constellation::Gps, 0.5, 3.0).unwrap();
    epoch.height(0.2, 3.0).unwrap();
    let selection: Selection = Selection::choose(epoch.rows(), MAX_WORK);
    assert_eq!((selection.subsets(), selection.rows()), (3, 14));
    for subset in 0..3 {
        assert_eq!(members(&selection, subset).len(), 4);
        assert!(!selection.contains(subset, 12) && !selection.contains(subset, 13));
    }
}
