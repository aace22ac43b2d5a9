//! Refinement: solves with the satellites that agree, then leaves out and takes back rows by
//! testing again.
//!
//! A subset's position is uncertain by tens of metres. Small faults therefore pass, and a healthy
//! satellite with a large sigma may be blamed. The refinement solves with all satellites that
//! agree. As long as the global test fails, it leaves out the worst row. At the end it compares
//! each left-out row with the solution, and takes it back if it agrees.
//!
//! The number of solves and tests is bounded by the number of faults that the selection can
//! tolerate, at most [`MAX_EXCLUDED`].

use heapless::Vec;

use super::consensus::{deviation_squared, disagreement, most_faults};
use super::{Consensus, ConsensusLimits, Selection};
use crate::bit_set::{bit, first, members};
use crate::integrity::raim::detection::Detection;
use crate::least_squares::equations::Row;
use crate::least_squares::{Estimate, Worst};
use crate::numeric::real::Real;
use crate::report::MAX_EXCLUDED;

/// Result: the rows to leave out.
#[derive(Clone, Debug, PartialEq)]
pub struct Refinement {
    /// Rows that disagree with all others.
    pub rows: Vec<usize, MAX_EXCLUDED>,
    /// True if the rest passed the global test.
    pub passed: bool,
}

/// Refines a consensus.
pub fn refine<T: Real, const N: usize>(
    rows: &[Row<T>],
    selection: &Selection<N>,
    consensus: &Consensus,
    limits: &ConsensusLimits<'_>,
) -> Refinement {
    let mut left_out = consensus.rows.clone();
    let most = most_faults(selection).max(left_out.len());
    let mut solution = Estimate::none();
    let passed = exclude_until_passed(rows, &mut left_out, most, limits, &mut solution).is_some();
    if let Some(bound) = disagreement(rows, limits).filter(|_| passed) {
        left_out.retain(|&index| rows.get(index).is_none_or(|row| disagrees(row, &solution, bound)));
    }
    Refinement { rows: left_out, passed }
}

/// Leaves the worst rows out and solves for the rest.
///
/// Returns `None` if more than `most` rows would be left out, or if no redundancy is left. The
/// solution is then unspecified.
fn exclude_until_passed<T: Real>(
    rows: &[Row<T>],
    left_out: &mut Vec<usize, MAX_EXCLUDED>,
    most: usize,
    limits: &ConsensusLimits<'_>,
    solution: &mut Estimate<T>,
) -> Option<()> {
    loop {
        let gone = left_out.iter().fold(0, |set, &index| set | bit(index));
        let stay = first(rows.len()) & !gone;
        solution.solve_set(rows, stay).ok()?;
        let stay = members(stay).filter_map(|index| Some((index, rows.get(index)?)));
        let stay = stay.filter(|(_, row)| row.weight > T::zero());
        let fits = stay.map(|(index, row)| (index, row.weight, solution.fit(row)));
        let sse =
            fits.clone().fold(T::zero(), |sum, (_, weight, fit)| sum + weight * fit.residual * fit.residual);
        if Detection::of(sse, solution.dof(), &limits.refinement).is_some_and(|test| !test.fault()) {
            return Some(());
        }
        if left_out.len() >= most || solution.dof() < 2 {
            return None;
        }
        let mut worst = Worst::none();
        fits.for_each(|(index, _, fit)| worst.add(index, fit.w_squared()));
        left_out.push(worst.index?).ok()?;
    }
}

/// Returns true if a left-out row disagrees, or if the solution does not determine its clock.
fn disagrees<T: Real>(row: &Row<T>, solution: &Estimate<T>, bound: T) -> bool {
    let comparable = row.clock.is_none_or(|clock| solution.determines(clock));
    !comparable || !(deviation_squared(row, solution, T::zero()) < bound)
}
