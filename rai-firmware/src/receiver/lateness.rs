//! How much later than it might an epoch has come: what a line, a relay or a logger holds back is old, and its tag does not say so.
//!
//! ```text
//! lag_i = t_i − τ_i        late_i = lag_i − min_{j ≤ i} (lag_j + d (t_i − t_j))
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `t_i` | when the epoch came, by the module's own clock | ms |
//! | `τ_i` | its tag | ms |
//! | `d` | [`SLOWEST`], how much the own clock may gain on the tags | – |
//!
//! The way from the antenna to the module always takes its time; the shortest that was seen counts as none. A clock that is set
//! back begins anew, as does one that the host says to forget.
//!
//! **Limits.** An own clock without a crystal may be 1 % fast. A delay that grows more slowly than that is not told from it, nor is
//! one that was there from the start.

use crate::time::GpsTime;

/// `1/d`: one percent.
const SLOWEST: u64 = 100;

/// The shortest way so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Lateness(Option<Last>);

/// Of the epoch before.
#[derive(Clone, Copy, Debug)]
struct Last {
    time: GpsTime,
    came_ms: u64,
    least_lag_ms: i64,
}

impl Lateness {
    /// How late an epoch is, ms.
    pub(super) fn of(&mut self, time: GpsTime, came_ms: u64) -> u64 {
        let lag_ms = came_ms.cast_signed().wrapping_sub(time.to_ms().cast_signed());
        let before = self.0.filter(|last| time.since_ms(last.time) >= 0);
        let least_lag_ms = before.map_or(lag_ms, |last| {
            let passed_ms = came_ms.saturating_sub(last.came_ms);
            lag_ms.min(last.least_lag_ms.saturating_add((passed_ms / SLOWEST).cast_signed()))
        });
        self.0 = Some(Last { time, came_ms, least_lag_ms });
        lag_ms.saturating_sub(least_lag_ms).max(0) as u64
    }

    /// The next epoch is as old as it says.
    pub(super) fn forget(&mut self) {
        self.0 = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How late epochs are that say these times and come then, s.
    fn late_s(epochs: &[(f64, f64)]) -> std::vec::Vec<f64> {
        let mut lateness = Lateness::default();
        let start = GpsTime { week: 2200, tow_ms: 0 };
        let late = |&(tag_s, came_s): &(f64, f64)| {
            let time = GpsTime::from_ms(start.to_ms() + (tag_s * 1e3) as u64);
            lateness.of(time, (came_s * 1e3) as u64) as f64 * 1e-3
        };
        epochs.iter().map(late).collect()
    }

    #[test]
    fn what_the_line_holds_back_is_late() {
        // The way takes 0.3 s; then 5 s are held back, caught up with, and held back for good.
        let epochs = [(100.0, 0.3), (101.0, 1.3), (102.0, 7.3), (108.0, 8.3), (109.0, 14.3), (110.0, 15.3)];
        let want = [0.0, 0.0, 4.94, 0.0, 4.94, 4.93];
        for (have, want) in late_s(&epochs).into_iter().zip(want) {
            assert!((have - want).abs() < 0.011, "{have} s, want {want}");
        }
    }

    #[test]
    fn a_fast_clock_of_its_own_is_no_delay() {
        let epochs: std::vec::Vec<_> =
            (0..10_000).map(|second| (f64::from(second), f64::from(second) * 1.009)).collect();
        assert!(late_s(&epochs).into_iter().all(|late_s| late_s < 0.02));
    }

    #[test]
    fn time_that_is_set_begins_anew() {
        assert_eq!(late_s(&[(500.0, 1.0), (20.0, 2.0), (21.0, 3.0), (3600.0, 4.0), (3601.0, 5.0)]), [0.0; 5]);
    }
}
