//! Choice between sources of ranges: a receiver may send them in two formats, or another station
//! may share its line.
//!
//! A source is a format and, in RTCM, the number of a station. The source whose ranges come first
//! is used, because ranges of two antennas in one epoch would give the position of neither. If the
//! source in use has been missing for [`PATIENCE_MS`] and for more than [`PATIENCE`] epochs of
//! other sources, another one replaces it. Otherwise a receiver that changes its format at start
//! would silence the module. When the first source returns, it is used again from its next epoch
//! on.
//!
//! If ranges of a source have agreed with orbits, it is settled as the receiver
//! ([`Preference::settle`]), and no other source replaces it until `FORGET`. A receiver in a tunnel
//! is silent while its corrections continue. The base station that sends them is near, so that its
//! position would look right. A source is present while it sends messages of ranges, even without
//! satellites.
//!
//! **Limit.** If another station's ranges are the first to come, they are used. Corrections must
//! therefore come on a separate line.

use super::Format;
use crate::time::WEEK_MS;

/// Largest number of epochs of other sources before another source may replace the one in use.
const PATIENCE: u8 = 3;

/// Least time without the source in use, by the tags of epochs, before another replaces it, ms.
const PATIENCE_MS: u32 = 30_000;

/// Source of ranges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Source {
    pub(super) format: Format,
    /// Number of the station; 0 if the format has none.
    pub(super) station: u16,
}

/// The source in use, and the count of epochs from other sources since it was last present.
#[derive(Debug)]
pub(super) struct Preference {
    first: Option<Source>,
    used: Option<Source>,
    /// True if no other source may replace it.
    is_settled: bool,
    /// Time of week, ms, at which the source in use was last present.
    used_ms: Option<u32>,
    /// Number of consecutive epochs of other sources.
    others: u8,
    /// Time of week of the last epoch of any source, ms.
    last_ms: Option<u32>,
    /// Time of week, ms, of the last epoch from a replacement. The first source does not add to it.
    spent_ms: Option<u32>,
}

