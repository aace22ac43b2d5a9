//! GPS time minus UTC: its sources, and the evidence that each needs to change a known number.
//!
//! | source | evidence that changes a known number |
//! |---|---|
//! | the receiver, or satellites in their navigation bits | a number that differs by 1, twice in a row; any other number, [`RUN`] times in a row |
//! | messages of one instant, one tagged with GPS time and one with UTC | any number, [`RUN`] times in a row |
//!
//! If no number is known, the first statement of a receiver or satellite counts. Later statements
//! must repeat, because a single one may be damaged. A step of 1 needs fewer, because leap seconds
//! come one at a time.
//!
//! A leap second is inserted at the end of June or December, at midnight of UTC ([ITU-R TF.460-6]).
//! Around that midnight, tags in [`STEP_RUN`] epochs suffice for a step of 1. Until they agree, a
//! UTC tag is uncertain by a second ([`LeapSeconds::is_unsure`]).
//!
//! [ITU-R TF.460-6]: crate#references

use crate::division::divided;
use crate::time::{DAY_MS, GpsTime, WEEK_MS};

/// Number of consecutive statements that overrule a known number.
const RUN: u8 = 10;

/// Number of consecutive tags that suffice for a step of 1 while a leap second may be inserted.
const STEP_RUN: u8 = 2;

/// Time before the midnight of a leap second from which on the step may appear, ms.
const BEFORE_STEP_MS: u32 = 60_000;

/// Time after that midnight until which the step may appear, ms.
const AFTER_STEP_MS: u32 = 60_000;

/// The inserted second, ms. By the number before the step it is the first second of the new day.
const LEAP_SECOND_MS: u32 = 1000;

/// Upper bound of leap seconds, s.
pub(in crate::input) const MOST_S: u32 = 63;

/// Difference below which tags are of one instant, ms.
const TAG_MS: u32 = 10;

/// Source of the number of leap seconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LeapSource {
    /// The receiver.
    Receiver,
    /// Satellites, in their navigation bits.
    Satellites,
    /// Messages of one instant, tagged with GPS time and with UTC.
    Tags,
}

/// GPS time minus UTC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct LeapSecond {
    /// GPS time minus UTC, s.
    pub seconds: u8,
    /// Source of the last statement.
    pub source: LeapSource,
    /// Time of the last epoch before that statement.
    pub reported: Option<GpsTime>,
}

/// Known number, and the last statements.
#[derive(Debug)]
pub(super) struct LeapSeconds {
    known: Option<LeapSecond>,
    claimed: Repeated,
    inferred: Repeated,
    /// Last epoch at the last comparison of tags.
    compared: Option<GpsTime>,
}

/// A number, and how often in a row it came.
#[derive(Debug)]
struct Repeated {
    seconds: u8,
    run: u8,
}

impl Repeated {
    const NONE: Self = Self { seconds: 0, run: 0 };

    /// Counts a number; returns how often in a row it has come.
    fn count(&mut self, seconds: u8) -> u8 {
        let run = if seconds == self.seconds { self.run.saturating_add(1) } else { 1 };
        *self = Self { seconds, run };
        run
    }
}

impl LeapSeconds {
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self { known: None, claimed: Repeated::NONE, inferred: Repeated::NONE, compared: None }
    }

    /// Returns GPS time minus UTC, with its source and time.
    pub(super) fn known(&self) -> Option<LeapSecond> {
        self.known
    }

    /// Takes a stated number; `now` is the last epoch.
    pub(super) fn receive(&mut self, seconds: u8, source: LeapSource, now: Option<GpsTime>) {
        let needed = match self.known.map_or(0, |known| known.seconds.abs_diff(seconds)) {
            0 => 1,
            1 => 2,
            _ => RUN,
        };
        if self.claimed.count(seconds) >= needed {
            self.known = Some(LeapSecond { seconds, source, reported: now });
        }
    }

    /// Takes the tags of two messages of one instant. One comparison is not enough: after lost
    /// bytes, one of the messages may be of a neighbouring epoch. Its tag then differs by whole
    /// seconds.
    pub(super) fn infer(&mut self, gps_ms: u32, utc_ms: u32, now: Option<GpsTime>) {
        let difference_ms = (gps_ms + WEEK_MS - utc_ms) % WEEK_MS;
        let seconds = (difference_ms + 500) / 1000;
        if seconds > MOST_S || difference_ms.abs_diff(1000 * seconds) >= TAG_MS {
            return;
        }
        let seconds = seconds as u8;
        self.compared = now;
        let is_news = self.known.is_none_or(|known| known.seconds != seconds);
        let is_next = self.known.is_some_and(|known| known.seconds.abs_diff(seconds) == 1);
        let needed = if is_next && self.is_step_due(now) { STEP_RUN } else { RUN };
        if self.inferred.count(seconds) >= needed && is_news {
            self.known = Some(LeapSecond { seconds, source: LeapSource::Tags, reported: now });
        }
    }
}

impl LeapSeconds {
    /// Returns true while a leap second may be inserted; `now` is the last epoch.
    pub(super) fn is_step_due(&self, now: Option<GpsTime>) -> bool {
        let Some((day, of_day_ms)) = self.utc(now) else { return false };
        match of_day_ms {
            ..=AFTER_STEP_MS => begins_half_year(day),
            _ => of_day_ms >= DAY_MS - BEFORE_STEP_MS && begins_half_year(day + 1),
        }
    }

