//! Heights and places from other sources than the satellites: heights that the host sends, and the
//! place of a fixed antenna.
//!
//! ```text
//! σ_h² = max(σ, σ₀)² + ((c + |v_U|) Δt)²           Δt ≤ Δt₀, otherwise the height has expired
//! contradiction of a place:  d > HPL + k max(σ, σ₀)
//! ```
//!
//! | symbol | item | unit |
//! |---|---|---|
//! | `σ` | stated with the height or the place | m |
//! | `σ₀` | [`LEAST_SIGMA_M`] | m |
//! | `c` | [`CLIMB_M_S`] | m/s |
//! | `v_U` | vertical velocity of the last epoch, if it had one | m/s |
//! | `Δt`, `Δt₀` | age of the height, [`HOLDS_MS`] | s |
//! | `d` | horizontal distance of the position from the place | m |
//! | `k` | [`SIGMAS`] | – |
//!
//! A height gives one more row of the equations ([`raim_core::internals::integrity`]), which can itself be the
//! faulty one. Its sigma has a lower bound, so that no height outweighs the satellites: a code
//! range at the zenith determines the height to about [`LEAST_SIGMA_M`].
//!
//! The place of a fixed antenna gives the same row if the host sends no height. Its horizontal
//! coordinates only take promises back. If a position is farther from the place than its level plus
//! the uncertainty of the place, one of the two must be wrong.

use core::f64::consts::PI;

use raim_core::epoch::Aiding;
use raim_core::frame::{Ecef, Geodetic, LocalAxes};
use raim_core::internals::numeric::sqrt;
use raim_core::report::Report;

use crate::settings::Place;

/// Least standard deviation of a height or a place, m.
const LEAST_SIGMA_M: f64 = 3.0;

/// Standard deviation of the climb of an antenna whose vertical velocity is unknown, m/s.
const CLIMB_M_S: f32 = 3.0;

/// Largest age of a height, ms.
const HOLDS_MS: u64 = 10_000;

/// Number of standard deviations of a place that contradict a position: the two-sided quantile of
/// 1e-7.
const SIGMAS: f64 = 5.33;

/// Largest radius of curvature of the ellipsoid, at the poles, with a margin for rounding, m.
const LARGEST_RADIUS_M: f32 = 6.4005e6;

/// Factor from degrees to radians.
const RAD: f64 = PI / 180.0;

/// A height that the host has sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HostHeight {
    /// Height above the ellipsoid, m.
    pub(crate) height_m: f64,
    /// Standard deviation as sent, m.
    pub(crate) sigma_m: f64,
    /// Arrival of the height, ms.
    pub(crate) came_ms: u64,
}

impl HostHeight {
    /// Returns the row of an epoch that came at `now_ms`, or `None` if the height has expired.
    pub(crate) fn aiding(&self, now_ms: u64, climb_m_s: f32) -> Option<Aiding> {
        let age_ms = now_ms.abs_diff(self.came_ms);
        // Through 32 bits, whose conversion is an instruction.
        let age_s = age_ms.min(HOLDS_MS) as u32 as f32 * 1e-3;
        let grown_m = (CLIMB_M_S + climb_m_s.abs()) * age_s;
        let sigma_m = self.sigma_m.max(LEAST_SIGMA_M) as f32;
        let sigma_m = f64::from(sqrt(sigma_m * sigma_m + grown_m * grown_m));
        (age_ms <= HOLDS_MS).then_some(Aiding::Height { value_m: self.height_m, sigma_m })
    }
}

/// Returns the row for the height of a fixed antenna.
pub(crate) fn aiding_of(place: &Place) -> Aiding {
    Aiding::Height { value_m: place.height_m, sigma_m: place.sigma_m.max(LEAST_SIGMA_M) }
}

/// Returns true if the position of a report contradicts the place of the antenna.
#[inline(never)]
pub(crate) fn is_elsewhere<const N: usize>(place: &Place, report: &Report<N>) -> bool {
    let (Some(solution), Some(levels)) = (&report.solution, &report.protection) else { return false };
    let distance_m = f64::from(distance_m(place, solution.position, &solution.geodetic));
    // A NaN distance counts as a contradiction.
    !(distance_m <= levels.hpl_m + SIGMAS * place.sigma_m.max(LEAST_SIGMA_M))
}