impl Preference {
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self {
            first: None,
            used: None,
            is_settled: false,
            used_ms: None,
            others: 0,
            last_ms: None,
            spent_ms: None,
        }
    }

    /// Settles on the source in use as the receiver, because its ranges agreed with orbits.
    pub(super) fn settle(&mut self) {
        (self.first, self.is_settled) = (self.used, true);
    }

    /// Returns true if ranges of this source are used. `tow_ms` is the time of week of their epoch,
    /// ms, if it is known.
    pub(super) fn takes(&mut self, source: Source, tow_ms: Option<u32>, is_empty: bool) -> bool {
        if self.used.is_none_or(|used| used == source) {
            (self.others, self.used_ms) = (0, tow_ms.or(self.used_ms));
        }
        if is_empty {
            return self.used.is_none_or(|used| used == source);
        }
        let first = *self.first.get_or_insert(source);
        let used = *self.used.get_or_insert(source);
        if source != used {
            if source == first {
                self.spent_ms = self.last_ms;
            } else {
                // Only a message that begins an epoch with a known time counts as an epoch of
                // another source.
                self.others =
                    self.others.saturating_add(u8::from(tow_ms.is_some() && tow_ms != self.last_ms));
                if self.is_settled || self.others <= PATIENCE || !self.is_missing(tow_ms) {
                    self.last_ms = tow_ms.or(self.last_ms);
                    return false;
                }
                self.spent_ms = None;
            }
            self.used = Some(source);
        }
        (self.others, self.last_ms, self.used_ms) = (0, tow_ms.or(self.last_ms), tow_ms.or(self.used_ms));
        tow_ms.is_none() || tow_ms != self.spent_ms
    }

    /// Returns true if epochs of other sources come while the settled one is missing. Only `FORGET`
    /// then lets another source be used.
    pub(super) const fn hears_others(&self) -> bool {
        self.is_settled && self.others > PATIENCE
    }

    /// Returns true if the source in use has been missing for [`PATIENCE_MS`].
    fn is_missing(&self, tow_ms: Option<u32>) -> bool {
        let since_ms = |(now_ms, then_ms): (u32, u32)| (now_ms + WEEK_MS).saturating_sub(then_ms) % WEEK_MS;
        tow_ms.zip(self.used_ms).map(since_ms).is_none_or(|since_ms| since_ms >= PATIENCE_MS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RECEIVER: Source = Source { format: Format::Ubx, station: 0 };
    const SAME: Source = Source { format: Format::Rtcm, station: 0 };
    const BASE: Source = Source { format: Format::Rtcm, station: 7 };

    fn takes(preference: &mut Preference, source: Source, second: u32) -> bool {
        preference.takes(source, Some(1000 * second), false)
    }

    #[test]
    fn the_format_that_came_first_is_used_until_it_is_missing() {
        let mut preference = Preference::new();
        for second in 0..10 {
            assert!(takes(&mut preference, RECEIVER, second));
            // An epoch has several messages.
            assert!(!takes(&mut preference, SAME, second));
            assert!(!takes(&mut preference, SAME, second));
        }
        let taken = (10..50).map(|second| takes(&mut preference, SAME, second));
        assert_eq!(taken.filter(|taken| *taken).count(), 11);
    }

    #[test]
    fn nobody_stands_in_for_whose_ranges_have_agreed() {
        let mut preference = Preference::new();
        assert!(takes(&mut preference, RECEIVER, 0));
        preference.settle();
        assert!(!preference.hears_others());
        assert!(!(1..10_000).any(|second| takes(&mut preference, BASE, second)));
        assert!(preference.hears_others());
        assert!(takes(&mut preference, RECEIVER, 10_000));
        assert!(!preference.hears_others());
    }

    #[test]
    fn who_stands_in_and_agrees_is_the_receiver() {
        let mut preference = Preference::new();
        assert!(takes(&mut preference, BASE, 0));
        assert_eq!((1..60).filter(|&second| takes(&mut preference, RECEIVER, second)).count(), 30);
        preference.settle();
        assert!(!takes(&mut preference, BASE, 60) && takes(&mut preference, RECEIVER, 60));
    }

    #[test]
    fn who_has_no_ranges_or_seldom_some_is_there() {
        let mut preference = Preference::new();
        assert!(takes(&mut preference, RECEIVER, 0));
        for second in 1..100 {
            preference.takes(RECEIVER, Some(1000 * second), true);
            assert!(!takes(&mut preference, BASE, second));
        }
        // One source at 0.1 Hz, and another at 5 Hz.
        for fifth in 500..1500 {
            let tow_ms = Some(200 * fifth);
            assert_eq!(fifth % 50 == 0 && preference.takes(RECEIVER, tow_ms, false), fifth % 50 == 0);
            assert!(!preference.takes(BASE, tow_ms, false));
        }
    }

    #[test]
    fn the_first_is_used_again_from_its_next_epoch_on() {
        let mut preference = Preference::new();
        assert!(takes(&mut preference, RECEIVER, 0));
        let stood_in = (1..40).filter(|second| takes(&mut preference, BASE, *second)).count();
        assert_eq!(stood_in, 10);
        // Both are there, the other one before it in each second.
        assert!(takes(&mut preference, BASE, 40));
        assert!(!takes(&mut preference, RECEIVER, 40), "two places in one epoch");
        for second in 41..45 {
            assert!(!takes(&mut preference, BASE, second));
            assert!(takes(&mut preference, RECEIVER, second));
        }
    }

    #[test]
    fn another_station_is_none_of_the_receiver() {
        let mut preference = Preference::new();
        for second in 0..10 {
            assert!(takes(&mut preference, SAME, second));
            assert!(!takes(&mut preference, BASE, second));
        }
    }

    #[test]
    fn who_has_no_ranges_takes_nobodys_place() {
        let mut preference = Preference::new();
        for second in 0..10 {
            preference.takes(SAME, Some(1000 * second), true);
            assert!(takes(&mut preference, RECEIVER, second));
        }
    }
}
