//! Modes that are monitored: which of them leave a solution, and how many there are.

use core::ops::ControlFlow;

use heapless::Vec;

use super::modes::{Mode, ModeBatch, Modes, RemainingRows, RowSet, Visitor, members, row};
use crate::allocation::Allocation;
use crate::bit_set::count_of;
use crate::numeric::real::Real;
use crate::satellite::Constellation;

/// Capacity for modes that leave a singular geometry, although enough satellites would remain.
pub(super) const SINGULAR: usize = 16;

/// Monitored modes, and their properties with all satellites in view.
#[derive(Clone, Debug)]
pub(super) struct MonitoredModes<'a, T: Real> {
    pub(super) modes: Modes<'a, T>,
    pub(super) allocation: &'a Allocation,
    /// `ρ`, the share of the risk.
    pub(super) risk_share: T,
    /// Sets of rows whose loss leaves a singular geometry.
    pub(super) singular: Vec<RowSet, SINGULAR>,
    /// `P_nm` with all satellites in view.
    pub(super) unmonitored_probability: T,
}

impl<'a, T: Real> MonitoredModes<'a, T> {
    /// Returns the modes before the choice.
    #[allow(clippy::inline_always, reason = "made where it stays: it is large")]
    #[inline(always)]
    pub(super) fn nothing(constellations: [T; Constellation::COUNT], allocation: &'a Allocation) -> Self {
        Self {
            modes: Modes::nothing(constellations, allocation),
            allocation,
            risk_share: T::one(),
            singular: Vec::new(),
            unmonitored_probability: T::zero(),
        }
    }

    /// Returns true if enough satellites remain without a set of rows, and their geometry is not
    /// known to be singular.
    pub(super) fn is_monitorable(&self, taken: RowSet) -> bool {
        self.leaves_enough(taken, 0) && !self.singular.contains(&taken)
    }

    /// Returns true if at least `more` satellites remain in addition to those that position and
    /// clocks need.
    // Not inlined, so that its many callers share one copy.
    #[inline(never)]
    pub(super) fn leaves_enough(&self, taken: RowSet, more: u32) -> bool {
        let left = (self.modes.satellites & !taken).count_ones();
        // Mostly there are enough for a clock of every constellation, which is the cheaper
        // comparison.
        left >= 3 + Constellation::COUNT as u32 + more || left >= 3 + self.clocks_left(taken) + more
    }

    /// Returns the number of constellations with remaining satellites.
    fn clocks_left(&self, taken: RowSet) -> u32 {
        self.modes.members.iter().filter(|&&members| members & !taken != 0).count() as u32
    }

    /// Returns the rows that are monitored singly.
    pub(super) fn singles(&self) -> RowSet {
        let watched = |&index: &usize| self.modes.monitors(index) && self.is_monitorable(row(index));
        members(self.modes.satellites).filter(watched).fold(0, |set, index| set | row(index))
    }

    /// Counts the modes that can be monitored, by the number of satellites alone.
    #[inline(never)]
    pub(super) fn count(&self, remains: &RemainingRows) -> ModeCount<T> {
        let gone = remains.gone;
        let ample =
            count_of(self.modes.satellites & !gone).saturating_sub(3 + self.clocks_left(gone) as usize);
        let count = ModeCount { modes: 0, unmonitorable: T::zero(), singular: false };
        let mut counter = ModeCounter { monitored: self, gone, ample, count };
        let was_monitorable = |taken| self.is_monitorable(taken);
        let _ = self.modes.visit(remains, &(1..=3), &was_monitorable, &mut counter);
        counter.count
    }
}

/// Number of monitored modes, and the probability of those that cannot be monitored.
#[derive(Clone, Debug)]
pub(super) struct ModeCount<T> {
    pub(super) modes: usize,
    pub(super) unmonitorable: T,
    /// True if modes with a singular geometry are already excluded.
    pub(super) singular: bool,
}

/// Visitor that counts modes.
struct ModeCounter<'w, 'a, T: Real> {
    monitored: &'w MonitoredModes<'a, T>,
    gone: RowSet,
    /// Number of satellites that may be lost, whichever they are.
    ample: usize,
    count: ModeCount<T>,
}

impl<T: Real> Visitor<T> for ModeCounter<'_, '_, T> {
    fn screen(&mut self, batch: &ModeBatch<T>) -> RowSet {
        if batch.taken > self.ample {
            return batch.rows;
        }
        self.count.modes += batch.rows.count_ones() as usize;
        0
    }

    fn visit(&mut self, mode: &Mode<T>) -> ControlFlow<()> {
        let taken = self.gone | self.monitored.modes.taken_by(mode.hypothesis);
        if mode.taken <= self.ample || self.monitored.leaves_enough(taken, 0) {
            self.count.modes += 1;
        } else {
            self.count.unmonitorable += mode.probability;
        }
        ControlFlow::Continue(())
    }
}
