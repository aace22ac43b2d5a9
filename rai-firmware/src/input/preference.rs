//! Whose ranges are used, where a receiver sends the same in two formats, or another station's share its line.
//!
//! Those of the source whose ranges came first: a format, and in RTCM the number of a station. Two antennas in one epoch would be one
//! place that is neither. When the first has been missing for [`PATIENCE`] epochs of another, that one stands in: a receiver
//! that was told to change its format must not silence the module. It does so until the first is back, from whose next
//! epoch on the first is used again.
//!
//! **Limit.** Where another station's ranges are the first to come, it is theirs that are used: corrections are to come on a line of
//! their own.

use super::framer::Protocol;

/// Epochs of another source without one of the first.
const PATIENCE: u8 = 3;

/// Who sends ranges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Source {
    pub(super) protocol: Protocol,
    /// Number of the station, 0 in a format that has none.
    pub(super) station: u16,
}

/// The source in use, and what came of others since.
#[derive(Debug)]
pub(super) struct Preference {
    first: Option<Source>,
    used: Option<Source>,
    /// Epochs of others in a row.
    others: u8,
    /// The time of week of the last epoch of any.
    last_ms: Option<u32>,
    /// The epoch in which another stood in for the last time: the rest of it is nobody's.
    spent_ms: Option<u32>,
}

impl Preference {
    pub(super) const fn new() -> Self {
        Self { first: None, used: None, others: 0, last_ms: None, spent_ms: None }
    }

    /// Whether ranges of this source are used, of an epoch at this time of week, if it can be told.
    pub(super) fn takes(&mut self, source: Source, tow_ms: Option<u32>, is_empty: bool) -> bool {
        if is_empty {
            // Who has nothing to say says neither that it is there.
            return self.used.is_none_or(|used| used == source);
        }
        let first = *self.first.get_or_insert(source);
        let used = *self.used.get_or_insert(source);
        if source != used {
            if source == first {
                self.spent_ms = self.last_ms;
            } else {
                // Another message of the same epoch is not one without the first, nor is one whose time cannot be told.
                self.others += u8::from(tow_ms.is_some() && tow_ms != self.last_ms);
                if self.others <= PATIENCE {
                    self.last_ms = tow_ms.or(self.last_ms);
                    return false;
                }
                self.spent_ms = None;
            }
            self.used = Some(source);
        }
        (self.others, self.last_ms) = (0, tow_ms.or(self.last_ms));
        tow_ms.is_none() || tow_ms != self.spent_ms
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RECEIVER: Source = Source { protocol: Protocol::Ubx, station: 0 };
    const SAME: Source = Source { protocol: Protocol::Rtcm, station: 0 };
    const BASE: Source = Source { protocol: Protocol::Rtcm, station: 7 };

    fn takes(preference: &mut Preference, source: Source, second: u32) -> bool {
        preference.takes(source, Some(1000 * second), false)
    }

    #[test]
    fn the_format_that_came_first_is_used_until_it_is_missing() {
        let mut preference = Preference::new();
        for second in 0..10 {
            assert!(takes(&mut preference, RECEIVER, second));
            // Several messages an epoch.
            assert!(!takes(&mut preference, SAME, second));
            assert!(!takes(&mut preference, SAME, second));
        }
        let taken = (10..20).map(|second| takes(&mut preference, SAME, second));
        assert_eq!(taken.filter(|taken| *taken).count(), 7);
    }

    #[test]
    fn the_first_is_used_again_from_its_next_epoch_on() {
        let mut preference = Preference::new();
        assert!(takes(&mut preference, RECEIVER, 0));
        let stood_in = (1..10).filter(|second| takes(&mut preference, BASE, *second)).count();
        assert_eq!(stood_in, 6);
        // Both are there, the other one before it in each second.
        assert!(takes(&mut preference, BASE, 10));
        assert!(!takes(&mut preference, RECEIVER, 10), "two places in one epoch");
        for second in 11..15 {
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
