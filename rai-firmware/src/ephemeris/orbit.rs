//! The broadcast Kepler orbit.
//!
//! ```text
//! n = √(µ/a³) + Δn          M = M0 + n t           E − e sin E = M
//! p = R_z(−ω) (a (cos E − e), a √(1 − e²) sin E)   φ, r: angle and length of p        i = i0 + δi(2φ) + i̇ t
//! q = p (1 + δr(2φ)/r) turned by δu(2φ)            Ω = Ω0 + (Ω̇ − ω_e) t − ω_e toe     X = R_z(−Ω) R_x(−i) q
//! geostationary BeiDou:  Ω = Ω0 + Ω̇ t − ω_e toe    X = R_z(ω_e t) R_x(−5°) R_z(−Ω) R_x(−i) q
//! Δt_r = −2 √µ/c² · e √a sin E
//! ```
//!
//! | symbol | here | unit |
//! |---|---|---|
//! | `t` | `since_toe_s` | s of system time |
//! | `µ`, `ω_e` | [`Gravity`] | m³/s², rad/s |
//! | `E`, `ω`, `i`, `Ω` | [`Direction`]: sine and cosine | 1 |
//! | `p`, `q` | [`InPlane`]: from the ascending node and across, as corrected | m |
//! | `Δt_r` | `relativity_s` | s |
//!
//! On a core without double precision a sine costs as much as thirty multiplications, so angles are carried as sine
//! and cosine and turned by products, and what is only a correction is worked out in single precision; four `sincos`
//! serve a satellite, five a geostationary one.
//!
//! References: [IS-GPS-200] table 20-IV; [OS-SIS-ICD] table 64; [BDS-SIS-B1I] table 5-11.

use core::f64::consts::PI;

use rai_core::frame::{Ecef, SPEED_OF_LIGHT_M_S};
use rai_core::satellite::{Constellation, SatelliteId};

use super::{BINARY_ANGLE_RAD, BinaryAngle, Ephemeris};

/// What the interface documents fix for their elements.
struct Gravity {
    /// Geocentric gravitational constant, m³/s².
    mu_m3_s2: f64,
    /// Its square root, so that no epoch has to take it.
    sqrt_mu: f64,
    /// Rotation rate of the earth, rad/s.
    earth_rate_rad_s: f64,
}

/// [IS-GPS-200] table 20-IV.
const GPS: Gravity =
    Gravity { mu_m3_s2: 3.986005e14, sqrt_mu: 19_964_981.843_217_388, earth_rate_rad_s: 7.2921151467e-5 };
/// [OS-SIS-ICD] table 64.
const GALILEO: Gravity =
    Gravity { mu_m3_s2: 3.986004418e14, sqrt_mu: 19_964_980.385_665_298, earth_rate_rad_s: 7.2921151467e-5 };
/// [BDS-SIS-B1I] table 5-11.
const BEIDOU: Gravity =
    Gravity { mu_m3_s2: 3.986004418e14, sqrt_mu: 19_964_980.385_665_298, earth_rate_rad_s: 7.292115e-5 };

const _: () =
    assert!(root_error(&GPS) < 1e-15 && root_error(&GALILEO) < 1e-15 && root_error(&BEIDOU) < 1e-15);

/// Relative error of the written square root.
const fn root_error(gravity: &Gravity) -> f64 {
    let error = gravity.sqrt_mu * gravity.sqrt_mu / gravity.mu_m3_s2 - 1.0;
    if error < 0.0 { -error } else { error }
}

/// Sine and cosine of −5°: the plane in which the geostationary elements are written ([BDS-SIS-B1I] table 5-11).
const GEOSTATIONARY_TILT: Direction =
    Direction { sin: -0.087_155_742_747_658_17, cos: 0.996_194_698_091_745_5 };

/// Steps of Newton's method: four suffice for an eccentricity of 0.5.
const NEWTON_STEPS: usize = 12;

/// What a step `s` leaves is at most `e s²`, rad: below this the next step would be lost in rounding.
const NEWTON_DONE_RAD: f64 = 1e-15;

/// An angle as its sine and cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Direction {
    sin: f64,
    cos: f64,
}

