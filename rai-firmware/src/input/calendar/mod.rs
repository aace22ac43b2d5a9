//! The present week, and time that only goes forward.
//!
//! Observations carry the second of the week, and ephemerides carry a week
//! ([`message_week`], [`roll_over`]). GPS counts weeks modulo 1,024: the week is
//! taken in the cycle nearest to the known time. Before any time is known, it is taken in the cycle
//! that begins with [`NOT_BEFORE_WEEK`].
//!
//! A wrong time on the wire does not last. An epoch older than the last one is dropped, but
//! [`RESTART_RUN`] such epochs that follow each other become the new time. A time that leaps ahead
//! is accepted.
//!
//! Confirmed time is stored separately. Satellites move by kilometres in a second. If the ranges of
//! an epoch agreed with orbits, its tag and the week of its ephemerides are therefore right. An
//! epoch that continues from there by the module's own clock ([`Tick::leads_to`]) is accepted at
//! once, in its week. No leap and no vote on the week in between changes this.
//!
//! The systems vote on the week ([`present_week`]).

mod leap_seconds;
mod message_week;
mod present_week;
mod roll_over;
mod week_votes;

use raim_core::satellite::Constellation;

use super::Counters;
use crate::counters::count;
use crate::time::{GpsTime, WEEK_MS};

use leap_seconds::LeapSeconds;
use present_week::{PresentWeek, Ruling};
use roll_over::dated;

#[cfg(feature = "glonass")]
pub(super) use leap_seconds::MOST_S;
#[cfg(feature = "osnma")]
pub(crate) use leap_seconds::begins_half_year;
pub use leap_seconds::{LeapSecond, LeapSource};
pub(super) use message_week::MessageWeek;
pub use message_week::NOT_BEFORE_WEEK;

/// Step of time that exceeds most gaps between epochs, ms.
const LEAP_MS: u64 = 60_000;

/// Number of consecutive older epochs that become the time.
const RESTART_RUN: u8 = 5;

/// Largest variation of the delay of epochs, measured by the module's own clock, ms.
const DELAY_MS: u64 = 3000;

/// Reciprocal of the largest relative error of the module's own clock.
const CLOCK_ERROR: u64 = 64;

/// Half of the cycle in which GPS counts weeks.
const HALF_CYCLE_WEEKS: u16 = 512;

/// Number of unconfirmed epochs after which the last confirmed one no longer overrules the votes,
/// because that one may itself have been wrong.
const DOUBT_EPOCHS: u16 = 600;

/// Calendar of the input.
#[derive(Debug)]
pub(super) struct Calendar {
    leap: LeapSeconds,
    /// Last epoch, or the reference time of an ephemeris before the first epoch.
    reference: Option<GpsTime>,
    /// Last epoch.
    last: Option<Tick>,
    /// Last epoch that was dropped because it was older, and the number of such epochs that
    /// followed each other.
    older: Option<(GpsTime, u8)>,
    /// Last epoch whose ranges agreed with orbits.
    confirmed: Option<Tick>,
    /// Number of epochs since the confirmed one.
    unconfirmed: u16,
    week: PresentWeek,
    /// True if the week was determined or corrected, so that earlier ephemerides may have a wrong
    /// week.
    is_redated: bool,
}

/// An epoch, and its arrival by the module's own clock, ms.
#[derive(Clone, Copy, Debug)]
struct Tick {
    time: GpsTime,
    came_ms: u64,
}

impl Tick {
    /// Returns the GPS time that corresponds to an arrival by the module's own clock.
    fn time_at(self, came_ms: u64) -> GpsTime {
        let passed_ms = came_ms.saturating_sub(self.came_ms);
        match u32::try_from(passed_ms).ok().filter(|&passed_ms| passed_ms < WEEK_MS) {
            Some(passed_ms) => self.time.later_by_ms(passed_ms),
            None => GpsTime::from_ms(self.time.to_ms().saturating_add(passed_ms)),
        }
    }

    /// Returns true if an epoch continues from this one by the module's own clock.
    fn leads_to(self, next: Self) -> bool {
        let error_ms = DELAY_MS + next.came_ms.saturating_sub(self.came_ms) / CLOCK_ERROR;
        next.time > self.time && next.time.since_ms(self.time_at(next.came_ms)).unsigned_abs() <= error_ms
    }

    /// Returns the epoch at `tow_ms` with this arrival, in the week that the module's own clock
    /// gives.
    fn next(self, tow_ms: u32, came_ms: u64) -> Self {
        Self { time: GpsTime::nearest(tow_ms, self.time_at(came_ms)), came_ms }
    }
}

/// Reason for which an epoch's time is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TimeError {
    WeekUnknown,
    Backwards,
    /// Too far ahead without evidence.
    Ahead,
}

