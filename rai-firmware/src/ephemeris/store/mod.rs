//! Ephemerides in use: the last set of each satellite in sight.
//!
//! ```text
//! offered is stale now                       nothing changes, unless the known set is stale or missing too
//! known is stale or unknown                  offered is taken
//! m + Σ m ≤ 10 m                             offered replaces what is known
//! else                                       neither is used until a third agrees with one of them
//!
//! m = |X' − X| + c|Δt' − Δt|                 at the present time
//! ```
//!
//! `X`, `Δt` are position and clock by the known set, `X'`, `Δt'` those by the offered one. `m` bounds
//! the change of a range. `Σ m` is the sum of a satellite's changes, of which [`FORGIVEN`] is
//! forgiven every 9 minutes. Without the sum, a series of sets could carry a satellite anywhere. In
//! 2,000 changes of sets in seven recordings, `m` was 4.7 m at most.
//!
//! **Choice.** The set received last is used, and not the set with the latest reference time,
//! because a set for a later period is worse now. A set that is out of date (past or future) never
//! replaces a current one, and any current one replaces it.
//!
//! **Contradiction.** Two current sets of one satellite describe one orbit and differ by a few
//! metres. If they differ by more, one of them is wrong, and it is unknown which. The third set
//! that decides must be a new one, because another copy of the contradicting set is no new
//! evidence. Against the known set it decides only 9 to 17 minutes after the contradiction, because
//! satellites change their sets every 10 minutes at most, and only if the known set did not come
//! again meanwhile. If the contradicting set came only once, for example from a damaged message, a copy of
//! the known set cancels it. If it was repeated, copies decide nothing. A satellite that changes
//! its orbit is out of use until its second new set.
//!
//! **Origin.** Bits of the receiver outrank a set that it decoded, and this one outranks a set of RTCM,
//! which a caster may have sent. While the known set is current, none of a lesser origin is
//! considered, and one of a better origin replaces it.
//!
//! **Galileo** sends two messages. I/NAV has both group delays and thus serves every pair of
//! signals. The orbit of F/NAV replaces it only if it is stale. The health that each message
//! reports of its signals counts at once ([`Ephemeris::merge_health`]).
//!
//! **Room** for [`CAPACITY`] satellites, as many as an epoch has: 64 take 9 KiB, and four systems
//! never have more in view. A stream may carry twice as many. If the store is full, the least
//! useful set is displaced, in this order:
//!
//! 1. a stale set;
//! 2. a satellite that was not in the last epochs ([`Sight`]), with or without a set;
//! 3. the satellite farthest below the horizon of the last position, if one is known;
//! 4. the satellite that was observed longest ago; a new satellite counts as one that has just gone
//!    below the horizon;
//! 5. a satellite of the system with the most sets, so that no system occupies the whole store at
//!    start;
//! 6. the set that was received first.
//!
//! A new set that the first three criteria rank below all others is not stored.
//! [`Store::displaced`] counts the displaced sets of satellites in sight. [`RIVALS`] contradicting
//! sets are stored. If there are more, the known set stays and counts as disputed.
//!
//! **Decoded sets.** A decoded set of the issue that is known by its bits renews health and accuracy.
//!
//! **State vectors** are integrated, and the part that the next epochs share is stored
//! ([`Store::advance`]).

#[cfg(feature = "osnma")]
mod proof;
mod signals;

use core::cmp::Reverse;

use heapless::Vec;
use nalgebra::Vector3;
use raim_core::frame::Ecef;
use raim_core::internals::numeric::sqrt;
use raim_core::satellite::{Constellation, SatelliteId};

#[cfg(feature = "cnav")]
use super::cnav::Cnav;
use super::sight::{Elevation, HORIZON, Sight, Skyline};
use super::{Ephemeris, EphemerisError, Source, difference_m, scaled};
use crate::counters::count;
use crate::time::GpsTime;
#[cfg(feature = "osnma")]
pub(crate) use proof::Demand;

/// Number of satellites that the store holds, as many as a raw epoch.
pub const CAPACITY: usize = crate::raw::EPOCH_CAPACITY;

/// Number of contradicting sets that the store holds.
const RIVALS: usize = 6;

/// Largest sum of the changes of a satellite, eighths of a metre: 10 m, three sigma of the poorest.
const AGREEMENT: u8 = 80;

/// Part of that sum that is forgiven in each period, eighths of a metre: 8.6 m an hour.
const FORGIVEN: u8 = 10;

/// Length of a period, ms, as a power of two: 8.7 minutes.
const PERIOD_POWER: u32 = 19;

/// Number of periods after which a third set may decide against the known one.
const DECIDED_AFTER: u8 = 2;

