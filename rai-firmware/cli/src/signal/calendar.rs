//! Conversion of RINEX calendar dates to instants of GPS time, and back for messages.
//!
//! | time system | minus GPS time |
//! |---|---|
//! | GPS, Galileo, QZSS | 0 |
//! | `BeiDou` | −14 s |
//! | GLONASS, UTC | −leap seconds since 1980 ([`leap_seconds`]) |
//!
//! RINEX gives dates in the time system of the satellite (ephemerides) or of the header
//! (observations). References: [RINEX-4.01] §4.1; days by the era method of [Hinnant2013].
//!
//! [RINEX-4.01]: crate#references
//! [Hinnant2013]: crate#references

use raim_firmware::time::{BEIDOU_OFFSET_MS, GpsTime};

/// Days from 1970-01-01 to 1980-01-06, where GPS time begins.
const GPS_EPOCH_DAYS: i64 = 3657;

/// Milliseconds in a day.
const DAY_MS: i64 = 86_400_000;

/// Time system of a date.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeSystem {
    /// GPS, Galileo and QZSS agree to nanoseconds.
    Gps,
    /// `BeiDou` time.
    Beidou,
    /// UTC, in which GLONASS dates are.
    Utc {
        /// Leap seconds that the file states.
        stated_s: Option<u8>,
    },
}

/// Months, from their first day on in UTC, of one more leap second: IERS Bulletin C 1 to 52.
const INSERTED: [(i64, i64); 18] = [
    (1981, 7),
    (1982, 7),
    (1983, 7),
    (1985, 7),
    (1988, 1),
    (1990, 1),
    (1991, 1),
    (1992, 7),
    (1993, 7),
    (1994, 7),
    (1996, 1),
    (1997, 7),
    (1999, 1),
    (2006, 1),
    (2009, 1),
    (2012, 7),
    (2015, 7),
    (2017, 1),
];

/// Returns GPS time minus UTC, s, at an instant of UTC in milliseconds after 1980-01-06.
///
/// The table is complete up to the last leap second that it has. What a file states counts only
/// after that: it may tell of a later leap second, but some files from before state the present
/// number.
fn leap_seconds_of_utc(utc_ms: i64, stated_s: Option<u8>) -> u8 {
    let since = |&(year, month): &(i64, i64)| DAY_MS * (days_from_civil(year, month, 1) - GPS_EPOCH_DAYS);
    let inserted = INSERTED.iter().take_while(|month| since(month) <= utc_ms).count();
    match stated_s {
        Some(stated_s) if inserted == INSERTED.len() => stated_s.max(inserted as u8),
        _ => inserted as u8,
    }
}

/// Returns GPS time minus UTC, s, at an instant of GPS time; a file may state the number.
pub fn leap_seconds(time: GpsTime, stated_s: Option<u8>) -> u8 {
    let gps_ms = time.to_ms().cast_signed();
    let about = leap_seconds_of_utc(gps_ms, stated_s);
    leap_seconds_of_utc(gps_ms - 1000 * i64::from(about), stated_s)
}

impl TimeSystem {
    /// Returns the lead of GPS time at an instant of this time, in milliseconds after 1980-01-06.
    fn behind_gps_ms(self, own_ms: i64) -> i64 {
        match self {
            Self::Gps => 0,
            Self::Beidou => i64::from(BEIDOU_OFFSET_MS),
            Self::Utc { stated_s } => i64::from(leap_seconds_of_utc(own_ms, stated_s)) * 1000,
        }
    }
}

/// Returns the days from 1970-01-01 to a date of the Gregorian calendar.
fn days_from_civil(year: i64, month: i64, day: i64) -> i64 {
    // Years begin in March, so that the leap day is the last one.
    let year = if month <= 2 { year - 1 } else { year };
    let era = year.div_euclid(400);
    let year_of_era = year.rem_euclid(400);
    let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    era * 146_097 + year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year - 719_468
}

