//! The newest ephemeris of every satellite.
//!
//! One that is complete stays in use until a newer one is complete; an interrupted upload therefore changes
//! nothing. Which is newer is said by the reference time and, among equals, by arrival (a corrected set under the
//! same reference time). Whatever is out of date, in the past or in the future, gives way to what is not, and takes
//! the place of nothing else: a reference time that is far off, though its message is whole, costs no satellite.
//!
//! Galileo sends two messages. I/NAV carries both group delays and so serves every pair of signals; F/NAV takes its
//! place only when it has become stale.
//!
//! Room for [`CAPACITY`] satellites, 11 KiB: twice as many as three systems show at once. When it is full, the one with
//! the oldest reference time goes, which is one that set hours ago.

use heapless::Vec;
use rai_core::satellite::SatelliteId;

use super::{Ephemeris, EphemerisError, Source};
use crate::time::GpsTime;

/// How many satellites the store holds.
pub const CAPACITY: usize = 96;

const _: () = assert!(size_of::<Ephemeris>() <= 120);

/// What became of an ephemeris that was offered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Insertion {
    /// It is the one in use now.
    Taken,
    /// The one in use is better; nothing changed.
    Older,
}

/// The ephemerides in use.
#[derive(Clone, Debug, Default)]
pub struct Store {
    entries: Vec<Ephemeris, CAPACITY>,
}

impl Store {
    /// A store without ephemerides.
    pub const fn new() -> Self {
        Self { entries: Vec::new() }
    }

    /// Offers an ephemeris. `now` is the time of the last epoch, if there was one.
    pub fn insert(&mut self, offered: Ephemeris, now: Option<GpsTime>) -> Insertion {
        let known = self.entries.iter_mut().find(|entry| entry.satellite == offered.satellite);
        if let Some(entry) = known {
            if !gives_way(entry, &offered, now) {
                return Insertion::Older;
            }
            *entry = offered;
            return Insertion::Taken;
        }
        match self.entries.push(offered) {
            Ok(()) => Insertion::Taken,
            Err(offered) => self.replace_oldest(offered),
        }
    }

    /// The ephemeris of a satellite, if it may be used at that time.
    ///
    /// # Errors
    /// [`EphemerisError`] says why there is none.
    pub fn get(&self, satellite: SatelliteId, time: GpsTime) -> Result<&Ephemeris, EphemerisError> {
        let entry = self.entries.iter().find(|entry| entry.satellite == satellite);
        let ephemeris = entry.ok_or(EphemerisError::Missing)?;
        ephemeris.usable_at(time)?;
        Ok(ephemeris)
    }

    /// How many satellites have an ephemeris, usable or not.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// True when no satellite has one.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    fn replace_oldest(&mut self, offered: Ephemeris) -> Insertion {
        match self.entries.iter_mut().min_by_key(|entry| entry.toe) {
            Some(oldest) if oldest.toe < offered.toe => {
                *oldest = offered;
                Insertion::Taken
            }
            _ => Insertion::Older,
        }
    }
}

/// Whether `entry` is replaced by `offered`.
fn gives_way(entry: &Ephemeris, offered: &Ephemeris, now: Option<GpsTime>) -> bool {
    match now {
        Some(now) if entry.is_stale(now) != offered.is_stale(now) => entry.is_stale(now),
        _ => match (entry.source, offered.source) {
            (Source::GalileoInav, Source::GalileoFnav) => false,
            (Source::GalileoFnav, Source::GalileoInav) => true,
            _ => offered.toe >= entry.toe,
        },
    }
}
