//! Which week it is, and that time goes forward.
//!
//! Observations say only where in the week they are; ephemerides say the week: `BeiDou` with 13 bits (until 2163),
//! Galileo with 12 (until 2078), GPS with 10. A GPS week is taken in the cycle of 1,024 nearest to the known time,
//! and before any time is known in the cycle that begins with [`NOT_BEFORE_WEEK`].
//!
//! Nothing on the wire is believed for ever. A time that goes back is dropped, but [`RESTART_RUN`] epochs in a row
//! that are older and follow each other are the new time: one corrupt time far ahead does not silence the receiver.
//! And [`DISSENT`] more ephemerides that contradict the week than confirm it correct it.

use rai_core::satellite::Constellation;

use super::Counters;
use crate::counters::count;
use crate::time::{BEIDOU_OFFSET_MS, BEIDOU_WEEK_OFFSET, GALILEO_WEEK_OFFSET, GpsTime, WEEK_MS};

/// The first week that a GPS ephemeris can mean when nothing else tells the time: 2019-04-07, the third cycle.
///
/// Right until 2038-11-20; with a Galileo or `BeiDou` ephemeris it is not needed.
pub const NOT_BEFORE_WEEK: u16 = 2048;

/// Epochs in a row that make an older time the time.
const RESTART_RUN: u8 = 5;

/// Ephemerides that outvote the week.
const DISSENT: u8 = 4;

/// How far from the present a reference time confirms the week, ms: three days, for orbits uploaded long ago.
const AGREEMENT_MS: u64 = 3 * 86_400_000;

/// How far around the end of the week the week number of a message may still or already be the neighbour's, ms.
const ROLL_OVER_MS: u32 = 4 * 3_600_000;

/// The week of GPS time that a message's week number means.
#[derive(Clone, Copy, Debug)]
pub(super) struct MessageWeek {
    pub(super) constellation: Constellation,
    pub(super) week: u16,
}

/// The time line.
#[derive(Debug)]
pub(super) struct Calendar {
    /// The last epoch, or the reference time of an ephemeris before there was one.
    reference: Option<GpsTime>,
    /// The last epoch.
    last: Option<GpsTime>,
    /// The last epoch that was dropped because it was older, and how many followed each other.
    older: Option<(GpsTime, u8)>,
    dissent: u8,
}

/// Why an epoch's time is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TimeError {
    WeekUnknown,
    Backwards,
}

impl Calendar {
    pub(super) const fn new() -> Self {
        Self { reference: None, last: None, older: None, dissent: 0 }
    }

    /// The last epoch accepted.
    pub(super) fn time(&self) -> Option<GpsTime> {
        self.last
    }

    /// The instant of an epoch at `tow_ms`, if time goes forward with it.
    pub(super) fn advance(&mut self, tow_ms: u32, counters: &mut Counters) -> Result<GpsTime, TimeError> {
        let reference = self.reference.ok_or(TimeError::WeekUnknown)?;
        let time = GpsTime::nearest(tow_ms, reference);
        if self.last.is_some_and(|last| time <= last) {
            if !self.follows_older(time) {
                return Err(TimeError::Backwards);
            }
            count(&mut counters.time_restarts);
        }
        self.older = None;
        self.reference = Some(time);
        self.last = Some(time);
        Ok(time)
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

    /// Lets an ephemeris vote on the week.
    pub(super) fn learn(&mut self, toe: GpsTime, counters: &mut Counters) {
        let Some(reference) = self.reference else {
            self.reference = Some(toe);
            return;
        };
        if toe.since_ms(reference).unsigned_abs() <= AGREEMENT_MS {
            self.dissent = self.dissent.saturating_sub(1);
            return;
        }
        self.dissent = self.dissent.saturating_add(1);
        if self.dissent >= DISSENT {
            count(&mut counters.week_corrections);
            *self = Self { reference: Some(toe), ..Self::new() };
        }
    }

    /// The instant that a message means with its week and `tow_s` of its own system.
    pub(super) fn resolve(&self, message: MessageWeek, tow_s: f64) -> Option<GpsTime> {
        if !(0.0..604_800.0).contains(&tow_s) {
            return None;
        }
        let tow_ms = libm::round(tow_s * 1e3) as u32;
        let week = self.full_week(message);
        let stated = match message.constellation {
            Constellation::Beidou => {
                GpsTime::from_ms(GpsTime { week, tow_ms }.to_ms() + BEIDOU_OFFSET_MS as u64)
            }
            _ => GpsTime { week, tow_ms },
        };
        Some(self.across_roll_over(stated))
    }

    fn full_week(&self, message: MessageWeek) -> u16 {
        match message.constellation {
            Constellation::Beidou => message.week.saturating_add(BEIDOU_WEEK_OFFSET),
            Constellation::Galileo => message.week.saturating_add(GALILEO_WEEK_OFFSET),
            Constellation::Gps | Constellation::Glonass => self.gps_week(message.week % 1024),
        }
    }

    /// The week ≡ `week` modulo 1,024 nearest to the known one.
    fn gps_week(&self, week: u16) -> u16 {
        let first = self.reference.map_or(NOT_BEFORE_WEEK, |reference| reference.week.saturating_sub(512));
        first.saturating_add(week.wrapping_sub(first) % 1024)
    }

    /// Mends a week number that is that of transmission while the reference time lies beyond the roll-over.
    ///
    /// Only near the roll-over, and only when it makes the reference time the present: a set that is a week old
    /// must not look fresh.
    fn across_roll_over(&self, stated: GpsTime) -> GpsTime {
        let Some(reference) = self.reference else {
            return stated;
        };
        let nearest = GpsTime::nearest(stated.tow_ms, reference);
        let is_at_edge = stated.tow_ms < ROLL_OVER_MS || stated.tow_ms > WEEK_MS - ROLL_OVER_MS;
        let is_neighbour = nearest.week.abs_diff(stated.week) == 1;
        let is_present = nearest.since_ms(reference).unsigned_abs() <= u64::from(ROLL_OVER_MS);
        if is_at_edge && is_neighbour && is_present { nearest } else { stated }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_older_time_comes_back_though_every_system_ends_its_own_epoch() {
        let (mut calendar, mut counters) = (Calendar::new(), Counters::default());
        calendar.learn(GpsTime { week: 2111, tow_ms: 0 }, &mut counters);
        assert!(calendar.advance(90_000_000, &mut counters).is_ok());
        let older = (1..=5).flat_map(|second| [second * 1000; 2]);
        let accepted = older.filter(|&tow_ms| calendar.advance(tow_ms, &mut counters).is_ok()).count();
        assert_eq!((accepted, calendar.time()), (1, Some(GpsTime { week: 2111, tow_ms: 5000 })));
    }
}
