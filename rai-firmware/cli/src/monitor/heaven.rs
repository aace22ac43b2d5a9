//! Directions of the satellites, from the bytes that a module receives (orbits and ranges) and from
//! the module's position.
//!
//! The module's sentences have no directions, so that a source of sentences alone shows no sky.

use std::collections::BTreeMap;

use raim_core::frame::{Ecef, LocalFrame};
use raim_core::satellite::SatelliteId;
use raim_firmware::ephemeris::Ephemeris;
use raim_firmware::input::{Event, Input};

/// Satellite in the sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Satellite of the point.
    pub satellite: SatelliteId,
    /// Angle above the horizon, rad.
    pub elevation_rad: f64,
    /// Angle from north over east, rad.
    pub azimuth_rad: f64,
}

/// Reader of the GNSS port beside the module.
#[derive(Debug, Default)]
pub struct Heaven {
    input: Input,
    orbits: BTreeMap<SatelliteId, Ephemeris>,
}

impl Heaven {
    /// Returns a reader before the first byte.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes bytes; returns the directions of the satellites in their last epoch, as seen from
    /// `place`.
    pub fn hear(&mut self, bytes: &[u8], now_ms: u64, place: Ecef) -> Option<Vec<Body>> {
        let Self { input, orbits } = self;
        let mut bodies = None;
        input.feed(bytes, now_ms, |event| match event {
            Event::Ephemeris(ephemeris) => {
                orbits.insert(ephemeris.satellite(), ephemeris);
            }
            Event::Epoch(raw, _) => {
                let frame = LocalFrame::at(place);
                let seen = raw.satellites.iter().filter_map(|satellite| {
                    let orbit = orbits.get(&satellite.satellite)?;
                    let state = orbit.at(raw.time, satellite.signals.first()?.range_m).ok()?;
                    let toward = frame.rotate(state.position - place);
                    let azimuth_rad = toward.east.atan2(toward.north);
                    let elevation_rad = toward.up.atan2(toward.east.hypot(toward.north));
                    Some(Body { satellite: satellite.satellite, elevation_rad, azimuth_rad })
                });
                bodies = Some(seen.collect());
            }
            Event::Redated(_)
            | Event::Position(_)
            | Event::Ionosphere(..)
            | Event::SelfReport(_)
            | Event::Rivalry(_) => {}
        });
        bodies
    }
}
