//! Memory of a known height. It decides whether the height is wrong if it contradicts the
//! satellites, or whether either may be wrong.
//!
//! ```text
//! d = h − u                      known height minus that of the satellites alone
//! step:   |d − d₋₁| > |d|/2      the height moved by itself
//! drift:  otherwise
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `d = h − u` | [`HeightReport::difference_m`] | m |
//! | `d₋₁` | difference of the epoch before, in `last` | m |
//!
//! The integrity module leaves out a height that contradicts the satellites, and the satellites
//! then agree. This proves nothing if all satellites are counterfeit. The past of the height
//! decides:
//!
//! | height | contradiction | verdict |
//! |---|---|---|
//! | never agreed for [`WEAK`] | any | that of the satellites |
//! | agreed for [`WEAK`] | a step | that of the satellites: if the sky had stepped, its rates or the greatest speed would contradict |
//! | agreed for [`WEAK`] | a drift | ambiguous, until height and satellites agree again or no height comes for [`FORGOTTEN_S`] |
//!
//! If satellites can be tested only with a height that was left out before, they are not promised.
//! The height must first agree for [`WEAK`] with satellites that can be tested without it.
//!
//! Limit: if epochs are far apart, a drift may look like a step. References: [TSO-C129a]
//! (a)(3)(xv), whose ramps of the altimeter must raise an alarm.
//!
//! [TSO-C129a]: crate#references

use crate::continuity::WEAK;
use crate::report::{Alert, HeightReport, Protected, Unavailable, Verdict};

/// Longest gap between two epochs with a height that does not end an agreement, s.
const FORGOTTEN_S: f64 = 60.0;

/// Memory of a known height.
#[derive(Clone, Debug)]
pub(super) struct HeightMemory {
    /// Number of epochs of the present agreement.
    epochs: u16,
    /// Length of the present agreement, s.
    agreed_s: f32,
    /// Time of the last epoch with a height, s, and its difference, m.
    last: Option<(f64, f32)>,
    /// True after an exclusion, until the height has agreed for long enough.
    is_doubtful: bool,
}

impl HeightMemory {
    /// Returns a memory without a height.
    pub(super) const fn new() -> Self {
        Self { epochs: 0, agreed_s: 0.0, last: None, is_doubtful: false }
    }

    /// Returns the verdict on an epoch after comparing its height with earlier ones, and remembers
    /// this height.
    pub(super) fn judge(&mut self, time_s: f64, height: &HeightReport, verdict: Verdict) -> Verdict {
        let difference_m = height.difference_m as f32;
        let before = self.last.replace((time_s, difference_m));
        let before = before.map(|(last_s, last_m)| (time_s - last_s, last_m));
        let before = before.filter(|(step_s, _)| (0.0..=FORGOTTEN_S).contains(step_s));
        if before.is_none() {
            (self.epochs, self.agreed_s) = (0, 0.0);
        }
        if !height.is_used {
            let is_step = before.is_none_or(|(_, last_m)| {
                // NaN counts as a drift.
                libm::fabsf(difference_m - last_m) > 0.5 * libm::fabsf(difference_m)
            });
            let is_other_truth = self.has_agreed() && !is_step;
            self.is_doubtful = true;
            if is_other_truth {
                return Verdict::Alert(Alert::Ambiguous);
            }
            (self.epochs, self.agreed_s) = (0, 0.0);
            return verdict;
        }
        if height.is_needed {
            // Only the height confirms these satellites, so that they cannot confirm the height.
            let is_promised = matches!(verdict, Verdict::Protected(_));
            let refused = Verdict::Unavailable(Unavailable::Redundancy);
            return if is_promised && self.is_doubtful { refused } else { verdict };
        }
        if matches!(verdict, Verdict::Protected(Protected::Ok | Protected::Excluded)) {
            let step_s = before.map_or(0.0, |(step_s, _)| step_s);
            self.agreed_s += if self.epochs > 0 { step_s as f32 } else { 0.0 };
            self.epochs = self.epochs.saturating_add(1);
            self.is_doubtful &= !self.has_agreed();
        }
        verdict
    }

    fn has_agreed(&self) -> bool {
        WEAK.is_met(self.epochs, f64::from(self.agreed_s), false)
    }
}

#[cfg(test)]
mod tests {
    use super::HeightMemory;
    use crate::report::{Alert, HeightReport, Protected, Unavailable, Verdict};

    const OK: Verdict = Verdict::Protected(Protected::Ok);
    const AMBIGUOUS: Verdict = Verdict::Alert(Alert::Ambiguous);
    const REFUSED: Verdict = Verdict::Unavailable(Unavailable::Redundancy);

    fn height(difference_m: f64, is_used: bool, is_needed: bool) -> HeightReport {
        HeightReport { is_used, is_needed, difference_m }
    }

    /// Returns the memory after eleven seconds of agreement.
    fn agreed() -> HeightMemory {
        let mut memory = HeightMemory::new();
        for second in 0..=10 {
            assert_eq!(memory.judge(f64::from(second), &height(0.5, true, false), OK), OK);
        }
        memory
    }

    #[test]
    fn height_that_never_agreed_is_left_out_and_changes_nothing() {
        let mut memory = HeightMemory::new();
        for second in 0..60 {
            assert_eq!(memory.judge(f64::from(second), &height(100.0, false, false), OK), OK);
        }
    }

    #[test]
    fn step_of_a_height_that_agreed_is_its_own() {
        let mut memory = agreed();
        for second in 11..60 {
            assert_eq!(memory.judge(f64::from(second), &height(100.0, false, false), OK), OK, "{second} s");
        }
    }

    #[test]
    fn drift_of_a_height_that_agreed_is_another_truth_until_both_agree_again() {
        let mut memory = agreed();
        for second in 11..31 {
            let difference_m = f64::from(second - 10);
            assert_eq!(memory.judge(f64::from(second), &height(difference_m, true, false), OK), OK);
        }
        for second in 31..200 {
            let difference_m = f64::from(second - 10);
            let have = memory.judge(f64::from(second), &height(difference_m, false, false), OK);
            assert_eq!(have, AMBIGUOUS, "{second} s");
        }
        assert_eq!(memory.judge(200.0, &height(1.0, true, false), OK), OK);
        assert_eq!(memory.judge(300.0, &height(120.0, false, false), OK), OK, "forgotten in the silence");
    }

    #[test]
    fn height_that_was_left_out_supports_no_satellites_until_it_agrees_again() {
        let mut memory = HeightMemory::new();
        assert_eq!(memory.judge(0.0, &height(1.0, true, true), OK), OK);
        assert_eq!(memory.judge(1.0, &height(80.0, false, false), OK), OK);
        assert_eq!(memory.judge(2.0, &height(1.0, true, true), OK), REFUSED);
        for second in 100..=110 {
            assert_eq!(memory.judge(f64::from(second), &height(1.0, true, false), OK), OK);
        }
        assert_eq!(memory.judge(111.0, &height(1.0, true, true), OK), OK);
    }
}
