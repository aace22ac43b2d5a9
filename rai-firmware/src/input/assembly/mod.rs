//! Assembly: joins the messages of one instant to one epoch, in any format.
//!
//! An epoch is complete when a message states that none follows, when a message of another instant
//! arrives, or when the line is silent. If its time is refused, the whole epoch is dropped
//! ([`super::calendar`]).
//!
//! | flaw on the wire | effect |
//! |---|---|
//! | systems tag one instant differently, by less than [`SAME_INSTANT_MS`] | one epoch, at the first tag |
//! | a system states that no message follows, but one does | that message is left out; the system's statement is ignored until it has been right [`FORGIVEN_AFTER`] times, and meanwhile epochs end with the next instant or a pause |
//! | every message states that more follow, and the next epoch comes a minute later | the epoch is complete when the line is silent; a message that comes after the silence is left out, and later silences are then ignored like wrong statements |
//! | a message without satellites is tagged ahead | it does not advance time, because no range supports its tag; if the tag is far ahead, the message is skipped |
//! | a message without satellites comes between the others with another tag | it is left out, with its statement whether others follow |
//! | ranges come again under a new tag, bit for bit | the repeat is dropped: satellites move by metres in a millisecond, so that its tag must be wrong |
//! | bytes are lost | the open epoch is dropped; the next message and all others of its instant are dropped too |
//! | two receivers with one station number share the line | the first ranges are used; a second, different range of a satellite is reported ([`Rivalry`]), and so are ranges that alternate between two receivers ([`turns`]) |
//! | the tag of one system is half a second or more off | the system is left out and counted ([`chain`]) |
//! | the tags of one system are wrong by 10 ms to half a second | one instant comes as two epochs without a common system, which is reported before the second one is judged ([`HALVES_MS`]) |

mod chain;
mod epoch_ranges;
mod turns;

use super::calendar::{Calendar, TimeError};
use super::{Counters, Event, Ranges, Rivalry, Series};
use crate::counters::count;
use crate::raw::RawEpoch;
use crate::time::GpsTime;

use chain::{ASTRAY_MS, Chain, apart_ms, bit};
use epoch_ranges::{Comparison, add, hash_of_ranges};
use turns::Turns;

/// Difference below which tags are of one instant, ms, because receivers round each system's own
/// time separately.
const SAME_INSTANT_MS: u32 = 10;

/// Difference of tags below which epochs of different systems are halves of one instant, ms.
/// Genuine epochs this close contain all systems, because a receiver that measures twice a second
/// or more sends its systems together.
const HALVES_MS: u32 = ASTRAY_MS;

/// Largest change of a range in a millisecond, m: 1,000 m/s of satellite, vehicle and clock.
const RATE_M_MS: f64 = 1.0;

/// Number of right statements after which a system's statement counts again.
const FORGIVEN_AFTER: u8 = 3;

/// Series that stands for a silent line: silence counts as a statement that no message follows.
/// RTCM does not use this number.
const SILENCE: Series = 15;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// No epoch is open.
    Idle,
    /// An epoch is open. The field names the distrusted series that stated its end, if there is
    /// one.
    Open(Option<Series>),
    /// Messages of this time of week, ms, are skipped.
    Dropping(u32),
    /// The epoch of this time of week, ms, was complete by the statement of this series.
    Complete(u32, Option<Series>),
    /// Bytes were lost, so that the next message may be a part of an epoch.
    Interrupted,
}

/// Assembly of the open epoch.
#[derive(Debug)]
pub(super) struct Assembly {
    epoch: RawEpoch,
    came_ms: u64,
    /// True if a message with satellites has come for this epoch. Only such a message advances the
    /// calendar to the epoch.
    is_vouched: bool,
    phase: Phase,
    /// Series that have a message in the epoch, one bit each.
    heard: u16,
    /// Number of right statements that each series still needs.
    distrust: [u8; 16],
    /// Tag and arrival, ms, of a message tagged with UTC that came while no epoch was open, ms.
    utc_before: Option<(u32, u64)>,
    /// True if the ranges of this epoch were reported to be of two receivers.
    has_rival: bool,
    chain: Chain,
    turns: Turns,
    /// Hash of the ranges of the last complete epoch.
    ranges_before: Option<u32>,
}

/// Longest time between the arrivals of two messages of one burst, ms.
const BURST_MS: u64 = 100;

