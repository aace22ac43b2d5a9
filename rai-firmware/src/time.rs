//! GPS time: week and milliseconds, one continuous scale for all systems.
//!
//! `BeiDou` time is GPS time minus 14 s and begins in week 1356. Galileo system time begins in week
//! 1024. It differs from GPS time by some tens of nanoseconds, which the receiver clock of that
//!       constellation absorbs.

use crate::division::divided;

/// Milliseconds in a week.
pub const WEEK_MS: u32 = 604_800_000;

/// Offset of GPS time from `BeiDou` time, ms ([BDS-SIS-ICD]: leap seconds from 1980 to 2006).
///
/// [BDS-SIS-ICD]: crate#references
pub const BEIDOU_OFFSET_MS: u32 = 14_000;

/// Week of GPS time at which `BeiDou` week 0 began, 2006-01-01.
pub const BEIDOU_WEEK_OFFSET: u16 = 1356;

/// Week of GPS time at which Galileo system time week 0 began, 1999-08-22.
pub const GALILEO_WEEK_OFFSET: u16 = 1024;

/// An instant of GPS time with millisecond resolution, because receivers measure at whole
/// milliseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct GpsTime {
    /// Weeks since 1980-01-06, not rolled over.
    pub week: u16,
    /// Milliseconds into the week, below [`WEEK_MS`].
    pub tow_ms: u32,
}

impl GpsTime {
    /// Returns the milliseconds since 1980-01-06.
    pub const fn to_ms(self) -> u64 {
        self.week as u64 * WEEK_MS as u64 + self.tow_ms as u64
    }

    /// Returns the instant `ms` after 1980-01-06.
    pub const fn from_ms(ms: u64) -> Self {
        let (week, tow_ms) = divided(ms, WEEK_MS);
        Self { week: week as u16, tow_ms }
    }

    /// Returns the milliseconds from `earlier` to `self`; negative if `self` is before it.
    // Not inlined, so that its many callers share one copy.
    #[inline(never)]
    pub const fn since_ms(self, earlier: Self) -> i64 {
        self.to_ms().cast_signed() - earlier.to_ms().cast_signed()
    }

    /// Returns the instant `ms` later, at most a week, without the division of [`Self::from_ms`].
    pub(crate) const fn later_by_ms(self, ms: u32) -> Self {
        let tow_ms = self.tow_ms + ms;
        if tow_ms < WEEK_MS {
            Self { tow_ms, ..self }
        } else {
            Self { week: self.week.saturating_add(1), tow_ms: tow_ms - WEEK_MS }
        }
    }

    /// Returns the instant this many milliseconds earlier, at most a week.
    pub(crate) const fn earlier_by_ms(self, ms: u32) -> Self {
        if self.tow_ms >= ms {
            Self { tow_ms: self.tow_ms - ms, ..self }
        } else {
            Self { week: self.week.saturating_sub(1), tow_ms: self.tow_ms + WEEK_MS - ms }
        }
    }

    /// Returns the same second of the week, this many weeks later, or earlier if negative.
    #[must_use]
    pub const fn later_by_weeks(self, weeks: i32) -> Self {
        let week = (self.week as i32).saturating_add(weeks);
        Self {
            week: if week < 0 {
                0
            } else if week > u16::MAX as i32 {
                u16::MAX
            } else {
                week as u16
            },
            ..self
        }
    }

    /// Returns the seconds since 1980-01-06, exact to a microsecond for centuries.
    pub fn to_s(self) -> f64 {
        self.to_ms() as f64 * 1e-3
    }

    /// Returns the instant at `tow_ms` of the week that lies within half a week of `reference`.
    ///
    /// A time of week after the end of a week thus follows those before the end.
    // Not inlined, so that its many callers share one copy.
    #[inline(never)]
    pub const fn nearest(tow_ms: u32, reference: Self) -> Self {
        let half_ms = WEEK_MS / 2;
        let week = if tow_ms > reference.tow_ms.saturating_add(half_ms) {
            reference.week.saturating_sub(1)
        } else if reference.tow_ms > tow_ms.saturating_add(half_ms) {
            reference.week.saturating_add(1)
        } else {
            reference.week
        };
        Self { week, tow_ms }
    }
}

/// Milliseconds in a day.
pub(crate) const DAY_MS: u32 = 86_400_000;

/// Offset of GLONASS time from UTC, ms.
pub const GLONASS_OFFSET_MS: u64 = 3 * 3_600_000;

/// Returns the instant nearest to `now` at which GLONASS time is `second_of_day`; `None` if no day
/// has this second.
///
/// GLONASS time has the leap seconds of UTC, so that the conversion to GPS time needs their number.
pub const fn glonass_time(second_of_day: u32, leap_s: u8, now: GpsTime) -> Option<GpsTime> {
    if second_of_day >= 86_400 {
        return None;
    }
    let of_day_ms = second_of_day * 1000 + (DAY_MS - GLONASS_OFFSET_MS as u32) + leap_s as u32 * 1000;
    // The first such instant after half a day before now. A week has whole days.
    let earliest = now.earlier_by_ms(DAY_MS / 2);
    Some(earliest.later_by_ms((of_day_ms + WEEK_MS - earliest.tow_ms) % DAY_MS))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_of_week_after_the_roll_over_belongs_to_the_next_week() {
        let reference = GpsTime { week: 2111, tow_ms: WEEK_MS - 1_000 };
        assert_eq!(GpsTime::nearest(0, reference), GpsTime { week: 2112, tow_ms: 0 });
        assert_eq!(GpsTime::nearest(WEEK_MS - 2_000, reference).week, 2111);
    }

    #[test]
    fn a_later_instant_may_be_in_the_next_week() {
        for tow_ms in [0, 1, WEEK_MS - 14_001, WEEK_MS - 14_000, WEEK_MS - 1] {
            let time = GpsTime { week: 2111, tow_ms };
            assert_eq!(time.later_by_ms(14_000), GpsTime::from_ms(time.to_ms() + 14_000), "{tow_ms}");
        }
    }

    #[test]
    fn glonass_counts_as_utc_three_hours_ahead() {
        // 2020-06-25 00:15 of GLONASS time is 2020-06-24 21:15 UTC, 18 s behind GPS time: day 3 of
        // week 2111.
        let want = GpsTime { week: 2111, tow_ms: (3 * 86_400 + 21 * 3600 + 15 * 60 + 18) * 1000 };
        for now_s in [-40_000_i64, -60, 0, 60, 40_000] {
            let now = GpsTime::from_ms(want.to_ms().wrapping_add_signed(now_s * 1000));
            assert_eq!(glonass_time(900, 18, now), Some(want), "{now_s}");
        }
        assert_eq!(glonass_time(86_400, 18, want), None);
    }

    #[test]
    fn a_late_time_of_week_beside_a_young_week_belongs_to_the_week_before() {
        let reference = GpsTime { week: 2112, tow_ms: 1_000 };
        assert_eq!(GpsTime::nearest(WEEK_MS - 1, reference).week, 2111);
    }
}