// A verdict of the authentication takes a word more.
const _: () = assert!(size_of::<Entry>() <= if cfg!(feature = "osnma") { 152 } else { 144 });

/// Outcome of offering an ephemeris.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Insertion {
    /// The offered set is in use now.
    Taken,
    /// The set in use, or those of other satellites in a full store, are more useful. At most the
    /// health of the set's own signals was copied.
    Kept,
    /// The offered set contradicts the one in use, and neither is used.
    Disputed,
}

/// The set of one satellite, and its history.
#[derive(Clone, Debug)]
struct Entry {
    ephemeris: Ephemeris,
    /// Number of the last epoch with the satellite. If it was in no epoch: the number of the last
    /// epoch but one when the set was received.
    observed: u32,
    /// Number of the ephemeris among all that were offered.
    received: u32,
    /// Number of the first ephemeris with the same orbit and clock.
    edition: u32,
    is_disputed: bool,
    /// Sum of the changes of orbit and clock, eighths of a metre.
    moved: u8,
    /// Elevation of the satellite when it was last computed.
    elevation: Elevation,
}

/// A set that contradicts the known set of a satellite.
#[derive(Clone, Debug)]
struct Rival {
    ephemeris: Ephemeris,
    /// True if the set was received more than once.
    is_repeated: bool,
    /// Period in which the set came, or the known one again.
    period: u8,
}

/// Ephemerides in use.
#[derive(Clone, Debug, Default)]
pub struct Store {
    entries: Vec<Entry, CAPACITY>,
    rivals: Vec<Rival, RIVALS>,
    epochs: u32,
    received: u32,
    sight: Sight,
    /// Sky at the last position that was known while the store was full.
    skyline: Option<Skyline>,
    displaced: u32,
    /// Number of the present period since the week began, modulo 256.
    period: u8,
    #[cfg(feature = "cnav")]
    cnav: Cnav,
    #[cfg(feature = "osnma")]
    demand: Demand,
}

