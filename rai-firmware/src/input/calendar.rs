//! Which week it is, and that time goes forward.
//!
//! Observations say only where in the week they are; ephemerides say the week ([`super::message_week`]). That of GPS is taken in
//! the cycle of 1,024 nearest to the known time, and before any time is known in the cycle that begins with [`NOT_BEFORE_WEEK`].
//!
//! Nothing on the wire is accepted for ever. A time that goes back is dropped, but [`RESTART_RUN`] epochs in a row
//! that are older and follow each other are the new time. A time that leaps ahead is the time.
//!
//! What is known better is remembered: satellites move by kilometres in a second, so an epoch whose ranges agreed with their orbits
//! was at the instant of its tag, and in the week of its ephemerides. An epoch that goes on from there by the module's own clock
//! ([`Tick::leads_to`]) is the time at once, in its week, whatever came between: leaps, however many, and votes on the week.
//!
//! The week is the systems' to vote on ([`super::week_votes`]).

use rai_core::satellite::Constellation;

use super::Counters;
use super::leap_seconds::{LeapSecond, LeapSeconds, LeapSource};
use super::message_week::{MessageWeek, NOT_BEFORE_WEEK, Side};
use super::week_votes::{Vote, WeekVotes};
use crate::counters::count;
use crate::time::{GpsTime, WEEK_MS};

/// A step of time that is longer than a gap between epochs mostly is, ms.
const LEAP_MS: u64 = 60_000;

/// Epochs in a row that make an older time the time.
const RESTART_RUN: u8 = 5;

/// How much an epoch's way to the own clock may vary, ms.
const DELAY_MS: u64 = 3000;

/// Half of the cycle in which GPS counts weeks.
const HALF_CYCLE_WEEKS: u64 = 512;

/// The own clock may be wrong by a part in so many.
const CLOCK_ERROR: u64 = 64;

/// How far from the present a reference time confirms the week, ms: three days, for orbits uploaded long ago.
const AGREEMENT_MS: u64 = 3 * 86_400_000;

/// Epochs that agreed with nothing after which what was confirmed does not stand against the votes any more: it may itself have
/// been wrong.
const DOUBT_EPOCHS: u16 = 600;

/// The time line.
#[derive(Debug)]
pub(super) struct Calendar {
    leap: LeapSeconds,
    /// The last epoch, or the reference time of an ephemeris before there was one.
    reference: Option<GpsTime>,
    /// The last epoch.
    last: Option<Tick>,
    /// The last epoch that was dropped because it was older, and how many followed each other.
    older: Option<(GpsTime, u8)>,
    /// The last epoch whose ranges agreed with orbits.
    confirmed: Option<Tick>,
    /// Epochs since.
    unconfirmed: u16,
    /// On which side of a roll-over all the sets lie that have said the week, where it is near one: it may be the week in which they
    /// were transmitted, and not theirs.
    one_sided: Option<Side>,
    votes: WeekVotes,
}

/// An epoch, and when it came by the own clock, ms.
#[derive(Clone, Copy, Debug)]
struct Tick {
    time: GpsTime,
    came_ms: u64,
}

impl Tick {
    /// What time it is when an epoch comes, by the own clock.
    fn time_at(self, came_ms: u64) -> GpsTime {
        let passed_ms = came_ms.saturating_sub(self.came_ms);
        match u32::try_from(passed_ms).ok().filter(|&passed_ms| passed_ms < WEEK_MS) {
            Some(passed_ms) => self.time.later_by_ms(passed_ms),
            None => GpsTime::from_ms(self.time.to_ms().saturating_add(passed_ms)),
        }
    }

    /// Whether an epoch goes on from here by the own clock.
    fn leads_to(self, next: Self) -> bool {
        let error_ms = DELAY_MS + next.came_ms.saturating_sub(self.came_ms) / CLOCK_ERROR;
        next.time > self.time && next.time.since_ms(self.time_at(next.came_ms)).unsigned_abs() <= error_ms
    }

    /// The epoch at `tow_ms` that came then, in the week that the own clock tells.
    fn next(self, tow_ms: u32, came_ms: u64) -> Self {
        Self { time: GpsTime::nearest(tow_ms, self.time_at(came_ms)), came_ms }
    }
}

