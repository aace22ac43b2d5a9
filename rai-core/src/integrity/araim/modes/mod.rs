//! Choice of the monitored fault modes, which are combinations of events with their probabilities.
//!
//! ```text
//! p_k  = p_0 Π P_e/(1 − P_e)      over the events of the combination          p_0 = Π (1 − P_e)
//! P_nm = P(more than r events) + Σ p_k of the unmonitored combinations
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `P_e/(1 − P_e)` | `odds` | – |
//! | `p_0` | `healthy` | – |
//! | `p_k` | [`Mode::probability`] | – |
//! | `P_nm` | [`Modes::unmonitored_probability`] | – |
//!
//! An event is a fault of one satellite, or of all satellites of one constellation. Combinations of
//! 1 to `r` events are listed. `r` is 2, or 3 if more than 2 events are too likely to be
//! unmonitored. The combinations are treated in this order:
//!
//! 1. If a combination is within one constellation and far less likely than the loss of that
//!    constellation, it is counted with the loss (consolidation).
//! 2. If a combination alone would break the requirement, it is monitored.
//! 3. The others are monitored from the smallest set of satellites to the largest, until `P_nm` is
//!    within its share.
//!
//! Several combinations may take the same satellites: for example, the loss of a constellation with
//! or without the fault of one of its satellites. A [`Mode`] is a set of satellites, with the
//! probability of all monitored combinations that take just these. It consists of whole
//! constellations and of rows of the others, because the solution without it is computed in this
//! form.
//!
//! Nothing is stored for each mode; the modes are visited again if needed. Sums are over the
//! *unmonitored* combinations, beginning with the rarest, so that single precision suffices. At
//! most three simultaneous events are considered.
//!
//! References: [MAAST] `determine_subsets`, [Blanch2015].
//!
//! [Blanch2015]: crate#references
//! [MAAST]: crate#references

mod choice;
mod combination;
mod consolidation;
mod sets;
mod visit;

use core::ops::{ControlFlow, RangeInclusive};

use heapless::Vec;

pub use sets::{Hypothesis, ROWS};
pub(super) use sets::{RowSet, members, row};
pub(super) use visit::{Mode, ModeBatch, RemainingRows, Visitor};

use choice::FaultOdds;
use combination::Combination;
use consolidation::OddsRange;
use sets::{ROW_EVENTS, event, is_listed_after, subsets};
use visit::ModeWalk;

use super::AraimError;
use crate::allocation::Allocation;
use crate::bit_set::count_of;
use crate::numeric::real::Real;
use crate::satellite::Constellation;

/// The loss of a constellation.
#[derive(Clone, Copy, Debug)]
struct ConstellationLoss<T> {
    id: usize,
    rows: RowSet,
    size: usize,
    odds: T,
    /// Probability, consolidated faults included.
    probability: T,
}

/// Cut: the last monitored combination among those that are not mandatory.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cutoff {
    /// Number of satellites of the last monitored combination; smaller combinations are all
    /// monitored.
    size: usize,
    /// Number of events of the last monitored combination of this size.
    count: u32,
    /// These events.
    events: RowSet,
}

/// Capacity for the odds of all rows.
pub(super) type PriorOdds<T, const N: usize> = Vec<FaultOdds<T>, N>;

