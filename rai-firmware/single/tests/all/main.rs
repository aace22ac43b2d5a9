//! The instance for a microcontroller: it finds the injected fault, and equals the generic code to
//! the last bit.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use raim_core::epoch::Epoch;
use raim_core::frame::{Ecef, LocalFrame};
use raim_core::least_squares::Workspace;
use raim_core::monitor::Monitor;
use raim_core::report::{Protected, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::Constellation;
use raim_single::CAPACITY;

use crate::sky::{observe, receiver, satellite};

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
const FAULTY: usize = 3;
const BIAS_M: f64 = 200.0;

/// Returns ten satellites, the fourth with a bias.
fn epoch(bias_m: f64) -> Epoch<CAPACITY> {
    let mut epoch = Epoch::new(0.0);
    for (index, direction) in DIRECTIONS.into_iter().enumerate() {
        let mut observation = observe(satellite(Constellation::Gps, index + 1), direction, 1e5);
        observation.range_m += if index == FAULTY { bias_m } else { 0.0 };
        epoch.push(observation).unwrap();
    }
    epoch
}

#[test]
fn position_is_where_the_receiver_is() {
    let mut room = Workspace::<f32, CAPACITY>::default();
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
    let named = have.excluded.iter().map(|suspect| suspect.satellite);
    assert!(named.eq([satellite(Constellation::Gps, FAULTY + 1)]));
    let want = Monitor::<f32, CAPACITY>::new(requirements).unwrap().process(&epoch(BIAS_M));
    assert_eq!(have, want);
}
