//! Which format's ranges are used, where a receiver sends the same in two.
//!
//! Those of the format whose ranges came first. When that one has been missing for [`PATIENCE`] epochs of the other, the
//! other takes its place: a receiver that was told to change its format must not silence the module.

use super::Ranges;
use super::framer::Protocol;

/// Epochs of the other format without one of the first.
const PATIENCE: u8 = 3;

/// The format in use, and what came in the other one since.
#[derive(Debug)]
pub(super) struct Preference {
    first: Option<Protocol>,
    /// Epochs of the other format in a row, and the time of week of the last of them.
    others: (u8, Option<u32>),
}

impl Preference {
    pub(super) const fn new() -> Self {
        Self { first: None, others: (0, None) }
    }

    /// Whether ranges in this format are used.
    pub(super) fn takes(&mut self, protocol: Protocol, ranges: &Ranges<'_>) -> bool {
        let first = *self.first.get_or_insert(protocol);
        if first == protocol {
            // The same epoch in the other format is not one without this.
            self.others = (0, ranges.tow_ms);
            return true;
        }
        let (epochs, last_ms) = self.others;
        // A message whose time cannot be told counts for no epoch.
        if ranges.tow_ms.is_some() && ranges.tow_ms != last_ms {
            self.others = (epochs + 1, ranges.tow_ms);
        }
        if self.others.0 <= PATIENCE {
            return false;
        }
        *self = Self { first: Some(protocol), others: (0, ranges.tow_ms) };
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::Measured;
    use super::*;

    fn at(tow_ms: u32) -> Ranges<'static> {
        let measured = Measured::Nothing;
        Ranges {
            series: None,
            tow_ms: Some(tow_ms),
            of_utc_ms: None,
            stated: None,
            more_follow: false,
            measured,
        }
    }

    #[test]
    fn the_format_that_came_first_is_used_until_it_is_missing() {
        let mut preference = Preference::new();
        for second in 0..10 {
            assert!(preference.takes(Protocol::Ubx, &at(1000 * second)));
            // Several messages an epoch.
            assert!(!preference.takes(Protocol::Rtcm, &at(1000 * second)));
            assert!(!preference.takes(Protocol::Rtcm, &at(1000 * second)));
        }
        let taken = (10..20).map(|second| preference.takes(Protocol::Rtcm, &at(1000 * second)));
        assert_eq!(taken.filter(|taken| *taken).count(), 7);
        assert!(!preference.takes(Protocol::Ubx, &at(20_000)));
    }
}
