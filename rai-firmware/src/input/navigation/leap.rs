//! Leap seconds that the satellites announce: the present number, the next one, and the time of the
//! change.
//!
//! The week of the change has eight bits. Of the weeks with these bits, the one nearest to the
//! present is taken. References: [IS-GPS-200] 20.3.3.5.2.4; [OS-SIS-ICD] 5.1.7.
//!
//! [IS-GPS-200]: crate#references
//! [OS-SIS-ICD]: crate#references

use crate::time::{GpsTime, WEEK_MS};

/// Milliseconds of a day.
const DAY_MS: u64 = 86_400_000;

/// Plausible values of GPS time minus UTC, s: 17 since 2015, and at most one more a year.
const PLAUSIBLE_S: core::ops::RangeInclusive<i32> = 0..=63;

/// Announcement of leap seconds by a satellite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::input) struct Announcement {
    /// Number before the change, s.
    pub(in crate::input) now_s: i32,
    /// Number after the change, s.
    pub(in crate::input) then_s: i32,
    /// Week modulo 256 and day, 1 to 7, at whose end the change is.
    pub(in crate::input) week: u8,
    pub(in crate::input) day: u8,
}

impl Announcement {
    /// Returns GPS time minus UTC at `time`, s; `None` for an implausible number.
    pub(in crate::input) fn at(&self, time: GpsTime) -> Option<u8> {
        let (before, after) = (time.week.saturating_sub(128), self.week);
        let week = before.saturating_add(u16::from(after.wrapping_sub(before as u8)));
        let change_ms = u64::from(week) * u64::from(WEEK_MS) + u64::from(self.day) * DAY_MS;
        let leap_s = if time.to_ms() < change_ms + self.now_s.unsigned_abs() as u64 * 1000 {
            self.now_s
        } else {
            self.then_s
        };
        PLAUSIBLE_S.contains(&leap_s).then_some(leap_s as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At the last leap second, the end of 2016-12-31, day 7 (Saturday) of week 1929, GPS − UTC
    /// rose from 17 to 18 s.
    const LAST: Announcement = Announcement { now_s: 17, then_s: 18, week: (1929 % 256) as u8, day: 7 };

    #[test]
    fn the_leap_second_of_2016() {
        let midnight_utc_ms = 1930 * u64::from(WEEK_MS) + 17_000;
        assert_eq!(LAST.at(GpsTime::from_ms(midnight_utc_ms - 1)), Some(17));
        assert_eq!(LAST.at(GpsTime::from_ms(midnight_utc_ms)), Some(18));
        assert_eq!(LAST.at(GpsTime { week: 2050, tow_ms: 0 }), Some(18));
    }

    #[test]
    fn a_number_that_it_cannot_be_is_none() {
        assert_eq!(Announcement { then_s: -3, ..LAST }.at(GpsTime { week: 1990, tow_ms: 0 }), None);
    }
}
