//! The instance of images: it finds the injected fault, and equals the generic code to the last
//! bit.

#![allow(clippy::unwrap_used)]

use raim_core::epoch::{Epoch, Observation};
use raim_core::frame::{EARTH_ROTATION_RAD_S, Ecef, Enu, Geodetic, LocalFrame, SPEED_OF_LIGHT_M_S};
use raim_core::monitor::Monitor;
use raim_core::report::{Protected, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::{Constellation, SatelliteId};
use raim_single::{CAPACITY, Workspace};

/// Azimuth and elevation in degrees.
const DIRECTIONS: [(f64, f64); 10] = [
    (0.0, 80.0),
    (30.0, 25.0),
    (150.0, 30.0),
    (270.0, 20.0),
    (100.0, 50.0),
    (210.0, 45.0),
    (330.0, 40.0),
    (60.0, 15.0),
    (240.0, 70.0),
    (185.0, 12.0),
];
const DISTANCE_M: f64 = 22_000e3;
const CLOCK_M: f64 = 1e5;
const FAULTY: usize = 3;
const BIAS_M: f64 = 200.0;

fn receiver() -> Ecef {
    Geodetic { latitude_rad: 0.6, longitude_rad: 1.9, height_m: 150.0 }.to_ecef()
}

fn satellite(index: usize) -> SatelliteId {
    SatelliteId::new(Constellation::Gps, index as u8 + 1).unwrap()
}

/// Returns ten satellites, the fourth with a bias.
fn epoch(bias_m: f64) -> Epoch<CAPACITY> {
    let (here, mut epoch) = (receiver(), Epoch::new(0.0));
    for (index, (azimuth_deg, elevation_deg)) in DIRECTIONS.into_iter().enumerate() {
        let (azimuth, elevation) = (f64::to_radians(azimuth_deg), f64::to_radians(elevation_deg));
        let horizontal_m = DISTANCE_M * elevation.cos();
        let direction = Enu {
            east: horizontal_m * azimuth.sin(),
            north: horizontal_m * azimuth.cos(),
            up: DISTANCE_M * elevation.sin(),
        };
        let position = here + LocalFrame::at(here).unrotate(direction);
        // While the signal travels, the earth turns.
        let turning_m =
            EARTH_ROTATION_RAD_S / SPEED_OF_LIGHT_M_S * (position.x_m * here.y_m - position.y_m * here.x_m);
        let bias_m = if index == FAULTY { bias_m } else { 0.0 };
        let range_m = DISTANCE_M + turning_m + CLOCK_M + bias_m;
        epoch.push(Observation { satellite: satellite(index), position, range_m, sigma_m: 3.0 }).unwrap();
    }
    epoch
}

#[test]
fn position_is_where_the_receiver_is() {
    let mut room = Workspace::default();
    let position = raim_single::position(&mut room, &epoch(0.0), Ecef::CENTRE).unwrap();
    assert!(position.distance_m(receiver()) < 0.1, "{} m", position.distance_m(receiver()));
    assert!(raim_single::position(&mut room, &Epoch::new(0.0), Ecef::CENTRE).is_none(), "an empty epoch");

    let epoch = epoch(0.0);
    let fix = room.fix(&epoch, Ecef::CENTRE).unwrap();
    assert_eq!(fix.position(), position);
    assert!((LocalFrame::at(fix.position()).height_m() - 150.0).abs() < 0.1);
}

#[test]
fn faulty_satellite_is_left_out_as_by_the_generic_monitor() {
    let requirements = Requirements::non_precision_approach();
    let mut monitor = raim_single::Monitor::new(requirements).unwrap();
    let have = raim_single::process(&mut monitor, &epoch(BIAS_M));
    assert_eq!(have.verdict, Verdict::Protected(Protected::Excluded));
    assert!(have.excluded.iter().map(|suspect| suspect.satellite).eq([satellite(FAULTY)]));
    let want = Monitor::<f32, CAPACITY>::new(requirements).unwrap().process(&epoch(BIAS_M));
    assert_eq!(have, want);
}
