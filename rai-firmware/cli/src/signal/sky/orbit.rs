//! Kepler orbits in the earth-fixed frame.
//!
//! ```text
//! M = M₀ + n t      E − e sin E = M      u = ω + ν(E)      Ω = Ω₀ + (Ω̇ − ω_e) t
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `a` | `semi_major_axis_m` | m |
//! | `e` | `eccentricity` | 1 |
//! | `i` | `inclination_rad` | rad |
//! | `Ω₀` | `node_rad` | rad, from the prime meridian at `t = 0` |
//! | `Ω̇` | `node_rate_rad_s` | rad/s, in inertial space |
//! | `ω` | `perigee_rad` | rad |
//! | `M₀` | `mean_anomaly_rad` | rad, at `t = 0` |
//! | `n` | `mean_motion_rad_s` | rad/s |
//!
//! The model has two bodies and a secular node. It suits the study of geometry; after a day it is
//! kilometres from a real satellite. References: [IS-GPS-200] table 20-IV for the form of the
//! equations.
//!
//! [IS-GPS-200]: crate#references

use raim_core::frame::{EARTH_ROTATION_RAD_S, Ecef, SPEED_OF_LIGHT_M_S};

/// Gravitational constant times the mass of the earth, m³/s² ([WGS84]).
///
/// [WGS84]: crate#references
pub const GRAVITATION_M3_S2: f64 = 3.986_004_418e14;

/// Semi-major axis of a geosynchronous orbit, m.
pub const GEOSYNCHRONOUS_AXIS_M: f64 = 42_164_172.0;

/// An orbit by its elements at `t = 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// Semi-major axis, m.
    pub semi_major_axis_m: f64,
    /// Eccentricity, below 0.1 for every navigation satellite.
    pub eccentricity: f64,
    /// Inclination, rad.
    pub inclination_rad: f64,
    /// Longitude of the ascending node, rad.
    pub node_rad: f64,
    /// Drift of the node in inertial space, rad/s.
    pub node_rate_rad_s: f64,
    /// Argument of perigee, rad.
    pub perigee_rad: f64,
    /// Mean anomaly, rad.
    pub mean_anomaly_rad: f64,
    /// Mean motion, rad/s.
    pub mean_motion_rad_s: f64,
}

impl Orbit {
    /// Returns a circular orbit whose satellite is `argument_rad` past the ascending node at
    /// `t = 0`.
    pub fn circular(semi_major_axis_m: f64, inclination_rad: f64, node_rad: f64, argument_rad: f64) -> Self {
        Self {
            semi_major_axis_m,
            eccentricity: 0.0,
            inclination_rad,
            node_rad,
            node_rate_rad_s: 0.0,
            perigee_rad: 0.0,
            mean_anomaly_rad: argument_rad,
            mean_motion_rad_s: mean_motion_rad_s(semi_major_axis_m),
        }
    }

    /// Returns a circular, exactly geosynchronous orbit that crosses the equator northwards at the
    /// knot of its inclined ground track.
    pub fn geosynchronous(inclination_rad: f64, node_rad: f64, knot_rad: f64) -> Self {
        Self {
            mean_motion_rad_s: EARTH_ROTATION_RAD_S,
            ..Self::circular(GEOSYNCHRONOUS_AXIS_M, inclination_rad, node_rad, knot_rad - node_rad)
        }
    }

    /// Returns the earth-fixed position at `t_s`.
    pub fn position(&self, t_s: f64) -> Ecef {
        let anomaly_rad = self.eccentric_anomaly_rad(t_s);
        let (sin_anomaly, cos_anomaly) = libm::sincos(anomaly_rad);
        let minor = libm::sqrt(1.0 - self.eccentricity * self.eccentricity);
        let true_anomaly_rad = libm::atan2(minor * sin_anomaly, cos_anomaly - self.eccentricity);
        let radius_m = self.semi_major_axis_m * (1.0 - self.eccentricity * cos_anomaly);
        let node_rad = self.node_rad + (self.node_rate_rad_s - EARTH_ROTATION_RAD_S) * t_s;
        turned(radius_m, self.perigee_rad + true_anomaly_rad, node_rad, self.inclination_rad)
    }

    /// Returns the relativistic correction of the satellite's clock between perigee and apogee, s
    /// ([IS-GPS-200] 20.3.3.3.3.1).
    ///
    /// [IS-GPS-200]: crate#references
    pub fn relativity_s(&self, t_s: f64) -> f64 {
        const FACTOR: f64 = -2.0 / (SPEED_OF_LIGHT_M_S * SPEED_OF_LIGHT_M_S);
        let energy = libm::sqrt(GRAVITATION_M3_S2 * self.semi_major_axis_m);
        FACTOR * energy * self.eccentricity * libm::sin(self.eccentric_anomaly_rad(t_s))
    }

    /// Solves Kepler's equation by Newton's method: from `E = M`, six steps reach rounding for
    /// `e < 0.1`.
    fn eccentric_anomaly_rad(&self, t_s: f64) -> f64 {
        let mean_rad = self.mean_anomaly_rad + self.mean_motion_rad_s * t_s;
        (0..6).fold(mean_rad, |anomaly_rad, _| {
            let (sin, cos) = libm::sincos(anomaly_rad);
            anomaly_rad - (anomaly_rad - self.eccentricity * sin - mean_rad) / (1.0 - self.eccentricity * cos)
        })
    }
}

/// Returns the mean motion by Kepler's third law, rad/s.
pub fn mean_motion_rad_s(semi_major_axis_m: f64) -> f64 {
    libm::sqrt(GRAVITATION_M3_S2 / semi_major_axis_m) / semi_major_axis_m
}

/// Rotates from the orbital plane into the earth-fixed frame.
fn turned(radius_m: f64, argument_rad: f64, node_rad: f64, inclination_rad: f64) -> Ecef {
    let (sin_argument, cos_argument) = libm::sincos(argument_rad);
    let (sin_node, cos_node) = libm::sincos(node_rad);
    let (sin_inclination, cos_inclination) = libm::sincos(inclination_rad);
    let across = sin_argument * cos_inclination;
    Ecef::new(
        radius_m * (cos_argument * cos_node - across * sin_node),
        radius_m * (cos_argument * sin_node + across * cos_node),
        radius_m * sin_argument * sin_inclination,
    )
}