impl Store {
    /// Returns a store without ephemerides.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub const fn new() -> Self {
        Self {
            entries: Vec::new(),
            rivals: Vec::new(),
            epochs: 0,
            received: 0,
            sight: Sight::new(),
            skyline: None,
            displaced: 0,
            period: 0,
            #[cfg(feature = "cnav")]
            cnav: Cnav::new(),
            #[cfg(feature = "osnma")]
            demand: Demand::Nothing,
        }
    }

    /// Offers an ephemeris. `now` is the time of the last epoch, if there was one.
    pub fn insert(&mut self, offered: Ephemeris, now: Option<GpsTime>) -> Insertion {
        self.received = self.received.saturating_add(1);
        let received = self.received;
        self.pass_time(now);
        let known = self.entries.iter_mut().find(|entry| entry.ephemeris.satellite == offered.satellite);
        let Some(entry) = known else {
            // The satellite may be about to rise. It is less useful than those in sight, but more
            // useful than any other.
            let observed = self.epochs.saturating_sub(1);
            let entry = Entry {
                ephemeris: offered,
                observed,
                received,
                edition: received,
                is_disputed: false,
                moved: 0,
                elevation: HORIZON,
            };
            return self.admit(entry, now);
        };
        let insertion = entry.consider(offered, received, now, self.period, &mut self.rivals);
        if insertion == Insertion::Taken {
            entry.received = received;
        }
        insertion
    }

    /// Begins a new period if its time has come.
    fn pass_time(&mut self, now: Option<GpsTime>) {
        let Some(now) = now else { return };
        let period = (now.tow_ms >> PERIOD_POWER) as u8;
        if core::mem::replace(&mut self.period, period) != period {
            self.entries.iter_mut().for_each(|entry| entry.moved = entry.moved.saturating_sub(FORGIVEN));
        }
    }

    /// Discards all sets of a system.
    pub fn forget(&mut self, constellation: Constellation) {
        self.entries.retain(|entry| entry.ephemeris.satellite.constellation() != constellation);
        self.rivals.retain(|rival| rival.ephemeris.satellite.constellation() != constellation);
    }

    /// Moves sets that are dated a week from the present into its week, because the week was
    /// determined or corrected after they came.
    pub fn redate(&mut self, present: GpsTime) {
        let entries = self.entries.iter_mut().map(|entry| &mut entry.ephemeris);
        for ephemeris in entries.chain(self.rivals.iter_mut().map(|rival| &mut rival.ephemeris)) {
            let nearest = GpsTime::nearest(ephemeris.toe.tow_ms, present);
            if nearest.week.abs_diff(ephemeris.toe.week) == 1 {
                ephemeris.date(nearest);
            }
        }
    }

    /// Records the satellites of an epoch.
    pub fn observe(&mut self, satellites: impl Iterator<Item = SatelliteId>) {
        self.epochs = self.epochs.saturating_add(1);
        self.sight.begin();
        for satellite in satellites {
            self.sight.add(satellite);
            if let Some(entry) = self.entries.iter_mut().find(|entry| entry.ephemeris.satellite == satellite)
            {
                entry.observed = self.epochs;
            }
        }
    }

    /// Takes the position of the receiver at the last epoch, and the elevation mask. If the store
    /// is full, each call computes the elevation of one satellite. All are thus renewed before any
    /// satellite has moved by a degree.
    #[inline(never)]
    pub fn look_from(&mut self, receiver: Ecef, mask_rad: f64, now: GpsTime) {
        if !self.entries.is_full() {
            return;
        }
        let skyline = Skyline::new(receiver, mask_rad);
        self.skyline = Some(skyline);
        let turn = self.epochs as usize % CAPACITY;
        if let Some(entry) = self.entries.get_mut(turn) {
            entry.elevation = skyline.elevation(&entry.ephemeris, now);
        }
    }

    /// Discards the position of the receiver.
    pub fn forget_position(&mut self) {
        self.skyline = None;
        self.entries.iter_mut().for_each(|entry| entry.elevation = HORIZON);
    }

    /// Returns the number of sets that were displaced although their satellites were in the last
    /// epochs or above the mask.
    pub fn displaced(&self) -> u32 {
        self.displaced
    }

    /// Integrates the state vectors of the satellites in the last epoch up to an instant. Positions
    /// at and soon after it then take one step. No position changes.
    pub fn advance(&mut self, time: GpsTime) {
        let observed = self.entries.iter_mut().filter(|entry| entry.observed == self.epochs);
        observed.for_each(|entry| entry.ephemeris.advance(time));
    }

    /// Returns the ephemeris of a satellite, if it may be used at that time.
    ///
    /// # Errors
    /// [`EphemerisError`] states why none may be used.
    pub fn get(&self, satellite: SatelliteId, time: GpsTime) -> Result<&Ephemeris, EphemerisError> {
        self.get_edition(satellite, time).map(|(ephemeris, _)| ephemeris)
    }

    /// Returns the ephemeris, and a number that changes if orbit or clock change.
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
        #[cfg(feature = "osnma")]
        if !self.demand.is_met_by(&entry.ephemeris) {
            return Err(EphemerisError::Unproved);
        }
        if entry.is_disputed { Err(EphemerisError::Disputed) } else { Ok((&entry.ephemeris, entry.edition)) }
    }

    /// Returns the number of satellites with an ephemeris, usable or not.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Returns true if no satellite has an ephemeris.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Admits a satellite without a set so far.
    fn admit(&mut self, entry: Entry, now: Option<GpsTime>) -> Insertion {
        let Err(mut entry) = self.entries.push(entry) else {
            return Insertion::Taken;
        };
        if is_stale(&entry.ephemeris, now) {
            return Insertion::Kept;
        }
        let Self { entries, rivals, sight, skyline, displaced, .. } = self;
        if let Some((skyline, now)) = skyline.zip(now) {
            entry.elevation = skyline.elevation(&entry.ephemeris, now);
        }
        let use_of = |entry: &Entry| {
            let is_in_sight = sight.has(entry.ephemeris.satellite);
            (
                !is_stale(&entry.ephemeris, now),
                is_in_sight,
                if is_in_sight { HORIZON } else { entry.elevation },
            )
        };
        let mut sets = [0_u8; Constellation::COUNT];
        for entry in &*entries {
            let system = entry.ephemeris.satellite.constellation();
            if let Some(sets) = sets.get_mut(usize::from(system as u8)) {
                *sets += 1;
            }
        }
        let sets_of =
            |entry: &Entry| sets.get(usize::from(entry.ephemeris.satellite.constellation() as u8)).copied();
        let worth =
            |entry: &&mut Entry| (use_of(entry), entry.observed, Reverse(sets_of(entry)), entry.received);
        let Some(least) = entries.iter_mut().min_by_key(worth) else { return Insertion::Kept };
        let is_taken = use_of(&entry) >= use_of(least);
        if is_taken {
            core::mem::swap(least, &mut entry);
        }
        let lost = entry;
        let is_above = skyline.is_some_and(|skyline| skyline.shows(lost.elevation));
        if !is_stale(&lost.ephemeris, now) && (is_above || sight.has(lost.ephemeris.satellite)) {
            count(displaced);
        }
        forget(rivals, lost.ephemeris.satellite);
        if is_taken { Insertion::Taken } else { Insertion::Kept }
    }
}

