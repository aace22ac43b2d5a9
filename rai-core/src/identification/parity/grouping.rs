//! Grouping: of all sets of one row the best, then of all sets of two, then of three, until one passes.
//!
//! The best set of a size is the one with the smallest `SSE_E`, the first in lexicographic order of equals. It finds
//! what sequential isolation misses: two faults that hide behind a third, healthy row.
//!
//! Work: `n + n(n−1)/2 + n(n−1)(n−2)/6` sets, 10,700 for 40 rows; a set costs about 100 instructions in `f32` on a
//! Cortex-M4F. A budget that is used up ends the search without a result.

use super::{Finding, Limits, Search};
use crate::identification::{baarda::Identification, tails};
use crate::real::Real;
use crate::removal::{NormalisedRow, Removal};
use crate::snapshot::Snapshot;
use crate::threshold::Thresholds;

/// Looks for the smallest set of rows without which the rest passes.
pub fn grouping<T: Real, const N: usize>(
    snapshot: &Snapshot<T, N>,
    thresholds: &Thresholds<'_>,
    limits: &Limits,
) -> Finding<T> {
    match Search::begin(snapshot, thresholds, limits) {
        Ok(search) => search.grouping(),
        Err(finding) => finding,
    }
}

impl<T: Real, const N: usize> Search<'_, T, N> {
    pub(super) fn grouping(&self) -> Finding<T> {
        let mut contest = Contest { best: None, left: self.limits.sets, cut: false };
        // With no degree of freedom left every set would pass, and none would mean anything.
        let largest = self.limits.rows().min(self.snapshot.dof().saturating_sub(1));
        for size in 1..=largest {
            contest.all_of_size(size, &self.rows);
            let sets = self.limits.sets - contest.left;
            if contest.cut {
                return Finding { set: Err(Identification::Budget), sets };
            }
            if let Some(best) = contest.best.take_if(|best| self.passes(best)) {
                return Finding { set: Ok(best), sets };
            }
        }
        Finding { set: Err(Identification::NoSet), sets: self.limits.sets - contest.left }
    }
}

/// The best set of the size at hand, and how many may still be looked at.
struct Contest<T: Real> {
    best: Option<Removal<T>>,
    left: usize,
    cut: bool,
}

impl<T: Real> Contest<T> {
    fn all_of_size(&mut self, size: usize, rows: &[NormalisedRow<T>]) {
        self.best = None;
        let none = Removal::none();
        match size {
            1 => self.singles(&none, rows),
            2 => self.pairs(&none, rows),
            _ => self.triples(rows),
        }
    }

    fn triples(&mut self, rows: &[NormalisedRow<T>]) {
        for (first, rest) in tails(rows) {
            // A set that is refused takes all larger sets with it: their smallest eigenvalue is smaller still.
            if let Some(base) = Removal::none().and(first).filter(|_| !self.cut) {
                self.pairs(&base, rest);
            }
        }
    }

    fn pairs(&mut self, base: &Removal<T>, rows: &[NormalisedRow<T>]) {
        for (first, rest) in tails(rows) {
            if let Some(base) = base.and(first).filter(|_| !self.cut) {
                self.singles(&base, rest);
            }
        }
    }

    /// `base` with each of `rows`.
    fn singles(&mut self, base: &Removal<T>, rows: &[NormalisedRow<T>]) {
        self.cut |= rows.len() > self.left;
        for row in rows.iter().take(self.left) {
            let explained = base.explained() + base.explains_more(row);
            if self.best.as_ref().is_none_or(|best| explained > best.explained())
                && let Some(set) = base.and(row)
            {
                self.best = Some(set);
            }
        }
        self.left = self.left.saturating_sub(rows.len());
    }
}
