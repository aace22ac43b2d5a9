//! Schedule of the ephemerides that a receiver knows, from the times of their broadcasts.
//!
//! At an epoch a receiver knows the newest ephemeris of each satellite that was sent by then. A
//! recording begins between broadcasts, so that the set sent just before it may be missing from the
//! navigation file. A satellite without a set therefore gets the first future one, if its reference
//! time is no farther than [`VALIDITY_MS`] away.
//!
//! GLONASS ephemerides are dated in UTC, and a module that does not know the leap seconds yet
//! cannot use them. Receivers repeat them, here every [`REPEATED_MS`].
//!
//! A receiver sends the sets of satellites in view, when they are new and then every
//! [`RECEIVER_REPEATS_MS`] ([`Schedule::like_a_receiver`]). A navigation file has those of the
//! whole world.
//!
//! Galileo satellites send the same orbit in two messages. I/NAV has the group delays of all
//! signals; F/NAV is sent only for satellites without I/NAV.

use std::collections::BTreeMap;

use raim_core::satellite::SatelliteId;
use raim_firmware::time::GpsTime;

use crate::signal::measurement::{Ephemeris, MeasuredEpoch, TimedEphemeris};

/// Longest time from its reference time at which an ephemeris is used ahead of its broadcast, ms: 2
/// h, half of a GPS fit interval.
const VALIDITY_MS: u64 = 2 * 3_600_000;

/// Interval of repetition of a GLONASS ephemeris, ms, which is that of the satellite.
const REPEATED_MS: i64 = 30_000;

/// Interval at which a receiver repeats the set of a satellite, ms.
const RECEIVER_REPEATS_MS: i64 = 60_000;

/// All broadcasts, and the ones sent so far.
pub(super) struct Schedule {
    satellites: BTreeMap<SatelliteId, Satellite>,
    /// True if only sets of satellites in view are sent, repeatedly.
    is_as_received: bool,
}

/// Broadcasts of one satellite in the order of time.
#[derive(Default)]
struct Satellite {
    broadcasts: Vec<TimedEphemeris>,
    /// Index of the broadcast that was sent last.
    known: Option<usize>,
    /// Time of that.
    reported: Option<GpsTime>,
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

    /// Sends only sets of satellites in view, and repeats them.
    pub(super) fn like_a_receiver(self) -> Self {
        Self { is_as_received: true, ..self }
    }

    /// Returns the sets that became known since the last call, and those that are repeated. The
    /// epoch must be no earlier than that call.
    pub(super) fn news(&mut self, epoch: &MeasuredEpoch) -> impl Iterator<Item = &TimedEphemeris> {
        let is_as_received = self.is_as_received;
        let mut seen: Vec<SatelliteId> = epoch.satellites.iter().map(|seen| seen.satellite).collect();
        seen.sort_unstable();
        // Both lists are in order, so that each is read once.
        let mut seen = seen.into_iter().peekable();
        self.satellites.iter_mut().filter_map(move |(id, satellite)| {
            while seen.next_if(|one| one < id).is_some() {}
            let is_seen = seen.peek() == Some(id);
            match is_as_received {
                true if !is_seen => None,
                true => satellite.news(epoch.time, Some(RECEIVER_REPEATS_MS), true),
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

    /// Returns the set that is sent now. Only with `repeats_ms` are sets other than those of
    /// GLONASS repeated.
    fn news(&mut self, now: GpsTime, repeats_ms: Option<i64>, is_seen: bool) -> Option<&TimedEphemeris> {
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
        let is_due = |repeats_ms| self.reported.is_none_or(|reported| now.since_ms(reported) >= repeats_ms);
        let is_repeated = repeats_ms.is_some_and(is_due) && is_seen;
        if !(is_news || is_repeated) {
            return None;
        }
        self.reported = Some(now);
        Some(newest)
    }

    fn first_to_come(&self, now: GpsTime) -> Option<usize> {
        let first = self.broadcasts.first()?;
        (first.toe.since_ms(now).unsigned_abs() <= VALIDITY_MS).then_some(0)
    }
}
