//! Refinement: solve with the satellites that nobody doubts, then test again, both ways.
//!
//! A subset's position is uncertain by tens of metres, so that small faults pass and a badly seen healthy satellite
//! may be named. With all others in the solution: while the global test fails, the worst row goes too; at the end
//! each row that was left out is held against the solution, and taken back where it agrees.
//!
//! Bounded by the number of faults that the selection can carry: at most [`MAX_EXCLUDED`] solves and as many tests.

use heapless::Vec;

use super::consensus::{deviation_squared, disagreement, most_faults};
use super::{Consensus, ConsensusLimits, Selection};
use crate::equations::LinearEpoch;
use crate::integrity::residuals::baarda::worst_two;
use crate::integrity::residuals::detection::Detection;
use crate::numeric::real::Real;
use crate::report::MAX_EXCLUDED;
use crate::snapshot::Snapshot;

/// The rows to leave out.
#[derive(Clone, Debug, PartialEq)]
pub struct Refinement {
    /// Those that disagree with all others.
    pub rows: Vec<usize, MAX_EXCLUDED>,
    /// True when the rest passed the global test.
    pub passed: bool,
}

/// Settles what a consensus left open.
pub fn refine<T: Real, const N: usize>(
    snapshot: &Snapshot<T, N>,
    selection: &Selection<N>,
    consensus: &Consensus,
    limits: &ConsensusLimits<'_>,
) -> Refinement {
    refine_in(&mut snapshot.clone(), snapshot.epoch(), selection, consensus, limits)
}

/// The same in a workspace that holds the epoch's rows, whichever of them took part there.
pub(super) fn refine_in<T: Real, const N: usize>(
    workspace: &mut Snapshot<T, N>,
    epoch: &LinearEpoch<T, N>,
    selection: &Selection<N>,
    consensus: &Consensus,
    limits: &ConsensusLimits<'_>,
) -> Refinement {
    let mut rows = consensus.rows.clone();
    workspace.epoch_mut().keep_only(|index| {
        let takes_part = epoch.rows().get(index).is_some_and(|row| row.weight > T::zero());
        takes_part && !consensus.rows.contains(&index)
    });
    let left_out = workspace.solve_again().is_ok();
    let most = most_faults(selection).max(rows.len());
    let passed = left_out && exclude_until_passed(workspace, &mut rows, most, limits);
    if let Some(bound) = disagreement(epoch, limits).filter(|_| passed) {
        rows.retain(|&index| disagrees(workspace, index, bound));
    }
    Refinement { rows, passed }
}

/// Leaves the worst rows out; false where there are more of them than `most`, or none is left to test with.
fn exclude_until_passed<T: Real, const N: usize>(
    solution: &mut Snapshot<T, N>,
    rows: &mut Vec<usize, MAX_EXCLUDED>,
    most: usize,
    limits: &ConsensusLimits<'_>,
) -> bool {
    loop {
        if Detection::passes(solution, &limits.refinement) {
            return true;
        }
        if rows.len() >= most || solution.dof() < 2 {
            return false;
        }
        let Some((index, _, _)) = worst_two(solution) else { return false };
        if solution.leave_out(index).is_err() || rows.push(index).is_err() {
            return false;
        }
    }
}

/// True where a row that was left out does not fit, or has no clock left to be compared with.
fn disagrees<T: Real, const N: usize>(solution: &Snapshot<T, N>, index: usize, bound: T) -> bool {
    solution.row(index).is_none_or(|(row, fit)| {
        let comparable = row.clock.is_none_or(|clock| solution.determines(clock));
        !comparable || !(deviation_squared(row, fit, solution, T::zero()) < bound)
    })
}
