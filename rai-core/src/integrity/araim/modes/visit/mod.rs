//! Walk through the modes: visits once every set of satellites that a monitored combination takes.

mod pairs;

use core::ops::{ControlFlow, RangeInclusive};

use super::Modes;
use super::sets::{EVENTS, Hypothesis, NONE, RowSet, above, losses, members, row};
use crate::bit_set::count_of;
use crate::numeric::real::Real;
use crate::satellite::Constellation;
use pairs::Pairs;

/// One monitored set of satellites.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrity::araim) struct Mode<T> {
    pub(in crate::integrity::araim) hypothesis: Hypothesis,
    /// Number of satellites that it takes.
    pub(in crate::integrity::araim) taken: usize,
    /// `p_k`.
    pub(in crate::integrity::araim) probability: T,
    /// `ln p_k`, or slightly more.
    pub(in crate::integrity::araim) ln_probability: T,
}

/// Modes that differ only in one row.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrity::araim) struct ModeBatch<T> {
    /// Common part of all modes.
    pub(in crate::integrity::araim) common: Hypothesis,
    /// Rows, one for each mode.
    pub(in crate::integrity::araim) rows: RowSet,
    /// Number of satellites that each mode takes.
    pub(in crate::integrity::araim) taken: usize,
    /// `p_k` of the likeliest mode, or more.
    pub(in crate::integrity::araim) probability: T,
    /// Logarithm of `probability`.
    pub(in crate::integrity::araim) ln_probability: T,
}

/// Receiver of the visited modes.
pub(in crate::integrity::araim) trait Visitor<T> {
    /// Returns the rows of a batch whose modes must be visited one by one. The others are
    /// dismissed.
    fn screen(&mut self, batch: &ModeBatch<T>) -> RowSet {
        batch.rows
    }

    fn visit(&mut self, mode: &Mode<T>) -> ControlFlow<()>;
}

/// Remaining rows of each constellation after an exclusion.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrity::araim) struct RemainingRows {
    pub(in crate::integrity::araim) gone: RowSet,
    members: [RowSet; Constellation::COUNT],
    /// Rows that are the only remaining ones of their constellation.
    alone: RowSet,
    /// Rows of constellations with so few rows that one mode can take all.
    few: RowSet,
    /// Constellations with remaining rows, a bit for each id.
    pub(super) in_view: usize,
}

impl RemainingRows {
    pub(super) fn of(members: &[RowSet; Constellation::COUNT], gone: RowSet) -> Self {
        let members = members.map(|members| members & !gone);
        let union = |set: RowSet, rows: &RowSet| set | rows;
        let alone = members.iter().filter(|rows| rows.is_power_of_two()).fold(0, union);
        let without_one = |rows: RowSet| rows & rows.wrapping_sub(1);
        let is_few = |rows: &&RowSet| (0..EVENTS).fold(**rows, |rows, _| without_one(rows)) == 0;
        let few = members.iter().filter(is_few).fold(0, union);
        let is_left = members.iter().enumerate().filter(|&(_, &members)| members != 0);
        let in_view = is_left.fold(0, |set, (id, _)| set | 1 << id);
        Self { gone, members, alone, few, in_view }
    }
}

/// The modes that lose the same constellations.
pub(super) struct ModeWalk<'m, T: Real> {
    pub(super) modes: &'m Modes<'m, T>,
    pub(super) lost: usize,
    lost_rows: RowSet,
    pub(super) lost_count: usize,
    pub(super) gone: RowSet,
    /// Remaining rows of each constellation.
    pub(super) members: &'m [RowSet; Constellation::COUNT],
    /// True if one mode can take all rows of a constellation.
    has_few: bool,
    /// Rows that a mode can take one by one: those of other constellations, unless they are the
    /// only ones.
    pub(super) left: RowSet,
}

impl<'m, T: Real> ModeWalk<'m, T> {
    /// Returns the walk through the modes that lose these constellations. They must be in view and
    /// no more than the limit.
    pub(super) fn without(modes: &'m Modes<T>, lost: usize, remains: &'m RemainingRows) -> Self {
        let RemainingRows { gone, members, alone, few, .. } = remains;
        let lost_rows = modes.rows_of(lost) & !gone;
        // Without its only satellite a constellation is lost, which belongs to another walk.
        let left = modes.fallible & !gone & !lost_rows & !alone;
        let lost_count = count_of(lost_rows);
        Self { modes, lost, lost_rows, lost_count, gone: *gone, members, has_few: few & left != 0, left }
    }