impl Assembly {
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self {
            epoch: RawEpoch::new(GpsTime { week: 0, tow_ms: 0 }),
            came_ms: 0,
            is_vouched: false,
            phase: Phase::Idle,
            heard: 0,
            distrust: [0; 16],
            utc_before: None,
            has_rival: false,
            chain: Chain::new(),
            turns: Turns::new(),
            ranges_before: None,
        }
    }

    /// Takes a message whose first byte came at `came_ms`, and passes the epochs that it completes
    /// to `tell`.
    pub(super) fn take(
        &mut self,
        ranges: &Ranges<'_>,
        came_ms: u64,
        calendar: &mut Calendar,
        counters: &mut Counters,
        tell: &mut dyn FnMut(Event<'_>),
    ) {
        if let Some((time, leap_s)) = ranges.stated {
            calendar.hear_receiver(time, leap_s, counters);
        }
        self.compare_tags(ranges, came_ms, calendar);
        match ranges.tow_ms {
            None if ranges.of_utc_ms.is_some() => count(&mut counters.leap_unknown),
            None => count(&mut counters.observations_other),
            Some(tow_ms) if self.is_unsure(ranges, tow_ms, calendar) => count(&mut counters.leap_unknown),
            // It says nothing about the open epoch, not even that it ends.
            Some(tow_ms) if self.is_aside(ranges, tow_ms, came_ms) => {
                return count(&mut counters.observations_ahead);
            }
            Some(tow_ms) if self.chain.take(ranges, tow_ms) => count(&mut counters.observations_astray),
            Some(tow_ms) => {
                if self.admits(ranges, tow_ms, came_ms, calendar, counters, tell) {
                    self.heard |= ranges.series.map_or(0, bit);
                    self.take_all(ranges, tow_ms, false, counters, tell);
                }
            }
        }
        if !ranges.more_follow {
            self.chain.end();
            self.end(ranges.series, counters, tell);
        }
    }

    /// Infers the leap seconds from two messages of one instant, of which one is tagged with UTC.
    fn compare_tags(&mut self, ranges: &Ranges<'_>, came_ms: u64, calendar: &mut Calendar) {
        match (ranges.of_utc_ms, self.phase) {
            (Some(utc_ms), Phase::Open(_)) => calendar.infer_leap(self.epoch.time.tow_ms, utc_ms),
            (Some(utc_ms), _) => self.utc_before = Some((utc_ms, came_ms)),
            (None, _) => {
                if let (Some((utc_ms, then_ms)), Some(tow_ms)) = (self.utc_before.take(), ranges.tow_ms)
                    && came_ms.saturating_sub(then_ms) < BURST_MS
                {
                    calendar.infer_leap(tow_ms, utc_ms);
                }
            }
        }
    }

    /// Returns true if the UTC tag of a message may be wrong by a leap second. Either it does not
    /// fit the open epoch, or no epoch is open to compare it with.
    fn is_unsure(&self, ranges: &Ranges<'_>, tow_ms: u32, calendar: &Calendar) -> bool {
        ranges.of_utc_ms.is_some_and(|utc_ms| match self.phase {
            Phase::Open(_) => !is_same(tow_ms, self.epoch.time.tow_ms) && calendar.is_step_due(),
            _ => calendar.is_unsure(utc_ms),
        })
    }

    /// Returns true if a message without satellites has another tag than the open epoch, which has
    /// some, although it came in the same burst or its tag is nearer than that of another epoch.
    fn is_aside(&self, ranges: &Ranges<'_>, tow_ms: u32, came_ms: u64) -> bool {
        let apart_ms = apart_ms(tow_ms, self.epoch.time.tow_ms);
        ranges.measured.is_empty()
            && self.is_open()
            && !self.epoch.satellites.is_empty()
            && apart_ms >= SAME_INSTANT_MS
            && (apart_ms < HALVES_MS || came_ms.saturating_sub(self.came_ms) < BURST_MS)
    }

    /// Moves the open epoch to the week of the present.
    pub(super) fn redate(&mut self, present: GpsTime) {
        self.epoch.time = GpsTime::nearest(self.epoch.time.tow_ms, present);
    }

    /// Completes an epoch with ranges that a series stated as complete. The line pauses, so that
    /// the statement was right. An epoch without ranges may have begun before its burst.
    pub(super) fn pause(&mut self, counters: &mut Counters, tell: &mut dyn FnMut(Event<'_>)) {
        self.chain.forget();
        if let Phase::Open(Some(series)) = self.phase
            && series != SILENCE
            && !self.epoch.satellites.is_empty()
        {
            self.forgive(series);
            self.complete(Some(series), counters, tell);
        }
    }

    /// Completes the open epoch if it has ranges, because the line is silent.
    pub(super) fn silence(&mut self, counters: &mut Counters, tell: &mut dyn FnMut(Event<'_>)) {
        self.pause(counters, tell);
        if !self.epoch.satellites.is_empty() {
            self.end(Some(SILENCE), counters, tell);
        }
    }

    /// Returns true if an epoch is open.
    pub(super) const fn is_open(&self) -> bool {
        matches!(self.phase, Phase::Open(_))
    }

    /// Drops the open epoch, because bytes were lost.
    pub(super) fn interrupt(&mut self, counters: &mut Counters) {
        self.chain.forget();
        if self.is_open() {
            count(&mut counters.epochs_broken);
        }
        self.phase = Phase::Interrupted;
    }

    /// Returns true if a message of this time belongs to the open epoch. If an epoch of another
    /// time is open, completes it first. If no epoch is open then, opens one.
    fn admits(
        &mut self,
        ranges: &Ranges<'_>,
        tow_ms: u32,
        came_ms: u64,
        calendar: &mut Calendar,
        counters: &mut Counters,
        tell: &mut dyn FnMut(Event<'_>),
    ) -> bool {
        let is_empty = ranges.measured.is_empty();
        if is_empty
            && !self.is_at(tow_ms)
            && let Err(reason) = calendar.foresee(tow_ms)
        {
            count(reason.counter(counters));
            return false;
        }
        if !is_empty && self.is_half(ranges.series, tow_ms, came_ms) {
            tell(Event::Rivalry(Rivalry::Halves));
        }
        match self.phase {
            Phase::Open(ended) if is_same(tow_ms, self.epoch.time.tow_ms) => {
                if let Some(series) = ended {
                    self.accuse(series);
                    self.phase = Phase::Open(None);
                }
                return is_empty || self.is_vouched || self.vouch(tow_ms, came_ms, calendar, counters, tell);
            }
            Phase::Open(ended) => {
                if let Some(series) = ended {
                    self.forgive(series);
                }
                self.complete(None, counters, tell);
            }
            Phase::Complete(complete_ms, ended) if is_same(tow_ms, complete_ms) => {
                // An epoch without satellites does not come again with some: its end was stated
                // early.
                let is_alike = is_empty || !self.epoch.satellites.is_empty();
                if is_alike && self.has_heard(ranges.series) {
                    // The epoch comes again, so that the statement of its end was right.
                    count(&mut counters.epochs_backwards);
                } else {
                    if let Some(series) = ended {
                        self.accuse(series);
                    }
                    count(&mut counters.observations_after_end);
                }
                self.take_all(ranges, tow_ms, true, &mut Counters::default(), tell);
                self.phase = Phase::Dropping(complete_ms);
                return false;
            }
            Phase::Dropping(dropped_ms) if is_same(tow_ms, dropped_ms) => {
                if is_same(tow_ms, self.epoch.time.tow_ms) {
                    self.take_all(ranges, tow_ms, true, &mut Counters::default(), tell);
                }
                return false;
            }
            Phase::Interrupted => {
                count(&mut counters.epochs_broken);
                self.phase = Phase::Dropping(tow_ms);
                return false;
            }
            Phase::Dropping(_) | Phase::Idle | Phase::Complete(..) => {}
        }
        self.epoch.satellites.clear();
        #[cfg(feature = "sbf")]
        {
            self.epoch.clock_jumps_ms = ranges.clock_jumps_ms;
        }
        self.came_ms = came_ms;
        self.heard = 0;
        self.has_rival = false;
        if !is_empty {
            return self.vouch(tow_ms, came_ms, calendar, counters, tell);
        }
        let foreseen = calendar.foresee(tow_ms);
        self.is_vouched = false;
        self.begin(foreseen, tow_ms, counters)
    }

    /// Returns true if the open or the last epoch is of this time.
    fn is_at(&self, tow_ms: u32) -> bool {
        match self.phase {
            Phase::Open(_) => is_same(tow_ms, self.epoch.time.tow_ms),
            Phase::Complete(last_ms, _) | Phase::Dropping(last_ms) => is_same(tow_ms, last_ms),
            Phase::Idle | Phase::Interrupted => false,
        }
    }

    /// Advances the calendar to the time of an epoch that has satellites. If the calendar refuses
    /// the time, the epoch is dropped.
    fn vouch(
        &mut self,
        tow_ms: u32,
        came_ms: u64,
        calendar: &mut Calendar,
        counters: &mut Counters,
        tell: &mut dyn FnMut(Event<'_>),
    ) -> bool {
        let time = calendar.advance(tow_ms, came_ms, counters);
        if let Some(present) = calendar.take_redating() {
            tell(Event::Redated(present));
        }
        self.is_vouched = time.is_ok();
        // A message without satellites may have opened the epoch early. The arrival of the epoch is
        // that of its first message with satellites.
        self.came_ms = came_ms;
        self.begin(time, tow_ms, counters)
    }

    fn begin(&mut self, time: Result<GpsTime, TimeError>, tow_ms: u32, counters: &mut Counters) -> bool {
        match time {
            Ok(time) => {
                self.epoch.time = time;
                self.phase = Phase::Open(None);
            }
            Err(reason) => {
                count(reason.counter(counters));
                self.phase = Phase::Dropping(tow_ms);
            }
        }
        time.is_ok()
    }

    /// Adds the ranges of a message, or compares them with those of the last complete epoch.
    ///
    /// If a range of a satellite came before in another message, both are compared. If the time
    /// between the two does not explain the difference, it is evidence of a second receiver. Adding
    /// and comparing share one function, because the compiler copies the message reader for each
    /// caller.
    #[inline(never)]
    fn take_all(
        &mut self,
        ranges: &Ranges<'_>,
        tow_ms: u32,
        is_again: bool,
        counters: &mut Counters,
        tell: &mut dyn FnMut(Event<'_>),
    ) {
        let earlier = self.epoch.satellites.len();
        let Self { epoch, has_rival, .. } = self;
        let mut comparison = Comparison::within(f64::from(apart_ms(tow_ms, epoch.time.tow_ms)) * RATE_M_MS);
        ranges.measured.each(counters, |satellite, signal, is_reference, counters| {
            if is_again || add(epoch, satellite, signal, is_reference, earlier, counters) {
                comparison.add(epoch, satellite, &signal);
            }
        });
        if comparison.finds_another() && !core::mem::replace(has_rival, true) {
            tell(Event::Rivalry(if is_again { Rivalry::Receivers } else { Rivalry::Joined }));
        }
    }

    /// Returns true if the ranges are of a system that the epoch lacks, and their tag is so near
    /// that both are of one instant. After a complete epoch a second condition applies: the time
    /// since its first byte must be below three quarters of the difference of the tags. Messages of
    /// the next instant cannot arrive so soon.
    fn is_half(&self, series: Option<Series>, tow_ms: u32, came_ms: u64) -> bool {
        let (instant_ms, is_complete) = match self.phase {
            Phase::Open(_) => (self.epoch.time.tow_ms, false),
            Phase::Complete(complete_ms, _) => (complete_ms, true),
            Phase::Idle | Phase::Dropping(_) | Phase::Interrupted => return false,
        };
        let apart_ms = apart_ms(tow_ms, instant_ms);
        let is_sooner = 4 * came_ms.saturating_sub(self.came_ms) < 3 * u64::from(apart_ms);
        self.heard != 0
            && !self.has_heard(series)
            && (SAME_INSTANT_MS..HALVES_MS).contains(&apart_ms)
            && (is_sooner || !is_complete)
    }

    /// Handles a message that states that it is the last one of the epoch.
    fn end(&mut self, series: Option<Series>, counters: &mut Counters, tell: &mut dyn FnMut(Event<'_>)) {
        match (self.phase, series) {
            (Phase::Open(_), Some(series)) if self.distrust_of(series) > 0 => {
                self.phase = Phase::Open(Some(series));
            }
            (Phase::Open(_), _) => self.complete(series, counters, tell),
            // The rest of a dropped epoch is also dropped.
            (Phase::Idle | Phase::Dropping(_) | Phase::Complete(..) | Phase::Interrupted, _) => {}
        }
    }

    /// Completes the epoch, unless it repeats the one before.
    fn complete(&mut self, series: Option<Series>, counters: &mut Counters, tell: &mut dyn FnMut(Event<'_>)) {
        self.phase = Phase::Complete(self.epoch.time.tow_ms, series);
        let ranges = hash_of_ranges(&self.epoch);
        if ranges.is_some() && ranges == self.ranges_before {
            return count(&mut counters.epochs_repeated);
        }
        self.ranges_before = ranges;
        // If two receivers share one epoch, its stored ranges are a mixture, and the test for
        // alternating receivers does not apply.
        if !self.has_rival
            && cfg!(feature = "signs")
            && let Some(rivalry) = self.turns.take(&self.epoch)
        {
            tell(Event::Rivalry(rivalry));
        }
        count(&mut counters.epochs);
        tell(Event::Epoch(&self.epoch, self.came_ms));
    }

    fn has_heard(&self, series: Option<Series>) -> bool {
        series.is_none_or(|series| self.heard & bit(series) != 0)
    }

    fn distrust_of(&self, series: Series) -> u8 {
        self.distrust.get(usize::from(series)).copied().unwrap_or(0)
    }

    fn accuse(&mut self, series: Series) {
        if let Some(distrust) = self.distrust.get_mut(usize::from(series)) {
            *distrust = FORGIVEN_AFTER;
        }
    }

    fn forgive(&mut self, series: Series) {
        if let Some(distrust) = self.distrust.get_mut(usize::from(series)) {
            *distrust = distrust.saturating_sub(1);
        }
    }
}

/// Returns true if two times of week are of one instant, across the end of the week as well.
fn is_same(a_ms: u32, b_ms: u32) -> bool {
    apart_ms(a_ms, b_ms) < SAME_INSTANT_MS
}
