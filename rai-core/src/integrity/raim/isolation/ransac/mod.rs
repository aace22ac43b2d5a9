//! Range consensus: small, well-shaped subsets of the satellites test the others ([Tian2024],
//! improved method).
//!
//! The satellites are dealt into `M = ⌊n/(3 + C)⌋` disjoint subsets of good geometry
//! ([`Selection`]). Each subset determines a position, with which every other satellite is
//! compared. A fault spoils one subset only, and the others show which satellite is faulty
//! ([`consensus`](fn@consensus)). A least-squares solution without the faulty satellites then finds small faults
//! ([`refine`]).
//!
//! ```text
//! x_k from subset k      v_i = y_i − h_i x_k      s_i² = σ_i² + h_i Cov_k h_iᵀ      z_i = |v_i| / s_i
//! subset k is an inlier if at most k_max = min(3, M − 1) of the others have z_i ≥ T_r
//! T_r = Q⁻¹(p_r / 2n), p_r = 1e-3
//! ```
//!
//! | symbol | where | unit |
//! |---|---|---|
//! | `M` | [`Selection::subsets`] | – |
//! | `T_r` | [`ConsensusLimits::consensus`] | – |
//! | `σ_i`, `v_i`, `s_i` | of one range | m |
//!
//! If there are fewer than two subsets, or none is an inlier, sequential exclusion is used
//! ([`baarda`](super::baarda)). Three faults, the largest number, need four subsets: 16 satellites
//! of one constellation, or 20 of two.
//!
//! Departures from [Tian2024]:
//!
//! - The paper compares a root mean square with a χ² threshold. But as soon as one satellite is
//!   faulty, every subset without it fails that test. Here subsets are ranked by the number of
//!   disagreeing satellites.
//! - `M` is `⌊n/(3 + C)⌋`, as in the paper's text, not `⌊n/(4 + C)⌋`, as in its flow chart.
//! - The refinement is an addition. Without it a fault of 150 m on a low satellite stays below
//!   `T_r s_i`.
//!
//! References: [Tian2024] §2, [Schroth2008] for consensus by counting.
//!
//! [Tian2024]: crate#references
//! [Schroth2008]: crate#references

mod consensus;
mod refinement;
mod selection;
mod subsets;
mod tetrahedra;

pub use consensus::{Consensus, NoConsensus, consensus};
pub use refinement::{Refinement, refine};
pub use selection::{MAX_SUBSETS, MAX_WORK, Selection};
pub use subsets::Subsets;

use crate::bounded::MAX_ROWS;
use crate::epoch::EpochView;
use crate::integrity::raim::detection::detect;
use crate::integrity::raim::detection::threshold::{ThresholdError, Thresholds};
use crate::integrity::raim::isolation::baarda::exclude_sequentially;
use crate::integrity::raim::isolation::exclusion::{Exclusion, ExclusionOutcome, Unidentified, leave_out};
use crate::least_squares::Excludable;
use crate::numeric::probability::Probability;
use crate::numeric::real::Real;

/// Thresholds of disagreement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConsensusLimits<'t> {
    /// Thresholds; their `w_test` applies to `z_i`.
    pub consensus: Thresholds<'t>,
    /// Thresholds; their `tau1` ends the refinement.
    pub refinement: Thresholds<'t>,
}

impl ConsensusLimits<'static> {
    /// Returns the published limits: one false disagreement in a thousand epochs, one false alarm
    /// of the refinement in ten thousand.
    ///
    /// # Errors
    /// [`ThresholdError`] if the tables lack one of the two probabilities.
    pub fn published() -> Result<Self, ThresholdError> {
        Self::up_to::<MAX_ROWS>()
    }

    /// Works like [`Self::published`], for at most `N` rows.
    fn up_to<const N: usize>() -> Result<Self, ThresholdError> {
        // The probability of missed detection is not used here.
        Ok(Self {
            consensus: Thresholds::up_to::<N>(DISAGREEMENT, DISAGREEMENT)?,
            refinement: Thresholds::up_to::<N>(ALARM, DISAGREEMENT)?,
        })
    }
}

/// `p_r`, the probability that a healthy satellite disagrees with a subset.
const DISAGREEMENT: Probability = certain(1e-3);

/// Probability that the refinement excludes one satellite too many.
const ALARM: Probability = certain(1e-4);

/// Returns a probability that is checked at compile time.
const fn certain(tail: f64) -> Probability {
    match Probability::new(tail) {
        Some(tail) => tail,
        None => unreachable!(),
    }
}

/// Isolates by consensus and leaves out the rows found. Without a consensus it excludes
/// sequentially.
///
/// `selection` must have been made for the same satellites in the same order. A longer one is not
/// used. Afterwards, `solution` is solved and tested without the listed rows.
#[inline(never)]
pub fn exclude<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    selection: &Selection<N>,
    thresholds: &Thresholds<'_>,
    limits: &ConsensusLimits<'_>,
) -> Exclusion<T> {
    let snapshot = solution.snapshot();
    let detection = detect(snapshot, thresholds);
    if !detection.is_some_and(|detection| detection.fault()) {
        return exclude_sequentially(solution, thresholds);
    }
    let rows = snapshot.equations();
    let Ok(consensus) = consensus(rows, selection, limits) else {
        return exclude_sequentially(solution, thresholds);
    };
    let refinement = refine(rows, selection, &consensus, limits);
    let exclusion = leave_out(solution, &refinement.rows, thresholds);
    if refinement.passed || exclusion.outcome != ExclusionOutcome::Isolated {
        return exclusion;
    }
    Exclusion { outcome: ExclusionOutcome::NotIsolated(Unidentified::NoSet), ..exclusion }
}

/// Works like [`exclude`], with subsets that are stored as long as the satellites stay the same.
#[inline(never)]
pub fn exclude_in<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    epoch: &EpochView<'_>,
    thresholds: &Thresholds<'_>,
    subsets: &mut Subsets<N>,
) -> Exclusion<T> {
    // In a build without the two probabilities, exclusion is sequential, as without a consensus.
    let Ok(published) = ConsensusLimits::up_to::<N>() else {
        return exclude_sequentially(solution, thresholds);
    };
    // The remaining rows must pass the caller's test, not the paper's.
    let limits = ConsensusLimits { refinement: *thresholds, ..published };
    let selection = subsets.of(epoch, solution.snapshot().equations());
    exclude(solution, selection, thresholds, &limits)
}
