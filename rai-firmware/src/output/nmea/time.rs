//! UTC in sentences: time of day and date.
//!
//! Days are counted from 1980-01-06. The date is that of the Gregorian calendar. It is computed
//! with years that begin in March, so that a leap day is the last day of its year: `day of year =
//! (153 month + 2) / 5 + day`.

use crate::division::divided;
use crate::time::{DAY_MS, GpsTime};

/// GPS time minus UTC, s: the leap seconds since 1980. 18 since 2017-01-01 (IERS Bulletin C 52);
/// none is announced.
pub const GPS_MINUS_UTC_S: u8 = 18;

/// Days from 0000-03-01 to 1980-01-06, when GPS time began.
const GPS_EPOCH_DAY: u32 = 723_125;

/// Days in 400 years of the calendar.
const DAYS_OF_400_YEARS: u32 = 146_097;

/// UTC, rounded to a hundredth of a second for the field `hhmmss.ss`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimeOfDay {
    centiseconds: u32,
    /// Day since 1980-01-06.
    day: u32,
    /// `hhmmss.ss`, formatted once for all sentences of an epoch.
    text: [u8; 9],
}

impl TimeOfDay {
    /// Returns UTC at an instant of GPS time; `gps_minus_utc_s` is [`GPS_MINUS_UTC_S`] until the
    /// next leap second. A time that rounds up to midnight is midnight of the next day.
    pub fn new(time: GpsTime, gps_minus_utc_s: u8) -> Self {
        let utc_ms = time.to_ms().saturating_sub(u64::from(gps_minus_utc_s) * 1000) + 5;
        let (day, of_day_ms) = divided(utc_ms, DAY_MS);
        let centiseconds = of_day_ms / 10;
        let [[a, b], [c, d], [e, f], [g, h]] = parts(centiseconds).map(two_digits);
        let text = [a, b, c, d, e, f, b'.', g, h];
        Self { centiseconds, day: day as u32, text }
    }

    /// Returns hours, minutes, seconds, hundredths.
    pub const fn parts(self) -> [u32; 4] {
        parts(self.centiseconds)
    }

    /// Returns seconds since midnight.
    #[cfg(feature = "observer")]
    pub fn second_of_day(self) -> f64 {
        f64::from(self.centiseconds) / 100.0
    }

    /// Returns `hhmmss.ss`.
    pub(super) const fn text(&self) -> &[u8] {
        &self.text
    }

    /// Returns year, month and day.
    pub const fn date(self) -> [u32; 3] {
        let day = self.day + GPS_EPOCH_DAY;
        let (era, day) = (day / DAYS_OF_400_YEARS, day % DAYS_OF_400_YEARS);
        let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
        let day = day - (365 * year + year / 4 - year / 100);
        let march_month = (5 * day + 2) / 153;
        let month = if march_month < 10 { march_month + 3 } else { march_month - 9 };
        let year = year + 400 * era + if month <= 2 { 1 } else { 0 };
        [year, month, day - (153 * march_month + 2) / 5 + 1]
    }

    /// Returns whole seconds of UTC since 1980-01-06. Instants in the same second share one `ZDA`.
    pub(crate) const fn second(self) -> u32 {
        self.day.wrapping_mul(86_400).wrapping_add(self.centiseconds / 100)
    }
}

const fn parts(centiseconds: u32) -> [u32; 4] {
    let seconds = centiseconds / 100;
    [seconds / 3600, seconds / 60 % 60, seconds % 60, centiseconds % 100]
}

/// Returns the two digits of a number below 100.
const fn two_digits(number: u32) -> [u8; 2] {
    [b'0' + (number / 10) as u8, b'0' + (number % 10) as u8]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The GPS weeks of these dates are those of the Navigation Center's almanac and of IERS
    /// bulletins.
    #[test]
    fn dates_are_those_of_known_weeks() {
        let cases = [
            (0, 0, [1980, 1, 6]),
            (1024, 0, [1999, 8, 22]),
            (1356, 0, [2006, 1, 1]),
            (2048, 0, [2019, 4, 7]),
            (2086, 6, [2020, 1, 4]),
            (2094, 6, [2020, 2, 29]),
            (2095, 0, [2020, 3, 1]),
            (2400, 2, [2026, 1, 6]),
            (6269, 0, [2100, 2, 28]),
            (6269, 1, [2100, 3, 1]),
        ];
        for (week, weekday, want) in cases {
            let time = GpsTime { week, tow_ms: (weekday * 86_400 + 43_218) * 1000 };
            assert_eq!(TimeOfDay::new(time, 18).date(), want, "week {week}, day {weekday}");
        }
    }

    #[test]
    fn a_time_that_rounds_up_to_midnight_is_of_the_next_day() {
        let midnight = GpsTime { week: 2400, tow_ms: 2 * 86_400_000 + 18_000 };
        let at = |ms| TimeOfDay::new(GpsTime::from_ms(midnight.to_ms().saturating_add_signed(ms)), 18);
        assert_eq!((at(-6).date(), at(-6).parts()), ([2026, 1, 5], [23, 59, 59, 99]));
        assert_eq!((at(-5).date(), at(-5).parts()), ([2026, 1, 6], [0, 0, 0, 0]));
    }
}
