//! The instant that a message means by the week number it says, which comes round again, and by the second of that week.
//!
//! | system | bits | of it, week 0 is | comes round |
//! |---|---|---|---|
//! | GPS | 10 | in the cycle nearest to the known time | every 1,024 weeks |
//! | Galileo | 12 | GPS week 1,024 | in 2078 |
//! | `BeiDou` | 13 | GPS week 1,356, 14 s later | in 2163 |
//!
//! Near the end of a week a number may be that of transmission while the second lies beyond the roll-over, or before it. Where the
//! known time says so the instant is taken a week later or earlier. Before anything is known a week that stands near its end may
//! itself be such a one: which [`Side`] of the roll-over it is from is remembered until something says more.

use rai_core::satellite::Constellation;

use crate::time::{BEIDOU_OFFSET_MS, BEIDOU_WEEK_OFFSET, GALILEO_WEEK_OFFSET, GpsTime, WEEK_MS};

/// The first week that a GPS ephemeris can mean when nothing else tells the time: 2019-04-07, the third cycle.
///
/// Right until 2038-11-20; with a Galileo or `BeiDou` ephemeris it is not needed.
pub const NOT_BEFORE_WEEK: u16 = 2048;

/// How far around the end of the week the week number of a message may still or already be the neighbour's, ms.
const ROLL_OVER_MS: u32 = 4 * 3_600_000;

/// Of the end of a week.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Before,
    After,
}

impl Side {
    /// Where an instant is near a roll-over.
    pub(super) const fn of(time: GpsTime) -> Option<Self> {
        match time.tow_ms {
            ..ROLL_OVER_MS => Some(Self::After),
            tow_ms if tow_ms > WEEK_MS - ROLL_OVER_MS => Some(Self::Before),
            _ => None,
        }
    }
}

/// A message's week number.
#[derive(Clone, Copy, Debug)]
pub(super) struct MessageWeek {
    pub(super) constellation: Constellation,
    pub(super) week: u16,
}

impl MessageWeek {
    /// The instant at `tow_s` of the system's own week, where it is about the time `known`; `doubt` is the side of the roll-over
    /// that this itself is from.
    pub(super) fn instant(self, tow_s: u32, known: Option<GpsTime>, doubt: Option<Side>) -> Option<GpsTime> {
        let tow_ms = tow_s.checked_mul(1000).filter(|tow_ms| *tow_ms < WEEK_MS)?;
        let week = self.full_week(known)?;
        let stated = match self.constellation {
            Constellation::Beidou => GpsTime { week, tow_ms }.later_by_ms(BEIDOU_OFFSET_MS),
            _ => GpsTime { week, tow_ms },
        };
        // What is itself in doubt mends nothing on the other side.
        let is_told = doubt.is_none_or(|side| Side::of(stated) == Some(side));
        Some(known.filter(|_| is_told).map_or(stated, |known| across_roll_over(stated, known)))
    }

    /// The week without roll-overs; GLONASS counts days, and has none.
    fn full_week(self, known: Option<GpsTime>) -> Option<u16> {
        match self.constellation {
            Constellation::Beidou => Some(self.week.saturating_add(BEIDOU_WEEK_OFFSET)),
            Constellation::Galileo => Some(self.week.saturating_add(GALILEO_WEEK_OFFSET)),
            Constellation::Gps => Some(gps_week(self.week % 1024, known)),
            Constellation::Glonass => None,
        }
    }
}

/// The week ≡ `week` modulo 1,024 nearest to the known one.
fn gps_week(week: u16, known: Option<GpsTime>) -> u16 {
    let first = known.map_or(NOT_BEFORE_WEEK, |known| known.week.saturating_sub(512));
    first.saturating_add(week.wrapping_sub(first) % 1024)
}

/// Mends a week number that is that of transmission while the second lies beyond the roll-over: soon after it a week later, shortly
/// before it a week earlier.
///
/// Only near the roll-over, and only when it makes the instant the present: a set that is a week old must not look fresh.
fn across_roll_over(stated: GpsTime, known: GpsTime) -> GpsTime {
    let nearest = GpsTime::nearest(stated.tow_ms, known);
    let is_present = nearest.since_ms(known).unsigned_abs() <= u64::from(ROLL_OVER_MS);
    let is_of_neighbour = match Side::of(stated) {
        Some(Side::After) => stated.week.checked_add(1) == Some(nearest.week),
        Some(Side::Before) => nearest.week.checked_add(1) == Some(stated.week),
        None => false,
    };
    if is_present && is_of_neighbour { nearest } else { stated }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Constellation::{Beidou, Galileo, Glonass, Gps};

    const KNOWN: GpsTime = GpsTime { week: 2111, tow_ms: WEEK_MS - 600_000 };

    fn instant(constellation: Constellation, week: u16, tow_s: u32, doubt: Option<Side>) -> Option<GpsTime> {
        MessageWeek { constellation, week }.instant(tow_s, Some(KNOWN), doubt)
    }

    #[test]
    fn weeks_of_all_systems_are_those_of_gps() {
        let noon = GpsTime { week: 2111, tow_ms: 300_000_000 };
        assert_eq!(instant(Gps, 2111 - 2048, 300_000, None), Some(noon));
        assert_eq!(instant(Galileo, 2111 - 1024, 300_000, None), Some(noon));
        assert_eq!(instant(Beidou, 2111 - 1356, 300_000 - 14, None), Some(noon));
        assert_eq!(instant(Glonass, 2111, 300_000, None), None);
        assert_eq!(instant(Gps, 63, 604_800, None), None);
    }

    #[test]
    fn week_of_transmission_is_that_of_the_present_only_near_its_end() {
        let next = GpsTime { week: 2112, tow_ms: 0 };
        assert_eq!(instant(Galileo, 2111 - 1024, 0, None), Some(next));
        assert_eq!(
            instant(Galileo, 2111 - 1024, 86_400, None),
            Some(GpsTime { week: 2111, tow_ms: 86_400_000 })
        );
        let before =
            MessageWeek { constellation: Galileo, week: 2112 - 1024 }.instant(604_000, Some(next), None);
        assert_eq!(before, Some(GpsTime { week: 2111, tow_ms: 604_000_000 }));
    }

    #[test]
    fn set_that_is_a_week_old_does_not_look_fresh() {
        let week_ago = GpsTime { week: 2110, tow_ms: 604_000_000 };
        assert_eq!(instant(Galileo, 2110 - 1024, 604_000, None), Some(week_ago));
        let ahead = GpsTime { week: 2113, tow_ms: 0 };
        assert_eq!(instant(Galileo, 2113 - 1024, 0, None), Some(ahead));
    }

    #[test]
    fn what_is_in_doubt_mends_nothing_on_the_other_side() {
        let stated = GpsTime { week: 2111, tow_ms: 0 };
        assert_eq!(instant(Galileo, 2111 - 1024, 0, Some(Side::Before)), Some(stated));
        assert_eq!(
            instant(Galileo, 2111 - 1024, 0, Some(Side::After)),
            Some(GpsTime { week: 2112, tow_ms: 0 })
        );
    }
}