/// Monitored modes of one epoch.
#[derive(Clone, Debug)]
pub(super) struct Modes<'r, T: Real> {
    odds: &'r [FaultOdds<T>],
    constellations: [T; Constellation::COUNT],
    /// Odds of the likeliest row.
    likeliest: FaultOdds<T>,
    /// Smallest of the rows' odds.
    rarest_odds: T,
    /// Rows of each constellation before an exclusion.
    pub(super) members: [RowSet; Constellation::COUNT],
    /// Number of these rows.
    pub(super) sizes: [usize; Constellation::COUNT],
    /// Rows that are satellites.
    pub(super) satellites: RowSet,
    /// Satellites that can fail by themselves.
    fallible: RowSet,
    healthy: T,
    ln_healthy: T,
    limit: usize,
    /// Probability that is consolidated into each constellation's loss.
    added: [T; Constellation::COUNT],
    mandatory: T,
    consolidation: T,
    cutoff: Cutoff,
    /// Constellations with whose loss every combination of it and one satellite is counted, a bit
    /// for each id.
    consolidates_all: u8,
    /// Constellations with whose loss every pair of their satellites is counted, a bit for each id.
    consolidates_pairs: u8,
    /// True if at most two events are listed and constellations are homogeneous, so that the
    /// monitored pairs depend only on [`Self::consolidates_pairs`] and on the cut.
    is_regular: bool,
    /// `P_nm` of the choice.
    pub(super) unmonitored_probability: T,
}

impl<'r, T: Real> Modes<'r, T> {
    /// Chooses the modes for satellites `(constellation, P_sat)` in the order of their rows and for
    /// the constellations' `P_const`.
    ///
    /// `None` is an aiding row, which never fails. Events with probability 0 are not listed.
    ///
    /// # Errors
    /// [`AraimError`] if there are too many rows, or for a probability outside [0, 0.5).
    pub(super) fn choose<const N: usize>(
        &mut self,
        satellites: impl Iterator<Item = Option<(Constellation, T)>>,
        room: &'r mut PriorOdds<T, N>,
        allocation: &Allocation,
    ) -> Result<(), AraimError> {
        let mut alike = [OddsRange::none(); Constellation::COUNT];
        let simultaneous = self.gather(satellites, room, &mut alike)?;
        let share = T::narrow(allocation.unmonitored_probability);
        let tail = self.count_events(simultaneous, share);
        self.cut(tail, share, &alike);
        Ok(())
    }

    /// Returns the modes before the choice.
    #[allow(clippy::inline_always, reason = "made where it stays: it is large")]
    #[inline(always)]
    pub(super) fn nothing(constellations: [T; Constellation::COUNT], allocation: &Allocation) -> Self {
        Self {
            odds: &[],
            constellations,
            likeliest: FaultOdds::never(),
            rarest_odds: T::one(),
            members: [0; Constellation::COUNT],
            sizes: [0; Constellation::COUNT],
            satellites: 0,
            fallible: 0,
            healthy: T::one(),
            ln_healthy: T::zero(),
            limit: 2,
            added: [T::zero(); Constellation::COUNT],
            mandatory: T::narrow(allocation.integrity_vertical) + T::narrow(allocation.integrity_horizontal),
            consolidation: T::narrow(allocation.consolidation),
            cutoff: Cutoff { size: 0, count: 0, events: 0 },
            consolidates_all: 0,
            consolidates_pairs: 0,
            is_regular: false,
            unmonitored_probability: T::zero(),
        }
    }

    /// Returns the probability of a constellation's loss, consolidated faults included.
    fn loss(&self, id: usize) -> T {
        let odds = self.constellations.get(id).copied().unwrap_or_else(T::zero);
        if odds > T::zero() { self.healthy * odds + self.added_to(id) } else { T::zero() }
    }

    /// Returns the loss of one constellation if no other combination takes just its satellites.
    ///
    /// This is so under two conditions: they are more than can fail one by one, and the loss
    /// together with one satellite's fault is consolidated or exceeds the limit of events.
    fn sole_loss(&self, lost: usize, gone: RowSet) -> Option<ConstellationLoss<T>> {
        if gone != 0 || !lost.is_power_of_two() {
            return None;
        }
        let id = lost.trailing_zeros() as usize;
        let rows = *self.members.get(id)?;
        let is_alone = self.limit == 1 || self.limit == 2 && self.consolidates_all >> id & 1 != 0;
        let odds = *self.constellations.get(id)?;
        let size = *self.sizes.get(id)?;
        (is_alone && size > self.limit).then_some(ConstellationLoss {
            id,
            rows,
            size,
            odds,
            probability: self.loss(id),
        })
    }

