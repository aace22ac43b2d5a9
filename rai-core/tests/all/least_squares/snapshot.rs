//! The 3×3 solve compared with least squares with all columns: equal in every quantity that the
//! core derives from it.

use nalgebra::Vector3;
use proptest::prelude::*;
use raim_core::internals::least_squares::equations::{LinearEpoch, MAX_ROWS};
use raim_core::internals::least_squares::{Snapshot, SnapshotError};
use raim_core::internals::numeric::real::Real;
use raim_core::satellite::Constellation;

use crate::solved::{copied, solved};

use super::oracle::{self, Range};

type Snapshot40<T> = Snapshot<'static, T>;

fn snapshot<T: Real>(ranges: &[Range]) -> Result<Snapshot40<T>, SnapshotError> {
    let mut epoch = LinearEpoch::new();
    for range in ranges {
        let line_of_sight = Vector3::from(range.line_of_sight);
        epoch.satellite(range.constellation, line_of_sight, range.residual_m, range.sigma_m).unwrap();
    }
    solved(epoch)
}

/// Returns a direction above the horizon, a constellation, a residual with a large clock, and a
/// sigma.
fn any_range() -> impl Strategy<Value = Range> {
    (0.0..std::f64::consts::TAU, 0.05f64..1.0, 0usize..4, -50.0f64..50.0, 0.5f64..20.0).prop_map(
        |(azimuth, up, constellation, residual_m, sigma_m)| {
            let horizontal = (1.0 - up * up).sqrt();
            let constellation = Constellation::ALL[constellation];
            let clock_m = 1e5 * f64::from(constellation as u8);
            Range {
                line_of_sight: [horizontal * azimuth.sin(), horizontal * azimuth.cos(), up],
                constellation,
                residual_m: residual_m + clock_m,
                sigma_m,
            }
        },
    )
}

fn assert_close(what: &str, have: f64, want: f64, relative: f64, absolute: f64) {
    let allowed = absolute.max(relative * want.abs());
    assert!((have - want).abs() <= allowed, "{what}: have {have}, want {want}");
}

