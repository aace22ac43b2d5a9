//! The satellites in sight: those of the last epochs, and those above the horizon of the last
//! position.
//!
//! ```text
//! sin el = p·(s − p) / (|p| |s − p|)          s satellite, p receiver; el above a spherical earth
//! ```
//!
//! Each satellite has one bit, with or without an ephemeris. Sines of elevations are stored in
//! hundredths.

use nalgebra::Vector3;
use raim_core::frame::Ecef;
use raim_core::internals::numeric::angle::sine;
use raim_core::internals::numeric::sqrt;
use raim_core::satellite::SatelliteId;

use super::{Ephemeris, coordinates_m};
use crate::time::GpsTime;

/// Epochs that one set of bits covers. A single epoch may have lost satellites. Two sets are
/// therefore stored, so that a satellite counts as in sight for three to six epochs.
const EPOCHS_OF_A_SET: u8 = 3;

/// Range that is assumed to locate a satellite, m. An error of 10,000 km moves the position by some
/// metres.
const RANGE_M: f64 = 2.3e7;

/// Hundredths of the sine of an elevation.
pub(super) type Elevation = i8;

/// Elevation if it is unknown.
pub(super) const HORIZON: Elevation = 0;

/// One bit for each satellite.
type Bits = [u32; 8];

/// Satellites of the last epochs.
#[derive(Clone, Debug, Default)]
pub(super) struct Sight {
    now: Bits,
    before: Bits,
    epochs: u8,
}

impl Sight {
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self { now: [0; 8], before: [0; 8], epochs: 0 }
    }

    /// Begins an epoch.
    pub(super) fn begin(&mut self) {
        if self.epochs == EPOCHS_OF_A_SET {
            (self.before, self.now, self.epochs) = (self.now, [0; 8], 0);
        }
        self.epochs += 1;
    }

    /// Adds a satellite to the epoch.
    pub(super) fn add(&mut self, satellite: SatelliteId) {
        let (word, bit) = place_of(satellite);
        if let Some(word) = self.now.get_mut(word) {
            *word |= bit;
        }
    }

    /// Returns true if the satellite was in one of the last epochs.
    pub(super) fn has(&self, satellite: SatelliteId) -> bool {
        let (word, bit) = place_of(satellite);
        [self.now, self.before].iter().any(|bits| bits.get(word).is_some_and(|word| word & bit != 0))
    }
}

/// Returns word and bit of a satellite. Each system has 64; satellites of QZSS come behind the 32
/// of GPS.
fn place_of(satellite: SatelliteId) -> (usize, u32) {
    let (_, number) = satellite.name();
    let behind = if satellite.is_qzss() { 40 } else { 0 };
    let index = usize::from(satellite.constellation() as u8) * 64 + usize::from((number + behind) % 64);
    (index / 32, 1 << (index % 32))
}

/// The sky of a receiver.
#[derive(Clone, Copy, Debug)]
pub(super) struct Skyline {
    receiver_m: Vector3<f32>,
    mask: Elevation,
}

impl Skyline {
    /// Returns the sky above a position and a mask.
    pub(super) fn new(receiver: Ecef, mask_rad: f64) -> Self {
        let Ecef { x_m, y_m, z_m } = receiver;
        Self {
            receiver_m: Vector3::new(x_m as f32, y_m as f32, z_m as f32),
            mask: hundredths(sine(mask_rad as f32)),
        }
    }

    /// Returns true if an elevation is above the mask.
    pub(super) fn shows(&self, elevation: Elevation) -> bool {
        elevation >= self.mask
    }

    /// Returns the elevation of a satellite; that of the horizon if the satellite has no position.
    pub(super) fn elevation(&self, ephemeris: &Ephemeris, now: GpsTime) -> Elevation {
        let Ok(state) = ephemeris.seen_at(now, RANGE_M) else { return HORIZON };
        let (receiver_m, satellite_m) = (self.receiver_m, Vector3::from(coordinates_m(state.place())));
        let way_m = satellite_m - receiver_m;
        hundredths(receiver_m.dot(&way_m) / sqrt(receiver_m.dot(&receiver_m) * way_m.dot(&way_m)))
    }
}

/// Rounds a sine; a NaN becomes the horizon.
fn hundredths(sine: f32) -> Elevation {
    (sine.clamp(-1.0, 1.0) * 100.0) as Elevation
}

#[cfg(test)]
mod tests {
    use raim_core::satellite::Constellation;

    use super::*;

    #[test]
    fn every_satellite_has_a_bit_of_its_own() {
        let numbers = |constellation, numbers: core::ops::RangeInclusive<u8>| {
            numbers.filter_map(move |number| SatelliteId::new(constellation, number))
        };
        let all = numbers(Constellation::Gps, 1..=32)
            .chain(numbers(Constellation::Gps, 193..=202))
            .chain(numbers(Constellation::Beidou, 1..=63))
            .chain(numbers(Constellation::Galileo, 1..=36))
            .chain(numbers(Constellation::Glonass, 1..=27));
        let mut places: std::vec::Vec<_> = all.map(place_of).collect();
        let many = places.len();
        places.sort_unstable();
        places.dedup();
        assert_eq!((many, places.len()), (168, 168));
        assert!(places.iter().all(|(word, _)| *word < 8));
    }

    #[test]
    fn a_satellite_is_in_sight_for_three_to_six_epochs() {
        let satellite = SatelliteId::new(Constellation::Beidou, 63).expect("a satellite");
        for first in 0..6 {
            let mut sight = Sight::new();
            let mut held = 0;
            for epoch in 0..20 {
                sight.begin();
                if epoch == first {
                    sight.add(satellite);
                }
                held += usize::from(sight.has(satellite));
            }
            assert!((3..=6).contains(&held), "{held} epochs from {first} on");
        }
    }
}