/// Returns the horizontal distance of a position from a place, m. It is never too small, and at
/// most 3 % too large within ten kilometres and 80° of latitude.
///
/// The differences of latitude and longitude are turned into metres by the largest radius of
/// curvature and by the larger circle of latitude. Sines and cosines of a place in double precision
/// would take 6 KB.
fn distance_m(place: &Place, position: Ecef, here: &Geodetic) -> f32 {
    let north_rad = (here.latitude_rad - place.latitude_deg * RAD) as f32;
    let east_rad = here.longitude_rad - place.longitude_deg * RAD;
    let east_rad = if east_rad > PI { east_rad - 2.0 * PI } else { east_rad };
    let east_rad = if east_rad < -PI { east_rad + 2.0 * PI } else { east_rad };
    let sine = LocalAxes::at(position).sin_latitude();
    // The cosine of the place's latitude differs by no more than the latitudes.
    let cosine = sqrt((1.0 - sine * sine).max(0.0)) + north_rad.abs();
    let east_rad = east_rad as f32 * cosine.min(1.0);
    let radius_m = LARGEST_RADIUS_M + here.height_m.max(0.0) as f32;
    radius_m * sqrt(north_rad * north_rad + east_rad * east_rad)
}

#[cfg(test)]
mod tests {
    use raim_core::frame::{Enu, LocalFrame};

    use super::*;

    fn distance_from_m(place: &Place, position: Ecef) -> f64 {
        f64::from(distance_m(place, position, &LocalFrame::at(position).geodetic()))
    }

    /// The reference rotates the difference of the two earth-fixed positions.
    #[test]
    fn distance_from_a_place_is_that_of_the_tangent_plane_and_never_too_small() {
        for latitude_deg in [-89.0, -60.0, -5.0, 0.0, 33.0, 70.0, 89.9] {
            for longitude_deg in [-180.0, -179.999, 0.0, 45.0, 179.999, 180.0] {
                let place = Place { latitude_deg, longitude_deg, height_m: 120.0, sigma_m: 3.0 };
                let [latitude_rad, longitude_rad] = [latitude_deg, longitude_deg].map(|deg| deg * RAD);
                let origin = Geodetic { latitude_rad, longitude_rad, height_m: 120.0 }.to_ecef();
                let frame = LocalFrame::at(origin);
                for (east, north) in [(0.0, 5.0), (30.0, 0.0), (-40.0, 30.0), (500.0, -900.0), (-9e3, 2e3)] {
                    let offset = frame.unrotate(Enu { east, north, up: 0.0 });
                    let have = distance_from_m(&place, origin + offset);
                    let want = east.hypot(north);
                    // Doubles of an angle carry 1e-9 m; the metres of a single, the rest.
                    assert!(have > want - 1e-3, "{place:?}: {have} for {want}");
                    assert!(have < 1.03 * want || latitude_deg.abs() > 80.0, "{place:?}: {have} for {want}");
                }
            }
        }
    }

    #[test]
    fn distant_position_is_elsewhere() {
        let place = Place { latitude_deg: 89.9, longitude_deg: 10.0, height_m: 0.0, sigma_m: 3.0 };
        for (latitude_deg, longitude_deg) in [(89.9_f64, -170.0_f64), (-89.9, 10.0), (0.0, 0.0), (50.0, 10.0)]
        {
            let [latitude_rad, longitude_rad] = [latitude_deg, longitude_deg].map(f64::to_radians);
            let position = Geodetic { latitude_rad, longitude_rad, height_m: 0.0 }.to_ecef();
            assert!(distance_from_m(&place, position) > 5e3);
        }
    }

    fn sigma_m(height: HostHeight, now_ms: u64, climb_m_s: f32) -> Option<f64> {
        height.aiding(now_ms, climb_m_s).map(|aiding| match aiding {
            Aiding::Height { sigma_m, .. } => sigma_m,
            other => panic!("{other:?} is no height"),
        })
    }

    /// Right triangles with whole sides: 3, 4, 5 and 3, 6, √45 and 8, 15, 17.
    #[test]
    fn sigma_of_a_height_is_bounded_from_below_and_grows_with_its_age() {
        let height = |sigma_m| HostHeight { height_m: 100.0, sigma_m, came_ms: 50_000 };
        assert_eq!(sigma_m(height(0.1), 50_000, 0.0), Some(3.0));
        assert_eq!(sigma_m(height(8.0), 50_000, 0.0), Some(8.0));
        assert_eq!(sigma_m(height(0.1), 51_000, -1.0), Some(5.0));
        assert_eq!(sigma_m(height(8.0), 55_000, 0.0), Some(17.0));
        assert_eq!(sigma_m(height(8.0), 45_000, 0.0), Some(17.0), "a clock that went back");
        assert_eq!(sigma_m(height(8.0), 60_001, 0.0), None);
    }
}