/// Why an epoch's time is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TimeError {
    WeekUnknown,
    Backwards,
    /// So far ahead that something has to vouch for it, and nothing does.
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
    pub(super) const fn new() -> Self {
        Self {
            leap: LeapSeconds::new(),
            reference: None,
            last: None,
            older: None,
            confirmed: None,
            unconfirmed: 0,
            one_sided: None,
            votes: WeekVotes::none(),
        }
    }

    /// No epoch is confirmed any more.
    pub(super) fn forget(&mut self) {
        self.confirmed = None;
    }

    /// The last epoch accepted.
    pub(super) fn time(&self) -> Option<GpsTime> {
        self.last.map(|last| last.time)
    }

    /// A receiver says what time it is. Believed where nothing else says it; ephemerides may outvote it.
    /// Whose weeks are of an earlier cycle than can be, as those of old receivers are, says nothing.
    pub(super) fn suppose(&mut self, time: GpsTime) {
        if time.week >= NOT_BEFORE_WEEK {
            self.reference.get_or_insert(time);
        }
    }

    /// Somebody says how many leap seconds there are.
    pub(super) fn hear_leap(&mut self, seconds: u8, source: LeapSource) {
        self.leap.hear(seconds, source, self.time());
    }

    /// A message of the open epoch is tagged with UTC.
    pub(super) fn infer_leap(&mut self, gps_ms: u32, utc_ms: u32) {
        self.leap.infer(gps_ms, utc_ms, self.time());
    }

    /// GPS time minus UTC, who said so and when.
    pub(super) fn leap_second(&self) -> Option<LeapSecond> {
        self.leap.known()
    }

    /// About when it is: the last epoch or, before there was one, the reference time of an ephemeris.
    pub(super) fn present(&self) -> Option<GpsTime> {
        self.reference
    }

    /// The instant of an epoch at `tow_ms` that came at `came_ms`, if time goes on to it.
    pub(super) fn advance(
        &mut self,
        tow_ms: u32,
        came_ms: u64,
        counters: &mut Counters,
    ) -> Result<GpsTime, TimeError> {
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

    /// The epoch at `tow_ms`, if it goes on from the one that was confirmed and what came between does not.
    fn as_confirmed(&self, tow_ms: u32, came_ms: u64) -> Option<Tick> {
        let confirmed = self.confirmed.filter(|_| self.unconfirmed < DOUBT_EPOCHS)?;
        let is_on_line = |last: Tick| last.time == confirmed.time || confirmed.leads_to(last);
        if self.last.is_some_and(is_on_line) {
            return None;
        }
        Some(confirmed.next(tow_ms, came_ms)).filter(|&next| confirmed.leads_to(next))
    }

    /// The ranges of an epoch that came at `came_ms` agreed with orbits.
    pub(super) fn confirm(&mut self, time: GpsTime, came_ms: u64) {
        // Of sets that are all dated a week early, and say so alike, ranges agree with the orbits as well.
        if self.one_sided.is_none() {
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

    /// The instant of an epoch at `tow_ms` that has no satellites to vouch for it: time does not go on to it, and it is none
    /// before an epoch that has satellites.
    pub(super) fn foresee(&self, tow_ms: u32) -> Result<GpsTime, TimeError> {
        let last = self.time().ok_or(TimeError::Ahead)?;
        let time = GpsTime::nearest(tow_ms, last);
        match time > last {
            true if follows(time, last) => Ok(time),
            true => Err(TimeError::Ahead),
            false => Err(TimeError::Backwards),
        }
    }

    /// Notes an epoch older than the last one; true when enough of them have followed each other.
    fn follows_older(&mut self, time: GpsTime) -> bool {
        let run = match self.older {
            Some((before, run)) if time > before => run.saturating_add(1),
            // The next system's message of the same instant.
            Some((before, run)) if time == before => run,
            _ => 1,
        };
        self.older = Some((time, run));
        run >= RESTART_RUN
    }

    /// Lets an ephemeris of a system vote on the week. The first one says it, and has no vote besides.
    pub(super) fn learn(&mut self, system: Constellation, toe: GpsTime, counters: &mut Counters) {
        let Some(reference) = self.reference else {
            (self.reference, self.one_sided) = (Some(toe), Side::of(toe));
            return;
        };
        // One of GLONASS is dated by what is in doubt.
        let is_dated = system != Constellation::Glonass;
        if is_dated && self.one_sided.is_some() && self.one_sided != Side::of(toe) {
            return self.take_week_of(toe, reference, counters);
        }
        let apart_ms = toe.since_ms(reference).unsigned_abs();
        let is_cycle = apart_ms > HALF_CYCLE_WEEKS * u64::from(WEEK_MS);
        let agrees = apart_ms <= AGREEMENT_MS;
        self.votes.count(system, if is_cycle { Vote::OtherCycle } else { Vote::of(agrees) });
        if !agrees && self.votes.contradict() {
            count(&mut counters.week_corrections);
            self.votes = self.votes.of_the_other_week();
            (self.reference, self.last, self.older) = (Some(toe), None, None);
            // Ranges agree with orbits of GPS in every cycle.
            self.confirmed = self.confirmed.filter(|_| !is_cycle);
        }
    }

    /// A set lies elsewhere than those that have said the week so far: it is in its own.
    fn take_week_of(&mut self, toe: GpsTime, reference: GpsTime, counters: &mut Counters) {
        self.one_sided = None;
        if toe.since_ms(reference).unsigned_abs() > AGREEMENT_MS {
            count(&mut counters.week_corrections);
            self.votes = WeekVotes::none();
            (self.reference, self.last, self.older) = (Some(toe), None, None);
        }
    }

    /// The instant that a message means with its week and `tow_s` of its own system.
    pub(super) fn resolve(&self, message: MessageWeek, tow_s: u32) -> Option<GpsTime> {
        message.instant(tow_s, self.reference, self.one_sided)
    }
}

/// Whether an epoch comes after another one within what is no leap.
fn follows(time: GpsTime, before: GpsTime) -> bool {
    time > before && time.since_ms(before).unsigned_abs() <= LEAP_MS
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::GALILEO_WEEK_OFFSET;

    #[test]
    fn an_older_time_comes_back_though_every_system_ends_its_own_epoch() {
        let (mut calendar, mut counters) = (Calendar::new(), Counters::default());
        calendar.learn(Constellation::Gps, GpsTime { week: 2111, tow_ms: 0 }, &mut counters);
        assert!(calendar.advance(90_000_000, 0, &mut counters).is_ok());
        let older = (1..=5).flat_map(|second| [second * 1000; 2]);
        let accepted = older.filter(|&tow_ms| calendar.advance(tow_ms, 0, &mut counters).is_ok()).count();
        assert_eq!((accepted, calendar.time()), (1, Some(GpsTime { week: 2111, tow_ms: 5000 })));
    }

    /// Seconds of the week, and when they come, s; and which of them are the time, s after the beginning of week 2111. One may
    /// be confirmed.
    fn times_of(epochs: &[(u32, u64)], confirmed: Option<usize>) -> std::vec::Vec<Option<i64>> {
        let (mut calendar, mut counters) = (Calendar::new(), Counters::default());
        let start = GpsTime { week: 2111, tow_ms: 0 };
        calendar.learn(Constellation::Gps, start.later_by_ms(200_000_000), &mut counters);
        let mut time = |(index, &(tow_s, came_s)): (usize, &(u32, u64))| {
            let time = calendar.advance(tow_s * 1000, came_s * 1000, &mut counters).ok()?;
            if confirmed == Some(index) {
                calendar.confirm(time, came_s * 1000);
            }
            Some(time.since_ms(start) / 1000)
        };
        epochs.iter().enumerate().map(&mut time).collect()
    }

    const WEEK_S: u32 = WEEK_MS / 1000;

    #[test]
    fn leaps_do_not_carry_what_is_confirmed_away() {
        let far = |leaps: u32| (100 + leaps * 280_000) % WEEK_S;
        // However many, however far, and however long they go on; and a little ahead.
        let mut epochs: std::vec::Vec<_> = (1..=3)
            .flat_map(|leaps| (0..8).map(move |second| (far(leaps) + second, u64::from(second))))
            .collect();
        epochs.push((112, 8));
        epochs.push((167, 8));
        epochs.extend([(109, 9), (110, 10)]);
        let times = times_of(&[&[(100, 0)], &epochs[..]].concat(), Some(0));
        assert_eq!(times[times.len() - 2..], [Some(109), Some(110)]);
    }

    #[test]
    fn what_comes_twice_is_not_the_time_twice() {
        // The second is not confirmed.
        assert_eq!(
            times_of(&[(100, 0), (101, 1), (101, 1), (102, 2)], Some(0)),
            [Some(100), Some(101), None, Some(102)]
        );
    }

    #[test]
    fn votes_do_not_carry_what_is_confirmed_into_another_week() {
        let (mut calendar, mut counters) = (Calendar::new(), Counters::default());
        let week = |week: u16| GpsTime { week, tow_ms: 200_000_000 };
        calendar.learn(Constellation::Gps, week(2111), &mut counters);
        let first = calendar.advance(200_001_000, 1000, &mut counters).unwrap();
        calendar.confirm(first, 1000);
        for system in [Constellation::Gps, Constellation::Beidou, Constellation::Galileo] {
            (0..20).for_each(|_| calendar.learn(system, week(2110), &mut counters));
        }
        assert_eq!(counters.week_corrections, 1);
        assert_eq!(
            calendar.advance(200_002_000, 2000, &mut counters),
            Ok(GpsTime { week: 2111, tow_ms: 200_002_000 })
        );
    }

    #[test]
    fn sets_on_one_side_of_a_roll_over_do_not_confirm_the_week() {
        let (mut calendar, mut counters) = (Calendar::new(), Counters::default());
        let before_roll_over_ms = WEEK_MS - 1_200_000;
        // Of the next week, but dated with the week in which it was transmitted.
        calendar.learn(Constellation::Gps, GpsTime { week: 2111, tow_ms: 0 }, &mut counters);
        let early = calendar.advance(before_roll_over_ms, 0, &mut counters).unwrap();
        // One of GLONASS, dated by it, says nothing else.
        calendar.learn(Constellation::Glonass, early, &mut counters);
        calendar.confirm(early, 0);
        assert_eq!(early.week, 2110);
        // One of Galileo, before the roll-over, and so without doubt: it is not moved to where the time seems to be.
        let message = MessageWeek { constellation: Constellation::Galileo, week: 2111 - GALILEO_WEEK_OFFSET };
        let set = calendar.resolve(message, before_roll_over_ms / 1000).unwrap();
        calendar.learn(Constellation::Galileo, set, &mut counters);
        let time = calendar.advance(before_roll_over_ms + 1000, 1000, &mut counters).unwrap();
        assert_eq!(time, GpsTime { week: 2111, tow_ms: before_roll_over_ms + 1000 });
        // Those of GPS are dated by it from now on.
        let message = MessageWeek { constellation: Constellation::Gps, week: 2111 % 1024 };
        assert_eq!(calendar.resolve(message, 0), Some(GpsTime { week: 2112, tow_ms: 0 }));
    }

    /// The week after ephemerides have voted for the next one, so many epochs after the last that was confirmed.
    fn week_voted_on(epochs: u32) -> u16 {
        let (mut calendar, mut counters) = (Calendar::new(), Counters::default());
        let week = |week: u16| GpsTime { week, tow_ms: 200_000_000 };
        calendar.learn(Constellation::Gps, week(2110), &mut counters);
        let mut advance = |second: u32| {
            let time = calendar
                .advance(200_001_000 + 1000 * second, 1000 * u64::from(second), &mut counters)
                .unwrap();
            if second == 0 {
                calendar.confirm(time, 0);
            }
            if second == epochs {
                (0..20).for_each(|_| calendar.learn(Constellation::Gps, week(2111), &mut counters));
            }
            time.week
        };
        (0..=epochs + 1).map(&mut advance).last().unwrap()
    }

    #[test]
    fn what_was_confirmed_ten_minutes_ago_gives_way_to_the_votes() {
        assert_eq!([599, 600].map(week_voted_on), [2110, 2111]);
    }

    #[test]
    fn receiver_of_an_earlier_cycle_says_no_week() {
        let mut calendar = Calendar::new();
        calendar.suppose(GpsTime { week: NOT_BEFORE_WEEK - 700, tow_ms: 0 });
        assert_eq!(calendar.present(), None);
    }

    #[test]
    fn cycle_of_gps_is_that_of_the_others() {
        let (mut calendar, mut counters) = (Calendar::new(), Counters::default());
        let week = |week: u16| GpsTime { week, tow_ms: 0 };
        calendar.learn(Constellation::Beidou, week(2111 + 1024), &mut counters);
        (0..100).for_each(|_| calendar.learn(Constellation::Gps, week(2111 + 1024), &mut counters));
        (0..4).for_each(|_| calendar.learn(Constellation::Beidou, week(2111), &mut counters));
        assert_eq!((counters.week_corrections, calendar.present()), (1, Some(week(2111))));
    }

    #[test]
    fn silence_of_days_ends_in_the_week_that_the_own_clock_tells() {
        let days = |days: u32| 86_400 * days;
        let ends_s = [days(3), days(5), days(6) + 3600, days(9)];
        for ends_s in ends_s {
            let epochs = [(100, 0), (ends_s % WEEK_S, u64::from(ends_s - 100))];
            assert_eq!(times_of(&epochs, None)[1], Some(i64::from(ends_s)));
        }
    }
}
