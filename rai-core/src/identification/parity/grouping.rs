//! Grouping: of all sets of one row the best, then of all sets of two, then of three, until one passes.
//!
//! The best set of a size is the one with the smallest `SSE_E`, the first in lexicographic order of equals. It finds
//! what sequential isolation misses: two faults that hide behind a third, healthy row.
//!
//! Work: `n + n(n−1)/2 + n(n−1)(n−2)/6` sets, 10,700 for 40 rows. A set costs a dozen products: a third row that two
//! others are tried with is taken out of all rows first ([`crate::removal`]). Only the best of a size is checked for
//! being refused; where it is, the size is looked through again below it. In `f32` on a Cortex-M4F all pairs of 20 rows
//! take 22,000 instructions, all triples 112,000. A budget that is used up ends the search without a result.

use heapless::Vec;

use super::{Finding, Limits, Search, search};
use crate::identification::{baarda::Identification, tails};
use crate::real::Real;
use crate::removal::{NormalisedRow, Removal};
use crate::report::MAX_EXCLUDED;
use crate::snapshot::{Snapshot, infinity};
use crate::threshold::Thresholds;

/// Looks for the smallest set of rows without which the rest passes.
#[inline(never)]
pub fn grouping<T: Real, const N: usize>(
    snapshot: &Snapshot<T, N>,
    thresholds: &Thresholds<'_>,
    limits: &Limits,
) -> Finding<T> {
    search(snapshot, thresholds, limits, |search: &Search<'_, T, N>| search.grouping())
}

impl<T: Real, const N: usize> Search<'_, T, N> {
    pub(super) fn grouping(&self) -> Finding<T> {
        let mut contest = Contest::new(self.rows, self.limits.sets);
        // With no degree of freedom left every set would pass, and none would mean anything.
        let largest = self.limits.rows().min(self.snapshot.dof().saturating_sub(1));
        for size in 1..=largest {
            let best = contest.best_of_size::<N>(size);
            let sets = self.limits.sets - contest.left;
            if contest.cut {
                return Finding { set: Err(Identification::Budget), sets };
            }
            if let Some(best) = best.filter(|best| self.passes(best)) {
                return Finding { set: Ok(best), sets };
            }
        }
        Finding { set: Err(Identification::NoSet), sets: self.limits.sets - contest.left }
    }
}

/// The set that explains most so far, and how many sets may still be looked at.
struct Contest<'r, T: Real> {
    rows: &'r [NormalisedRow<T>],
    best: Option<Entrant<T>>,
    /// Sets that explain as much as this are refused.
    ceiling: T,
    left: usize,
    cut: bool,
}

/// A set by the indices of its rows, as many as its size says.
#[derive(Clone, Copy)]
struct Entrant<T> {
    explained: T,
    set: [usize; MAX_EXCLUDED],
}

impl<'r, T: Real> Contest<'r, T> {
    fn new(rows: &'r [NormalisedRow<T>], sets: usize) -> Self {
        Self { rows, best: None, ceiling: infinity(), left: sets, cut: false }
    }

    /// The best set of a size that is not refused. The best are rarely refused: it is cheaper to look through all sets
    /// again than to examine each that leads for a while.
    fn best_of_size<const N: usize>(&mut self, size: usize) -> Option<Removal<T>> {
        self.ceiling = infinity();
        loop {
            self.best = None;
            self.all_of_size::<N>(size);
            let Entrant { explained, set } = self.best.filter(|_| !self.cut)?;
            if let Some(removal) = self.removal(set.get(..size)?) {
                return Some(removal);
            }
            self.ceiling = explained;
        }
    }

    fn all_of_size<const N: usize>(&mut self, size: usize) {
        match size {
            1 => self.singles(),
            2 => self.pairs(T::zero(), [], self.rows),
            _ => self.triples::<N>(),
        }
    }

    fn singles(&mut self) {
        for row in self.granted(self.rows) {
            self.enter(row.explained(), [row.index, 0, 0]);
        }
    }

    /// All pairs of `rows`, each together with a row that is gone already, if one is, and explains so much.
    fn pairs<const GONE: usize>(&mut self, explained: T, gone: [usize; GONE], rows: &[NormalisedRow<T>]) {
        for (first, rest) in tails(rows) {
            if first.redundancy < T::UNTESTABLE {
                continue;
            }
            for second in self.granted(rest) {
                let explained = explained + first.explained_with(second);
                let mut set = [first.index, second.index, 0];
                if let Some(&gone) = gone.first() {
                    set = [gone, first.index, second.index];
                }
                self.enter(explained, set);
            }
        }
    }

    fn triples<const N: usize>(&mut self) {
        let mut changed = Vec::<NormalisedRow<T>, N>::new();
        for (first, rest) in tails(self.rows) {
            if !self.cut {
                let root = first.redundancy.sqrt();
                changed.clear();
                for row in rest {
                    // Fewer than N: never full here.
                    let _ = changed.push(row.without(first, root));
                }
                self.pairs(first.explained(), [first.index], &changed);
            }
        }
    }

    /// As many of `rows` as may still be looked at, which they are from now on.
    fn granted<'q>(&mut self, rows: &'q [NormalisedRow<T>]) -> &'q [NormalisedRow<T>] {
        self.cut |= rows.len() > self.left;
        let granted = rows.get(..self.left).unwrap_or(rows);
        self.left -= granted.len();
        granted
    }

    /// Keeps a set that is better than all before.
    fn enter(&mut self, explained: T, set: [usize; MAX_EXCLUDED]) {
        let leads = self.best.is_none_or(|best| explained > best.explained);
        if leads && explained < self.ceiling {
            self.best = Some(Entrant { explained, set });
        }
    }

    fn removal(&self, set: &[usize]) -> Option<Removal<T>> {
        set.iter().try_fold(Removal::none(), |removal, &index| {
            removal.and(self.rows.iter().find(|row| row.index == index)?)
        })
    }
}
