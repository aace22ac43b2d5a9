//! Sets of rows left out by algebra, compared with solving again without them, and with parity
//! space written out.

use nalgebra::{DMatrix, DVector, Vector3};
use proptest::prelude::*;
use raim_core::internals::integrity::raim::isolation::parity::correlation;
use raim_core::internals::least_squares::downdate::{ExclusionSet, NormalisedRows, testable_rows};
use raim_core::internals::least_squares::equations::{LinearEpoch, MAX_ROWS};
use raim_core::internals::least_squares::{Snapshot, Workspace};
use raim_core::internals::numeric::real::Real;
use raim_core::satellite::Constellation;

use crate::solved::solved;

use super::oracle::{self, Dense, Range};

fn testable<T: Real>(snapshot: &Snapshot<'_, T>) -> NormalisedRows<T> {
    let mut rows = NormalisedRows::new();
    testable_rows(snapshot, &mut rows);
    rows
}

fn snapshot<T: Real>(ranges: &[Range]) -> Snapshot<'static, T> {
    let mut epoch = LinearEpoch::new();
    for range in ranges {
        let line_of_sight = Vector3::from(range.line_of_sight);
        epoch.satellite(range.constellation, line_of_sight, range.residual_m, range.sigma_m).unwrap();
    }
    solved(epoch).unwrap()
}

fn any_range(constellations: usize) -> impl Strategy<Value = Range> {
    (0.0..std::f64::consts::TAU, 0.05f64..1.0, 0..constellations, -50.0f64..50.0, 0.5f64..20.0).prop_map(
        |(azimuth, up, constellation, residual_m, sigma_m)| {
            let horizontal = (1.0 - up * up).sqrt();
            let constellation = Constellation::ALL[constellation];
            let line_of_sight = [horizontal * azimuth.sin(), horizontal * azimuth.cos(), up];
            Range { line_of_sight, constellation, residual_m, sigma_m }
        },
    )
}

/// Returns between 8 and 40 ranges of up to three constellations, and a set of one to three of the
/// first eight.
fn ranges_and_set() -> impl Strategy<Value = (Vec<Range>, Vec<usize>)> {
    (prop::collection::vec(any_range(3), 8..40), prop::sample::subsequence((0..8).collect::<Vec<_>>(), 1..=3))
}

fn well_conditioned(dense: &Dense) -> bool {
    dense.hdop < 20.0 && (0..3).all(|axis| dense.covariance_m2[(axis, axis)] < 1e3)
}

/// Returns true if the position is known to 10 m. Beyond this limit, the last digits of single
/// precision become metres.
fn is_known_to_10_m(dense: &Dense) -> bool {
    (0..3).all(|axis| dense.covariance_m2[(axis, axis)] < 100.0)
}

/// Returns true if a constellation loses its last range.
fn empties_a_constellation(ranges: &[Range], set: &[usize]) -> bool {
    set.iter().any(|&gone| {
        let same = |index: &usize| ranges[*index].constellation == ranges[gone].constellation;
        (0..ranges.len()).filter(same).all(|index| set.contains(&index))
    })
}

fn assert_close(what: &str, have: f64, want: f64, relative: f64, absolute: f64) {
    let allowed = absolute.max(relative * want.abs());
    assert!((have - want).abs() <= allowed, "{what}: have {have}, want {want}");
}

/// Returns the parity matrix: an orthonormal basis of the null space of the transposed design, from
/// a full singular value decomposition of the design bordered by zeros.
fn parity_matrix(ranges: &[Range], dense: &Dense) -> DMatrix<f64> {
    let count = ranges.len();
    let clocks: Vec<Constellation> = Constellation::ALL
        .into_iter()
        .filter(|clock| ranges.iter().any(|range| range.constellation == *clock))
        .collect();
    let square = DMatrix::from_fn(count, count, |row, column| {
        let range = &ranges[row];
        let element = match column {
            0..3 => -range.line_of_sight[column],
            _ => f64::from(u8::from(clocks.get(column - 3) == Some(&range.constellation))),
        };
        element / range.sigma_m
    });
    let left = square.svd(true, false).u.unwrap();
    left.columns(count - dense.dof, dense.dof).transpose()
}

