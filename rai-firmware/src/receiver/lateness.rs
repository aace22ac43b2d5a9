//! How long an epoch was on its way: what a line, a relay or a logger holds back is old, and its tag does not say so.
//!
//! ```text
//! late = min (t − tₚ − (τ − τₚ) − d (t − tₚ))
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `t`, `τ` | when the epoch came, by the module's own clock; its tag | ms |
//! | `tₚ`, `τₚ` | the same of an epoch that was protected | ms |
//! | `d` | how much the own clock may gain on the tags: [`FAST`] | – |
//!
//! The way from the antenna to the module always takes its time; the shortest that was seen counts as none. Tags are held
//! against those of protected epochs alone: satellites move by kilometres in a second, so ranges that agree with their orbits
//! are of the instant that they are tagged with. A signal that was recorded and is sent again is late for the same reason.
//!
//! A difference of whole weeks is the week that was put right ([`crate::input`]), and is none.
//!
//! **Limits.** A delay that grows more slowly than `d` is not told from a fast clock, nor is one seen that was there from the
//! start. A clock faster than `d` makes everything late in the end.

use crate::time::{GpsTime, WEEK_MS};

/// `1/d`: an oscillator without a crystal is within one percent, and a division by this is none.
const FAST: u64 = 64;

/// What is nearer to whole weeks is a week that was put right, ms.
const NEAR_MS: i64 = 60_000;

const WEEK: i64 = WEEK_MS as i64;

/// The shortest way of protected epochs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Lateness(Option<Shortest>);

#[derive(Clone, Copy, Debug)]
struct Shortest {
    time: GpsTime,
    came_ms: u64,
}

impl Lateness {
    /// How late an epoch is, ms.
    pub(super) fn of(&self, time: GpsTime, came_ms: u64) -> u64 {
        let Some(shortest) = self.0 else { return 0 };
        let gained_ms = came_ms.saturating_sub(shortest.came_ms) / FAST;
        let longer_ms = shortest.longer_ms(time, came_ms) + NEAR_MS;
        let this_week_ms = if longer_ms < WEEK { longer_ms } else { longer_ms % WEEK };
        u64::try_from(this_week_ms - NEAR_MS).unwrap_or(0).saturating_sub(gained_ms)
    }

    /// An epoch was protected: its tag is right.
    pub(super) fn learn(&mut self, time: GpsTime, came_ms: u64) {
        let is_other_week = |shortest: &Shortest| shortest.longer_ms(time, came_ms) + NEAR_MS >= WEEK;
        if self.of(time, came_ms) == 0 || self.0.as_ref().is_some_and(is_other_week) {
            self.0 = Some(Shortest { time, came_ms });
        }
    }
}

impl Shortest {
    /// By how much the way of an epoch is longer than this one, ms; negative where it is shorter.
    fn longer_ms(&self, time: GpsTime, came_ms: u64) -> i64 {
        came_ms.saturating_sub(self.came_ms).cast_signed() - time.since_ms(self.time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const START: GpsTime = GpsTime { week: 2200, tow_ms: 0 };

    /// How late epochs are that say these times and come then, s, each protected.
    fn late_s(epochs: &[(f64, f64)]) -> std::vec::Vec<f64> {
        let mut lateness = Lateness::default();
        let late = |&(tag_s, came_s): &(f64, f64)| {
            let time = GpsTime::from_ms(START.to_ms().wrapping_add_signed((tag_s * 1e3) as i64));
            let (came_ms, late_ms) = ((came_s * 1e3) as u64, lateness.of(time, (came_s * 1e3) as u64));
            lateness.learn(time, came_ms);
            late_ms as f64 * 1e-3
        };
        epochs.iter().map(late).collect()
    }

    fn assert_late(epochs: &[(f64, f64)], want_s: &[f64]) {
        for (have, want) in late_s(epochs).into_iter().zip(want_s) {
            assert!((have - want).abs() < 0.3, "{have} s, want {want}");
        }
    }

    #[test]
    fn what_the_line_holds_back_is_late() {
        // The way takes 0.3 s; then 5 s are held back, caught up with, and held back for good.
        let epochs = [(100.0, 0.3), (101.0, 1.3), (102.0, 7.3), (108.0, 8.3), (109.0, 14.3), (110.0, 15.3)];
        assert_late(&epochs, &[0.0, 0.0, 5.0, 0.0, 5.0, 5.0]);
    }

    #[test]
    fn a_fast_clock_of_its_own_is_no_delay() {
        let epochs: std::vec::Vec<_> =
            (0..10_000).map(|second| (f64::from(second), f64::from(second) * 1.009)).collect();
        assert!(late_s(&epochs).into_iter().all(|late_s| late_s < 0.02));
    }

    #[test]
    fn what_was_recorded_is_late_by_its_age() {
        assert_late(&[(5000.0, 1.0), (20.0, 2.0), (21.0, 3.0), (6000.0, 4.0)], &[0.0, 4981.0, 4981.0, 0.0]);
    }

    #[test]
    fn a_week_that_is_put_right_is_no_delay() {
        const WEEK_S: f64 = WEEK_MS as f64 * 1e-3;
        let weeks =
            [(0.0, 1.0), (1.0 - WEEK_S, 2.0), (2.0 - WEEK_S, 3.0), (3.0, 4.0), (4.0 - 99.0 * WEEK_S, 7.0)];
        assert_late(&weeks, &[0.0, 0.0, 0.0, 0.0, 2.0]);
    }

    #[test]
    fn before_anything_was_protected_nothing_is_late() {
        let lateness = Lateness::default();
        assert_eq!(lateness.of(START, 0), 0);
        assert_eq!(lateness.of(START, u64::MAX / 2), 0);
    }
}