/// Returns the date of a day counted from 1970-01-01: year, month, day.
fn civil_from_days(days: i64) -> (i64, i64, i64) {
    let days = days + 719_468;
    let era = days.div_euclid(146_097);
    let day_of_era = days.rem_euclid(146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = (month_from_march + 2) % 12 + 1;
    let year = year_of_era + era * 400 + i64::from(month <= 2);
    (year, month, day)
}

/// Returns the instant of `year month day hour minute second` in the blank-separated `text`; `None`
/// for text that is no date from 1980 to 2079. Most lines of a file are asked for a date and have
/// none, so that an error with words would cost most of the time.
///
/// Two-digit years are those of RINEX 2: 80 to 99 are 1980 to 1999, 00 to 79 are 2000 to 2079.
/// Seconds are rounded to milliseconds, which is the resolution of an observation message.
pub fn instant(text: &str, system: TimeSystem) -> Option<GpsTime> {
    let mut words = text.split_ascii_whitespace();
    let mut integer = || words.next()?.parse::<i64>().ok();
    let (year, month, day, hour, minute) = (integer()?, integer()?, integer()?, integer()?, integer()?);
    let second: f64 = words.next()?.parse().ok()?;
    let is_time = (0..24).contains(&hour) && (0..60).contains(&minute) && (0.0..61.0).contains(&second);
    let is_day = (1..=12).contains(&month) && (1..=31).contains(&day);
    let year = match year {
        80..=99 => year + 1900,
        0..=79 => year + 2000,
        _ => year,
    };
    if !(is_time && is_day && (1980..2080).contains(&year)) {
        return None;
    }
    let days = days_from_civil(year, month, day);
    if civil_from_days(days) != (year, month, day) {
        return None;
    }
    let days = days - GPS_EPOCH_DAYS;
    let ms = days * DAY_MS + (hour * 60 + minute) * 60_000 + (second * 1000.0).round() as i64;
    from_ms(ms + system.behind_gps_ms(ms))
}

/// Returns the instant of a date, `year month day hour minute second`, in GPS time, or in UTC and
/// this many hours ahead of it.
pub fn date(text: &str, ahead_of_utc_h: Option<u8>) -> Option<GpsTime> {
    let Some(ahead_h) = ahead_of_utc_h else { return instant(text, TimeSystem::Gps) };
    let local = instant(text, TimeSystem::Gps)?;
    let utc_ms = local.to_ms().cast_signed() - 3_600_000 * i64::from(ahead_h);
    from_ms(utc_ms + 1000 * i64::from(leap_seconds_of_utc(utc_ms, None)))
}

/// Returns the instant this many milliseconds after 1980-01-06, if it is within a century.
fn from_ms(ms: i64) -> Option<GpsTime> {
    // 5,200 weeks: a century.
    const CENTURY_MS: i64 = 5200 * 7 * DAY_MS;
    (0..CENTURY_MS).contains(&ms).then(|| GpsTime::from_ms(ms as u64))
}

/// Returns the instant closest to `near` whose second of the week is `tow_s`, whatever the week of
/// either; `None` for a second that is more than a week before or after the week's beginning.
pub fn nearest_week(tow_s: f64, near: GpsTime, system: TimeSystem) -> Option<GpsTime> {
    const WEEK_S: f64 = 604_800.0;
    const WEEK_MS: i64 = 7 * DAY_MS;
    if !(-WEEK_S..=WEEK_S).contains(&tow_s) {
        return None;
    }
    let near_ms = near.to_ms().cast_signed();
    let tow_ms = (tow_s * 1000.0).round() as i64 + system.behind_gps_ms(near_ms);
    let ahead_ms = (tow_ms - near_ms + WEEK_MS / 2).rem_euclid(WEEK_MS) - WEEK_MS / 2;
    from_ms(near_ms + ahead_ms)
}

/// Returns `2020-06-25 00:00:30`, GPS time.
pub fn readable(time: GpsTime) -> String {
    readable_unix(time.to_ms().cast_signed() + GPS_EPOCH_DAYS * DAY_MS)
}

/// Returns `2020-06-25 00:00:30` for milliseconds since 1970.
pub fn readable_unix(ms: i64) -> String {
    let (year, month, day) = civil_from_days(ms.div_euclid(DAY_MS));
    let second = ms.rem_euclid(DAY_MS) / 1000;
    let (hour, minute) = (second / 3600, second / 60 % 60);
    format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{:02}", second % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_match_the_published_weeks() {
        // Weeks and seconds are those beside the same dates in IGS navigation files.
        for (text, system, week, tow_s) in [
            ("1980 1 6 0 0 0", TimeSystem::Gps, 0, 0.0),
            ("20 6 25 0 0 0.0", TimeSystem::Gps, 2111, 345_600.0),
            ("2024 01 01 00 00 00", TimeSystem::Gps, 2295, 86_400.0),
            ("2024 01 01 00 00 00", TimeSystem::Beidou, 2295, 86_414.0),
            ("2024 06 24 08 00 33.9970000", TimeSystem::Gps, 2320, 115_233.997),
            ("2024 2 29 23 59 42", TimeSystem::Utc { stated_s: None }, 2303, 432_000.0),
            ("2016 6 6 11 10 25", TimeSystem::Utc { stated_s: Some(18) }, 1900, 126_642.0),
        ] {
            let have = instant(text, system).unwrap();
            let want = GpsTime { week, tow_ms: f64::round(tow_s * 1000.0) as u32 };
            assert_eq!(have, want, "{text}");
        }
    }

    #[test]
    fn a_date_prints_as_it_was_read() {
        for text in ["1999-12-31 23:59:59", "2000-02-29 00:00:00", "2024-12-31 12:34:56"] {
            let have = instant(&text.replace(['-', ':'], " "), TimeSystem::Gps).map(readable).unwrap();
            assert_eq!(have, text);
        }
    }

    /// IERS Bulletin C: number after the leap second at the end of 2005, 2016 and June 2012.
    #[test]
    fn leap_seconds_are_those_of_the_date() {
        for (utc, before_s, after_s) in [("2006 1 1", 13, 14), ("2012 7 1", 15, 16), ("2017 1 1", 17, 18)] {
            let midnight = instant(&format!("{utc} 0 0 0"), TimeSystem::Gps).unwrap();
            let at = |offset_s: i64| {
                let ms = midnight.to_ms().cast_signed() + 1000 * (i64::from(before_s) + offset_s);
                leap_seconds(from_ms(ms).unwrap(), None)
            };
            assert_eq!([at(-1), at(1)], [before_s, after_s], "{utc}");
        }
        // A file may state a leap second of later years, but none of earlier ones.
        let later = instant("2031 1 1 0 0 0", TimeSystem::Gps).unwrap();
        assert_eq!(
            [None, Some(18), Some(19), Some(0)].map(|stated| leap_seconds(later, stated)),
            [18, 18, 19, 18]
        );
        let earlier = instant("2016 6 6 0 0 0", TimeSystem::Gps).unwrap();
        assert_eq!([None, Some(17), Some(18)].map(|stated| leap_seconds(earlier, stated)), [17; 3]);
    }

    #[test]
    fn nonsense_is_refused() {
        for text in ["", "2024 13 1 0 0 0", "2024 1 1 25 0 0", "1979 1 1 0 0 0", "2024 1 1 0 0 NaN", "x"] {
            assert_eq!(instant(text, TimeSystem::Gps), None, "{text}");
        }
    }

    #[test]
    fn a_time_of_week_belongs_to_the_nearest_week() {
        let sunday = GpsTime { week: 2320, tow_ms: 0 };
        let have = nearest_week(604_000.0, sunday, TimeSystem::Gps).unwrap();
        let want = GpsTime { week: 2319, tow_ms: 604_000_000 };
        assert_eq!(have, want);
    }
}