impl TimeError {
    pub(super) fn counter(self, counters: &mut Counters) -> &mut u32 {
        match self {
            Self::WeekUnknown => &mut counters.epochs_without_week,
            Self::Backwards => &mut counters.epochs_backwards,
            Self::Ahead => &mut counters.observations_ahead,
        }
    }
}

impl Calendar {
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self {
            leap: LeapSeconds::new(),
            reference: None,
            last: None,
            older: None,
            confirmed: None,
            unconfirmed: 0,
            week: PresentWeek::new(),
            is_redated: false,
        }
    }

    /// Discards the confirmed epoch.
    pub(super) fn forget(&mut self) {
        self.confirmed = None;
    }

    /// Returns the last accepted epoch.
    pub(super) fn time(&self) -> Option<GpsTime> {
        self.last.map(|last| last.time)
    }

    /// Takes the time and the leap seconds that a receiver states.
    pub(super) fn hear_receiver(&mut self, time: GpsTime, leap_s: Option<u8>, counters: &mut Counters) {
        self.suppose(time, counters);
        if let Some(leap_s) = leap_s {
            self.hear_leap(leap_s, LeapSource::Receiver);
        }
    }

    /// Takes the time that a receiver states. It determines the week if nothing else does, and
    /// decides if the ephemerides leave two weeks. Ephemerides may outvote it. A week before
    /// [`NOT_BEFORE_WEEK`] is ignored, because some receivers count an earlier cycle.
    fn suppose(&mut self, time: GpsTime, counters: &mut Counters) {
        if time.week < NOT_BEFORE_WEEK {
            return;
        }
        if self.week.awaits_epoch() {
            self.name_week(time.tow_ms);
        }
        match self.reference {
            Some(reference) => {
                let ruling = self.week.hear_time(time, reference);
                self.obey(ruling, reference, counters);
            }
            None => self.reference = Some(time),
        }
    }

    /// Takes the week of the next epoch from a trusted source, in any cycle of GPS weeks.
    pub(super) fn assume(&mut self, week: u16) {
        // The middle of the week is within half a week of each of its seconds, so that it selects
        // the week.
        self.reference = Some(GpsTime { week, tow_ms: WEEK_MS / 2 });
        (self.last, self.older, self.confirmed) = (None, None, None);
        self.week = PresentWeek::new();
    }

    /// Returns the present if its week was determined or corrected since the last call, so that
    /// earlier ephemerides must be dated again.
    pub(super) fn take_redating(&mut self) -> Option<GpsTime> {
        self.reference.filter(|_| core::mem::take(&mut self.is_redated))
    }

    /// Dates the first epoch, at `tow_ms`, by the ephemerides that came before it.
    fn name_week(&mut self, tow_ms: u32) {
        if let Some((present, is_off)) = self.week.first_epoch(tow_ms) {
            (self.reference, self.is_redated) = (Some(present), is_off);
        }
    }

    /// Takes a stated number of leap seconds.
    pub(super) fn hear_leap(&mut self, seconds: u8, source: LeapSource) {
        self.leap.receive(seconds, source, self.time());
    }

    /// Takes a message of the open epoch that is tagged with UTC.
    pub(super) fn infer_leap(&mut self, gps_ms: u32, utc_ms: u32) {
        self.leap.infer(gps_ms, utc_ms, self.time());
    }

    /// Returns true while a leap second may be inserted.
    pub(super) fn is_step_due(&self) -> bool {
        self.leap.is_step_due(self.time())
    }

    /// Returns true if a tag of UTC that is the first of its instant may be wrong by a second.
    pub(super) fn is_unsure(&self, utc_ms: u32) -> bool {
        self.leap.is_unsure(utc_ms, self.time())
    }

    /// Returns GPS time minus UTC, with its source and time.
    pub(super) fn leap_second(&self) -> Option<LeapSecond> {
        self.leap.known()
    }

    /// Returns the approximate present: the last epoch or, before the first epoch, the reference
    /// time of an ephemeris.
    pub(super) fn present(&self) -> Option<GpsTime> {
        self.reference
    }

    /// Returns the instant of an epoch at `tow_ms` that came at `came_ms`, if time advances to it.
    pub(super) fn advance(
        &mut self,
        tow_ms: u32,
        came_ms: u64,
        counters: &mut Counters,
    ) -> Result<GpsTime, TimeError> {
        self.name_week(tow_ms);
        let reference = self.reference.ok_or(TimeError::WeekUnknown)?;
        let as_confirmed = self.as_confirmed(tow_ms, came_ms);
        let Some(last) = self.last else {
            let next = Tick { time: GpsTime::nearest(tow_ms, reference), came_ms };
            return Ok(self.set(as_confirmed.unwrap_or(next)));
        };
        let next = as_confirmed.unwrap_or_else(|| last.next(tow_ms, came_ms));
        if next.time <= last.time {
            if as_confirmed.is_none() && !self.follows_older(next.time) {
                return Err(TimeError::Backwards);
            }
            count(&mut counters.time_restarts);
        }
        Ok(self.set(next))
    }

    /// Returns the epoch at `tow_ms` if it continues from the confirmed epoch, but not from the
    /// last one.
    fn as_confirmed(&self, tow_ms: u32, came_ms: u64) -> Option<Tick> {
        let confirmed = self.confirmed.filter(|_| self.unconfirmed < DOUBT_EPOCHS)?;
        let is_on_line = |last: Tick| last.time == confirmed.time || confirmed.leads_to(last);
        if self.last.is_some_and(is_on_line) {
            return None;
        }
        Some(confirmed.next(tow_ms, came_ms)).filter(|&next| confirmed.leads_to(next))
    }

    /// Confirms an epoch that came at `came_ms`, because its ranges agreed with orbits.
    pub(super) fn confirm(&mut self, time: GpsTime, came_ms: u64) {
        // While the week is in doubt, agreement is no evidence: ranges agree as well with orbits
        // that are all dated a week early.
        if !self.week.is_in_doubt() {
            (self.confirmed, self.unconfirmed) = (Some(Tick { time, came_ms }), 0);
        }
    }

    fn set(&mut self, tick: Tick) -> GpsTime {
        self.older = None;
        self.unconfirmed = self.unconfirmed.saturating_add(1);
        self.reference = Some(tick.time);
        self.last = Some(tick);
        tick.time
    }

    /// Returns the instant of an epoch at `tow_ms` without satellites. Such an epoch does not
    /// advance time, and it is refused before an epoch with satellites.
    pub(super) fn foresee(&self, tow_ms: u32) -> Result<GpsTime, TimeError> {
        let last = self.time().ok_or(TimeError::Ahead)?;
        let time = GpsTime::nearest(tow_ms, last);
        match time > last {
            true if follows(time, last) => Ok(time),
            true => Err(TimeError::Ahead),
            false => Err(TimeError::Backwards),
        }
    }

    /// Notes an epoch older than the last one. Returns true if enough such epochs have followed
    /// each other.
    fn follows_older(&mut self, time: GpsTime) -> bool {
        let run = match self.older {
            Some((before, run)) if time > before => run.saturating_add(1),
            // A message of another system for the same instant.
            Some((before, run)) if time == before => run,
            _ => 1,
        };
        self.older = Some((time, run));
        run >= RESTART_RUN
    }

    /// Takes an ephemeris that states this reference time. Returns the reference time that it means
    /// at the known present.
    pub(super) fn learn(
        &mut self,
        system: Constellation,
        stated: GpsTime,
        counters: &mut Counters,
    ) -> GpsTime {
        // An ephemeris of GLONASS states no week; the present has dated it.
        if system == Constellation::Glonass {
            return stated;
        }
        let Some(reference) = self.reference else {
            self.week.begin((system, stated));
            self.reference = Some(stated);
            return stated;
        };
        let ruling = self.week.receive((system, stated), reference);
        self.obey(ruling, reference, counters);
        if ruling != Ruling::Stands && self.week.awaits_epoch() {
            self.week.begin((system, stated));
            self.reference = Some(stated);
        }
        match self.reference.filter(|_| !self.week.awaits_epoch()) {
            Some(now) => dated(system, stated, now),
            None => stated,
        }
    }

    fn obey(&mut self, ruling: Ruling, reference: GpsTime, counters: &mut Counters) {
        match ruling {
            Ruling::Stands => return,
            Ruling::Moved(weeks) => {
                let moved = |time: GpsTime| time.later_by_weeks(weeks);
                self.reference = Some(moved(reference));
                self.last = self.last.map(|last| Tick { time: moved(last.time), ..last });
                self.older = None;
                self.is_redated = true;
            }
            Ruling::Replaced(present) => {
                (self.reference, self.last, self.older) = (Some(present), None, None);
                // Ranges agree with orbits of GPS in every cycle, so that confirmed time is no
                // evidence here.
                let is_cycle = present.week.abs_diff(reference.week) > HALF_CYCLE_WEEKS;
                self.confirmed = self.confirmed.filter(|_| !is_cycle);
            }
        }
        count(&mut counters.week_corrections);
    }

    /// Returns the instant that a message states with its week and `tow_s` of its own system.
    pub(super) fn stated(&self, message: MessageWeek, tow_s: u32) -> Option<GpsTime> {
        message.stated(tow_s, self.reference)
    }
}

/// Returns true if an epoch follows another one without a leap.
fn follows(time: GpsTime, before: GpsTime) -> bool {
    time > before && time.since_ms(before).unsigned_abs() <= LEAP_MS
}

#[cfg(test)]
mod tests;