impl Direction {
    fn of(angle_rad: f64) -> Self {
        let (sin, cos) = libm::sincos(angle_rad);
        Self { sin, cos }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            sin: self.sin * other.cos + self.cos * other.sin,
            cos: self.cos * other.cos - self.sin * other.sin,
        }
    }

    /// Turns by a small angle, |d| ≤ 1/16 rad: the first terms left out of the series are below 1e-16.
    ///
    /// Coefficients are multiplied by: a division costs four times as much.
    fn plus_small(self, d: f64) -> Self {
        let q = d * d;
        let sin = d * (1.0 + q * (-1.0 / 6.0 + q * (1.0 / 120.0 - q * (1.0 / 5040.0))));
        let cos = 1.0 + q * (-0.5 + q * (1.0 / 24.0 + q * (-1.0 / 720.0 + q * (1.0 / 40_320.0))));
        self.plus(Self { sin, cos })
    }

    /// Turns by any angle: by the series when it is small, which costs a third.
    fn plus_angle(self, angle_rad: f64) -> Self {
        if angle_rad.abs() <= 0.0625 { self.plus_small(angle_rad) } else { self.plus(Self::of(angle_rad)) }
    }
}

/// Position and relativity of one instant.
pub(super) struct Orbit {
    pub(super) position: Ecef,
    /// Periodic relativistic part of the clock, s.
    pub(super) relativity_s: f64,
}

/// The place in the orbit plane at one instant, from the ascending node and across, and the plane's inclination.
struct InPlane {
    along_m: f64,
    across_m: f64,
    inclination: Direction,
}

impl Ephemeris {
    /// The orbit `since_toe_s` seconds of system time after the reference time.
    pub(super) fn orbit_at(&self, since_toe_s: f64) -> Orbit {
        let gravity = gravity(self.satellite.constellation());
        let anomaly = self.eccentric_anomaly(gravity, since_toe_s);
        let plane = self.in_plane(anomaly, since_toe_s);
        Orbit {
            position: self.earth_fixed(gravity, &plane, since_toe_s),
            relativity_s: self.relativity_s(gravity, anomaly.sin),
        }
    }

    fn eccentric_anomaly(&self, gravity: &Gravity, since_toe_s: f64) -> Direction {
        let axis_m = self.sqrt_a_sqrt_m * self.sqrt_a_sqrt_m;
        let motion_rad_s =
            gravity.sqrt_mu / (axis_m * self.sqrt_a_sqrt_m) + PI * f64::from(self.delta_n_sc_s);
        solve_kepler(radians(self.m0) + motion_rad_s * since_toe_s, self.eccentricity)
    }

    fn in_plane(&self, anomaly: Direction, since_toe_s: f64) -> InPlane {
        let axis_m = self.sqrt_a_sqrt_m * self.sqrt_a_sqrt_m;
        let node = Direction::of(radians(self.omega));
        let flattening = libm::sqrt(1.0 - self.eccentricity * self.eccentricity);
        let to_perigee_m = axis_m * (anomaly.cos - self.eccentricity);
        let aside_m = axis_m * flattening * anomaly.sin;
        let along_m = to_perigee_m * node.cos - aside_m * node.sin;
        let across_m = to_perigee_m * node.sin + aside_m * node.cos;

        // The corrections are hundreds of metres at most: seven digits of them are less than a tenth of a millimetre.
        let (x_m, y_m) = (along_m as f32, across_m as f32);
        let inverse_square = (x_m * x_m + y_m * y_m).recip();
        let (cos_doubled, sin_doubled) =
            ((x_m * x_m - y_m * y_m) * inverse_square, 2.0 * x_m * y_m * inverse_square);
        let correct = |c: f32, s: f32| c * cos_doubled + s * sin_doubled;
        let turn = correct(self.cuc_rad, self.cus_rad);
        let radius_m = axis_m as f32 * (1.0 - self.eccentricity as f32 * anomaly.cos as f32);
        let stretch = correct(self.crc_m, self.crs_m) / radius_m;
        // (1 + stretch)(1 + i turn − turn²/2): what is left out is below a micrometre.
        let (outward, forward) = (stretch - 0.5 * turn * turn, turn + stretch * turn);
        InPlane {
            along_m: along_m + f64::from(outward * x_m - forward * y_m),
            across_m: across_m + f64::from(outward * y_m + forward * x_m),
            inclination: Direction::of(
                radians(self.i0)
                    + PI * f64::from(self.idot_sc_s) * since_toe_s
                    + f64::from(correct(self.cic_rad, self.cis_rad)),
            ),
        }
    }

