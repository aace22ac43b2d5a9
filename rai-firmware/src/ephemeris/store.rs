//! The ephemerides in use: what was received last, of the satellites in sight.
//!
//! ```text
//! offered, stale now                         nothing changes, unless all that is known is as useless
//! known is stale or unknown                  offered is taken
//! |X − X'| ≤ 30 m and c|Δt − Δt'| ≤ 30 m     offered replaces what is known
//! else                                       neither is used until a third agrees with one of them
//! ```
//!
//! **Which is better.** What was received last, whatever its reference time: a set that is ahead of its time is worse than
//! the one for now, though it is newer. Whatever is out of date, in the past or in the future, gives way to what is not,
//! and takes the place of nothing else.
//!
//! **Contradiction.** Two sets of one satellite that are both in date describe one orbit, and differ by a few metres. Where
//! they differ by more, one is wrong, and nothing says which. The third that decides is a set of its own: one more copy
//! of what contradicts has nothing new to say. A copy of what was known takes back a contradiction that came once, as by a
//! message spoilt on its way; where the contradiction is repeated as well, copies decide nothing. A satellite that has been
//! moved is out of use until its second new set.
//!
//! **Galileo** sends two messages. I/NAV carries both group delays and so serves every pair of signals; the orbit of
//! F/NAV takes its place only when it has become stale. What each says of the health of its own signals counts from then on
//! ([`Ephemeris::merge_health`]).
//!
//! **Room** for [`CAPACITY`] satellites, 9 KiB: as many as an epoch has, and more than four systems show at once. When it
//! is full, first goes what is stale, then what is not in sight: what was not observed for longest, then what was received first; a
//! satellite that is new counts as one that has just set. Half a dozen
//! contradictions are kept; where there are more, the set that is known stays, disputed.
//!
//! **State vectors** are integrated, and what the next epochs have in common with this one is kept ([`Store::advance`]).

use heapless::Vec;
use rai_core::frame::SPEED_OF_LIGHT_M_S;
use rai_core::satellite::{Constellation, SatelliteId};

use super::{Ephemeris, EphemerisError, Source};
use crate::time::GpsTime;

/// How many satellites the store holds.
pub const CAPACITY: usize = 64;

/// How many contradictions are kept.
const RIVALS: usize = 6;

/// Who was in one of so many epochs is in sight: one epoch may have lost satellites.
const IN_SIGHT_EPOCHS: u32 = 6;

/// Two sets that are farther apart than this, in position or clock, contradict each other, m: ten sigma of the poorest.
const AGREEMENT_M: f64 = 30.0;

const _: () = assert!(size_of::<Entry>() <= 144);

/// What became of an ephemeris that was offered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Insertion {
    /// It is the one in use now.
    Taken,
    /// The one in use is better; nothing changed but what it says of its own signals' health.
    Kept,
    /// It contradicts the one in use: neither is used.
    Disputed,
}

/// What is known of one satellite.
#[derive(Clone, Debug)]
struct Entry {
    ephemeris: Ephemeris,
    /// Of which epoch the satellite was last a part; of one that has been in none, the last but one when it was received.
    observed: u32,
    /// The how-manieth ephemeris it was.
    received: u32,
    /// The how-manieth was the first that said the same of orbit and clock.
    edition: u32,
    is_disputed: bool,
    /// Whether the satellite has been in an epoch.
    was_seen: bool,
}

/// What contradicts the set that is known of a satellite.
#[derive(Clone, Debug)]
struct Rival {
    ephemeris: Ephemeris,
    /// It was received more than once.
    is_repeated: bool,
}

/// The ephemerides in use.
#[derive(Clone, Debug, Default)]
pub struct Store {
    entries: Vec<Entry, CAPACITY>,
    rivals: Vec<Rival, RIVALS>,
    epochs: u32,
    received: u32,
}

impl Store {
    /// A store without ephemerides.
    pub const fn new() -> Self {
        Self { entries: Vec::new(), rivals: Vec::new(), epochs: 0, received: 0 }
    }

