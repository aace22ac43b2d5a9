//! Consensus: the subset with which the other satellites agree, and the satellites that disagree.
//!
//! A subset is solved alone, and predicts the ranges of all other rows. If it lacks a
//! constellation, it does not determine that clock. The median of that constellation's residuals
//! then replaces the clock; faults of fewer than half of them move it little.
//!
//! Among several inlier subsets the one with the fewest disagreements is chosen, then the one with
//! the smallest sum of `min(z_i², T_r²)`, then the first. Cost: one solve for each subset.

use core::fmt;

use heapless::Vec;

use super::{ConsensusLimits, Selection};
use crate::bit_set::members;
use crate::bounded::gather;
use crate::least_squares::Estimate;
use crate::least_squares::equations::Row;
use crate::numeric::real::Real;
use crate::report::MAX_EXCLUDED;
use crate::satellite::Constellation;

/// Largest position variance with which a subset is used, in units of its mean range variance
/// (`PDOP²`).
///
/// [Tian2024] relies on the selection to avoid badly shaped subsets. But above a PDOP of 1,000 no
/// satellite would ever disagree.
///
/// [Tian2024]: crate#references
const MAX_DILUTION: f64 = 1e6;

/// Reason why no subset is an inlier.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NoConsensus {
    /// Fewer than two subsets, or a selection for other rows.
    TooFewSubsets,
    /// Too many other satellites disagree with each subset.
    NoInlier,
}

impl fmt::Display for NoConsensus {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::TooFewSubsets => "consensus needs at least two subsets of the same rows",
            Self::NoInlier => "too many satellites disagree with every subset",
        })
    }
}

impl core::error::Error for NoConsensus {}

/// The inlier subset, and the rows that disagree with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Consensus {
    /// Number of the subset in the selection.
    pub subset: usize,
    /// Rows with `z_i ≥ T_r`.
    pub rows: Vec<usize, MAX_EXCLUDED>,
}

/// Returns the number of satellites that may disagree with an inlier.
pub(super) fn most_faults<const N: usize>(selection: &Selection<N>) -> usize {
    selection.subsets().saturating_sub(1).min(MAX_EXCLUDED)
}

/// Returns `T_r²` for the rows that take part, or `None` beyond the table.
pub(super) fn disagreement<T: Real>(rows: &[Row<T>], limits: &ConsensusLimits<'_>) -> Option<T> {
    let used = rows.iter().filter(|row| row.weight > T::zero()).count();
    limits.consensus.w_test(used).map(|threshold: T| threshold * threshold)
}

/// Tests the rows outside each subset with its solution.
///
/// # Errors
/// [`NoConsensus`] if no subset is an inlier.
pub fn consensus<T: Real, const N: usize>(
    rows: &[Row<T>],
    selection: &Selection<N>,
    limits: &ConsensusLimits<'_>,
) -> Result<Consensus, NoConsensus> {
    if selection.subsets() < 2 || selection.rows() > rows.len() {
        return Err(NoConsensus::TooFewSubsets);
    }
    let bound = disagreement(rows, limits).ok_or(NoConsensus::TooFewSubsets)?;
    let mut best: Option<(Vote<T>, usize)> = None;
    for subset in 0..selection.subsets() {
        let vote = vote(rows, selection, subset, bound);
        let inlier = vote.filter(|vote| vote.against <= most_faults(selection));
        if let Some(vote) = inlier.filter(|vote| best.as_ref().is_none_or(|(best, _)| vote.beats(best))) {
            best = Some((vote, subset));
        }
    }
    best.map(|(vote, subset)| Consensus { subset, rows: vote.rows }).ok_or(NoConsensus::NoInlier)
}

/// Agreement of the rows outside a subset with its position.
struct Vote<T> {
    against: usize,
    /// Rows that disagree, up to the number that may be left out.
    rows: Vec<usize, MAX_EXCLUDED>,
    /// `Σ min(z², T_r²)`.
    misfit: T,
}

impl<T: Real> Vote<T> {
    fn beats(&self, other: &Self) -> bool {
        self.against < other.against || self.against == other.against && self.misfit < other.misfit
    }
}

/// Returns the vote on a subset, or `None` if it determines no usable position.
fn vote<T: Real, const N: usize>(
    rows: &[Row<T>],
    selection: &Selection<N>,
    subset: usize,
    bound: T,
) -> Option<Vote<T>> {
    let set = selection.set(subset);
    let mut solution = Estimate::none();
    solution.solve_set(rows, set).ok()?;
    let solved = members(set).filter_map(|index| rows.get(index));
    if !is_worth_a_vote(solved, &solution) {
        return None;
    }
    let levels = Constellation::ALL.map(|clock| median_without_clock::<T, N>(rows, &solution, clock));
    let mut vote = Vote { against: 0, rows: Vec::new(), misfit: T::zero() };
    for (index, row) in rows.iter().enumerate() {
        if !(row.weight > T::zero()) || selection.contains(subset, index) {
            continue;
        }
        let level = row.clock.and_then(|clock| levels.get(clock as usize)).copied().flatten();
        let squared = deviation_squared(row, &solution, level.unwrap_or(T::zero()));
        // NaN fails this comparison, so that the row disagrees.
        if squared < bound {
            vote.misfit += squared;
        } else {
            vote.misfit += bound;
            vote.against += 1;
            let _ = vote.rows.push(index);
        }
    }
    Some(vote)
}

/// Returns false if the geometry of a subset is too bad for a vote.
fn is_worth_a_vote<'r, T: Real>(members: impl Iterator<Item = &'r Row<T>>, solution: &Estimate<T>) -> bool {
    let members = members.filter(|row| row.weight > T::zero());
    let sum = members.fold(T::zero(), |sum, row| sum + row.sigma);
    let mean = sum / T::narrow(solution.used() as f64);
    solution.covariance().trace() <= mean * mean * T::narrow(MAX_DILUTION)
}

/// Returns `z_i²` of a row that is left out of a solution, after subtracting `level` from its
/// residual.
#[inline(never)]
pub(super) fn deviation_squared<T: Real>(row: &Row<T>, solution: &Estimate<T>, level: T) -> T {
    let fit = solution.fit(row);
    let residual = fit.residual - level;
    let variance = row.sigma * row.sigma + solution.level_variance(row) + fit.centred.dot(&fit.gain);
    residual * residual / variance
}

/// Returns the median of the residuals of a constellation that the epoch contains, but not the
/// solution.
#[inline(never)]
fn median_without_clock<T: Real, const N: usize>(
    rows: &[Row<T>],
    solution: &Estimate<T>,
    clock: Constellation,
) -> Option<T> {
    if solution.determines(clock) {
        return None;
    }
    let of_clock = rows.iter().filter(|row| row.clock == Some(clock) && row.weight > T::zero());
    let residuals: Vec<T, N> = gather(of_clock.map(|row| solution.fit(row).residual));
    let last = residuals.len().checked_sub(1)?;
    Some((ranked(&residuals, last / 2)? + ranked(&residuals, last.div_ceil(2))?) / T::narrow(2.0))
}

/// Returns the value at `rank` (from 0) in ascending order.
fn ranked<T: Real>(values: &[T], rank: usize) -> Option<T> {
    let before = |index: usize, value: T| {
        let earlier = values.iter().enumerate();
        earlier.filter(|&(other, &rival)| rival < value || rival == value && other < index).count()
    };
    values
        .iter()
        .copied()
        .enumerate()
        .find(|&(index, value)| before(index, value) == rank)
        .map(|(_, value)| value)
}