    fn is_loss_watched(&self, loss: ConstellationLoss<T>) -> bool {
        loss.probability > self.mandatory || self.comes_before_the_cut(event(loss.id), 1, loss.size)
    }

    /// Returns the probability of a combination.
    fn probability_of(&self, combination: &Combination<T>) -> T {
        let own = self.healthy * combination.odds;
        if combination.is_whole_constellation() {
            own + self.added_to(combination.constellation)
        } else {
            own
        }
    }

    fn added_to(&self, constellation: usize) -> T {
        self.added.get(constellation).copied().unwrap_or_else(T::zero)
    }

    /// Returns true if a combination is monitored separately.
    #[inline(never)]
    fn is_monitored(&self, combination: &Combination<T>, probability: T) -> bool {
        self.consolidates(combination, probability).is_none()
            && (probability > self.mandatory
                || self.comes_before_the_cut(
                    combination.events,
                    combination.events.count_ones(),
                    combination.size,
                ))
    }

    #[inline]
    fn comes_before_the_cut(&self, events: RowSet, count: u32, size: usize) -> bool {
        let Cutoff { size: at_size, count: at_count, events: at } = self.cutoff;
        let is_before = || count < at_count || count == at_count && !is_listed_after(events, at);
        size < at_size || size == at_size && is_before()
    }

    /// Returns true if the fault of one satellite is monitored separately.
    pub(super) fn monitors(&self, index: usize) -> bool {
        let combination = self.combination(row(index));
        let probability = self.probability_of(&combination);
        probability > T::zero() && self.is_monitored(&combination, probability)
    }

    /// Returns the satellites that, without `gone`, are not the only remaining ones of their
    /// constellation.
    pub(super) fn not_alone(&self, gone: RowSet) -> RowSet {
        let left = self.members.iter().map(|members| members & !gone);
        left.filter(|left| !left.is_power_of_two()).fold(0, |set, left| set | left)
    }

    /// Returns a set of events as a combination.
    fn combination(&self, events: RowSet) -> Combination<T> {
        let mut combination = Combination::empty();
        // The loop uses the lowest bit and not its index, because it is run for every cause and
        // needs the bit too.
        let mut left = events & ROW_EVENTS;
        while left != 0 {
            let lowest = left & left.wrapping_neg();
            if let Some(odds) = self.odds.get(lowest.trailing_zeros() as usize) {
                combination.add(lowest, odds.constellation, odds.odds);
            }
            left ^= lowest;
        }
        for (id, (&odds, &rows)) in self.constellations.iter().zip(&self.members).enumerate() {
            if events & event(id) != 0 {
                combination.add(rows, id, odds);
            }
        }
        combination.events = events;
        combination.size = combination.rows.count_ones() as usize;
        combination
    }

    /// Returns the remaining rows of each constellation without `gone`.
    pub(super) fn remains(&self, gone: RowSet) -> RemainingRows {
        RemainingRows::of(&self.members, gone)
    }

    /// Visits the modes of the remaining satellites with a number of rows and constellations.
    ///
    /// `was_monitorable` returns true if a combination, given by its rows before an exclusion,
    /// counts. The code of the walk is large, so that all visitors share one copy.
    #[inline(never)]
    pub(super) fn visit(
        &self,
        remains: &RemainingRows,
        sizes: &RangeInclusive<usize>,
        was_monitorable: &dyn Fn(RowSet) -> bool,
        visitor: &mut dyn Visitor<T>,
    ) -> ControlFlow<()> {
        let in_view = remains.in_view;
        let most = self.limit.min(*sizes.end()) as u32;
        // Constellations first, because their part of the levels is mostly the largest.
        let mut lost = in_view;
        for _ in 0..1usize << Constellation::COUNT {
            if lost.count_ones() <= most {
                let walk = ModeWalk::without(self, lost, remains);
                walk.visit(sizes, was_monitorable, visitor)?;
            }
            if lost == 0 {
                break;
            }
            lost = lost.wrapping_sub(1) & in_view;
        }
        ControlFlow::Continue(())
    }

