//! Frequency slots: GLONASS satellites send on carriers of their own, and ranges of them say on
//! which.

use std::collections::BTreeMap;

use raim_core::satellite::{Constellation, SatelliteId};

use crate::measurement::{Ephemeris, TimedEphemeris};

/// The slots that the ephemerides name.
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

    /// The slot of a satellite, −7 to 6; 0 where all of its system share their carriers, none where
    /// nobody has said it.
    pub(super) fn slot(&self, satellite: SatelliteId) -> Option<i8> {
        match satellite.constellation() {
            Constellation::Glonass => self.slots.get(&satellite).copied(),
            _ => Some(0),
        }
    }
}
