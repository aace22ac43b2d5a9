//! Weeks that the present can be in, derived from one ephemeris (set). It states a week and a
//! reference time, which are ambiguous near the end of a week.
//!
//! The stated week is that of transmission ([IS-GPS-200] 20.3.3.3.1.1) or that of `toe`; both are
//! in use. The ranges give the second of the present week, so that each meaning determines the
//! present week. `w` is the stated week, `t` the second of `toe`, and `c` the second of the
//! present. `toe`, transmission and the present are within half a week of each other. "The end" is
//! that of the week.
//!
//! | `t` and `c` | present week if `w` is that of `toe` | of transmission, just now | of transmission, before the week ended | preferred |
//! |---|---|---|---|---|
//! | `t` after the end, `c` before it | `w − 1` | `w` | – | `w` |
//! | `t` before the end, `c` after it | `w + 1` | `w` | `w + 1` | `w + 1`, of Galileo `w` |
//! | both soon after it | `w` | `w` | `w + 1` | `w` |
//! | elsewhere | `w` | `w` | – | `w` |
//!
//! Galileo sends a past `toe` and renews its sets every ten minutes; the other systems renew theirs
//! at full hours. If the reference time is two hours or more after the end, the set was not
//! transmitted before it. The reason is the fit interval of GPS, four hours.
//!
//! The result depends only on the message and on the second of the week, never on an earlier week
//! of the calendar.
//!
//! [IS-GPS-200]: crate#references

use raim_core::satellite::Constellation;

use super::message_week::behind_gps_ms;
use crate::time::{GpsTime, WEEK_MS};

/// Half a week, ms: the largest distance of `toe`, transmission and the present.
const HALF_WEEK_MS: i64 = WEEK_MS as i64 / 2;

/// Longest time after the end of a week for which a receiver still sends a set from before it, ms.
const PASSED_ON_MS: u32 = 4 * 3_600_000;

/// First reference time of sets that are transmitted only after the end of the week, ms. It is two
/// hours, minus the 16 s by which an upload moves it.
const FIRST_OF_WEEK_MS: u32 = 7_184_000;

/// Largest distance from the present at which the reference time of a set is moved to the
/// neighbouring week, ms.
const PRESENT_MS: u64 = 4 * 3_600_000;

/// Weeks that the present can be in: `first`, and the next one if `is_pair`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PresentWeeks {
    /// First week, counted from that of the instant with which the set was compared.
    first: i32,
    is_pair: bool,
    /// Likelier week of the pair.
    preferred: i32,
    /// True if two of the three meanings give the preferred week.
    is_likely: bool,
}

impl PresentWeeks {
    /// Compares a set of a system with an instant, of which only the second of the week is used.
    /// Weeks are counted from that of the instant.
    pub(super) fn of(system: Constellation, stated: GpsTime, now: GpsTime) -> Self {
        let behind_ms = behind_gps_ms(system);
        let (stated, now) = (stated.earlier_by_ms(behind_ms), now.earlier_by_ms(behind_ms));
        let week = i32::from(stated.week) - i32::from(now.week);
        let apart_ms = i64::from(stated.tow_ms) - i64::from(now.tow_ms);
        if apart_ms > HALF_WEEK_MS {
            let is_fresh = system == Constellation::Galileo;
            return Self { preferred: if is_fresh { week } else { week + 1 }, ..Self::pair(week, !is_fresh) };
        }
        if apart_ms < -HALF_WEEK_MS {
            return Self { preferred: week, ..Self::pair(week - 1, false) };
        }
        let is_soon_after = now.tow_ms < PASSED_ON_MS && stated.tow_ms < FIRST_OF_WEEK_MS;
        Self { is_pair: is_soon_after, ..Self::pair(week, false) }
    }

    const fn pair(first: i32, is_likely: bool) -> Self {
        Self { first, is_pair: true, preferred: first, is_likely }
    }