impl Entry {
    /// Considers another set: replaces this one, stores it as its rival, or discards it.
    fn consider(
        &mut self,
        mut offered: Ephemeris,
        received: u32,
        now: Option<GpsTime>,
        period: u8,
        rivals: &mut Vec<Rival, RIVALS>,
    ) -> Insertion {
        let known = &mut self.ephemeris;
        let is_needed = is_stale(known, now);
        let is_outranked = offered.origin < known.origin;
        #[cfg(feature = "sbf")]
        if !is_needed
            && !self.is_disputed
            && is_outranked
            && offered.is_issue_of(known)
            && change(known, &offered, now) <= AGREEMENT
        {
            known.merge_decoded(&offered);
        }
        if !is_needed && (is_outranked || is_stale(&offered, now)) {
            return Insertion::Kept;
        }
        // A set of a better origin needs no agreement.
        let is_needed = is_needed || offered.origin > known.origin;
        if !is_needed && (known.source, offered.source) == (Source::GalileoInav, Source::GalileoFnav) {
            known.merge_health(&offered);
            return Insertion::Kept;
        }
        offered.inherit_health(known, is_needed);
        let rival = rivals.iter_mut().find(|rival| rival.ephemeris.satellite == offered.satellite);
        if !is_needed && known.describes_as(&offered) {
            // The rival stays, because it may be repeated. It must wait anew for a third set, because
            // the known one is still sent.
            self.is_disputed &= rival.is_some_and(|rival| {
                rival.period = period;
                rival.is_repeated
            });
            *known = offered;
            return if self.is_disputed { Insertion::Disputed } else { Insertion::Taken };
        }
        let more = if is_needed { 0 } else { change(known, &offered, now) };
        let moved = self.moved.saturating_add(more);
        if moved <= AGREEMENT {
            self.moved = moved;
            return self.settle(offered, received, rivals);
        }
        self.is_disputed = true;
        if let Some(rival) = rival {
            if rival.ephemeris.describes_as(&offered) {
                rival.is_repeated = true;
                return Insertion::Disputed;
            }
            // The rival stays, so that no series of sets leads away from it.
            if change(&rival.ephemeris, &offered, now) <= AGREEMENT {
                if now.is_none() || period.wrapping_sub(rival.period) >= DECIDED_AFTER {
                    return self.settle(offered, received, rivals);
                }
                return Insertion::Disputed;
            }
            forget(rivals, offered.satellite);
        }
        // Without room for a rival, the known set waits for a set that agrees with it.
        let _ = rivals.push(Rival { ephemeris: offered, is_repeated: false, period });
        Insertion::Disputed
    }

    /// Takes a set without contradiction.
    fn settle(&mut self, agreed: Ephemeris, received: u32, rivals: &mut Vec<Rival, RIVALS>) -> Insertion {
        forget(rivals, agreed.satellite);
        (self.ephemeris, self.edition, self.is_disputed) = (agreed, received, false);
        Insertion::Taken
    }
}

/// Returns true if a set is stale now; false without a time.
// Not inlined, so that its many callers share one copy.
#[inline(never)]
fn is_stale(ephemeris: &Ephemeris, now: Option<GpsTime>) -> bool {
    now.is_some_and(|now| ephemeris.is_stale(now))
}

/// Returns by how much a range changes with another set of its satellite at most, eighths of a metre,
/// at the present time; without a time, half-way between their reference times. A set that cannot
/// be computed changes nothing.
// Not inlined, so that its two callers share one copy.
#[inline(never)]
fn change(one: &Ephemeris, other: &Ephemeris, now: Option<GpsTime>) -> u8 {
    let when = now.unwrap_or_else(|| GpsTime::from_ms(u64::midpoint(one.toe.to_ms(), other.toe.to_ms())));
    let (Ok(one), Ok(other)) = (one.seen_at(when, 0.0), other.seen_at(when, 0.0)) else {
        return 0;
    };
    let way_m = Vector3::from(difference_m(other.place(), one.place()));
    let later_m = scaled(other.clock_m32() - one.clock_m32(), -32) as f32;
    let moved_m = sqrt(way_m.dot(&way_m)) + later_m.abs();
    // Rounded up; the conversion saturates.
    (8.0 * moved_m + 1.0) as u8
}

fn forget(rivals: &mut Vec<Rival, RIVALS>, satellite: SatelliteId) {
    rivals.retain(|rival| rival.ephemeris.satellite != satellite);
}

#[cfg(test)]
mod tests;
