//! ARAIM: solution separation over all monitored fault modes. Its protection levels account for the
//! whole risk.
//!
//! ```text
//! alarm          |x_k − x| > T_k = K σ_ss,k     on any axis, for any monitored mode k
//! K              Q⁻¹(P_FA_H / 4M), Q⁻¹(P_FA_V / 2M)
//! level          2 Q((L − b_0)/σ_0) + Σ p_k Q((L − T_k − b_k)/σ_k) = R
//! R              PHMI_V/PHMI (ρ (PHMI − P_nm) − p_new),  half of it with PHMI_H for each horizontal axis
//! ρ = 1/(options + 1)
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `x`, `x_k` | position from all satellites, and from those that mode `k` leaves | m |
//! | `σ_ss,k`, `σ_k` | standard deviations of `x_k − x`, and of `x_k` for integrity | m |
//! | `b_k`, `p_k` | nominal bias of `x_k`, and prior probability of mode `k`; `k = 0` is no fault | m, – |
//! | `PHMI`, `PHMI_H`, `PHMI_V` | permitted risk, and its shares ([`Allocation`]) | – |
//! | `p_new` | prior probability of modes that cannot be monitored after an exclusion | – |
//! | `options` | number of exclusions that may be tried | – |
//! | `M` | [`Finding::modes`] | – |
//! | `P_nm` | [`Finding::unmonitored_probability`] | – |
//! | `K` | [`Finding::factors`] | – |
//! | `L` | [`Finding::levels_m`], east, north, up | m |
//! | largest vertical `T_k` of the likely modes | [`Finding::effective_monitor_threshold_m`] | m |
//! | `σ_acc`, up | [`Finding::accuracy_m`] | m |
//!
//! There are three steps: [`modes`] chooses the monitored fault modes, [`subsets`] computes the
//! position without each mode, [`levels`] sums the risk.
//!
//! After an alarm, exclusions are tried one after another: satellites, then constellations, in
//! ascending order of the remaining SSE ([`exclusion`]). The first set that agrees is used, unless
//! another explains the data as well ([`AraimOutcome::Ambiguous`]). Every outcome, with or without
//! an exclusion, has its share of the risk, so that the risk includes a wrong exclusion. An epoch
//! must also pass the global test of [`super::raim::detection`], because only this test detects
//! unmonitored faults.
//!
//! Unlike the levels of [`super::raim`], these also cover several faults and the loss of a
//! constellation. They are only as good as the priors and sigmas on which they are based
//! ([`crate::weighting`]).
//!
//! Cost on a Cortex-M4F in `f32`: 350 to 1,100 instructions for each monitored mode, tests and
//! levels together, and fewer if there are many modes. A bound dismisses most modes, at 150
//! instructions each; the others are solved. Nothing is stored for each mode. With more than
//! [`ROWS`] rows or [`MAX_MODES`] modes the result is an [`AraimError`].
//!
//! References: [Blanch2015]. If the paper leaves a choice, that of [MAAST] is used.
//!
//! [Blanch2015]: crate#references
//! [MAAST]: crate#references

#[cfg(feature = "araim")]
mod epoch;
mod evaluation;
mod exclusion;
mod levels;
mod modes;
mod monitored;
mod subsets;
#[cfg(test)]
#[allow(clippy::indexing_slicing, clippy::expect_used, reason = "a test may panic")]
mod tests;

use core::fmt;

use nalgebra::Matrix3;

pub use crate::allocation::Allocation;
#[cfg(feature = "araim")]
pub(super) use epoch::judge_epoch;
pub use exclusion::{AraimJudgement, AraimOutcome, AraimScratch, judge, judge_in};
pub use modes::{Hypothesis, ROWS};

use crate::least_squares::equations::Row;
use crate::least_squares::{RowFit, Snapshot};
use crate::numeric::real::Real;
use crate::satellite::Constellation;

/// Maximum number of modes that are monitored at once.
pub const MAX_MODES: usize = 1024;

/// View of a solved epoch: the input of ARAIM.
#[derive(Clone, Copy, Debug)]
pub struct View<'v, T: Real> {
    /// The equations; weight 0 for a row that is left out.
    pub rows: &'v [Row<T>],
    /// The fit of each equation.
    pub fits: &'v [RowFit<T>],
    /// Covariance of the position, m².
    pub covariance: &'v Matrix3<T>,
    /// Weighted sum of squared residuals.
    pub sse: T,
}

impl<'v, T: Real> View<'v, T> {
    /// Returns the view of a snapshot.
    pub(crate) fn of<const N: usize>(snapshot: &'v Snapshot<'_, T, N>) -> Self {
        Self {
            rows: snapshot.equations(),
            fits: snapshot.fits(),
            covariance: snapshot.covariance(),
            sse: snapshot.sse(),
        }
    }
}

/// Integrity data of one satellite, in addition to the sigma of its row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior<T> {
    /// Standard deviation for accuracy and continuity, m.
    pub accuracy_m: T,
    /// Largest nominal bias, m.
    pub bias_m: T,
    /// Probability that it is faulty, in [0, 0.5).
    pub fault: T,
}

/// Priors of the satellites and of their constellations.
#[derive(Clone, Copy, Debug)]
pub struct Priors<'p, T> {
    /// Priors of the satellites, which are the first rows, in their order. Later rows are aiding
    /// rows, which never fail.
    pub satellites: &'p [Prior<T>],
    /// Probability that a constellation as a whole is faulty, in [0, 0.5).
    pub constellations: [T; Constellation::COUNT],
}

/// Reason why ARAIM has no result.
///
/// `repr(u32)`, so that a `Result` with it is copied word by word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AraimError {
    /// More rows than [`ROWS`].
    Rows,
    /// More modes to monitor than [`MAX_MODES`].
    Modes,
    /// A probability outside [0, 0.5), a sigma of a row outside 1 mm to 1000 km, or a bias or an
    /// accuracy outside 0 to 1000 km.
    Prior,
}

impl fmt::Display for AraimError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Rows => "rows must be at most 60",
            Self::Modes => "monitored modes must be at most 1024",
            Self::Prior => "probabilities must be at least 0 and below 0.5, sigmas within 1 mm to 1000 km, biases and accuracies within 0 to 1000 km",
        })
    }
}

impl core::error::Error for AraimError {}

/// Result of solution separation for one set of satellites, such as all in view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding<T> {
    /// Number of monitored modes.
    pub modes: usize,
    /// Probability of unmonitored faults, including modes that cannot be monitored after an
    /// exclusion.
    pub unmonitored_probability: T,
    /// Thresholds in units of the separation's sigma, east, north, up.
    pub factors: [T; 3],
    /// Protection levels, east, north, up, m; infinite if the unmonitored faults use up the risk.
    pub levels_m: [T; 3],
    /// Largest vertical threshold of a likely mode, m.
    pub effective_monitor_threshold_m: T,
    /// Standard deviation of the height for accuracy, m.
    pub accuracy_m: T,
    /// Largest ratio of a separation to its threshold, dimensionless.
    pub ratio: T,
    /// The mode with the largest share in each level.
    pub dominant: [Hypothesis; 3],
    /// True if any separation exceeds its threshold.
    pub alarm: bool,
}

impl<T: Real> Finding<T> {
    /// Returns the horizontal protection level, m.
    pub fn hpl_m(&self) -> T {
        let [east, north, _] = self.levels_m;
        (east * east + north * north).sqrt_approx()
    }

    /// Returns the vertical protection level, m.
    pub fn vpl_m(&self) -> T {
        let [.., up] = self.levels_m;
        up
    }
}
