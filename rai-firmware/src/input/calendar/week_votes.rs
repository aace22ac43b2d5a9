//! Votes of the systems on the week, by their ephemerides.
//!
//! One system does not outvote two that agree, however many votes it has. The week is wrong if at
//! least [`DISSENT`] ephemerides contradict it, and more systems contradict than confirm it. If as
//! many systems contradict as confirm, the contradicting ephemerides must be [`DISSENT`] more. A
//! system that has confirmed the week contradicts it only after more contrary votes than it
//! confirmed, so that a few forged ephemerides do not turn its vote.
//!
//! Two kinds of confirmation do not count. GLONASS counts days, and the known time dates it, so
//! that it has no vote. GPS counts weeks in cycles of 1,024, of which the nearest is taken. If
//! other systems contradict the cycle, the confirmations of GPS are discarded.

use raim_core::satellite::Constellation;

/// Number of contrary ephemerides that correct the week; also their excess over the confirming ones
/// if as many systems contradict as confirm.
const DISSENT: u8 = 4;

/// Largest number of votes of one system that count.
const MOST: i8 = 8;

/// Vote of an ephemeris on the week.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Vote {
    /// The week is right.
    Right,
    /// The week is another one.
    Other,
    /// The week is another one, outside the present cycle of GPS weeks.
    OtherCycle,
}

/// Votes of each system: positive if the week is right, negative if it is wrong.
#[derive(Clone, Debug)]
pub(super) struct WeekVotes([i8; Constellation::ALL.len()]);

impl WeekVotes {
    pub(super) const fn none() -> Self {
        Self([0; Constellation::ALL.len()])
    }

    /// Takes the vote of an ephemeris.
    pub(super) fn count(&mut self, system: Constellation, vote: Vote) {
        if system == Constellation::Glonass {
            return;
        }
        let gps = &mut self.0[Constellation::Gps as usize];
        if vote == Vote::OtherCycle {
            *gps = (*gps).min(0);
        }
        if let Some(votes) = self.0.get_mut(system as usize) {
            let next = if vote == Vote::Right { *votes + 1 } else { *votes - 1 };
            *votes = next.clamp(-MOST, MOST);
        }
    }

    /// Returns true if the week is wrong.
    pub(super) fn contradict(&self) -> bool {
        let sum = |is_of: fn(&i8) -> bool| {
            let votes = self.0.iter().copied().filter(is_of);
            votes.fold((0, 0), |(systems, sum), vote| (systems + 1, sum + vote.unsigned_abs()))
        };
        let ((against, dissent), (confirming, agreement)) = (sum(|&vote| vote < 0), sum(|&vote| vote > 0));
        dissent >= DISSENT
            && (against > confirming || against == confirming && dissent >= agreement.saturating_add(DISSENT))
    }

    /// Returns the votes on the other week: one per system, with the opposite sign.
    pub(super) fn of_the_other_week(&self) -> Self {
        Self(self.0.map(|vote| -vote.signum()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Constellation::{Beidou, Galileo, Gps};

    /// Returns the votes after these: for the week if positive, against it if negative.
    fn after(votes: &[(Constellation, i32)]) -> WeekVotes {
        let mut week = WeekVotes::none();
        for (system, votes) in votes {
            (0..votes.abs())
                .for_each(|_| week.count(*system, if *votes > 0 { Vote::Right } else { Vote::Other }));
        }
        week
    }

    #[test]
    fn one_system_does_not_outvote_two_however_often_it_speaks() {
        assert!(!after(&[(Gps, 1), (Galileo, 1), (Beidou, -100)]).contradict());
        assert!(after(&[(Gps, 100), (Galileo, -1), (Beidou, -3)]).contradict());
        assert!(after(&[(Gps, -4)]).contradict());
        assert!(after(&[(Gps, 4), (Beidou, -8)]).contradict());
        assert!(!after(&[(Gps, 5), (Beidou, -8)]).contradict());
    }

    #[test]
    fn four_ephemerides_outvote_nobody_who_has_confirmed_the_week() {
        for [gps, galileo] in [[4, 0], [3, 1], [2, 2], [1, 3], [0, 4]] {
            assert!(!after(&[(Gps, 8), (Galileo, 8), (Gps, -gps), (Galileo, -galileo)]).contradict());
        }
        assert!(after(&[(Gps, 8), (Galileo, 8), (Gps, -10), (Galileo, -10)]).contradict());
    }

    #[test]
    fn who_cannot_know_confirms_nothing() {
        use Constellation::Glonass;
        assert!(after(&[(Glonass, 8), (Gps, -4)]).contradict());
        let mut cycle = after(&[(Gps, 8), (Glonass, 8)]);
        (0..4).for_each(|_| cycle.count(Beidou, Vote::OtherCycle));
        assert!(cycle.contradict());
        let mut cycle = after(&[(Gps, 8), (Galileo, 1)]);
        (0..4).for_each(|_| cycle.count(Beidou, Vote::OtherCycle));
        assert!(!cycle.contradict(), "Galileo knows the cycle");
    }
}