    /// Returns the week if there is only one.
    pub(super) fn only(self) -> Option<i32> {
        Some(self.first).filter(|_| !self.is_pair)
    }

    /// Returns true if the present can be in that week.
    pub(super) const fn allows(self, week: i32) -> bool {
        week == self.first || self.is_pair && week == self.first + 1
    }

    /// Returns the likelier week.
    pub(super) const fn preferred(self) -> i32 {
        self.preferred
    }

    /// Returns the less likely week, counted from the likelier one.
    pub(super) fn doubt(self) -> Option<i32> {
        let other = if self.preferred == self.first { 1 } else { -1 };
        Some(other).filter(|_| self.is_pair)
    }

    /// Returns the weight of the set's evidence for the week, to choose between sets.
    pub(super) const fn weight(self) -> u8 {
        match self {
            Self { is_pair: false, .. } => 2,
            Self { is_likely: true, .. } => 1,
            Self { .. } => 0,
        }
    }
}

/// Returns the reference time of a set at the known present: the nearest one if the stated week
/// allows it, otherwise the stated one.
///
/// A set that states the neighbouring week is moved only near the present, because a set that is a
/// week old must not look fresh.
pub(super) fn dated(system: Constellation, stated: GpsTime, now: GpsTime) -> GpsTime {
    let nearest = GpsTime::nearest(stated.tow_ms, now);
    let is_present = nearest.since_ms(now).unsigned_abs() <= PRESENT_MS;
    if is_present && PresentWeeks::of(system, stated, now).allows(0) { nearest } else { stated }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Constellation::{Beidou, Galileo, Gps};

    const BEFORE: GpsTime = GpsTime { week: 2113, tow_ms: WEEK_MS - 600_000 };
    const AFTER: GpsTime = GpsTime { week: 2114, tow_ms: 70_000 };

    fn weeks(system: Constellation, week: u16, tow_s: u32, now: GpsTime) -> std::vec::Vec<i32> {
        let weeks = PresentWeeks::of(system, GpsTime { week, tow_ms: 1000 * tow_s }, now);
        (2100..2130).filter(|week| weeks.allows(week - i32::from(now.week))).collect()
    }

    #[test]
    fn present_is_in_the_week_of_transmission_or_beside_that_of_toe() {
        for system in [Gps, Galileo] {
            assert_eq!(weeks(system, 2113, 0, BEFORE), [2112, 2113]);
            assert_eq!(weeks(system, 2113, 601_200, BEFORE), [2113]);
            assert_eq!(weeks(system, 2113, 601_200, AFTER), [2113, 2114]);
            assert_eq!(weeks(system, 2113, 0, AFTER), [2113, 2114]);
            assert_eq!(weeks(system, 2114, 7200, AFTER), [2114]);
        }
    }

    #[test]
    fn week_of_beidou_ends_14_s_later() {
        let after = |tow_ms| GpsTime { week: 2114, tow_ms };
        // Second 0 of `BeiDou` week 758 is second 14 of GPS week 2114.
        assert_eq!(weeks(Beidou, 2114, 14, after(13_999)), [2114, 2115]);
        assert_eq!(weeks(Beidou, 2114, 14, BEFORE), [2113, 2114]);
        assert_eq!(weeks(Beidou, 2113, 14 + 601_200, after(13_999)), [2114]);
    }

    #[test]
    fn set_that_is_a_week_old_does_not_look_fresh() {
        let date = |week, tow_ms| dated(Gps, GpsTime { week, tow_ms }, BEFORE);
        let next = GpsTime { week: 2114, tow_ms: 0 };
        assert_eq!([date(2113, 0), date(2114, 0)], [next; 2]);
        for (week, tow_ms) in [(2112, 604_000_000), (2115, 0), (2113, 86_400_000), (2112, 0)] {
            assert_eq!(date(week, tow_ms), GpsTime { week, tow_ms });
        }
    }
}
