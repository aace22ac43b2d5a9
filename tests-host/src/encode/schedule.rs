//! Which ephemerides a receiver knows when, from what was broadcast when.
//!
//! At an epoch a receiver knows, of each satellite, the newest ephemeris that was sent by then. A recording begins
//! in the middle: what a satellite was sending just before may be missing from the navigation file. So a satellite
//! of which nothing is known yet gets the first one that is to come, if its reference time is no farther than
//! [`VALIDITY_MS`] away.
//!
//! GLONASS ephemerides are dated in UTC, and a module that does not know the leap seconds yet has no use for them: receivers say
//! them again and again, here every [`REPEATED_MS`].
//!
//! A receiver sends sets of the satellites that it sees, when they are new to it and again every [`RECEIVER_REPEATS_MS`]
//! ([`Schedule::like_a_receiver`]). A navigation file holds those of the whole world.
//!
//! Galileo satellites send the same orbit in two messages. I/NAV has the group delays of all signals; F/NAV is sent
//! only for satellites without I/NAV.

use std::collections::BTreeMap;

use raim_core::satellite::SatelliteId;
use raim_firmware::time::GpsTime;

use crate::measurement::{Ephemeris, MeasuredEpoch, TimedEphemeris};

/// How far from its reference time an ephemeris is used ahead of its broadcast, ms: 2 h, half of a GPS fit interval.
const VALIDITY_MS: u64 = 2 * 3_600_000;

/// How often a GLONASS ephemeris is said again, ms: as often as the satellite sends it.
const REPEATED_MS: i64 = 30_000;

/// How often a receiver sends the set of a satellite again, ms.
const RECEIVER_REPEATS_MS: i64 = 60_000;

/// All broadcasts, and how far they have been passed on.
pub(super) struct Schedule {
    satellites: BTreeMap<SatelliteId, Satellite>,
    /// True if only sets of satellites in view are sent, again and again.
    is_as_received: bool,
}

/// One satellite's broadcasts in the order of time.
#[derive(Default)]
struct Satellite {
    broadcasts: Vec<TimedEphemeris>,
    /// Index of the one that was passed on last.
    known: Option<usize>,
    /// When that was.
    said: Option<GpsTime>,
}

impl Schedule {
    pub(super) fn new(ephemerides: impl Iterator<Item = TimedEphemeris>) -> Self {
        let mut satellites: BTreeMap<SatelliteId, Satellite> = BTreeMap::new();
        for ephemeris in ephemerides {
            satellites.entry(ephemeris.satellite).or_default().broadcasts.push(ephemeris);
        }
        satellites.values_mut().for_each(Satellite::arrange);
        Self { satellites, is_as_received: false }
    }

    /// Sends sets of satellites in view alone, and repeats them.
    pub(super) fn like_a_receiver(self) -> Self {
        Self { is_as_received: true, ..self }
    }

    /// What has become known since the last call, the epoch being no earlier than then, and what of its satellites is said again.
    pub(super) fn news(&mut self, epoch: &MeasuredEpoch) -> impl Iterator<Item = &TimedEphemeris> {
        let is_as_received = self.is_as_received;
        let mut seen: Vec<SatelliteId> = epoch.satellites.iter().map(|seen| seen.satellite).collect();
        seen.sort_unstable();
        self.satellites.iter_mut().filter_map(move |(id, satellite)| {
            let is_seen = || seen.binary_search(id).is_ok();
            match is_as_received {
                true if !is_seen() => None,
                true => satellite.news(epoch.time, Some(RECEIVER_REPEATS_MS), || true),
                false => satellite.news(epoch.time, None, is_seen),
            }
        })
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

    /// Returns the set that is sent now. Sets other than those of GLONASS are sent again only with `repeats_ms`.
    fn news(
        &mut self,
        now: GpsTime,
        repeats_ms: Option<i64>,
        is_seen: impl FnOnce() -> bool,
    ) -> Option<&TimedEphemeris> {
        let sent = self.broadcasts.partition_point(|ephemeris| ephemeris.sent <= now);
        let newest = match (sent.checked_sub(1), self.known) {
            (Some(newest), _) => newest,
            (None, Some(_)) => return None,
            (None, None) => self.first_to_come(now)?,
        };
        let known = self.known.replace(newest);
        let message = |index: usize| self.broadcasts.get(index).map(|ephemeris| &ephemeris.message);
        // The same message sent again is no news.
        let is_news = known != Some(newest) && known.and_then(message) != message(newest);
        let newest = self.broadcasts.get(newest)?;
        let is_glonass = matches!(newest.message, Ephemeris::Glonass(_));
        let repeats_ms = if is_glonass { Some(REPEATED_MS) } else { repeats_ms };
        let is_due = |repeats_ms| self.said.is_none_or(|said| now.since_ms(said) >= repeats_ms);
        let is_repeated = repeats_ms.is_some_and(is_due) && is_seen();
        if !(is_news || is_repeated) {
            return None;
        }
        self.said = Some(now);
        Some(newest)
    }

    fn first_to_come(&self, now: GpsTime) -> Option<usize> {
        let first = self.broadcasts.first()?;
        (first.toe.since_ms(now).unsigned_abs() <= VALIDITY_MS).then_some(0)
    }
}