    /// Offers an ephemeris. `now` is the time of the last epoch, if there was one.
    pub fn insert(&mut self, offered: Ephemeris, now: Option<GpsTime>) -> Insertion {
        self.received = self.received.saturating_add(1);
        let received = self.received;
        let known = self.entries.iter_mut().find(|entry| entry.ephemeris.satellite == offered.satellite);
        let Some(entry) = known else {
            // It may be of a satellite that is about to rise: not so sure to be of use as those in sight, more than any other.
            let observed = self.epochs.saturating_sub(1);
            let entry = Entry {
                ephemeris: offered,
                observed,
                received,
                edition: received,
                is_disputed: false,
                was_seen: false,
            };
            return self.admit(entry, now);
        };
        let insertion = entry.consider(offered, received, now, &mut self.rivals);
        if insertion == Insertion::Taken {
            entry.received = received;
        }
        insertion
    }

    /// Forgets all sets of a system.
    pub fn forget(&mut self, constellation: Constellation) {
        self.entries.retain(|entry| entry.ephemeris.satellite.constellation() != constellation);
        self.rivals.retain(|rival| rival.ephemeris.satellite.constellation() != constellation);
    }

    /// Moves sets that are dated a week from the present into its week: the week was named or moved after they came.
    pub fn redate(&mut self, present: GpsTime) {
        let entries = self.entries.iter_mut().map(|entry| &mut entry.ephemeris);
        for ephemeris in entries.chain(self.rivals.iter_mut().map(|rival| &mut rival.ephemeris)) {
            let nearest = GpsTime::nearest(ephemeris.toe.tow_ms, present);
            if nearest.week.abs_diff(ephemeris.toe.week) == 1 {
                ephemeris.date(nearest);
            }
        }
    }

    /// Takes note of which satellites an epoch holds.
    pub fn observe(&mut self, satellites: impl Iterator<Item = SatelliteId>) {
        self.epochs = self.epochs.saturating_add(1);
        for satellite in satellites {
            if let Some(entry) = self.entries.iter_mut().find(|entry| entry.ephemeris.satellite == satellite)
            {
                (entry.observed, entry.was_seen) = (self.epochs, true);
            }
        }
    }

    /// Integrates the state vectors of the satellites that were observed last up to an instant, so that where they are
    /// then and soon after is a matter of one step. It changes no position.
    pub fn advance(&mut self, time: GpsTime) {
        let observed = self.entries.iter_mut().filter(|entry| entry.observed == self.epochs);
        observed.for_each(|entry| entry.ephemeris.advance(time));
    }

    /// The ephemeris of a satellite, if it may be used at that time.
    ///
    /// # Errors
    /// [`EphemerisError`] says why there is none.
    pub fn get(&self, satellite: SatelliteId, time: GpsTime) -> Result<&Ephemeris, EphemerisError> {
        self.get_edition(satellite, time).map(|(ephemeris, _)| ephemeris)
    }

    /// The same, with a number that is another where orbit or clock are others.
    ///
    /// # Errors
    /// As [`Self::get`].
    pub(crate) fn get_edition(
        &self,
        satellite: SatelliteId,
        time: GpsTime,
    ) -> Result<(&Ephemeris, u32), EphemerisError> {
        let entry = self.entries.iter().find(|entry| entry.ephemeris.satellite == satellite);
        let entry = entry.ok_or(EphemerisError::Missing)?;
        entry.ephemeris.usable_at(time)?;
        if entry.is_disputed { Err(EphemerisError::Disputed) } else { Ok((&entry.ephemeris, entry.edition)) }
    }

