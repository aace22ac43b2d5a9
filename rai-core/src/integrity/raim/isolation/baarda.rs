//! Baarda's w-test and sequential exclusion.
//!
//! ```text
//! w_i = v_i √(w_i / r_i)         N(0, 1) without fault, mean √r_i b_i/σ_i under a bias b_i
//! T_d = Q⁻¹(P_fa / 2n)           two-sided over n rows
//! SSE without i = SSE − w_i²     so that the row with the largest |w| explains the data best
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `w_i` | [`RowFit::w_test`](crate::least_squares::RowFit::w_test) | – |
//! | `r_i` | [`RowFit::redundancy`](crate::least_squares::RowFit::redundancy) | – |
//! | `b_i = v_i / r_i` | [`Suspect::bias_m`](crate::report::Suspect::bias_m) with standard deviation `σ_i/√r_i` | m |
//!
//! After a detected fault with `dof ≥ 2`, the row with the largest |w| is identified, if this is
//! above `T_d` and unique. The row is left out and the rest tested again, until the test passes or
//! no row can be identified.
//!
//! Departures from the papers: [Lin2016] prints `d_i > T_d` without the absolute value; [Chen2009]
//! eq. 13 prints `ω_i/S_ii`, but the statistic is `ω_i²/S_ii`. References: [Baarda1968], [Lin2016]
//! eq. 14–20.
//!
//! [Lin2016]: crate#references
//! [Chen2009]: crate#references
//! [Baarda1968]: crate#references

use heapless::Vec;

use super::exclusion::{Excluded, Exclusion, ExclusionOutcome, Unidentified};
use crate::integrity::raim::detection::Detection;
use crate::integrity::raim::detection::threshold::Thresholds;
use crate::least_squares::{Excludable, Snapshot, Worst};
use crate::numeric::real::Real;

/// Returns the row with the largest |w| with its w², and the w² of the runner-up. The first of
/// equal rows wins.
pub fn worst_two<T: Real, const N: usize>(snapshot: &Snapshot<'_, T, N>) -> Option<(usize, T, T)> {
    let Worst { index, largest, runner_up } = snapshot.statistics().worst;
    let first = || snapshot.equations().iter().position(|row| row.weight > T::zero());
    Some((index.or_else(first)?, largest, runner_up))
}

/// Returns the faulty row of a snapshot in which a fault was detected.
///
/// # Errors
/// [`Unidentified`] names the reason why no row is identified.
pub fn identify<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    thresholds: &Thresholds<'_>,
) -> Result<usize, Unidentified> {
    if snapshot.dof() < 2 {
        return Err(Unidentified::NoRedundancy);
    }
    let (Some((index, largest, runner_up)), Some(threshold)) =
        (worst_two(snapshot), thresholds.w_test::<T>(snapshot.used()))
    else {
        return Err(Unidentified::BelowThreshold);
    };
    // NaN fails this comparison, so that no row is identified.
    if !(largest > threshold * threshold) {
        return Err(Unidentified::BelowThreshold);
    }
    let unique = T::one() - T::TIE;
    if runner_up < largest * unique * unique { Ok(index) } else { Err(Unidentified::Ambiguous) }
}

/// Leaves out the worst row repeatedly until the rest passes the global test, at most
/// [`MAX_EXCLUDED`](crate::report::MAX_EXCLUDED) rows.
///
/// Afterwards, `solution` is solved without the listed rows. A snapshot without redundancy cannot
/// pass, so that the result is [`ExclusionOutcome::NotIsolated`].
pub fn exclude_sequentially<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    thresholds: &Thresholds<'_>,
) -> Exclusion<T> {
    let mut rows = Vec::new();
    loop {
        if Detection::passes(solution.snapshot(), thresholds) {
            let outcome = if rows.is_empty() { ExclusionOutcome::Passed } else { ExclusionOutcome::Isolated };
            return Exclusion { rows, outcome };
        }
        let reason = match identify(solution.snapshot(), thresholds) {
            Ok(index) if !rows.is_full() => {
                let w_test = solution.snapshot().row(index).map_or(T::zero(), |(_, fit)| fit.w_test());
                if solution.leave_out(index).is_ok() && rows.push(Excluded { index, w_test }).is_ok() {
                    continue;
                }
                Unidentified::NoSet
            }
            Ok(_) => Unidentified::NoSet,
            Err(reason) => reason,
        };
        return Exclusion { rows, outcome: ExclusionOutcome::NotIsolated(reason) };
    }
}
