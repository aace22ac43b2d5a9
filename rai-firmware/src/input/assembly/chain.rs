//! Chains of messages: each message of one instant, except the last, states that more follow.
//!
//! A receiver may tag one of its systems with a time that is seconds off. For example, a station of
//! 2012 tags `BeiDou` with GPS time, 14 s ahead. Taken alone, such a message would open an epoch in
//! the future, and every later message of the other systems would be in the past. But the message
//! before it stated that more of **the same** instant follow, which the tag contradicts. The
//! message is left out, and the other systems stay in use.
//!
//! | case | reason why the message stays |
//! |---|---|
//! | no message ever stated that none follows | the receiver never ends a chain, so that its statements are no evidence |
//! | the system already has a message in this chain | the next epoch begins; the end of this chain was lost |
//! | the tag is in UTC | the tag may be wrong by a leap second; the calendar needs the message to infer the leap seconds |
//! | the line was silent, or bytes were lost | the chain may have ended meanwhile |

use crate::input::{Ranges, Series};
use crate::time::WEEK_MS;

/// Smallest difference of tags that contradicts a chain, ms. If the difference is smaller, the
/// messages are of one instant, or are reported as its halves with different tags.
pub(super) const ASTRAY_MS: u32 = 500;

/// Chain under way.
#[derive(Debug)]
pub(super) struct Chain {
    /// Time of week of the chain, ms, while more of it follow.
    instant_ms: Option<u32>,
    /// Series that have a message in the chain, one bit each.
    heard: u16,
    /// True if a message stated that none follows.
    is_ever_ended: bool,
}

impl Chain {
    pub(super) const fn new() -> Self {
        Self { instant_ms: None, heard: 0, is_ever_ended: false }
    }

    /// Takes a message with its time of week, ms. Returns true if its tag contradicts the chain.
    pub(super) fn take(&mut self, ranges: &Ranges<'_>, tow_ms: u32) -> bool {
        let Some(series) = ranges.series else { return false };
        if ranges.of_utc_ms.is_some() || ranges.measured.is_empty() {
            return false;
        }
        let is_new = self.heard & bit(series) == 0;
        match self.instant_ms {
            Some(instant_ms) if apart_ms(instant_ms, tow_ms) < ASTRAY_MS => {}
            Some(_) if is_new && (self.is_ever_ended || !ranges.more_follow) => return true,
            _ => {
                self.instant_ms = Some(tow_ms);
                self.heard = 0;
            }
        }
        self.heard |= bit(series);
        false
    }

    /// Ends the chain, because a message stated that none follows.
    pub(super) const fn end(&mut self) {
        self.is_ever_ended = true;
        self.forget();
    }

    /// Forgets the chain, because the message that ends it may be lost.
    pub(super) const fn forget(&mut self) {
        self.instant_ms = None;
        self.heard = 0;
    }
}

/// Returns the bit of a series.
pub(super) fn bit(series: Series) -> u16 {
    1_u16.checked_shl(u32::from(series)).unwrap_or(0)
}

/// Returns the time between two times of week, ms.
pub(super) fn apart_ms(a_ms: u32, b_ms: u32) -> u32 {
    let apart_ms = a_ms.abs_diff(b_ms);
    apart_ms.min(WEEK_MS.saturating_sub(apart_ms))
}