    /// Returns true if a UTC tag that is the first of its instant may be wrong by a second. Either
    /// no tags were compared since the leap second became possible, or they did not fit the known
    /// number.
    pub(super) fn is_unsure(&self, utc_ms: u32, now: Option<GpsTime>) -> bool {
        if self.inferred.run == 0 || !self.is_step_due(now) {
            return false;
        }
        let is_after = utc_ms % DAY_MS < DAY_MS / 2;
        let was_compared = self
            .utc(self.compared)
            .is_some_and(|(day, of_day_ms)| begins_half_year(day) && of_day_ms >= LEAP_SECOND_MS);
        let has_misfit = self.known.is_some_and(|known| known.seconds != self.inferred.seconds);
        has_misfit || is_after && !was_compared
    }

    /// Returns the days since 1980-01-06 in UTC, and the milliseconds of the day.
    fn utc(&self, now: Option<GpsTime>) -> Option<(u32, u32)> {
        let leap_ms = 1000 * u64::from(self.known?.seconds);
        let (day, of_day_ms) = divided(now?.to_ms().saturating_sub(leap_ms), DAY_MS);
        Some((day as u32, of_day_ms))
    }
}

/// Returns true for the first of January and of July, until 2099.
pub(crate) const fn begins_half_year(days_since_1980_01_06: u32) -> bool {
    // Days of four years, of which the first is a leap year, as 1980 was.
    matches!((days_since_1980_01_06 + 5) % 1461, 0 | 182 | 366 | 547 | 731 | 912 | 1096 | 1277)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_word_changes_nothing_that_is_known() {
        let mut leap = LeapSeconds::new();
        let seconds = |leap: &LeapSeconds| leap.known().map(|leap| leap.seconds);
        leap.receive(18, LeapSource::Satellites, None);
        assert_eq!(seconds(&leap), Some(18));
        for wrong in [28, 19, 28, 17] {
            leap.receive(wrong, LeapSource::Satellites, None);
            assert_eq!(seconds(&leap), Some(18), "{wrong} said once");
        }
        // A leap second has come.
        leap.receive(19, LeapSource::Receiver, None);
        leap.receive(19, LeapSource::Receiver, None);
        assert_eq!(seconds(&leap), Some(19));
        for _ in 0..RUN {
            assert_eq!(seconds(&leap), Some(19));
            leap.receive(12, LeapSource::Receiver, None);
        }
        assert_eq!(seconds(&leap), Some(12));
    }

    #[test]
    fn tags_of_one_instant_mend_what_is_known() {
        let mut leap = LeapSeconds::new();
        leap.receive(28, LeapSource::Satellites, None);
        for second in 100..100 + u32::from(RUN) {
            leap.infer(1000 * second, 1000 * (second - 18), None);
        }
        assert_eq!(leap.known(), Some(LeapSecond { seconds: 18, source: LeapSource::Tags, reported: None }));
    }

    #[test]
    fn half_years_begin_when_leap_seconds_were_inserted() {
        // IERS Bulletin C: the first instant after a leap second, s of Unix time, and GPS time
        // minus UTC from then on.
        const UNIX_1980_01_06: u64 = 315_964_800;
        let inserted = [
            (362_793_600, 1),    // 1981-07-01
            (567_993_600, 5),    // 1988-01-01
            (820_454_400, 11),   // 1996-01-01
            (1_136_073_600, 14), // 2006-01-01
            (1_230_768_000, 15), // 2009-01-01
            (1_341_100_800, 16), // 2012-07-01
            (1_435_708_800, 17), // 2015-07-01
            (1_483_228_800, 18), // 2017-01-01
        ];
        for (unix_s, after) in inserted {
            let mut leap = LeapSeconds::new();
            leap.receive(after - 1, LeapSource::Receiver, None);
            let at = |offset_s: u64| {
                let ms = 1000 * (unix_s - UNIX_1980_01_06 + u64::from(after) - 100 + offset_s);
                leap.is_step_due(Some(GpsTime::from_ms(ms)))
            };
            // Second 99 is midnight by the number before the step.
            assert_eq!([38, 39, 100, 159, 160].map(at), [false, true, true, true, false], "{unix_s}");
        }
    }

    #[test]
    fn step_of_a_second_needs_two_epochs_at_the_end_of_a_half_year_only() {
        for (unix_s, needed) in [(1_483_228_800_u64, 2), (1_483_228_800 - 86_400, u32::from(RUN))] {
            let mut leap = LeapSeconds::new();
            leap.receive(17, LeapSource::Receiver, None);
            let midnight_s = unix_s - 315_964_800 + 18;
            let known = (0..needed).map(|second| {
                let now = GpsTime::from_ms(1000 * (midnight_s + u64::from(second)));
                leap.infer(now.tow_ms, (now.tow_ms + WEEK_MS - 18_000) % WEEK_MS, Some(now));
                leap.known().map(|leap| leap.seconds)
            });
            let known: std::vec::Vec<_> = known.collect();
            assert!(known[..known.len() - 1].iter().all(|known| *known == Some(17)), "{known:?}");
            assert_eq!(known.last(), Some(&Some(18)));
        }
    }
}
