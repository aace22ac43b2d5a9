//! Small skies whose truth is known by construction.
//!
//! Ranges are straight distances to satellites turned by the angle through which the earth rotates
//! in flight: the exact form of what the core does to first order.

use raim_core::epoch::{Epoch, Observation};
use raim_core::frame::{EARTH_ROTATION_RAD_S, Ecef, Enu, Geodetic, LocalFrame, SPEED_OF_LIGHT_M_S};
use raim_core::internals::integrity::raim::isolation::parity::Isolation;
use raim_core::monitor::Method;
use raim_core::satellite::{Constellation, SatelliteId};

/// Standard deviation that the observations claim, m.
pub(crate) const SIGMA_M: f64 = 3.0;

/// Satellites for which an epoch has room in the tests that do not ask about room: each other number
/// compiles the whole monitor once more.
pub(crate) const CAPACITY: usize = 40;

/// Azimuth and elevation in degrees of well-spread directions.
pub(crate) const DIRECTIONS: [(f64, f64); 8] = [
    (10.0, 75.0),
    (50.0, 20.0),
    (110.0, 45.0),
    (160.0, 15.0),
    (200.0, 60.0),
    (250.0, 25.0),
    (300.0, 40.0),
    (340.0, 12.0),
];

/// Methods of classic RAIM.
pub(crate) const METHODS: [Method; 7] = [
    Method::Auto,
    Method::Baarda,
    Method::Ransac,
    Method::Parity(Isolation::Simultaneous),
    Method::Parity(Isolation::Sequential),
    Method::Parity(Isolation::Hybrid),
    Method::Parity(Isolation::Grouping),
];

/// Returns an epoch of these observations.
pub(crate) fn epoch_of<const N: usize>(time_s: f64, observations: &[Observation]) -> Epoch<N> {
    let mut epoch = Epoch::new(time_s);
    for observation in observations {
        epoch.push(*observation).unwrap();
    }
    epoch
}

/// Returns the position of the receiver.
pub(crate) fn receiver() -> Ecef {
    Geodetic { latitude_rad: 0.6, longitude_rad: 1.9, height_m: 150.0 }.to_ecef()
}

/// Returns a satellite of a constellation.
pub(crate) fn satellite(constellation: Constellation, number: usize) -> SatelliteId {
    SatelliteId::new(constellation, number as u8).unwrap()
}

/// Returns a satellite in a direction, 22,000 km away, and its range with a receiver clock.
pub(crate) fn observe(
    id: SatelliteId,
    (azimuth_deg, elevation_deg): (f64, f64),
    clock_m: f64,
) -> Observation {
    let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
    let distance_m = 22_000e3;
    let horizontal = distance_m * elevation.cos();
    let direction = Enu {
        east: horizontal * azimuth.sin(),
        north: horizontal * azimuth.cos(),
        up: distance_m * elevation.sin(),
    };
    let position = receiver() + LocalFrame::at(receiver()).unrotate(direction);
    let mut range_m = distance_m;
    for _ in 0..5 {
        let angle = EARTH_ROTATION_RAD_S * range_m / SPEED_OF_LIGHT_M_S;
        let turned = Ecef::new(
            position.x_m * angle.cos() + position.y_m * angle.sin(),
            position.y_m * angle.cos() - position.x_m * angle.sin(),
            position.z_m,
        );
        range_m = turned.distance_m(receiver());
    }
    Observation { satellite: id, position, range_m: range_m + clock_m, sigma_m: SIGMA_M }
}
