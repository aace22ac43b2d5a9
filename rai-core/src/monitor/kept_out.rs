//! Systems that were found broken again and again, and are kept out for a while.
//!
//! If the ranges of a system jump in half of the epochs, each of these needs a search. Some jumps
//! are also too small to be isolated. After [`EXCLUSIONS`] exclusions the system is left out before
//! anything is tested, as if the receiver did not track it. It takes part again after it has agreed
//! with the others for [`WEAK`].

use crate::continuity::WEAK;
use crate::satellite::Constellation;

/// Number of exclusions after which a system is kept out, if it did not agree for [`WEAK`] between
/// them.
const EXCLUSIONS: u8 = 3;

/// A system's exclusions, and its agreement since the last one.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Record {
    exclusions: u8,
    epochs: u16,
    agreed_s: f32,
}

impl Record {
    const CLEAN: Self = Self { exclusions: 0, epochs: 0, agreed_s: 0.0 };

    /// Adds an epoch in which the system agreed with the others.
    fn agree(&mut self, step_s: f32) {
        // If the time goes back or is NaN, the agreement begins anew.
        if self.epochs > 0 && step_s >= 0.0 {
            self.agreed_s += step_s;
        } else {
            (self.epochs, self.agreed_s) = (0, 0.0);
        }
        self.epochs = self.epochs.saturating_add(1);
        if WEAK.is_met(self.epochs, f64::from(self.agreed_s), false) {
            *self = Self::CLEAN;
        }
    }

    /// Ends the agreement.
    fn disagree(&mut self) {
        (self.epochs, self.agreed_s) = (0, 0.0);
    }
}

/// The systems of one epoch; each set has a bit for each id.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SystemsSeen {
    /// Systems left out as a whole because the others agree without them.
    pub(super) excluded: u8,
    /// Systems in view.
    pub(super) in_view: u8,
    /// True if the systems that are kept out would agree with the others.
    pub(super) kept_out_agree: bool,
}

impl SystemsSeen {
    /// No system is in view.
    pub(super) const NONE: Self = Self { excluded: 0, in_view: 0, kept_out_agree: false };
}

/// Exclusions of each system.
#[derive(Clone, Debug)]
pub(super) struct KeptOutSystems {
    records: [Record; Constellation::COUNT],
    /// Time of the last epoch whose satellites agreed, s.
    latest_s: f64,
}

impl KeptOutSystems {
    /// Returns records without an exclusion.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self { records: [Record::CLEAN; Constellation::COUNT], latest_s: 0.0 }
    }

    /// Forgets all exclusions.
    pub(super) fn restart(&mut self) {
        *self = Self::new();
    }

    /// Returns the systems to leave out, a bit for each id.
    pub(super) fn systems(&self) -> u8 {
        if !cfg!(feature = "hypotheses") {
            return 0;
        }
        let each = self.records.iter().enumerate();
        each.fold(0, |set, (id, record)| set | u8::from(record.exclusions >= EXCLUSIONS) << id)
    }

    /// Adds an epoch whose satellites agree, except for those that were left out.
    pub(super) fn learn(&mut self, time_s: f64, seen: SystemsSeen) {
        if !cfg!(feature = "hypotheses") {
            return;
        }
        let step_s = (time_s - self.latest_s) as f32;
        self.latest_s = time_s;
        let kept_out = self.systems();
        if (kept_out | seen.excluded) == 0 && self.records.iter().all(|record| *record == Record::CLEAN) {
            return;
        }
        for (id, record) in self.records.iter_mut().enumerate() {
            let is_in = |set: u8| set >> id & 1 != 0;
            if !is_in(seen.in_view) {
                continue;
            }
            if is_in(seen.excluded & !kept_out) {
                record.exclusions = record.exclusions.saturating_add(1);
                record.disagree();
            } else if is_in(kept_out) && !seen.kept_out_agree {
                record.disagree();
            } else if record.exclusions > 0 {
                record.agree(step_s);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{KeptOutSystems, SystemsSeen};

    const BEIDOU: u8 = 0b10;
    const ALL: u8 = 0b111;

    fn broken() -> SystemsSeen {
        SystemsSeen { excluded: BEIDOU, in_view: ALL, kept_out_agree: false }
    }

    fn agreeing() -> SystemsSeen {
        SystemsSeen { excluded: 0, in_view: ALL, kept_out_agree: true }
    }

    #[test]
    fn third_exclusion_keeps_a_system_out() {
        let mut kept_out = KeptOutSystems::new();
        for second in 0..3 {
            assert_eq!(kept_out.systems(), 0, "{second} s");
            kept_out.learn(f64::from(second), broken());
        }
        assert_eq!(kept_out.systems(), BEIDOU);
    }

    #[test]
    fn system_returns_after_ten_epochs_and_ten_seconds_of_agreement() {
        let mut kept_out = KeptOutSystems::new();
        (0..3).for_each(|second| kept_out.learn(f64::from(second), broken()));
        (3..12).for_each(|second| kept_out.learn(f64::from(second), agreeing()));
        // One more contradiction begins the agreement anew.
        kept_out.learn(12.0, SystemsSeen { kept_out_agree: false, ..agreeing() });
        (13..23).for_each(|second| kept_out.learn(f64::from(second), agreeing()));
        assert_eq!(kept_out.systems(), BEIDOU);
        kept_out.learn(23.0, agreeing());
        assert_eq!(kept_out.systems(), 0);
    }

    #[test]
    fn exclusions_between_agreements_and_absence_count_separately() {
        let mut kept_out = KeptOutSystems::new();
        for round in 0..5 {
            let start_s = f64::from(round) * 20.0;
            kept_out.learn(start_s, broken());
            kept_out.learn(start_s + 1.0, broken());
            (2..14).for_each(|second| kept_out.learn(start_s + f64::from(second), agreeing()));
            assert_eq!(kept_out.systems(), 0, "round {round}");
        }
        (0..3).for_each(|second| kept_out.learn(200.0 + f64::from(second), broken()));
        let absent = SystemsSeen { in_view: ALL & !BEIDOU, ..agreeing() };
        (3..60).for_each(|second| kept_out.learn(200.0 + f64::from(second), absent));
        assert_eq!(kept_out.systems(), BEIDOU);
    }
}
