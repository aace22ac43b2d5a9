//! The week of the present, from the weeks that ephemerides (sets) state.
//!
//! Before the first epoch the second of the week is unknown, and near the end of a week a stated
//! week is ambiguous ([`super::roll_over`]). Distinct statements are stored until the first epoch.
//! The most informative one then dates it.
//!
//! If every set so far fits two weeks, the likelier one is used, and the other is stored as a
//! doubt. The first set of any system that fits only one of the two decides. As long as there is a
//! doubt, no epoch confirms the week: ranges agree as well with orbits that are all dated a week
//! early. Sets that fit both weeks are no evidence. Sets that fit neither vote
//! ([`super::week_votes`]).

use heapless::Vec;
use raim_core::satellite::Constellation;

use super::roll_over::PresentWeeks;
use super::week_votes::{Vote, WeekVotes};
use crate::time::GpsTime;

/// Number of statements stored until the first epoch. A system has one to four reference times at a
/// time.
const KEPT: usize = 8;

/// Half of the cycle in which GPS counts weeks.
const HALF_CYCLE_WEEKS: u32 = 512;

/// System of a set, and the instant that it states.
type Statement = (Constellation, GpsTime);

/// Effect of a set on the week of the present.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ruling {
    /// The week is unchanged.
    Stands,
    /// The week was in doubt, and is now this many weeks later.
    Moved(i32),
    /// The systems agree on another week; this is the present in it.
    Replaced(GpsTime),
}

/// Evidence for the week of the present.
#[derive(Debug)]
pub(super) struct PresentWeek {
    kept: Vec<Statement, KEPT>,
    /// Other week that every set so far fits, counted from that of the present.
    doubt: Option<i32>,
    votes: WeekVotes,
}

impl PresentWeek {
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self { kept: Vec::new(), doubt: None, votes: WeekVotes::none() }
    }

    /// Returns true while the present may also be in the other week.
    pub(super) const fn is_in_doubt(&self) -> bool {
        self.doubt.is_some()
    }

    /// Returns true if statements wait for the first epoch.
    pub(super) fn awaits_epoch(&self) -> bool {
        !self.kept.is_empty()
    }

    /// Begins with the first set.
    pub(super) fn begin(&mut self, first: Statement) {
        self.kept.clear();
        self.keep(first);
        self.doubt = None;
    }

    fn keep(&mut self, statement: Statement) {
        if !self.kept.contains(&statement) {
            // Further statements only vote.
            let _ = self.kept.push(statement);
        }
    }

    /// Takes a set after the first; `now` is the last epoch or, before the first epoch, the instant
    /// that the first set states.
    pub(super) fn receive(&mut self, (system, stated): Statement, now: GpsTime) -> Ruling {
        let weeks = PresentWeeks::of(system, stated, now);
        match self.kept.first() {
            Some(&(of, first)) => {
                let of_first = PresentWeeks::of(of, first, now);
                if !(-1..=1).any(|week| weeks.allows(week) && of_first.allows(week)) {
                    return self.dissent(system, weeks, now);
                }
                self.keep((system, stated));
            }
            None if weeks.allows(0) => {}
            None => return self.contradict(system, weeks, now),
        }
        if self.doubt.is_some_and(|other| !weeks.allows(other)) {
            self.doubt = None;
        }
        if weeks.only() == Some(0) {
            self.votes.count(system, Vote::Right);
        }
        Ruling::Stands
    }

    /// Takes a set that does not fit the week of the present.
    fn contradict(&mut self, system: Constellation, weeks: PresentWeeks, now: GpsTime) -> Ruling {
        match self.doubt.filter(|&other| weeks.allows(other)) {
            Some(other) => {
                (self.doubt, self.votes) = (None, WeekVotes::none());
                Ruling::Moved(other)
            }
            None => self.dissent(system, weeks, now),
        }
    }

    fn dissent(&mut self, system: Constellation, weeks: PresentWeeks, now: GpsTime) -> Ruling {
        let is_cycle = weeks.preferred().unsigned_abs() > HALF_CYCLE_WEEKS;
        self.votes.count(system, if is_cycle { Vote::OtherCycle } else { Vote::Other });
        if !self.votes.contradict() {
            return Ruling::Stands;
        }
        self.votes = self.votes.of_the_other_week();
        self.doubt = weeks.doubt();
        Ruling::Replaced(now.later_by_weeks(weeks.preferred()))
    }

    /// Returns the first epoch, at `tow_ms`, in the week of the stored statements. The flag is true
    /// if the stated week of one of them is not the week that it means.
    pub(super) fn first_epoch(&mut self, tow_ms: u32) -> Option<(GpsTime, bool)> {
        let kept = core::mem::take(&mut self.kept);
        let weeks_of = |&(system, stated): &Statement| {
            let origin = GpsTime { week: stated.week, tow_ms };
            (PresentWeeks::of(system, stated, origin), origin)
        };
        // The first of those with the same weight.
        let weeks_of = |(index, statement)| (index, weeks_of(statement));
        let (base, (weeks, origin)) =
            kept.iter().enumerate().rev().map(weeks_of).max_by_key(|(_, (weeks, _))| weeks.weight())?;
        let mut present = origin.later_by_weeks(weeks.preferred());
        self.doubt = weeks.doubt();
        if self.is_in_doubt() {
            self.votes = WeekVotes::none();
        }
        // The first set has no second vote, and each of the others has voted already.
        let votes = self.votes.clone();
        for (_, &statement) in kept.iter().enumerate().filter(|(index, _)| *index != base) {
            match self.receive(statement, present) {
                Ruling::Stands => {}
                Ruling::Moved(weeks) => present = present.later_by_weeks(weeks),
                Ruling::Replaced(by) => present = by,
            }
        }
        self.votes = votes;
        let is_off = kept.iter().any(|&(_, stated)| GpsTime::nearest(stated.tow_ms, present) != stated);
        Some((present, is_off))
    }

    /// Takes the time that a receiver states with an epoch. It only decides between two weeks.
    pub(super) fn hear_time(&mut self, stated: GpsTime, now: GpsTime) -> Ruling {
        let weeks = i32::from(GpsTime::nearest(now.tow_ms, stated).week) - i32::from(now.week);
        match self.doubt {
            Some(other) if weeks == other => {
                (self.doubt, self.votes) = (None, WeekVotes::none());
                Ruling::Moved(other)
            }
            Some(_) if weeks == 0 => {
                self.doubt = None;
                Ruling::Stands
            }
            _ => Ruling::Stands,
        }
    }
}
