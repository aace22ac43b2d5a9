//! Whether the week is the right one: the systems vote on it, each with its ephemerides.
//!
//! What one system says, however often, does not outvote two that agree. The week is wrong when more systems contradict it than
//! confirm it, or as many and with [`DISSENT`] more ephemerides. Who has confirmed it is heard to contradict it when it has done
//! so as often: some forged ephemerides do not turn a system's vote.

use rai_core::satellite::Constellation;

/// Ephemerides that it takes to correct the week.
const DISSENT: u8 = 4;

/// The votes of one system that count.
const MOST: i8 = 8;

/// What each system says of the week: that it is right where positive, that it is wrong where negative.
#[derive(Debug)]
pub(super) struct WeekVotes([i8; Constellation::ALL.len()]);

impl WeekVotes {
    pub(super) const fn none() -> Self {
        Self([0; Constellation::ALL.len()])
    }

    /// Takes the vote of an ephemeris.
    pub(super) fn count(&mut self, system: Constellation, agrees: bool) {
        if let Some(vote) = self.0.get_mut(system as usize) {
            let next = if agrees { *vote + 1 } else { *vote - 1 };
            *vote = next.clamp(-MOST, MOST);
        }
    }

    /// Whether the week is wrong.
    pub(super) fn contradict(&self) -> bool {
        let sum = |is_of: fn(&i8) -> bool| {
            let votes = self.0.iter().copied().filter(is_of);
            votes.fold((0, 0), |(systems, sum), vote| (systems + 1, sum + vote.unsigned_abs()))
        };
        let ((against, dissent), (confirming, agreement)) = (sum(|&vote| vote < 0), sum(|&vote| vote > 0));
        dissent >= DISSENT
            && (against > confirming || against == confirming && dissent >= agreement.saturating_add(DISSENT))
    }

    /// What they say of the week that those who contradict mean: a vote of each.
    pub(super) fn of_the_other_week(&self) -> Self {
        Self(self.0.map(|vote| -vote.signum()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Constellation::{Beidou, Galileo, Gps};

    /// Votes in turn: so many for the week where positive, against it where negative.
    fn after(votes: &[(Constellation, i32)]) -> WeekVotes {
        let mut week = WeekVotes::none();
        for (system, votes) in votes {
            (0..votes.abs()).for_each(|_| week.count(*system, *votes > 0));
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
}
