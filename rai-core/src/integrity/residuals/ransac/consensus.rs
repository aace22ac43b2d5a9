//! Consensus: which subset do the other satellites agree with, and who disagrees?
//!
//! A subset's solution is a [`Snapshot`] with all other rows left out; their residuals are then those of a prediction.
//! A constellation that a subset lacks has no clock in it: its residuals are referred to their median, which up to
//! half of them may not move.
//!
//! Of several subsets that are inliers, the one with the fewest disagreements wins, then the one with the smallest sum
//! of `min(z_i², T_r²)`, then the first. Cost: one snapshot for each subset.

use heapless::Vec;

use super::{ConsensusLimits, Selection};
use crate::bounded::gather;
use crate::equations::{LinearEpoch, Row};
use crate::numeric::real::Real;
use crate::report::MAX_EXCLUDED;
use crate::satellite::Constellation;
use crate::snapshot::{Fit, Snapshot};

/// Largest position variance of a subset that still votes, in units of its mean variance of a range (`PDOP²`).
///
/// [Tian2024] leaves badly shaped subsets to the selection; beyond a PDOP of 1,000 nothing would ever disagree.
///
/// [Tian2024]: crate#references
const MAX_DILUTION: f64 = 1e6;

/// Why no subset is an inlier.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NoConsensus {
    /// Fewer than two subsets, or a selection for other rows.
    TooFewSubsets,
    /// Too many others disagree with each of them.
    NoInlier,
}

/// The inlier, and who disagrees with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Consensus {
    /// Its number in the selection.
    pub subset: usize,
    /// Rows with `z_i ≥ T_r`.
    pub rows: Vec<usize, MAX_EXCLUDED>,
}

/// Satellites that may disagree with an inlier.
pub(super) fn most_faults<const N: usize>(selection: &Selection<N>) -> usize {
    selection.subsets().saturating_sub(1).min(MAX_EXCLUDED)
}

/// `T_r²` for the rows that take part; `None` beyond the table.
pub(super) fn disagreement<T: Real, const N: usize>(
    epoch: &LinearEpoch<T, N>,
    limits: &ConsensusLimits<'_>,
) -> Option<T> {
    let used = epoch.rows().iter().filter(|row| row.weight > T::zero()).count();
    limits.consensus.w_test(used).map(|threshold| T::narrow(threshold * threshold))
}

/// Lets each subset judge the rows outside it.
///
/// # Errors
/// [`NoConsensus`] where no subset is an inlier.
pub fn consensus<T: Real, const N: usize>(
    epoch: &LinearEpoch<T, N>,
    selection: &Selection<N>,
    limits: &ConsensusLimits<'_>,
) -> Result<Consensus, NoConsensus> {
    let mut workspace = Snapshot::unsolved();
    workspace.epoch_mut().copy_from(epoch);
    consensus_in(&mut workspace, epoch, selection, limits)
}

/// The same in a workspace that holds the epoch's rows, and then the last subset's solution.
pub(super) fn consensus_in<T: Real, const N: usize>(
    workspace: &mut Snapshot<T, N>,
    epoch: &LinearEpoch<T, N>,
    selection: &Selection<N>,
    limits: &ConsensusLimits<'_>,
) -> Result<Consensus, NoConsensus> {
    if selection.subsets() < 2 || selection.rows() != epoch.rows().len() {
        return Err(NoConsensus::TooFewSubsets);
    }
    let bound = disagreement(epoch, limits).ok_or(NoConsensus::TooFewSubsets)?;
    let mut best: Option<(Vote<T>, usize)> = None;
    for subset in 0..selection.subsets() {
        let vote = vote(workspace, epoch, selection, subset, bound);
        let inlier = vote.filter(|vote| vote.against <= most_faults(selection));
        if let Some(vote) = inlier.filter(|vote| best.as_ref().is_none_or(|(best, _)| vote.beats(best))) {
            best = Some((vote, subset));
        }
    }
    best.map(|(vote, subset)| Consensus { subset, rows: vote.rows }).ok_or(NoConsensus::NoInlier)
}

/// How the rows outside a subset agree with it.
struct Vote<T> {
    against: usize,
    /// Those against, as far as they may be left out.
    rows: Vec<usize, MAX_EXCLUDED>,
    /// `Σ min(z², T_r²)`.
    misfit: T,
}

impl<T: Real> Vote<T> {
    fn beats(&self, other: &Self) -> bool {
        self.against < other.against || self.against == other.against && self.misfit < other.misfit
    }
}

/// `None` where a subset gives no position worth a vote.
fn vote<T: Real, const N: usize>(
    alone: &mut Snapshot<T, N>,
    epoch: &LinearEpoch<T, N>,
    selection: &Selection<N>,
    subset: usize,
    bound: T,
) -> Option<Vote<T>> {
    alone.epoch_mut().keep_only(|index| selection.contains(subset, index));
    alone.solve_again().ok()?;
    let solution = &*alone;
    if !is_worth_a_vote(solution) {
        return None;
    }
    let levels = Constellation::ALL.map(|clock| median_without_clock(epoch, solution, clock));
    let mut vote = Vote { against: 0, rows: Vec::new(), misfit: T::zero() };
    for (index, (row, (_, fit))) in epoch.rows().iter().zip(solution.rows()).enumerate() {
        if !(row.weight > T::zero()) || selection.contains(subset, index) {
            continue;
        }
        let level = row.clock.and_then(|clock| levels.get(clock as usize)).copied().flatten();
        let squared = deviation_squared(row, fit, solution, level.unwrap_or(T::zero()));
        // Written so that what is not a number disagrees.
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

/// False for a position that a subset determines too badly.
fn is_worth_a_vote<T: Real, const N: usize>(solution: &Snapshot<T, N>) -> bool {
    let members = solution.rows().filter(|(row, _)| row.weight > T::zero());
    let sum = members.fold(T::zero(), |sum, (row, _)| sum + row.sigma);
    let mean = sum / T::narrow(solution.used() as f64);
    solution.covariance().trace() <= mean * mean * T::narrow(MAX_DILUTION)
}

/// `z_i²` of a row that is left out of a solution, its residual first referred to a level.
pub(super) fn deviation_squared<T: Real, const N: usize>(
    row: &Row<T>,
    fit: &Fit<T>,
    solution: &Snapshot<T, N>,
    level: T,
) -> T {
    let residual = fit.residual - level;
    let variance = row.sigma * row.sigma + solution.level_variance(row) + fit.centred.dot(&fit.gain);
    residual * residual / variance
}

/// Median of the residuals of a constellation that takes part in the epoch, but not in the solution.
fn median_without_clock<T: Real, const N: usize>(
    epoch: &LinearEpoch<T, N>,
    solution: &Snapshot<T, N>,
    clock: Constellation,
) -> Option<T> {
    if solution.determines(clock) {
        return None;
    }
    let rows = epoch.rows().iter().zip(solution.rows());
    let of_clock = rows.filter(|(row, _)| row.clock == Some(clock) && row.weight > T::zero());
    let residuals: Vec<T, N> = gather(of_clock.map(|(_, (_, fit))| fit.residual));
    let last = residuals.len().checked_sub(1)?;
    Some((ranked(&residuals, last / 2)? + ranked(&residuals, last.div_ceil(2))?) / T::narrow(2.0))
}

/// The value with `rank` others before it, in ascending order, the first of equals first.
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
