//! Directions and ranges from a site to the satellites above its mask.
//!
//! The signal that arrives at `t` left at `t − τ`. The satellite is taken where it was then, and
//! the earth turns under the signal by `ω_e τ`. Both are exact here, because the satellite's
//! position is rotated, so that a first-order correction elsewhere can be compared with it.

use raim_core::frame::{EARTH_ROTATION_RAD_S, Ecef, Enu, Geodetic, LocalFrame, SPEED_OF_LIGHT_M_S};
use raim_core::satellite::SatelliteId;

use super::fleet::Satellite;

/// An antenna on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// Earth-fixed position of the antenna.
    pub position: Ecef,
    /// Local frame at the antenna: east, north, up.
    pub frame: LocalFrame,
}

impl Site {
    /// Returns a site from its coordinates in degrees and its height above the ellipsoid.
    pub fn geodetic(latitude_deg: f64, longitude_deg: f64, height_m: f64) -> Self {
        let latitude_rad = latitude_deg.to_radians();
        let longitude_rad = longitude_deg.to_radians();
        Self::at(Geodetic { latitude_rad, longitude_rad, height_m }.to_ecef())
    }

    /// Returns a site at an earth-fixed position.
    pub fn at(position: Ecef) -> Self {
        Self { position, frame: LocalFrame::at(position) }
    }

    /// Returns the unit vector to an earth-fixed point of the same instant.
    pub fn direction(&self, point: Ecef) -> Enu {
        let difference = point - self.position;
        unit(self.frame.rotate(difference), difference.radius_m())
    }

    /// Returns the unit vector to an earth-fixed point of the same instant if the sine of its
    /// elevation is at least `sin_mask`, which is not negative. Points below the horizon, two thirds
    /// of a sky, cost no root.
    pub fn direction_above(&self, point: Ecef, sin_mask: f64) -> Option<Enu> {
        let difference = point - self.position;
        let towards = self.frame.rotate(difference);
        if towards.up < 0.0 {
            return None;
        }
        Some(unit(towards, difference.radius_m())).filter(|direction| direction.up >= sin_mask)
    }
}

fn unit(Enu { east, north, up }: Enu, length: f64) -> Enu {
    Enu { east: east / length, north: north / length, up: up / length }
}

/// A satellite above the mask.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// Name of the satellite.
    pub satellite: SatelliteId,
    /// Transmission time, s on the sky's clock.
    pub sent_s: f64,
    /// Position of the satellite at transmission, in the earth-fixed frame of that instant.
    pub position: Ecef,
    /// Distance that the signal travelled, m.
    pub range_m: f64,
    /// Unit vector from the site to the satellite.
    pub line_of_sight: Enu,
}

impl Sight {
    /// Returns the angle above the horizon, rad.
    pub fn elevation_rad(&self) -> f64 {
        libm::asin(self.line_of_sight.up.clamp(-1.0, 1.0))
    }

    /// Returns the angle from north over east, 0 to 2π rad.
    pub fn azimuth_rad(&self) -> f64 {
        let azimuth_rad = libm::atan2(self.line_of_sight.east, self.line_of_sight.north);
        azimuth_rad.rem_euclid(core::f64::consts::TAU)
    }
}

/// Returns the satellites above `mask_rad` at `t_s`, in the order given.
pub fn sights(satellites: &[Satellite], site: &Site, t_s: f64, mask_rad: f64) -> Vec<Sight> {
    let sin_mask = libm::sin(mask_rad);
    let seen = satellites.iter().map(|satellite| sight(satellite, site, t_s));
    seen.filter(|sight| sight.line_of_sight.up >= sin_mask).collect()
}

/// Traces one signal back. Each round shrinks the error of the travel time by `v/c`; four rounds
/// leave none.
fn sight(satellite: &Satellite, site: &Site, t_s: f64) -> Sight {
    let travelled = |travel_s: f64| {
        let position = satellite.orbit.position(t_s - travel_s);
        let turned = turned(position, EARTH_ROTATION_RAD_S * travel_s);
        (position, turned, site.position.distance_m(turned))
    };
    let travel_s = (0..4).fold(0.0, |travel_s, _| travelled(travel_s).2 / SPEED_OF_LIGHT_M_S);
    let (position, turned, range_m) = travelled(travel_s);
    Sight {
        satellite: satellite.id,
        sent_s: t_s - travel_s,
        position,
        range_m,
        line_of_sight: site.direction(turned),
    }
}

/// Returns the same point in axes that have turned eastwards by `angle_rad`.
fn turned(point: Ecef, angle_rad: f64) -> Ecef {
    let (sin, cos) = libm::sincos(angle_rad);
    Ecef::new(cos * point.x_m + sin * point.y_m, cos * point.y_m - sin * point.x_m, point.z_m)
}