/// Returns the w-test of a range by a solution without the set: of its own residual, or of its
/// difference to the prediction. `None` if nothing else tests it.
fn dense_w_test(ranges: &[Range], set: &[usize], dense: &Dense, index: usize) -> Option<f64> {
    let range = ranges[index];
    if !set.contains(&index) {
        let place = (0..index).filter(|before| !set.contains(before)).count();
        let redundancy = dense.projection[(place, place)];
        return (redundancy > 1e-9).then(|| dense.residuals_m[place] / (range.sigma_m * redundancy.sqrt()));
    }
    let kept = (0..ranges.len()).filter(|index| !set.contains(index));
    let mut clocks: Vec<_> = kept.map(|index| ranges[index].constellation).collect();
    clocks.sort_unstable();
    clocks.dedup();
    let clock = clocks.iter().position(|clock| *clock == range.constellation)?;
    let design = DVector::from_fn(3 + clocks.len(), |column, _| match column {
        0..3 => -range.line_of_sight[column],
        _ => f64::from(u8::from(column - 3 == clock)),
    });
    let residual_m = range.residual_m - design.dot(&dense.unknowns_m);
    let variance_m2 = range.sigma_m.powi(2) + (&dense.covariance_m2 * &design).dot(&design);
    Some(residual_m / variance_m2.sqrt())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn a_w_test_is_that_of_the_dense_solution_in_use_or_left_out((ranges, set) in ranges_and_set()) {
        let Some(dense) = oracle::solve_without(&ranges, &set).filter(well_conditioned) else {
            return Ok(());
        };
        let mut epoch = LinearEpoch::<f64, MAX_ROWS>::new();
        for range in &ranges {
            let line_of_sight = Vector3::from(range.line_of_sight);
            epoch.satellite(range.constellation, line_of_sight, range.residual_m, range.sigma_m).unwrap();
        }
        for index in &set {
            epoch.leave_out(*index);
        }
        let mut workspace = Workspace::of(epoch);
        prop_assert!(workspace.solve().is_ok());
        for index in 0..ranges.len() {
            match (workspace.w_test(index), dense_w_test(&ranges, &set, &dense, index)) {
                (Some(have), Some(want)) => assert_close("w", have, want, 1e-6, 1e-6),
                (have, want) => prop_assert_eq!(have, want),
            }
        }
    }

    #[test]
    fn leaving_a_set_out_equals_solving_without_it((ranges, set) in ranges_and_set()) {
        prop_assume!(!empties_a_constellation(&ranges, &set));
        let full = oracle::solve(&ranges);
        prop_assume!(full.as_ref().is_some_and(well_conditioned));
        let dense = oracle::solve_without(&ranges, &set);
        prop_assume!(dense.as_ref().is_some_and(well_conditioned));
        let want = dense.unwrap();
        let snapshot = snapshot::<f64>(&ranges);
        let have = ExclusionSet::of(&snapshot, &set).unwrap();
        prop_assert_eq!(have.dof(&snapshot), want.dof);
        assert_close("sse", have.sse(&testable(&snapshot)), want.sse, 1e-8, 1e-7);
        assert_close("sse by difference", snapshot.sse() - have.explained(), want.sse, 1e-8, 1e-6);
        for row in 0..3 {
            assert_close("x", have.correction(&snapshot)[row], want.unknowns_m[row], 1e-8, 1e-6);
            for column in 0..3 {
                let have = have.covariance(&snapshot)[(row, column)];
                assert_close("P", have, want.covariance_m2[(row, column)], 1e-7, 1e-6);
            }
        }
    }

    #[test]
    fn single_precision_is_within_a_thousandth((ranges, set) in ranges_and_set()) {
        prop_assume!(!empties_a_constellation(&ranges, &set));
        let full = oracle::solve(&ranges);
        prop_assume!(full.as_ref().is_some_and(is_known_to_10_m));
        let dense = oracle::solve_without(&ranges, &set);
        prop_assume!(dense.as_ref().is_some_and(is_known_to_10_m));
        let want = dense.unwrap();
        let snapshot = snapshot::<f32>(&ranges);
        let have = ExclusionSet::of(&snapshot, &set).unwrap();
        assert_close("sse", have.sse(&testable(&snapshot)).into(), want.sse, 1e-3, 1e-2);
        for axis in 0..3 {
            assert_close("x", have.correction(&snapshot)[axis].into(), want.unknowns_m[axis], 1e-3, 0.05);
        }
    }

    #[test]
    fn a_set_that_empties_a_constellation_is_refused(
        mut ranges in prop::collection::vec(any_range(1), 8..20),
        lone in prop::collection::vec(any_range(1), 1..=3),
    ) {
        let lone = lone.into_iter().map(|range| Range { constellation: Constellation::Galileo, ..range });
        let set: Vec<usize> = (ranges.len()..ranges.len() + lone.len()).collect();
        ranges.extend(lone);
        prop_assume!(oracle::solve(&ranges).as_ref().is_some_and(well_conditioned));
        prop_assert_eq!(ExclusionSet::of(&snapshot::<f64>(&ranges), &set), None);
        prop_assert_eq!(ExclusionSet::of(&snapshot::<f32>(&ranges), &set), None);
    }

    #[test]
    fn rows_are_the_parity_vectors(ranges in prop::collection::vec(any_range(3), 8..24)) {
        let dense = oracle::solve(&ranges);
        prop_assume!(dense.as_ref().is_some_and(|dense| well_conditioned(dense) && dense.dof > 0));
        let dense = dense.unwrap();
        let parity = parity_matrix(&ranges, &dense);
        let scaled = DVector::from_fn(ranges.len(), |row, _| ranges[row].residual_m / ranges[row].sigma_m);
        let vector = &parity * scaled;
        let snapshot = snapshot::<f64>(&ranges);
        assert_close("p.p", snapshot.sse(), vector.norm_squared(), 1e-9, 1e-7);
        for row in testable(&snapshot) {
            let line = parity.column(row.index);
            assert_close("p.p_i", row.residual, vector.dot(&line), 1e-8, 1e-7);
            for other in testable(&snapshot) {
                let want = line.dot(&parity.column(other.index));
                assert_close("p_i.p_j", row.projection(&other), want, 1e-8, 1e-8);
            }
            let (_, fit) = snapshot.row(row.index).unwrap();
            let have = correlation(&snapshot, fit);
            let want = vector.dot(&line) / (vector.norm() * line.norm());
            prop_assert!(have.abs() <= 1.0 + 1e-12);
            // A row that hardly shows leaves hardly a direction.
            if fit.redundancy > 1e-4 {
                assert_close("rho", have, want, 1e-6, 1e-7);
            }
        }
    }
}