    /// How many satellites have an ephemeris, usable or not.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// True when no satellite has one.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Takes in a satellite of which nothing is known.
    fn admit(&mut self, entry: Entry, now: Option<GpsTime>) -> Insertion {
        let Err(entry) = self.entries.push(entry) else {
            return Insertion::Taken;
        };
        if is_stale(&entry.ephemeris, now) {
            return Insertion::Kept;
        }
        let since = self.epochs.saturating_sub(IN_SIGHT_EPOCHS);
        let worth = |entry: &&mut Entry| {
            let is_in_sight = entry.was_seen && entry.observed > since;
            (!is_stale(&entry.ephemeris, now), is_in_sight, entry.observed, entry.received)
        };
        if let Some(least) = self.entries.iter_mut().min_by_key(worth) {
            forget(&mut self.rivals, least.ephemeris.satellite);
            *least = entry;
        }
        Insertion::Taken
    }
}

impl Entry {
    /// Takes a set in the place of this one, as its rival, or not.
    fn consider(
        &mut self,
        mut offered: Ephemeris,
        received: u32,
        now: Option<GpsTime>,
        rivals: &mut Vec<Rival, RIVALS>,
    ) -> Insertion {
        let known = &mut self.ephemeris;
        let (is_useless, is_needed) = (is_stale(&offered, now), is_stale(known, now));
        if is_useless && !is_needed {
            return Insertion::Kept;
        }
        if !is_needed && (known.source, offered.source) == (Source::GalileoInav, Source::GalileoFnav) {
            known.merge_health(&offered);
            return Insertion::Kept;
        }
        offered.inherit_health(known, is_needed);
        let rival = rivals.iter_mut().find(|rival| rival.ephemeris.satellite == offered.satellite);
        if !is_needed && known.describes_as(&offered) {
            // The contradiction is kept in mind: it may be repeated.
            self.is_disputed &= rival.is_some_and(|rival| rival.is_repeated);
            *known = offered;
            return if self.is_disputed { Insertion::Disputed } else { Insertion::Taken };
        }
        if is_needed || agree(known, &offered, now) {
            return self.settle(offered, received, rivals);
        }
        self.is_disputed = true;
        match rival {
            Some(rival) if rival.ephemeris.describes_as(&offered) => rival.is_repeated = true,
            Some(rival) if agree(&rival.ephemeris, &offered, now) => {
                return self.settle(offered, received, rivals);
            }
            Some(rival) => *rival = Rival { ephemeris: offered, is_repeated: false },
            // Without room the known set alone waits for one that agrees.
            None => _ = rivals.push(Rival { ephemeris: offered, is_repeated: false }),
        }
        Insertion::Disputed
    }

    /// Takes a set that nothing contradicts any longer.
    fn settle(&mut self, agreed: Ephemeris, received: u32, rivals: &mut Vec<Rival, RIVALS>) -> Insertion {
        forget(rivals, agreed.satellite);
        (self.ephemeris, self.edition, self.is_disputed) = (agreed, received, false);
        Insertion::Taken
    }
}

/// True when a set is of no use now; without a time none is.
fn is_stale(ephemeris: &Ephemeris, now: Option<GpsTime>) -> bool {
    now.is_some_and(|now| ephemeris.is_stale(now))
}

/// True when two sets of a satellite put it at the same place with the same clock; without a time, half-way between
/// their reference times. What cannot be computed contradicts nothing.
fn agree(one: &Ephemeris, other: &Ephemeris, now: Option<GpsTime>) -> bool {
    if one.describes_as(other) {
        return true;
    }
    let when = now.unwrap_or_else(|| GpsTime::from_ms(u64::midpoint(one.toe.to_ms(), other.toe.to_ms())));
    let (Ok(one), Ok(other)) = (one.at(when, 0.0), other.at(when, 0.0)) else {
        return true;
    };
    let clock_m = SPEED_OF_LIGHT_M_S * (one.clock_s - other.clock_s).abs();
    one.position.distance_m(other.position) <= AGREEMENT_M && clock_m <= AGREEMENT_M
}

fn forget(rivals: &mut Vec<Rival, RIVALS>, satellite: SatelliteId) {
    rivals.retain(|rival| rival.ephemeris.satellite != satellite);
}
