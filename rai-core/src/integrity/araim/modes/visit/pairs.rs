//! Pairs of events, treated as sets of second events, so that unmonitored pairs are never visited.
//!
//! This is possible if constellations are homogeneous ([`super::super::Modes::is_regular`]). A pair
//! of satellites is then monitored, unless it comes after the cut or is counted with the loss of
//! their constellation. A constellation's loss with a satellite of another one is monitored, unless
//! it comes after the cut. Each such pair is the only cause of its mode.

use core::cmp::Ordering;
use core::ops::ControlFlow;

use super::super::FaultOdds;
use super::super::sets::{Hypothesis, RowSet, above, event, members, row};
use super::{Mode, ModeBatch, ModeWalk, Visitor};
use crate::bit_set::count_of;
use crate::numeric::real::Real;

/// The pairs among the modes of a walk.
pub(super) struct Pairs<'w, 'm, T: Real> {
    walk: &'w ModeWalk<'m, T>,
}

/// Common part of all pairs with the same first event.
struct FirstEvent<T> {
    /// The first event alone.
    hypothesis: Hypothesis,
    event: RowSet,
    /// Rows of the event before an exclusion.
    rows: RowSet,
    /// Number of rows that a pair with it takes before an exclusion.
    size: usize,
    /// Number of remaining rows that a pair with it takes.
    taken: usize,
    /// `p_0 P/(1 − P)`.
    probability: T,
    ln_probability: T,
}

impl<'w, 'm, T: Real> Pairs<'w, 'm, T> {
    /// Returns `None` if modes of two events must be visited one by one.
    pub(super) fn of(walk: &'w ModeWalk<'m, T>) -> Option<Self> {
        let lost = walk.lost;
        // The last row of a constellation can be lost with the constellation or alone.
        let is_alone = |(id, rows): (usize, &RowSet)| lost >> id & 1 != 0 && rows.is_power_of_two();
        let has_one_cause = !walk.members.iter().enumerate().any(is_alone);
        (walk.modes.is_regular && lost.count_ones() < 2 && has_one_cause).then_some(Self { walk })
    }

    #[inline]
    pub(super) fn visit(
        &self,
        was_monitorable: &dyn Fn(RowSet) -> bool,
        visitor: &mut dyn Visitor<T>,
    ) -> ControlFlow<()> {
        let ModeWalk { lost, left, .. } = *self.walk;
        if !self.reach_the_cut() {
            return ControlFlow::Continue(());
        }
        if lost != 0 {
            let Some(first) = self.constellation() else { return ControlFlow::Continue(()) };
            return self.visit_with(&first, left, was_monitorable, visitor);
        }
        members(left).try_for_each(|index| {
            let Some(first) = self.row(index) else { return ControlFlow::Continue(()) };
            let others = left & above(index) & !self.consolidated_with(index);
            self.visit_with(&first, others, was_monitorable, visitor)
        })
    }

    /// Visits the singly monitored rows, if no satellite is excluded. None of them is counted with
    /// its constellation's loss.
    pub(super) fn visit_singles(&self, visitor: &mut dyn Visitor<T>) -> ControlFlow<()> {
        let modes = self.walk.modes;
        let rows = self.monitored_singles();
        let batch = ModeBatch {
            common: Hypothesis::NONE,
            rows,
            taken: 1,
            probability: modes.healthy * modes.likeliest.odds,
            ln_probability: modes.ln_healthy + modes.likeliest.ln,
        };
        members(visitor.screen(&batch)).try_for_each(|index| {
            let Some(odds) = modes.odds.get(index) else { return ControlFlow::Continue(()) };
            visitor.visit(&Mode {
                hypothesis: Hypothesis::of_row(index),
                taken: 1,
                probability: modes.healthy * odds.odds,
                ln_probability: modes.ln_healthy + odds.ln,
            })
        })
    }

    /// Returns the rows that are monitored singly.
    fn monitored_singles(&self) -> RowSet {
        let ModeWalk { modes, left, .. } = *self.walk;
        if modes.cutoff.size > 1 || modes.must_monitor_all_singles() {
            return left;
        }
        let is_monitored = |&index: &usize| {
            let is_mandatory = |odds: &FaultOdds<T>| modes.healthy * odds.odds > modes.mandatory;
            modes.odds.get(index).is_some_and(is_mandatory) || modes.comes_before_the_cut(row(index), 1, 1)
        };
        members(left).filter(is_monitored).fold(0, |set, index| set | row(index))
    }

