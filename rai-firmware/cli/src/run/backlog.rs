//! How old the epochs of a pipe are.
//!
//! The clock of the service stands still while a consumer does not read, so that no epoch of a pipe is
//! late for the module. A reader that is always a little too slow makes each epoch older than the one
//! before. It shows by the time that was not held:
//!
//! ```text
//! age = (t − t_0) − (tag − tag_0) − 250 ppm (t − t_0)        s, beyond that of the freshest epoch, 0
//! ```
//!
//! | symbol | here | unit |
//! |---|---|---|
//! | `t` | time at which an epoch was judged, [`Clock::unheld`](super::clock::Clock::unheld) | s |
//! | `tag` | its time tag | s |
//!
//! A recording in a pipe comes faster than it was made: each of its epochs is the freshest. A tag that
//! goes back begins anew. The age of the first epoch cannot be known.

use std::time::Duration;

/// Most by which the oscillator of a computer is wrong.
const CLOCK_ERROR: f64 = 250e-6;

/// The epochs of a pipe so far.
#[derive(Debug, Default)]
pub(super) struct Backlog {
    /// Time tag of the freshest epoch, s, and the time at which it was judged.
    freshest: Option<(f64, Duration)>,
    last_tag_s: f64,
}

impl Backlog {
    /// Takes an epoch that was judged at this time; returns its age.
    pub(super) fn age(&mut self, tag_s: f64, now: Duration) -> Duration {
        let goes_back = tag_s < std::mem::replace(&mut self.last_tag_s, tag_s);
        let age_s = match self.freshest {
            Some((first_s, then)) if !goes_back => {
                let passed_s = now.saturating_sub(then).as_secs_f64();
                passed_s - (tag_s - first_s) - CLOCK_ERROR * passed_s
            }
            _ => 0.0,
        };
        if age_s <= 0.0 {
            self.freshest = Some((tag_s, now));
        }
        Duration::try_from_secs_f64(age_s).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the ages, s, of epochs with these tags that were judged at these times, s.
    fn ages<const N: usize>(epochs: [(f64, f64); N]) -> [f64; N] {
        let mut backlog = Backlog::default();
        epochs.map(|(tag_s, now_s)| backlog.age(tag_s, Duration::from_secs_f64(now_s)).as_secs_f64())
    }

    #[track_caller]
    fn assert_near<const N: usize>(have: [f64; N], want: [f64; N]) {
        assert!(have.iter().zip(want).all(|(have, want)| (have - want).abs() < 0.01), "{have:?}");
    }

    #[test]
    fn epochs_that_are_judged_ever_later_are_old_until_they_have_caught_up() {
        let slow = [(100.0, 0.0), (101.0, 1.2), (102.0, 2.4), (103.0, 3.6), (104.0, 4.0), (105.0, 5.0)];
        assert_near(ages(slow), [0.0, 0.2, 0.4, 0.6, 0.0, 0.0]);
    }

    #[test]
    fn recording_is_never_old_and_a_time_that_goes_back_begins_anew() {
        assert_near(ages([(100.0, 0.0), (101.0, 0.1), (102.0, 0.2), (102.9, 1.2)]), [0.0, 0.0, 0.0, 0.1]);
        assert_near(ages([(100.0, 0.0), (40.0, 1.0), (41.0, 2.5)]), [0.0, 0.0, 0.5]);
    }

    #[test]
    fn oscillator_of_a_computer_makes_no_epoch_old() {
        assert_near(ages([(0.0, 0.0), (86_400.0, 86_400.0 * 1.0002)]), [0.0, 0.0]);
    }
}