    fn earth_fixed(&self, gravity: &Gravity, plane: &InPlane, since_toe_s: f64) -> Ecef {
        let at_toe_rad = radians(self.omega0) - gravity.earth_rate_rad_s * self.toe_of_system_s();
        let drift_rad = PI * f64::from(self.omegadot_sc_s) * since_toe_s;
        let turn_rad = gravity.earth_rate_rad_s * since_toe_s;
        if is_geostationary(self.satellite) {
            let inertial = plane.towards(Direction::of(at_toe_rad + drift_rad));
            rotate_z(rotate_x(inertial, GEOSTATIONARY_TILT), Direction::of(turn_rad))
        } else {
            plane.towards(Direction::of(at_toe_rad + drift_rad - turn_rad))
        }
    }

    /// Periodic relativistic clock error from the eccentricity, s.
    fn relativity_s(&self, gravity: &Gravity, sin_anomaly: f64) -> f64 {
        const C2: f64 = SPEED_OF_LIGHT_M_S * SPEED_OF_LIGHT_M_S;
        -2.0 * gravity.sqrt_mu / C2 * self.eccentricity * self.sqrt_a_sqrt_m * sin_anomaly
    }
}

impl InPlane {
    /// The position when the ascending node lies in this direction.
    fn towards(&self, node: Direction) -> Ecef {
        let level_m = self.across_m * self.inclination.cos;
        Ecef::new(
            self.along_m * node.cos - level_m * node.sin,
            self.along_m * node.sin + level_m * node.cos,
            self.across_m * self.inclination.sin,
        )
    }
}

/// `E − e sin E = M` by Newton's method, e at most 0.5.
///
/// The slope `1 − e cos E` is at least 0.5, so no step divides by little, and each step squares the error.
fn solve_kepler(mean_rad: f64, eccentricity: f64) -> Direction {
    let mut anomaly_rad = mean_rad;
    let mut direction = Direction::of(mean_rad);
    for _ in 0..NEWTON_STEPS {
        let miss_rad = mean_rad - anomaly_rad + eccentricity * direction.sin;
        let step_rad = miss_rad / (1.0 - eccentricity * direction.cos);
        anomaly_rad += step_rad;
        direction = direction.plus_angle(step_rad);
        if eccentricity * step_rad * step_rad < NEWTON_DONE_RAD {
            break;
        }
    }
    direction
}

fn gravity(constellation: Constellation) -> &'static Gravity {
    match constellation {
        Constellation::Beidou => &BEIDOU,
        Constellation::Galileo => &GALILEO,
        Constellation::Gps | Constellation::Glonass => &GPS,
    }
}

/// The `BeiDou` numbers that belong to geostationary satellites ([BDS-SIS-B1I] 4.2, table 4-1).
fn is_geostationary(satellite: SatelliteId) -> bool {
    satellite.constellation() == Constellation::Beidou && matches!(satellite.number(), 1..=5 | 59..=63)
}

fn rotate_x(point: Ecef, by: Direction) -> Ecef {
    Ecef::new(point.x_m, by.cos * point.y_m + by.sin * point.z_m, by.cos * point.z_m - by.sin * point.y_m)
}

fn rotate_z(point: Ecef, by: Direction) -> Ecef {
    Ecef::new(by.cos * point.x_m + by.sin * point.y_m, by.cos * point.y_m - by.sin * point.x_m, point.z_m)
}

fn radians(angle: BinaryAngle) -> f64 {
    f64::from(angle) * BINARY_ANGLE_RAD
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kepler_is_solved_for_every_eccentricity_that_is_let_in() {
        for step in 0..=50 {
            let eccentricity = f64::from(step) * 0.01;
            for tenth in -70..70 {
                let want = f64::from(tenth) * 0.1;
                // The closed form goes the other way: from the anomaly to the mean anomaly.
                let have = solve_kepler(want - eccentricity * libm::sin(want), eccentricity);
                let error = libm::hypot(have.sin - libm::sin(want), have.cos - libm::cos(want));
                assert!(error < 1e-14, "e {eccentricity}: {error:e} at {want}");
            }
        }
    }

    #[test]
    fn a_small_turn_by_series_is_the_turn_by_sine_and_cosine() {
        for d in [-0.0625, -1e-3, 0.0, 1e-9, 0.0625] {
            let (have, want) = (Direction::of(1.2).plus_small(d), Direction::of(1.2 + d));
            assert!((have.sin - want.sin).abs() < 3e-16 && (have.cos - want.cos).abs() < 3e-16, "{d}");
        }
    }
}
