//! Effects of leaving out a satellite on the geometry, and effects that need not occur.
//!
//! Without row `k` the position is known less well by exactly its squared slope,
//! `P_h(−k) = P_h + slope_h,k²`, and every other row is tested less well,
//! `r_i(−k) = r_i − S_ik²/r_k`. Protection levels are not monotone: see
//! [`a_protection_level_can_shrink_with_the_satellite_that_is_hardest_to_test`].

use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;
use raim_core::internals::integrity::raim::levels::{largest_slopes, slopes};
use raim_core::internals::least_squares::Snapshot;
use raim_core::internals::least_squares::equations::{LinearEpoch, MAX_ROWS};
use raim_core::internals::numeric::real::Real;
use raim_core::satellite::Constellation;

use crate::solved::{copied, solved};

use super::skies::{Sky, any_sky};

/// Variances east + north and up, m².
fn variances<T: Real>(covariance: &Matrix3<T>) -> [f64; 2] {
    [(covariance.m11 + covariance.m22).widen(), covariance.m33.widen()]
}

fn redundancies<T: Real>(snapshot: &Snapshot<'_, T>) -> Vec<f64> {
    snapshot.rows().map(|(_, fit)| fit.redundancy.widen()).collect()
}

/// Returns true if rounding is multiplied by more than a hundred.
fn is_hardly_solved<T: Real>(snapshot: &Snapshot<'_, T>) -> bool {
    let (hdop, vdop) = snapshot.dilutions();
    hdop.widen().max(vdop.widen()) > 10.0
}

/// Leaves each row out in turn; `rounding` is relative.
fn every_row_helps<T: Real>(sky: &Sky, rounding: f64) -> Result<(), TestCaseError> {
    let Ok(all) = solved::<T>(sky.linearised(1.0)) else { return Ok(()) };
    for index in 0..sky.observations.len() {
        let (row, fit) = all.row(index).unwrap();
        // Too little of 1 is left to compare with.
        if fit.redundancy.widen() < 0.1 {
            continue;
        }
        let slope = slopes(row, fit);
        let growth = [slope.horizontal, slope.vertical].map(|slope| slope.widen() * slope.widen());
        let mut rest = copied(&all);
        if rest.leave_out(index).is_err() || is_hardly_solved(&rest) {
            continue;
        }
        let (before, after) = (variances(all.covariance()), variances(rest.covariance()));
        for ((have, before), growth) in after.into_iter().zip(before).zip(growth) {
            let want = before + growth;
            prop_assert!((have / want - 1.0).abs() < rounding, "row {index}: have {have}, want {want}");
        }
        for (other, (after, before)) in redundancies(&rest).into_iter().zip(redundancies(&all)).enumerate() {
            let grew = after > before + rounding;
            prop_assert!(other == index || !grew, "row {other} without {index}: {before} to {after}");
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn variance_grows_by_the_squared_slope_of_the_row_left_out(sky in any_sky(0)) {
        every_row_helps::<f64>(&sky, 1e-6)?;
        every_row_helps::<f32>(&sky, 1e-2)?;
    }
}

/// One satellite alone stands in the east, so that hardly anything tests it: its slope is the
/// largest. The six that are high, and the four low in north and south, know the place worse
/// without it and watch each other well enough.
#[test]
fn a_protection_level_can_shrink_with_the_satellite_that_is_hardest_to_test() {
    let at = |azimuth_deg: f64, elevation_deg: f64| {
        let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
        Vector3::new(azimuth.sin() * elevation.cos(), azimuth.cos() * elevation.cos(), elevation.sin())
    };
    let high = [0.0, 60.0, 120.0, 180.0, 240.0, 300.0].map(|azimuth_deg| at(azimuth_deg, 75.0));
    let low = [0.0, 5.0, 175.0, 180.0].map(|azimuth_deg| at(azimuth_deg, 10.0));
    let mut epoch = LinearEpoch::<f64, MAX_ROWS>::new();
    for direction in [at(90.0, 10.0)].into_iter().chain(high).chain(low) {
        epoch.satellite(Constellation::Gps, direction, 0.0, 3.0).unwrap();
    }
    let mut snapshot = solved(epoch).unwrap();
    let (with, known_with) = (largest_slopes(&snapshot), variances(snapshot.covariance()));
    snapshot.leave_out(0).unwrap();
    let (without, known_without) = (largest_slopes(&snapshot), variances(snapshot.covariance()));
    assert!(known_without[0] > 2.0 * known_with[0], "{known_with:?} to {known_without:?}");
    assert!(without.horizontal < 0.8 * with.horizontal, "{with:?} to {without:?}");
}