    pub(super) fn visit(
        &self,
        sizes: &RangeInclusive<usize>,
        was_monitorable: &dyn Fn(RowSet) -> bool,
        visitor: &mut dyn Visitor<T>,
    ) -> ControlFlow<()> {
        let (lost, size, limit) = (self.lost, self.lost.count_ones() as usize, self.modes.limit);
        let offer = |visitor: &mut _, size: usize, rows: [usize; EVENTS]| match self.mode(
            size,
            rows,
            was_monitorable,
        ) {
            Some(mode) if sizes.contains(&size) => Visitor::visit(visitor, &mode),
            _ => ControlFlow::Continue(()),
        };
        if lost != 0 && sizes.contains(&size) {
            offer(visitor, size, [NONE; EVENTS])?;
        }
        if let Some(pairs) = Pairs::of(self) {
            if lost == 0 && sizes.contains(&1) && self.gone == 0 {
                pairs.visit_singles(visitor)?;
            } else if lost == 0 && sizes.contains(&1) {
                members(self.left).try_for_each(|first| offer(visitor, 1, [first, NONE, NONE]))?;
            }
            return if sizes.contains(&2) {
                pairs.visit(was_monitorable, visitor)
            } else {
                ControlFlow::Continue(())
            };
        }
        let is_wanted = |more: usize| size + more <= limit && size + more <= *sizes.end();
        for first in members(self.left).filter(|_| is_wanted(1)) {
            if sizes.contains(&(size + 1)) {
                offer(visitor, size + 1, [first, NONE, NONE])?;
            }
            let after = self.left & above(first);
            for second in members(after).filter(|_| is_wanted(2)) {
                if sizes.contains(&(size + 2)) {
                    offer(visitor, size + 2, [first, second, NONE])?;
                }
                for third in members(after & above(second)).filter(|_| is_wanted(3)) {
                    offer(visitor, size + 3, [first, second, third])?;
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// Returns the mode of the lost constellations and these rows. Returns `None` if it is not
    /// monitored, or if it belongs to another walk.
    #[inline]
    fn mode(
        &self,
        size: usize,
        rows: [usize; EVENTS],
        was_monitorable: &dyn Fn(RowSet) -> bool,
    ) -> Option<Mode<T>> {
        let chosen = rows.iter().fold(0, |set, &index| set | row(index));
        if self.has_few && size > 1 && self.empties(chosen) {
            return None;
        }
        // Without an exclusion, only these events take just these rows. So it is at the limit of
        // events.
        let is_sole = self.lost == 0 && (self.gone == 0 || size == self.modes.limit);
        let (probability, ln_probability) = if is_sole {
            self.sole(chosen, rows, size, was_monitorable)?
        } else {
            let probability = self.sum_of_causes(chosen, was_monitorable);
            (probability, probability.ln())
        };
        let hypothesis = Hypothesis::of(self.lost, rows);
        let taken = self.lost_count + size - self.lost.count_ones() as usize;
        (probability > T::zero()).then_some(Mode { hypothesis, taken, probability, ln_probability })
    }

    /// Returns true if the rows contain all remaining ones of a constellation, which is another
    /// mode.
    fn empties(&self, chosen: RowSet) -> bool {
        self.members.iter().any(|&members| members & self.left != 0 && members & !chosen == 0)
    }

    /// Returns the probability that just these rows fail independently, and its logarithm.
    #[inline]
    fn sole(
        &self,
        chosen: RowSet,
        rows: [usize; EVENTS],
        size: usize,
        was_monitorable: &dyn Fn(RowSet) -> bool,
    ) -> Option<(T, T)> {
        let modes = self.modes;
        let (mut product, mut ln, mut constellation) = (modes.healthy, modes.ln_healthy, NONE);
        for (position, &index) in rows.iter().take(size).enumerate() {
            let odds = modes.odds.get(index)?;
            product *= odds.odds;
            ln += odds.ln;
            constellation =
                if position == 0 || constellation == odds.constellation { odds.constellation } else { NONE };
        }
        let odds = modes.constellations.get(constellation);
        let consolidated = odds.is_some_and(|&odds| product < modes.consolidation * (modes.healthy * odds));
        let watched = !consolidated
            && (product > modes.mandatory || modes.comes_before_the_cut(chosen, size as u32, size));
        (watched && (self.gone == 0 || was_monitorable(chosen))).then_some((product, ln))
    }

    /// Returns true if no other combination takes just the satellites of the lost constellations.
    ///
    /// This is so if they have more satellites than can fail at once, and their number is the limit
    /// of events.
    fn has_one_cause(&self) -> bool {
        let limit = self.modes.limit;
        let is_large = |size: &usize| *size > limit;
        let mut lost = self.modes.sizes.iter().enumerate().filter(|(id, _)| self.lost >> id & 1 != 0);
        self.gone == 0 && self.lost.count_ones() as usize == limit && lost.all(|(_, size)| is_large(size))
    }

    /// Returns the probability of all monitored combinations that leave the same satellites.
    #[inline(never)]
    fn sum_of_causes(&self, chosen: RowSet, was_monitorable: &dyn Fn(RowSet) -> bool) -> T {
        if chosen == 0
            && let Some(loss) = self.modes.sole_loss(self.lost, self.gone)
        {
            return if self.modes.is_loss_watched(loss) { loss.probability } else { T::zero() };
        }
        if chosen == 0 && self.has_one_cause() {
            let combination = self.modes.combination(losses(self.lost));
            let probability = self.modes.probability_of(&combination);
            let is_monitored = self.modes.is_monitored(&combination, probability);
            return if is_monitored { probability } else { T::zero() };
        }
        let mut sum = T::zero();
        self.modes.causes(self.lost_rows, chosen, self.gone, &mut |combination, probability| {
            let counts = self.modes.is_monitored(combination, probability)
                && (self.gone == 0 || was_monitorable(combination.rows));
            if counts {
                sum += probability;
            }
        });
        sum
    }
}
