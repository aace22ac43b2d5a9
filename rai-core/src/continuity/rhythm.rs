//! Rhythm: does an epoch come from the receiver that sent those before?
//!
//! A receiver measures at fixed parts of each second. If another receiver takes its place on the
//! line, under the same number, its epochs mostly lie between those of the first:
//!
//! ```text
//! n   = max(1, rint(1 s / T))                    T  the shortest time between two protected epochs
//! off = |n Δt − rint(n Δt)| / n                  Δt since the last protected epoch
//!
//! another receiver if  off > 20 ms  and the position is not where the receiver can be expected
//! ```
//!
//! `T` must be a part of a second or a number of seconds, and [`LEAST`] epochs must have kept it.
//! Receivers of other rates, such as one epoch in 0.7 s, have no rhythm. A receiver that restarts
//! may change its part of the second. It is then where it can be expected ([`super::reach`]), and
//! its new rhythm is learned.
//!
//! The first receiver is known again by both: its rhythm and its place. Until then no position is
//! protected. [`super::Continuity::forget`] ends this too, and so does the age of the anchor.
//!
//! **Limits.** Two receivers that measure at the same parts of a second are not told apart, and
//! neither are those with more than 25 epochs a second.

/// Largest variation of the time of an epoch, s. Tags have milliseconds, and clocks that are not
/// steered depart from their second by as much.
const SAME_S: f32 = 0.02;

/// Number of epochs that must have kept the rhythm.
const LEAST: u8 = 10;

/// Times of the epochs of a receiver, relative to each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rhythm {
    /// Shortest time between two protected epochs, s; NaN if it does not fit a second.
    step_s: f32,
    /// Number of epochs that kept the rhythm, up to [`LEAST`].
    kept: u8,
    /// True from the first epoch of another receiver on.
    is_other: bool,
}

impl Rhythm {
    /// Returns the state before the first epoch.
    pub(super) const fn new() -> Self {
        Self { step_s: f32::NAN, kept: 0, is_other: false }
    }

    /// Takes an epoch that is protected if judged alone, `elapsed_s` after the last protected one.
    /// Returns true if another receiver sent it. `is_expected` tells whether the receiver can be
    /// expected at its position.
    pub(super) fn is_of_another(&mut self, elapsed_s: f32, is_expected: impl FnOnce() -> bool) -> bool {
        if !self.is_other && (elapsed_s - self.step_s).abs() <= SAME_S {
            self.kept += u8::from(self.kept < LEAST);
            return false;
        }
        let is_off = departure_s(elapsed_s, self.step_s) > SAME_S;
        if self.is_other || is_off && self.kept >= LEAST {
            self.is_other = self.is_other && is_off || !is_expected();
        }
        if !self.is_other {
            if is_off {
                self.kept = 0;
            }
            // NaN is not at most the new one, so that any step that fits a second takes its place.
            if is_off || !(self.step_s <= elapsed_s) {
                // To 1 % of the step: 33 ms are 1/30 s, and 60 ms are not 1/17 s.
                let is_regular = 2.0 * departure_s(elapsed_s, elapsed_s) <= SAME_S * elapsed_s;
                self.step_s = if is_regular { elapsed_s } else { f32::NAN };
            }
        }
        self.is_other
    }
}

/// Returns the departure of `Δt` from a multiple of `1/n`, with the `n` of a step, s.
#[inline(never)]
fn departure_s(elapsed_s: f32, step_s: f32) -> f32 {
    let per_second = whole(1.0 / step_s).max(1.0);
    let count = elapsed_s * per_second;
    (count - whole(count)).abs() / per_second
}

/// Returns the nearest whole number of a positive one.
// Not inlined, so that its callers share one copy. It is smaller than libm's, which keeps signs.
#[inline(never)]
fn whole(number: f32) -> f32 {
    (number + 0.5) as i32 as f32
}
