//! Combinations of simultaneous events, and their order.

use core::ops::ControlFlow;

use super::sets::{NONE, ROW_EVENTS, RowSet};
use crate::bit_set::count_of;
use crate::numeric::real::Real;

/// A fault of one satellite or one constellation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Event<T> {
    pub(super) rows: RowSet,
    pub(super) bit: RowSet,
    pub(super) size: usize,
    pub(super) constellation: usize,
    pub(super) odds: T,
}

/// A combination of simultaneous events.
#[derive(Clone, Copy, Debug)]
pub(super) struct Combination<T> {
    pub(super) events: RowSet,
    pub(super) rows: RowSet,
    pub(super) size: usize,
    /// The only constellation that is affected; [`NONE`] if there are several.
    pub(super) constellation: usize,
    pub(super) odds: T,
    pub(super) bare: T,
}

impl<T: Real> Combination<T> {
    pub(super) fn empty() -> Self {
        Self { events: 0, rows: 0, size: 0, constellation: NONE, odds: T::one(), bare: T::one() }
    }

    /// Adds an event. The caller sets `events` and `size`.
    pub(super) fn add(&mut self, rows: RowSet, constellation: usize, odds: T) {
        let is_first = self.rows == 0;
        self.constellation =
            if is_first || self.constellation == constellation { constellation } else { NONE };
        self.rows |= rows;
        self.odds *= odds;
        self.bare *= odds / (T::one() + odds);
    }

    pub(super) fn of_one(event: &Event<T>) -> Self {
        let Event { rows, bit, size, constellation, odds } = *event;
        Self { events: bit, rows, size, constellation, odds, bare: odds }
    }

    pub(super) fn with(&self, event: &Event<T>) -> Self {
        // A satellite is in a constellation or not, so that the sets of two events are nested or
        // disjoint.
        let apart = self.rows & event.rows == 0;
        Self {
            events: self.events | event.bit,
            rows: self.rows | event.rows,
            size: if apart { self.size + event.size } else { count_of(self.rows | event.rows) },
            constellation: if self.constellation == event.constellation { self.constellation } else { NONE },
            odds: self.odds * event.odds,
            bare: self.bare,
        }
    }

    /// Returns true for the loss of one constellation and no other event.
    pub(super) fn is_whole_constellation(&self) -> bool {
        self.events & ROW_EVENTS == 0 && self.events & self.events.wrapping_sub(1) == 0
    }
}

/// Probabilities of 0, 1, 2, 3 and more simultaneous events, as sums of positive terms.
#[derive(Clone, Copy, Debug)]
pub(super) struct Simultaneous<T> {
    pub(super) none: T,
    one: T,
    two: T,
    pub(super) three: T,
    pub(super) more: T,
}

impl<T: Real> Simultaneous<T> {
    /// Returns the probabilities without events.
    pub(super) fn nothing() -> Self {
        Self { none: T::one(), one: T::zero(), two: T::zero(), three: T::zero(), more: T::zero() }
    }

    /// Adds an event by its odds.
    #[inline]
    pub(super) fn add(&mut self, odds: T) {
        let fine = (T::one() + odds).recip();
        let failed = odds * fine;
        self.more += self.three * failed;
        self.three = self.three * fine + self.two * failed;
        self.two = self.two * fine + self.one * failed;
        self.one = self.one * fine + self.none * failed;
        self.none *= fine;
    }
}

/// Visits every combination of a number of events, in descending order.
#[inline(never)]
pub(super) fn combinations_backwards<T: Real>(
    events: &[Event<T>],
    size: usize,
    visitor: &mut dyn FnMut(Combination<T>) -> ControlFlow<()>,
) -> ControlFlow<()> {
    for (index, event) in events.iter().enumerate().rev() {
        let one = Combination::of_one(event);
        if size == 1 {
            visitor(one)?;
            continue;
        }
        for (second, event) in events.iter().enumerate().skip(index + 1).rev() {
            let two = one.with(event);
            if size == 2 {
                visitor(two)?;
                continue;
            }
            for event in events.iter().skip(second + 1).rev() {
                visitor(two.with(event))?;
            }
        }
    }
    ControlFlow::Continue(())
}
