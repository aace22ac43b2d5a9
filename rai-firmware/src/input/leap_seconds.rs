//! How many seconds GPS time is ahead of UTC: who says it, and when it is believed.
//!
//! | who | what changes a known number |
//! |---|---|
//! | the receiver, or satellites in their navigation bits | the next number, said twice in a row; any other, said [`RUN`] times in a row |
//! | messages of one instant, one tagged with GPS time and one with UTC | any other, the same [`RUN`] times in a row |
//!
//! Where nothing is known, the first word counts. One word may be spoilt; leap seconds come one at a time.

use crate::time::{GpsTime, WEEK_MS};

/// How often in a row something has to be said that contradicts what is known.
const RUN: u8 = 10;

/// More leap seconds than there will be.
const MOST_S: u32 = 63;

/// Tags of one instant differ by less, ms.
const TAG_MS: u32 = 10;

/// Who said how many leap seconds there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeapSource {
    /// The receiver.
    Receiver,
    /// Satellites, in their navigation bits.
    Satellites,
    /// Messages of one instant, tagged with GPS time and with UTC.
    Tags,
}

/// How far GPS time is ahead of UTC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeapSecond {
    /// GPS time minus UTC, s.
    pub seconds: u8,
    /// Who said so last.
    pub source: LeapSource,
    /// When, by the last epoch.
    pub said: Option<GpsTime>,
}

/// What is known, and what was said last.
#[derive(Debug)]
pub(super) struct LeapSeconds {
    known: Option<LeapSecond>,
    claimed: Repeated,
    inferred: Repeated,
}

/// A number, and how often in a row it has come.
#[derive(Debug)]
struct Repeated {
    seconds: u8,
    run: u8,
}

impl Repeated {
    const NONE: Self = Self { seconds: 0, run: 0 };

    /// Counts a number; gives how often in a row it has come.
    fn count(&mut self, seconds: u8) -> u8 {
        let run = if seconds == self.seconds { self.run.saturating_add(1) } else { 1 };
        *self = Self { seconds, run };
        run
    }
}

impl LeapSeconds {
    pub(super) const fn new() -> Self {
        Self { known: None, claimed: Repeated::NONE, inferred: Repeated::NONE }
    }

    /// GPS time minus UTC, who said so and when.
    pub(super) fn known(&self) -> Option<LeapSecond> {
        self.known
    }

    /// Somebody says how many there are; `now` is the last epoch.
    pub(super) fn hear(&mut self, seconds: u8, source: LeapSource, now: Option<GpsTime>) {
        let needed = match self.known.map_or(0, |known| known.seconds.abs_diff(seconds)) {
            0 => 1,
            1 => 2,
            _ => RUN,
        };
        if self.claimed.count(seconds) >= needed {
            self.known = Some(LeapSecond { seconds, source, said: now });
        }
    }

    /// Two messages of one instant are tagged so. A message of a neighbouring epoch, where bytes were lost, is wrong by whole
    /// seconds, and so is not believed at once.
    pub(super) fn infer(&mut self, gps_ms: u32, utc_ms: u32, now: Option<GpsTime>) {
        let difference_ms = (gps_ms + WEEK_MS - utc_ms) % WEEK_MS;
        let seconds = (difference_ms + 500) / 1000;
        if seconds > MOST_S || difference_ms.abs_diff(1000 * seconds) >= TAG_MS {
            return;
        }
        let seconds = seconds as u8;
        let is_news = self.known.is_none_or(|known| known.seconds != seconds);
        if self.inferred.count(seconds) >= RUN && is_news {
            self.known = Some(LeapSecond { seconds, source: LeapSource::Tags, said: now });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_word_changes_nothing_that_is_known() {
        let mut leap = LeapSeconds::new();
        let seconds = |leap: &LeapSeconds| leap.known().map(|leap| leap.seconds);
        leap.hear(18, LeapSource::Satellites, None);
        assert_eq!(seconds(&leap), Some(18));
        for wrong in [28, 19, 28, 17] {
            leap.hear(wrong, LeapSource::Satellites, None);
            assert_eq!(seconds(&leap), Some(18), "{wrong} said once");
        }
        // A leap second has come.
        leap.hear(19, LeapSource::Receiver, None);
        leap.hear(19, LeapSource::Receiver, None);
        assert_eq!(seconds(&leap), Some(19));
        for _ in 0..RUN {
            assert_eq!(seconds(&leap), Some(19));
            leap.hear(12, LeapSource::Receiver, None);
        }
        assert_eq!(seconds(&leap), Some(12));
    }

    #[test]
    fn tags_of_one_instant_mend_what_is_known() {
        let mut leap = LeapSeconds::new();
        leap.hear(28, LeapSource::Satellites, None);
        for second in 100..100 + u32::from(RUN) {
            leap.infer(1000 * second, 1000 * (second - 18), None);
        }
        assert_eq!(leap.known(), Some(LeapSecond { seconds: 18, source: LeapSource::Tags, said: None }));
    }
}
