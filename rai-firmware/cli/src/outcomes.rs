//! Outcomes of epochs, counted: promised, alert or unavailable, and whether the promise was kept.
//!
//! Campaigns, replays, attacks and experiments count the same five numbers with this type. Numbers
//! that only one of them needs stand beside it, in a type of their own.

use std::ops::AddAssign;

/// Outcome of one epoch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The position may be used.
    Promised {
        /// True if an error exceeds its protection level.
        is_misleading: bool,
        /// True if an error exceeds its alert limit.
        is_hazardous: bool,
    },
    /// The position must not be used.
    Alert,
    /// There is no promise.
    Unavailable,
}

/// Number of epochs by outcome.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Outcomes {
    /// Number of epochs whose position may be used.
    pub promised: usize,
    /// Number of epochs whose position must not be used.
    pub alerts: usize,
    /// Number of epochs without a promise.
    pub unavailable: usize,
    /// Number of promised epochs with an error above a protection level.
    pub misleading: usize,
    /// Number of promised epochs with an error above an alert limit.
    pub hazardous: usize,
}

impl Outcomes {
    /// Counts an epoch.
    pub fn add(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Promised { is_misleading, is_hazardous } => {
                self.promised += 1;
                self.misleading += usize::from(is_misleading);
                self.hazardous += usize::from(is_hazardous);
            }
            Outcome::Alert => self.alerts += 1,
            Outcome::Unavailable => self.unavailable += 1,
        }
    }

    /// Returns the number of epochs.
    pub const fn epochs(&self) -> usize {
        self.promised + self.alerts + self.unavailable
    }
}

impl AddAssign for Outcomes {
    fn add_assign(&mut self, other: Self) {
        self.promised += other.promised;
        self.alerts += other.alerts;
        self.unavailable += other.unavailable;
        self.misleading += other.misleading;
        self.hazardous += other.hazardous;
    }
}

#[cfg(test)]
mod tests {
    use super::{Outcome, Outcomes};

    #[test]
    fn every_epoch_has_one_outcome_and_only_promises_are_broken() {
        let mut outcomes = Outcomes::default();
        for (is_misleading, is_hazardous) in [(false, false), (true, false), (true, true)] {
            outcomes.add(Outcome::Promised { is_misleading, is_hazardous });
        }
        outcomes.add(Outcome::Alert);
        outcomes.add(Outcome::Unavailable);
        let want = Outcomes { promised: 3, alerts: 1, unavailable: 1, misleading: 2, hazardous: 1 };
        assert_eq!((outcomes, outcomes.epochs()), (want, 5));
        outcomes += want;
        assert_eq!((outcomes.epochs(), outcomes.misleading, outcomes.hazardous), (10, 4, 2));
    }
}
