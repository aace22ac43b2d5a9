//! Errors that all ranges share: how far do they move the position?
//!
//! The residual error of an ionosphere model is nearly the same in all ranges. Clocks and position
//! absorb most of it, and no test sees that part. It consists of an offset and two slopes, each
//! with one value for the whole epoch ([`crate::weighting::ionosphere`]):
//!
//! ```text
//! d_0 = Σ_i w_i g_i m_i        d_E = Σ_i w_i g_i k_i e_i        d_N = Σ_i w_i g_i k_i n_i
//! D = Σ_k d_k d_kᵀ             HPL += 3 √(larger eigenvalue of D_EN)             VPL += 3 √D_UU
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `w_i g_i` | weight times gain of the row: displacement of the position per metre of its range | – |
//! | `m_i`, `k_i` | [`SharedError::common_m`], [`SharedError::slope_m`] | m at one sigma |
//! | `e_i`, `n_i` | line of sight, `−h_i` | – |
//! | 3 | [`COMMON_SIGMAS`] | – |
//!
//! The three values are assumed to lie in an ellipsoid of three sigmas. The largest displacement of
//! the position in the direction of a unit vector `a` is then `3 √(aᵀ D a)`. It is added to the
//! level as a bias, because it averages out neither over satellites nor over time.

use nalgebra::Vector3;

use crate::integrity::raim::levels::PositionSigma;
use crate::least_squares::Snapshot;
use crate::numeric::real::Real;
use crate::numeric::space::{add_outer_product, plus_scaled, zero, zeros};
use crate::report::ProtectionLevels;
use crate::weighting::COMMON_SIGMAS;
use crate::weighting::shared::SharedError;

/// Returns the largest effect of the shared range errors on the position, horizontally and
/// vertically, m.
///
/// `shared` are the errors of the first rows; later rows share no error. `growth` is a factor on the
/// number of sigmas.
#[inline(never)]
pub fn shared_shift<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    shared: &[SharedError],
    growth: f32,
) -> ProtectionLevels {
    let narrow = |error_m: f32| T::narrow(f64::from(error_m));
    let [mut offset, mut east, mut north] = [zero(); 3];
    for ((row, fit), shared) in snapshot.rows().zip(shared) {
        if shared.common_m > 0.0 {
            offset = plus_scaled(&offset, row.weight * narrow(shared.common_m), &fit.gain);
        }
        if shared.slope_m > 0.0 {
            let slope = row.weight * narrow(shared.slope_m);
            east = plus_scaled(&east, slope * row.design.x, &fit.gain);
            north = plus_scaled(&north, slope * row.design.y, &fit.gain);
        }
    }
    largest_shift(&[offset, east, north], COMMON_SIGMAS * growth)
}

/// Returns the largest sum of these displacements within the ellipsoid of so many sigmas.
fn largest_shift<T: Real>(moves: &[Vector3<T>], sigmas: f32) -> ProtectionLevels {
    let mut squares = zeros();
    for moved in moves {
        add_outer_product(&mut squares, moved, moved);
    }
    let PositionSigma { horizontal, vertical } = PositionSigma::of(&squares);
    let sigmas = f64::from(sigmas);
    ProtectionLevels { hpl_m: sigmas * horizontal.widen(), vpl_m: sigmas * vertical.widen() }
}