    /// Returns the largest product of fault probabilities among the monitored combinations of a
    /// mode. It does not contain the probability that the other events do not occur.
    #[inline(never)]
    pub(super) fn prior(
        &self,
        hypothesis: Hypothesis,
        gone: RowSet,
        was_monitorable: &dyn Fn(RowSet) -> bool,
    ) -> T {
        let chosen = hypothesis.rows().fold(0, |set, index| set | row(index));
        if hypothesis.constellations == 0 && gone == 0 {
            return self.combination(chosen).bare;
        }
        if chosen == 0
            && let Some(loss) = self.sole_loss(usize::from(hypothesis.constellations), gone)
        {
            let is_monitored = self.is_loss_watched(loss) && was_monitorable(loss.rows);
            return if is_monitored { loss.odds / (T::one() + loss.odds) } else { T::zero() };
        }
        let lost_rows = self.rows_of(usize::from(hypothesis.constellations)) & !gone;
        let mut largest = T::zero();
        self.causes(lost_rows, chosen, gone, &mut |combination, probability| {
            if self.is_monitored(combination, probability)
                && was_monitorable(combination.rows)
                && combination.bare > largest
            {
                largest = combination.bare;
            }
        });
        largest
    }

    /// Returns the probability above which a mode must be monitored, because it alone would break
    /// the requirement.
    pub(super) fn mandatory(&self) -> T {
        self.mandatory
    }

    /// Returns `p_0`.
    pub(super) fn healthy(&self) -> T {
        self.healthy
    }

    /// Returns the rows that a hypothesis takes, before an exclusion.
    // Not inlined, so that its many callers share one copy.
    #[inline(never)]
    pub(super) fn taken_by(&self, hypothesis: Hypothesis) -> RowSet {
        let rows = hypothesis.rows().fold(0, |set, index| set | row(index));
        rows | self.rows_of(usize::from(hypothesis.constellations))
    }

    /// Returns all rows of some constellations.
    fn rows_of(&self, constellations: usize) -> RowSet {
        let chosen = self.members.iter().enumerate().filter(|(id, _)| constellations >> id & 1 != 0);
        chosen.fold(0, |rows, (_, members)| rows | members)
    }

    /// Visits every combination, monitored or not, that leaves the same satellites as a mode.
    #[inline(never)]
    fn causes(
        &self,
        lost_rows: RowSet,
        chosen: RowSet,
        gone: RowSet,
        cause: &mut dyn FnMut(&Combination<T>, T),
    ) {
        let (target, room) = (lost_rows | chosen, lost_rows | chosen | gone);
        let mut forced = chosen;
        let mut pool = (lost_rows | gone) & self.fallible;
        let left = self.limit.saturating_sub(count_of(chosen));
        for (id, (&odds, &rows)) in self.constellations.iter().zip(&self.members).enumerate() {
            if odds > T::zero() && rows & !room == 0 {
                // If the rows are too many to fail one by one, only the loss of the constellation
                // takes them.
                let is_forced = count_of(rows & lost_rows) > left;
                *if is_forced { &mut forced } else { &mut pool } |= event(id);
            }
        }
        if self.limit == 2 {
            // The loss of a constellation together with one of its satellites is already counted
            // with the loss.
            for (id, &rows) in self.members.iter().enumerate() {
                if forced & event(id) != 0 && self.consolidates_all >> id & 1 != 0 {
                    pool &= !rows;
                }
            }
        }
        let left = self.limit.saturating_sub(count_of(forced));
        if forced & ROW_EVENTS & !self.fallible != 0 || count_of(forced) > self.limit {
            return;
        }
        for chosen in subsets(pool, left as u32) {
            let events = forced | chosen;
            let combination = self.combination(events);
            if events != 0 && combination.rows & target == target {
                cause(&combination, self.probability_of(&combination));
            }
        }
    }
}
