//! One epoch from ranges to a verdict: seven satellites, of which one is wrong by 80 m.
//!
//! `cargo run --package raim-core --example one_epoch`

use raim_core::epoch::{Epoch, Observation};
use raim_core::frame::{Ecef, Enu, LocalFrame};
use raim_core::monitor::Monitor;
use raim_core::requirements::Requirements;
use raim_core::satellite::{Constellation, SatelliteId};

/// East, north and up of the satellites, m: one in the zenith, six around it.
const DIRECTIONS_M: [[f64; 3]; 7] = [
    [0.0, 0.0, 22e6],
    [0.0, 17.6e6, 13.2e6],
    [0.0, -17.6e6, 13.2e6],
    [17.6e6, 0.0, 13.2e6],
    [-17.6e6, 0.0, 13.2e6],
    [13.2e6, 10.56e6, 14.08e6],
    [-10.56e6, 14.08e6, 13.2e6],
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let antenna = Ecef::new(3_582_105.0, 532_590.0, 5_232_755.0);
    let frame = LocalFrame::at(antenna);
    let mut epoch = Epoch::<40>::new(0.0);
    for (number, [east, north, up]) in (1..).zip(DIRECTIONS_M) {
        let satellite = SatelliteId::new(Constellation::Gps, number).ok_or("no such satellite")?;
        let position = antenna + frame.unrotate(Enu { east, north, up });
        let fault_m = if number == 5 { 80.0 } else { 0.0 };
        epoch.push(Observation { satellite, position, range_m: 22e6 + fault_m, sigma_m: 2.0 })?;
    }

    // Single precision is what the processor of a microcontroller computes in hardware.
    let mut monitor = Monitor::<f32, 40>::new(Requirements::non_precision_approach())?;
    let report = monitor.process(&epoch);

    println!("verdict: {:?}", report.verdict);
    for excluded in &report.excluded {
        println!("left out: {}", excluded.satellite);
    }
    if let Some(solution) = report.solution {
        println!("off by {:.3} m", solution.position.distance_m(antenna));
    }
    Ok(())
}
