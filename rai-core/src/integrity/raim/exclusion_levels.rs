//! Exclusion levels: from which effect on the position is the fault of a satellite found *and* the
//! satellite excluded?
//!
//! A protection level bounds an undetected fault. If several satellites may be the cause of a
//! detected fault, no position is promised. Let the range to satellite `i` be off by `n` sigmas.
//! Each other explanation of the residuals fails its own test with probability `1 − P_md` if the
//! fault leaves it the non-centrality of a missed fault:
//!
//! ```text
//! no fault at all                n² S_ii                    ≥ λ(ν)
//! a fault of satellite j         n² (S_ii − S_ij²/S_jj)     ≥ λ(ν − 1)
//! a shift of a constellation     n² S'_ii                   ≥ λ(ν')
//!
//! HEL = max over i of  max( n_i |A_i|, HPL without i )      n_i: the least that satisfies all
//! ```
//!
//! | symbol | where | unit |
//! |---|---|---|
//! | `S_ij` | [`NormalisedRow::projection`](crate::least_squares::downdate::NormalisedRow::projection) | – |
//! | `S'_ii` | redundancy of the row within its part ([`constellation_shift`]) | – |
//! | `ν`, `ν'` | degrees of freedom of all rows, and with a second position | – |
//! | `λ` | [`Thresholds::lambda`] | – |
//! | `A_i` | motion of the position per sigma of the row, horizontal or vertical | m |
//! | `HEL`, `VEL` | result of [`exclusion_levels`] | m |
//!
//! The level depends on geometry and sigmas, not on the ranges. It can therefore be predicted. A
//! fault that moves the position by the level or more is excluded but for `P_md` of a rival. Rivals
//! that are equally near add up: then the probability is theirs together.
//!
//! **Limits.** The level holds for one faulty satellite, for the search of single rows
//! ([`super::isolation::baarda`]), and for the global test at `τ1`. Aiding rows count as
//! satellites. Of two satellites with a clock of their own neither can be told from the other, so
//! that there is no level.
//!
//! The horizontal exclusion level of [DO-229] is defined by the same two probabilities, of a missed
//! alert and of a failed exclusion.
//!
//! [DO-229]: crate#references

use crate::integrity::raim::detection::threshold::Thresholds;
use crate::integrity::raim::hypotheses::constellation_shift;
use crate::integrity::raim::levels::{KFactors, LevelInputs, Levels, slopes};
use crate::least_squares::downdate::{NormalisedRow, NormalisedRows, testable_rows};
use crate::least_squares::{Snapshot, larger};
use crate::numeric::real::Real;
use crate::report::ProtectionLevels;

/// Returns the horizontal and the vertical exclusion level, m, or `None` if there is a satellite
/// that cannot be excluded in this geometry.
///
/// Every row is left out once and taken back.
pub fn exclusion_levels<T: Real, const N: usize>(
    snapshot: &mut Snapshot<'_, T, N>,
    thresholds: &Thresholds<'_>,
    levels: Levels,
    factors: &KFactors<T>,
) -> Option<ProtectionLevels> {
    let mut most = told_apart(snapshot, thresholds)?;
    for index in 0..snapshot.equations().len() {
        if snapshot.row(index).is_some_and(|(row, _)| row.weight > T::zero()) {
            let without = levels_without(snapshot, index, thresholds, levels, factors)?;
            most = most.or_larger(&without);
        }
    }
    (most.hpl_m.is_finite() && most.vpl_m.is_finite()).then_some(most)
}

/// Returns the protection levels without a row.
fn levels_without<T: Real, const N: usize>(
    snapshot: &mut Snapshot<'_, T, N>,
    index: usize,
    thresholds: &Thresholds<'_>,
    levels: Levels,
    factors: &KFactors<T>,
) -> Option<ProtectionLevels> {
    snapshot.leave_out(index).ok()?;
    let lambda = thresholds.lambda(snapshot.dof());
    let without = lambda.map(|lambda| LevelInputs::of(snapshot, levels, factors).protect(lambda));
    // This succeeds, because these rows were solved before.
    snapshot.take_back(index).ok()?;
    without
}

/// Returns the largest motions of the position, horizontal and vertical, by a fault that is just
/// told apart from every rival.
#[inline(never)]
fn told_apart<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    thresholds: &Thresholds<'_>,
) -> Option<ProtectionLevels> {
    let dof = snapshot.dof();
    let dof_without = dof.checked_sub(1)?;
    let mut rows = NormalisedRows::<T, N>::new();
    testable_rows(snapshot, &mut rows);
    let (mut horizontal, mut vertical) = (T::zero(), T::zero());
    for (index, (row, fit)) in snapshot.rows().enumerate() {
        let Some(tested) = rows.iter().find(|tested| tested.index == index) else {
            // A row that moves nothing needs no exclusion.
            let slopes = slopes(row, fit);
            horizontal = larger(horizontal, slopes.horizontal);
            vertical = larger(vertical, slopes.vertical);
            continue;
        };
        let others = rows.iter().filter(|other| other.index != index);
        let hidden = others.fold(thresholds.hidden(dof, tested.redundancy), |hidden, other| {
            larger(hidden, thresholds.hidden(dof_without, shown_without(tested, other)))
        });
        let squared = larger(hidden, constellation_shift::hides(snapshot, index, thresholds)) * row.weight;
        let (gain_h, gain_v) = fit.squared_gains();
        // If a row moves nothing, any bias may be hidden: the product is NaN then, and not larger.
        horizontal = larger(horizontal, (squared * gain_h).sqrt_approx());
        vertical = larger(vertical, (squared * gain_v).sqrt_approx());
    }
    Some(ProtectionLevels { hpl_m: horizontal.widen(), vpl_m: vertical.widen() })
}

/// Returns the share of a row's squared bias that shows without another row.
fn shown_without<T: Real>(row: &NormalisedRow<T>, rival: &NormalisedRow<T>) -> T {
    let shared = row.projection(rival);
    row.redundancy - shared * shared / rival.redundancy
}
