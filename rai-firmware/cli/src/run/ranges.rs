//! A receiver that sends no ranges any more, and other messages still.
//!
//! ```text
//! no epoch for max(5 s, 3 usual intervals), and valid frames for 2 s after that ─► its ranges are missing
//! ```
//!
//! The module reports `STALE`, as for a line that is dead. Here the line lives, and the usual cause is
//! a change of the receiver's configuration, by whoever may write to it. This is said once, on the
//! page, and in the metrics.

/// Shortest time without an epoch after which ranges are missing, ms.
const SHORTEST_MS: u64 = 5000;
/// Usual intervals between epochs after which they are missing.
const INTERVALS: u64 = 3;
/// Time for which frames must come without an epoch, ms: a computer that has slept gets the first
/// frames before the next epoch.
const CERTAIN_MS: u64 = 2000;
/// Time after the last valid frame after which the line counts as dead, ms.
const DEAD_MS: u64 = 10_000;

/// The epochs of a receiver.
#[derive(Debug, Default)]
pub(super) struct Ranges {
    /// Time tag of the last epoch, s, and the instant at which it was seen, ms.
    last: Option<(f64, u64)>,
    interval_ms: u64,
    /// Valid frames so far, and the instant of the last one, ms.
    frames: u32,
    heard_ms: u64,
    /// The instant of the first frame after an epoch was due, ms.
    late_ms: Option<u64>,
    are_missing: bool,
    is_said: bool,
}

impl Ranges {
    /// Looks at the last epoch and at the number of valid frames; returns what is to be said.
    pub(super) fn look(&mut self, tag_s: Option<f64>, frames: u32, now_ms: u64) -> Option<&'static str> {
        if std::mem::replace(&mut self.frames, frames) != frames {
            self.heard_ms = now_ms;
        }
        // The module forgets its last epoch in a silence.
        let tag_s = tag_s.or(self.last.map(|(last_s, _)| last_s))?;
        match self.last {
            Some((last_s, since_ms)) if last_s.to_bits() == tag_s.to_bits() => {
                let due_ms = since_ms + SHORTEST_MS.max(INTERVALS.saturating_mul(self.interval_ms));
                if self.heard_ms > due_ms {
                    self.late_ms.get_or_insert(self.heard_ms);
                }
                let is_certain =
                    self.late_ms.is_some_and(|late_ms| now_ms.saturating_sub(late_ms) > CERTAIN_MS);
                self.are_missing = is_certain && now_ms.saturating_sub(self.heard_ms) < DEAD_MS;
                let reported = "the receiver sends no ranges any more, and other messages still: has its \
                            configuration changed?";
                (self.are_missing && !std::mem::replace(&mut self.is_said, true)).then_some(reported)
            }
            last => {
                if let Some((_, since_ms)) = last {
                    self.interval_ms = now_ms.saturating_sub(since_ms);
                }
                self.last = Some((tag_s, now_ms));
                (self.late_ms, self.are_missing) = (None, false);
                std::mem::take(&mut self.is_said).then_some("the receiver sends ranges again")
            }
        }
    }

    /// Returns true while ranges are missing from a line that lives.
    pub(super) const fn are_missing(&self) -> bool {
        self.are_missing
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Looks ten times a second for some seconds; returns what was said, with the time in s.
    fn reported(
        ranges: &mut Ranges,
        seconds: std::ops::Range<u64>,
        every_s: u64,
        frames_go_on: bool,
    ) -> Vec<(u64, &'static str)> {
        let mut have = Vec::new();
        for now_ms in (1000 * seconds.start..1000 * seconds.end).step_by(100) {
            let second = now_ms / 1000;
            let tag_s = second.checked_rem(every_s).map_or(19, |passed| second - passed);
            let frames = if frames_go_on { now_ms / 100 } else { seconds.start * 10 };
            let words = ranges.look(Some(tag_s as f64), frames as u32, now_ms);
            have.extend(words.map(|words| (now_ms / 1000, words)));
        }
        have
    }

    #[test]
    fn ranges_that_end_are_missed_once_and_found_again() {
        let mut ranges = Ranges::default();
        assert_eq!(reported(&mut ranges, 0..20, 1, true), []);
        let have = reported(&mut ranges, 20..45, 0, true);
        assert!(
            have.len() == 1 && (26..29).contains(&have[0].0) && have[0].1.contains("no ranges"),
            "{have:?}"
        );
        assert!(ranges.are_missing());
        // Then the line dies, too.
        assert_eq!(reported(&mut ranges, 45..60, 0, false), []);
        assert!(!ranges.are_missing());
        let have = reported(&mut ranges, 60..70, 1, true);
        assert!(have.len() == 1 && have[0].1.contains("again") && !ranges.are_missing(), "{have:?}");
    }

    #[test]
    fn line_that_is_silent_and_receiver_that_reports_seldom_lack_no_ranges() {
        let mut ranges = Ranges::default();
        assert_eq!(reported(&mut ranges, 0..20, 1, true), []);
        assert_eq!(reported(&mut ranges, 20..99, 0, false), []);
        assert!(!ranges.are_missing());
        let mut ranges = Ranges::default();
        let have = reported(&mut ranges, 0..300, 30, true);
        // The first interval is not known, and so it seems to be an end of the ranges.
        assert!(have.len() <= 2, "{have:?}");
        assert_eq!(reported(&mut ranges, 300..600, 30, true), []);
    }
}
