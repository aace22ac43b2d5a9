//! Frequency slots: GLONASS satellites send on their own carriers, and their ranges state the slot.

use std::collections::BTreeMap;

use raim_core::satellite::{Constellation, SatelliteId};

use crate::signal::measurement::{Ephemeris, TimedEphemeris};

/// Slots in the ephemerides.
pub(super) struct Channels {
    slots: BTreeMap<SatelliteId, i8>,
}

impl Channels {
    pub(super) fn of(ephemerides: &[TimedEphemeris]) -> Self {
        let slot = |ephemeris: &TimedEphemeris| match &ephemeris.message {
            Ephemeris::Glonass(message) => {
                Some((ephemeris.satellite, message.glo_satellite_freq_chan_number))
            }
            _ => None,
        };
        Self { slots: ephemerides.iter().filter_map(slot).collect() }
    }

    /// Returns the slot of a satellite, −7 to 6; 0 if its system shares carriers, `None` if the
    /// slot is unknown.
    pub(super) fn slot(&self, satellite: SatelliteId) -> Option<i8> {
        match satellite.constellation() {
            Constellation::Glonass => self.slots.get(&satellite).copied(),
            _ => Some(0),
        }
    }
}