    /// Returns true if any of the pairs comes before the cut.
    fn reach_the_cut(&self) -> bool {
        let ModeWalk { modes, lost, .. } = *self.walk;
        let lost_size = modes.sizes.get(lost.trailing_zeros() as usize).filter(|_| lost != 0);
        let size = lost_size.map_or(2, |size| size + 1);
        size < modes.cutoff.size || size == modes.cutoff.size && modes.cutoff.count >= 2
    }

    /// Returns the lost constellation as the first event.
    fn constellation(&self) -> Option<FirstEvent<T>> {
        let ModeWalk { modes, lost, lost_count, .. } = *self.walk;
        let id = lost.trailing_zeros() as usize;
        let probability = modes.healthy * *modes.constellations.get(id)?;
        Some(FirstEvent {
            hypothesis: Hypothesis::of_constellations(lost as u8),
            event: event(id),
            rows: *modes.members.get(id)?,
            size: *modes.sizes.get(id)? + 1,
            taken: lost_count + 1,
            probability,
            ln_probability: probability.ln(),
        })
    }

    fn row(&self, index: usize) -> Option<FirstEvent<T>> {
        let modes = self.walk.modes;
        let odds = modes.odds.get(index)?;
        Some(FirstEvent {
            hypothesis: Hypothesis::of_row(index),
            event: row(index),
            rows: row(index),
            size: 2,
            taken: 2,
            probability: modes.healthy * odds.odds,
            ln_probability: modes.ln_healthy + odds.ln,
        })
    }

    /// Returns the rows with which a row forms no monitored pair: those of its constellation, if
    /// such pairs are counted with its loss or take all of its rows.
    fn consolidated_with(&self, index: usize) -> RowSet {
        let ModeWalk { modes, members, .. } = self.walk;
        let fellows = modes
            .odds
            .get(index)
            .and_then(|odds| Some((odds.constellation, members.get(odds.constellation)?)));
        let Some((id, &fellows)) = fellows else { return 0 };
        let is_swallowed = modes.consolidates_pairs >> id & 1 != 0 || count_of(fellows) == 2;
        if is_swallowed { fellows } else { 0 }
    }

    /// Visits the monitored pairs with a first event.
    #[inline]
    fn visit_with(
        &self,
        first: &FirstEvent<T>,
        others: RowSet,
        was_monitorable: &dyn Fn(RowSet) -> bool,
        visitor: &mut dyn Visitor<T>,
    ) -> ControlFlow<()> {
        let ModeWalk { modes, gone, .. } = *self.walk;
        let mut rows = self.before_the_cut(first, others);
        if gone != 0 {
            let counts = |&index: &usize| was_monitorable(first.rows | row(index));
            rows = members(rows).filter(counts).fold(0, |set, index| set | row(index));
        }
        let batch = ModeBatch {
            common: first.hypothesis,
            rows,
            taken: first.taken,
            probability: first.probability * modes.likeliest.odds,
            ln_probability: first.ln_probability + modes.likeliest.ln,
        };
        members(visitor.screen(&batch)).try_for_each(|index| {
            let Some(odds) = modes.odds.get(index) else { return ControlFlow::Continue(()) };
            visitor.visit(&Mode {
                hypothesis: first.hypothesis.and(index),
                taken: first.taken,
                probability: first.probability * odds.odds,
                ln_probability: first.ln_probability + odds.ln,
            })
        })
    }

    /// Returns the rows whose pairs with the first event come before the cut.
    fn before_the_cut(&self, first: &FirstEvent<T>, others: RowSet) -> RowSet {
        let modes = self.walk.modes;
        let (size, at) = (first.size, &modes.cutoff);
        if size != at.size || at.count != 2 {
            return if modes.comes_before_the_cut(first.event, 2, size) { others } else { 0 };
        }
        // The last monitored pair; pairs are listed in the order of words.
        let (least, largest) = (at.events & at.events.wrapping_neg(), at.events & at.events.wrapping_sub(1));
        if first.hypothesis.constellations != 0 {
            let lesser = others & (least.wrapping_sub(1));
            return if first.event <= largest { lesser | others & least } else { lesser };
        }
        match first.event.cmp(&least) {
            Ordering::Less => others,
            Ordering::Equal => others & (largest | (largest.wrapping_sub(1))),
            Ordering::Greater => 0,
        }
    }
}