/// Tolerances of the specification for `f64`; geometries are kept where the dense inverse itself is
/// that good.
fn well_conditioned(dense: &oracle::Dense) -> bool {
    dense.hdop < 20.0 && (0..3).all(|axis| dense.covariance_m2[(axis, axis)] < 1e3)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn equals_least_squares_with_all_columns(ranges in prop::collection::vec(any_range(), 4..40)) {
        let dense = oracle::solve(&ranges);
        prop_assume!(dense.as_ref().is_some_and(well_conditioned));
        let want = dense.unwrap();
        let have = snapshot::<f64>(&ranges).unwrap();
        prop_assert_eq!(have.dof(), want.dof);
        assert_close("sse", have.sse(), want.sse, 1e-9, 1e-7);
        for axis in 0..3 {
            assert_close("x", have.correction()[axis], want.unknowns_m[axis], 1e-9, 1e-6);
        }
        assert_close("hdop", have.dilutions().0, want.hdop, 1e-9, 0.0);
        assert_close("vdop", have.dilutions().1, want.vdop, 1e-9, 0.0);
        for row in 0..3 {
            for column in 0..3 {
                let have = have.covariance()[(row, column)];
                assert_close("P", have, want.covariance_m2[(row, column)], 1e-8, 1e-8);
            }
        }
        let is_there = |clock: &Constellation| ranges.iter().any(|range| range.constellation == *clock);
        let clocks: Vec<Constellation> = Constellation::ALL.into_iter().filter(is_there).collect();
        prop_assert_eq!(have.used(), ranges.len());
        for clock in Constellation::ALL {
            prop_assert_eq!(have.determines(clock), clocks.contains(&clock));
            prop_assert_eq!(have.clock_m(clock).is_some(), clocks.contains(&clock));
        }
        for (column, clock) in (3..).zip(clocks) {
            assert_close("b", have.clock_m(clock).unwrap(), want.unknowns_m[column], 1e-9, 1e-6);
            let have = have.clock_variance(clock).unwrap();
            assert_close("Q", have, want.covariance_m2[(column, column)], 1e-8, 0.0);
        }
        for (index, (row, fit)) in have.rows().enumerate() {
            assert_close("v", fit.residual, want.residuals_m[index], 1e-9, 1e-6);
            assert_close("S_ii", fit.redundancy, want.projection[(index, index)], 1e-9, 1e-9);
            for axis in 0..3 {
                assert_close("A", row.weight * fit.gain[axis], want.gain[(axis, index)], 1e-8, 1e-9);
            }
            for other in 0..ranges.len() {
                let have = have.projection(index, other).unwrap();
                assert_close("S_ij", have, want.projection[(index, other)], 1e-8, 1e-9);
            }
        }
    }

    #[test]
    fn leaving_a_row_out_equals_never_having_had_it(
        ranges in prop::collection::vec(any_range(), 9..30),
        index in 0usize..9,
    ) {
        let dense = oracle::solve_without(&ranges, &[index]);
        prop_assume!(dense.as_ref().is_some_and(well_conditioned));
        prop_assume!(oracle::solve(&ranges).is_some());
        let want = dense.unwrap();
        let mut have = snapshot::<f64>(&ranges).unwrap();
        let full = copied(&have);
        have.leave_out(index).unwrap();
        prop_assert_eq!(have.dof(), want.dof);
        assert_close("sse", have.sse(), want.sse, 1e-9, 1e-7);
        assert_close("x", have.correction().x, want.unknowns_m[0], 1e-9, 1e-6);
        // HDOP_i, by the identity, is the HDOP of the geometry without the row.
        assert_close("hdop_i", full.hdop_without(index).unwrap(), want.hdop, 1e-7, 1e-9);
        have.take_back(index).unwrap();
        prop_assert_eq!(have, full);
    }

    #[test]
    fn single_precision_is_within_a_thousandth(ranges in prop::collection::vec(any_range(), 6..40)) {
        let dense = oracle::solve(&ranges);
        prop_assume!(dense.as_ref().is_some_and(well_conditioned));
        let want = dense.unwrap();
        // 10 m: beyond, the last digits of a single become metres.
        prop_assume!((0..3).all(|axis| want.covariance_m2[(axis, axis)] < 100.0));
        let have = snapshot::<f32>(&ranges).unwrap();
        assert_close("sse", f64::from(have.sse()), want.sse, 1e-3, 1e-2);
        for axis in 0..3 {
            assert_close("x", f64::from(have.correction()[axis]), want.unknowns_m[axis], 1e-3, 0.05);
        }
    }
}

#[test]
fn a_cone_of_satellites_is_singular() {
    let ranges: Vec<Range> = (0..8)
        .map(|index| {
            let azimuth = f64::from(index) * 0.7;
            Range {
                line_of_sight: [0.8 * azimuth.sin(), 0.8 * azimuth.cos(), 0.6],
                constellation: Constellation::Gps,
                residual_m: 1.0,
                sigma_m: 1.0,
            }
        })
        .collect();
    assert_eq!(snapshot::<f64>(&ranges).unwrap_err(), SnapshotError::Singular);
    assert_eq!(snapshot::<f32>(&ranges).unwrap_err(), SnapshotError::Singular);
}

#[test]
fn a_known_height_replaces_a_satellite() {
    // Three satellites at the horizon's corners and the zenith-less geometry: with a height, four
    // unknowns have four rows.
    let mut epoch = LinearEpoch::<f64, MAX_ROWS>::new();
    for azimuth in [0.0_f64, 2.1, 4.2] {
        let (sin, cos) = azimuth.sin_cos();
        let line_of_sight = Vector3::new(0.8 * sin, 0.8 * cos, 0.6);
        epoch.satellite(Constellation::Gps, line_of_sight, 7.0, 1.0).unwrap();
    }
    assert_eq!(solved(epoch.clone()).unwrap_err(), SnapshotError::Insufficient);
    epoch.height(5.0, 1.0).unwrap();
    let have = solved(epoch).unwrap();
    assert_eq!(have.dof(), 0);
    // Equal ranges at equal elevations: no horizontal shift; up is the height; the clock takes the
    // rest.
    assert_close("up", have.correction().z, 5.0, 0.0, 1e-9);
    assert_close("east", have.correction().x, 0.0, 0.0, 1e-9);
    assert_close("clock", have.clock_m(Constellation::Gps).unwrap(), 7.0 + 0.6 * 5.0, 0.0, 1e-9);
}
