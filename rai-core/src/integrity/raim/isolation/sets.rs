//! Enumeration of all sets of one, two or three rows, each with the decrease of SSE without it.
//!
//! Work: `n + n(n−1)/2 + n(n−1)(n−2)/6` sets, 10,700 for 40 rows. A set takes a dozen products: a
//! row that forms triples with many pairs is first projected out of all others
//! ([`crate::least_squares::downdate`]).

use crate::bounded::MAX_ROWS;
use crate::least_squares::downdate::{NormalisedRow, PairCandidate, ReducedRow, ReducedRows};
use crate::numeric::real::Real;
use crate::report::MAX_EXCLUDED;

/// Returns the number of sets of up to `largest` rows out of `rows`; a set has at most
/// [`MAX_EXCLUDED`].
pub const fn count_up_to(largest: usize, rows: usize) -> usize {
    let (ones, twos) = (rows, rows * rows.saturating_sub(1) / 2);
    let threes = twos * rows.saturating_sub(2) / 3;
    match largest {
        0 => 0,
        1 => ones,
        2 => ones + twos,
        _ => ones + twos + threes,
    }
}

/// Budget of a search: the number of sets that it may still compare.
pub(in crate::integrity::raim) struct SetBudget {
    pub(in crate::integrity::raim) left: usize,
    /// True if more sets were needed than granted.
    pub(in crate::integrity::raim) cut: bool,
}

impl SetBudget {
    pub(in crate::integrity::raim) const fn new(sets: usize) -> Self {
        Self { left: sets, cut: false }
    }

    /// Returns a budget for all sets of the rows of any epoch, each compared once.
    pub(in crate::integrity::raim) const fn for_all() -> Self {
        Self::new(count_up_to(MAX_EXCLUDED, MAX_ROWS))
    }

    /// Returns as many of `rows` as the budget grants, and charges them.
    fn granted<'q, E>(&mut self, rows: &'q [E]) -> &'q [E] {
        self.cut |= rows.len() > self.left;
        let granted = rows.get(..self.left).unwrap_or(rows);
        self.left -= granted.len();
        granted
    }
}

/// Calls `show` for each set of a size that decreases SSE by at least the bar, in lexicographic
/// order, with this decrease and its rows.
///
/// The callback returns the new bar. Few sets reach it, so that most take one comparison.
// Not inlined, so that the reduced rows are off the stack after the enumeration.
#[inline(never)]
pub(in crate::integrity::raim) fn each_of_size<T: Real, const N: usize>(
    rows: &[NormalisedRow<T>],
    size: usize,
    work: &mut SetBudget,
    bar: T,
    show: &mut dyn FnMut(T, [usize; MAX_EXCLUDED]) -> T,
) {
    let mut above = SetFilter { bar, show };
    // One buffer for pairs and triples, because it is large.
    let mut standings = ReducedRows::<'_, T, N>::new();
    match size {
        1 => {
            for row in work.granted(rows) {
                above.consider(row.explained(), || [row.index, 0, 0]);
            }
        }
        2 => {
            stand(&mut standings, rows.iter().map(ReducedRow::of));
            pairs(T::zero(), &standings, work, &mut above, None);
        }
        _ => triples(rows, &mut standings, work, &mut above),
    }
}

/// Works like [`each_of_size`] for sets of one or two rows from which one more estimated parameter
/// was projected out. The callback receives only the decrease.
// Not inlined, for the same reason.
#[inline(never)]
pub(in crate::integrity::raim) fn each_of_size_beside<'r, T: Real, const N: usize>(
    rows: impl Iterator<Item = ReducedRow<'r, T>>,
    size: usize,
    work: &mut SetBudget,
    bar: T,
    mut show: impl FnMut(T) -> T,
) {
    let mut above = SetFilter { bar, show: &mut |explained, _| show(explained) };
    let mut standings = ReducedRows::<'_, T, N>::new();
    stand(&mut standings, rows);
    match size {
        1 => {
            for standing in work.granted(&standings) {
                above.consider(standing.explained(), || [standing.index(), 0, 0]);
            }
        }
        _ => pairs(T::zero(), &standings, work, &mut above, None),
    }
}

/// Least decrease of SSE that a set must reach, and the callback that receives the set. The
/// callback is no type parameter, so that all searches share one copy of the loops.
struct SetFilter<'s, T> {
    bar: T,
    show: &'s mut dyn FnMut(T, [usize; MAX_EXCLUDED]) -> T,
}

impl<T: Real> SetFilter<'_, T> {
    fn consider(&mut self, explained: T, set: impl FnOnce() -> [usize; MAX_EXCLUDED]) {
        if explained >= self.bar {
            self.bar = (self.show)(explained, set());
        }
    }
}

/// Writes reduced rows into a buffer, which has capacity for all.
fn stand<'r, T: Real, const N: usize>(
    place: &mut ReducedRows<'r, T, N>,
    standings: impl Iterator<Item = ReducedRow<'r, T>>,
) {
    place.clear();
    standings.for_each(|standing| _ = place.push(standing));
}

/// Visits all pairs of rows; if the row `gone` was projected out, each forms a triple with it.
/// `explained` is the decrease of SSE without `gone`.
// Not inlined, so that pairs and triples share one copy.
#[inline(never)]
fn pairs<T: Real>(
    explained: T,
    rows: &[ReducedRow<'_, T>],
    work: &mut SetBudget,
    above: &mut SetFilter<'_, T>,
    gone: Option<usize>,
) {
    let set = |first: usize, second: usize| match gone {
        Some(gone) => [gone, first, second],
        None => [first, second, 0],
    };
    for (first, rest) in tails(rows) {
        if first.is_untestable() {
            continue;
        }
        let mut going = PairCandidate::new(explained, first);
        going.set_bar(above.bar);
        for second in work.granted(rest) {
            if let Some(explained) = going.explains_with(second) {
                above.consider(explained, || set(first.index(), second.index()));
                going.set_bar(above.bar);
            }
        }
    }
}

fn triples<'r, T: Real, const N: usize>(
    rows: &'r [NormalisedRow<T>],
    standings: &mut ReducedRows<'r, T, N>,
    work: &mut SetBudget,
    above: &mut SetFilter<'_, T>,
) {
    for (gone, rest) in tails(rows) {
        if !work.cut {
            let root = gone.redundancy.sqrt_approx();
            stand(standings, rest.iter().map(|row| ReducedRow::without(row, gone, root)));
            pairs(gone.explained(), standings, work, above, Some(gone.index));
        }
    }
}

/// Iterates over each element with those after it. Nested calls visit every combination once, in
/// lexicographic order.
fn tails<E>(elements: &[E]) -> impl Iterator<Item = (&E, &[E])> {
    (0..elements.len()).filter_map(|first| elements.get(first..)?.split_first())
}
