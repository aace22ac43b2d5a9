//! Range consensus: small, well-shaped subsets of the satellites test the others ([Tian2024],
//! improved method).
//!
//! The satellites are dealt into `M = ⌊n/(3 + C)⌋` disjoint subsets of good geometry
//! ([`Selection`]). Each subset gives a position, and each other satellite is compared with it. A
//! fault spoils one subset; the others agree which satellite is faulty ([`consensus`]). A
//! least-squares solution without these satellites then finds the small faults ([`refine`]).
//!
//! ```text
//! x_k from subset k      v_i = y_i − h_i x_k      s_i² = σ_i² + h_i Cov_k h_iᵀ      z_i = |v_i| / s_i
//! subset k is an inlier when at most k_max = min(3, M − 1) of the others have z_i ≥ T_r
//! T_r = Q⁻¹(p_r / 2n), p_r = 1e-3
//! ```
//!
//! | symbol | where | unit |
//! |---|---|---|
//! | `M` | [`Selection::subsets`] | – |
//! | `T_r` | [`ConsensusLimits::consensus`] | – |
//! | `σ_i`, `v_i`, `s_i` | of one range | m |
//!
//! If there are fewer than two subsets, or none that the others agree with, sequential exclusion is
//! used ([`baarda`](super::baarda)). Three faults need four subsets: 16 satellites of one
//! constellation, 20 of two. At most three faults are treated.
//!
//! Departures from [Tian2024], which compares a root mean square with a χ² threshold: as soon as
//! one satellite is faulty, every subset without it fails that test, so that subsets are ranked by
//! the number of disagreeing satellites. `M` is `⌊n/(3 + C)⌋`, as in its text, not `⌊n/(4 + C)⌋`,
//! as in its flow chart. The refinement is an addition: without it a fault of 150 m on a low
//! satellite stays below `T_r s_i`.
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
    /// Thresholds whose w-test part applies to `z_i`.
    pub consensus: Thresholds<'t>,
    /// Thresholds whose global test ends the refinement.
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

/// Isolates by consensus and leaves out the rows found; without consensus falls back to sequential
/// exclusion.
///
/// `selection` must have been made for the same satellites in the same order; one of another length
/// counts as none. `solution` ends as the solution without the listed rows, solved and tested
/// again.
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

/// Works like [`exclude`], with the subsets that are kept while the satellites stay the same.
#[inline(never)]
pub fn exclude_in<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    epoch: &EpochView<'_>,
    thresholds: &Thresholds<'_>,
    subsets: &mut Subsets<N>,
) -> Exclusion<T> {
    // The tables hold both probabilities; without them it falls back as without consensus.
    let Ok(published) = ConsensusLimits::up_to::<N>() else {
        return exclude_sequentially(solution, thresholds);
    };
    // The remaining rows must pass the test in force, not the paper's.
    let limits = ConsensusLimits { refinement: *thresholds, ..published };
    let selection = subsets.of(epoch, solution.snapshot().equations());
    exclude(solution, selection, thresholds, &limits)
}
