//! Which ephemerides a receiver knows when, from what was broadcast when.
//!
//! At an epoch a receiver knows, of each satellite, the newest ephemeris that was sent by then. A recording begins
//! in the middle: what a satellite was sending just before may be missing from the navigation file. So a satellite
//! of which nothing is known yet gets the first one that is to come, if its reference time is no farther than
//! [`VALIDITY_MS`] away.
//!
//! Galileo satellites send the same orbit in two messages. I/NAV has the group delays of all signals; F/NAV is sent
//! only for satellites without I/NAV.

use std::collections::BTreeMap;

use rai_core::satellite::SatelliteId;
use rai_firmware::time::GpsTime;

use crate::measurement::{Ephemeris, TimedEphemeris};

/// How far from its reference time an ephemeris is used ahead of its broadcast, ms: 2 h, half of a GPS fit interval.
const VALIDITY_MS: u64 = 2 * 3_600_000;

/// All broadcasts, and how far they have been passed on.
pub(super) struct Schedule {
    satellites: BTreeMap<SatelliteId, Satellite>,
}

/// One satellite's broadcasts in the order of time.
#[derive(Default)]
struct Satellite {
    broadcasts: Vec<TimedEphemeris>,
    /// Index of the one that was passed on last.
    known: Option<usize>,
}

impl Schedule {
    pub(super) fn new(ephemerides: impl Iterator<Item = TimedEphemeris>) -> Self {
        let mut satellites: BTreeMap<SatelliteId, Satellite> = BTreeMap::new();
        for ephemeris in ephemerides {
            satellites.entry(ephemeris.satellite).or_default().broadcasts.push(ephemeris);
        }
        satellites.values_mut().for_each(Satellite::arrange);
        Self { satellites }
    }

    /// What has become known since the last call, `now` being no earlier than then.
    pub(super) fn news(&mut self, now: GpsTime) -> impl Iterator<Item = &TimedEphemeris> {
        self.satellites.values_mut().filter_map(move |satellite| satellite.news(now))
    }
}

impl Satellite {
    fn arrange(&mut self) {
        let is_fnav = |ephemeris: &TimedEphemeris| matches!(ephemeris.message, Ephemeris::GalileoFnav(_));
        if !self.broadcasts.iter().all(is_fnav) {
            self.broadcasts.retain(|ephemeris| !is_fnav(ephemeris));
        }
        self.broadcasts.sort_by_key(|ephemeris| (ephemeris.sent, ephemeris.toe));
    }

    fn news(&mut self, now: GpsTime) -> Option<&TimedEphemeris> {
        let sent = self.broadcasts.partition_point(|ephemeris| ephemeris.sent <= now);
        let newest = match (sent.checked_sub(1), self.known) {
            (Some(newest), _) => newest,
            (None, Some(_)) => return None,
            (None, None) => self.first_to_come(now)?,
        };
        let known = self.known.replace(newest).and_then(|known| self.broadcasts.get(known));
        // The same message sent again is no news.
        self.broadcasts.get(newest).filter(|newest| known.is_none_or(|known| known.message != newest.message))
    }

    fn first_to_come(&self, now: GpsTime) -> Option<usize> {
        let first = self.broadcasts.first()?;
        (first.toe.since_ms(now).unsigned_abs() <= VALIDITY_MS).then_some(0)
    }
}
