//! Integrity: is something wrong, which satellite is faulty, and how large can the undetected error
//! be?
//!
//! ```text
//! fix ─► test ─► (search, leave out, test again) ─► is it the only explanation? ─► judgement
//! ```
//!
//! Within this module, only [`judge`] and its search distinguish one [`Method`] from another.
//! Outside, the method also decides on aiding rows and sigmas. The result is a [`Judgement`], from
//! which the monitor derives the verdict ([`crate::monitor`]).
//!
//! **A clock forecast or a known height as one more row** adds redundancy, so that four satellites
//! can be tested. But a forecast comes from earlier epochs of the same receiver, and a known height
//! may be wrong in every epoch. If the satellites can be tested without these rows, the tests with
//! and without them must both pass. The larger protection levels are then reported.
//!
//! Such a row is treated like a satellite's. It adds a degree of freedom, every search may leave it
//! out, and its slope enters the levels. The row of a height has `h = (0, 0, 1)` and `w = 1/σ_h²`.
//! With the covariance `P` of the position, height included, its redundancy is `r = 1 − w P_UU` and
//! its gain `g = P h`. Its slopes are `√(w/r) √(P_EU² + P_NU²)` and `√(w/r) P_UU`. The levels
//! therefore bound the effect of a height error of any size that the test misses. They do not bound
//! an error of the height and of a satellite at once. Before any method searches, the row alone is
//! left out if the test then passes and no exclusion of a satellite fits nearly as well.

pub mod araim;
mod by_residuals;
mod judgement;
mod method;
pub mod raim;
mod search;
mod systems;

use crate::bounded::MAX_ROWS;
use crate::epoch::EpochView;
use crate::least_squares::{Excludable, Snapshot};
use crate::numeric::real::Real;
use crate::report::ProtectionLevels;
use crate::requirements::Requirements;
use crate::weighting::Ism;
use crate::weighting::shared::SharedError;
#[cfg(feature = "araim")]
use araim::judge_epoch;
use by_residuals::judge_by_residuals;
use raim::detection::Detection;
use raim::detection::threshold::Thresholds;
use raim::detection::threshold::policy::{NoThreshold, Policy, ThresholdProblem};
use raim::hypotheses::time_tag::RangeRates;
use raim::isolation::ransac;
use raim::levels::{KFactors, LevelInputs, Levels};
use raim::shared_errors::shared_shift;

pub use judgement::{Judgement, Test, WithoutAiding};
pub use method::{Method, MethodError};
pub use search::{AUTOMATIC_SETS, Search};
pub(crate) use systems::KeptOut;

/// Criteria of a judgement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Criteria<'c, T> {
    /// Limits and probabilities.
    pub requirements: &'c Requirements,
    /// Thresholds for these probabilities.
    pub thresholds: Thresholds<'static>,
    /// Factors of the protection levels for these probabilities.
    pub factors: &'c KFactors<T>,
    /// Threshold policy of the global test.
    pub policy: Policy,
    /// Method that finds the faulty satellites.
    pub method: Method,
    /// Quantity that a protection level bounds.
    pub levels: Levels,
    /// Integrity support message, for [`Method::Araim`].
    pub ism: &'c Ism,
    /// Factor on the effect of shared errors, at least 1.
    pub shared_growth: f32,
}

/// Scratch memory of the methods, and the subsets that [`Method::Ransac`] keeps from epoch to
/// epoch.
#[derive(Clone, Debug)]
pub struct MethodScratch<T: Real, const N: usize = MAX_ROWS> {
    /// Subsets of [`Method::Ransac`].
    pub subsets: ransac::Subsets<N>,
    /// Initialised at the first use, in place, because the value is large for the stack.
    #[cfg(feature = "araim")]
    araim: Option<araim::AraimScratch<T, N>>,
    #[cfg(not(feature = "araim"))]
    scalar: core::marker::PhantomData<T>,
}

impl<T: Real, const N: usize> Default for MethodScratch<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real, const N: usize> MethodScratch<T, N> {
    /// Returns empty scratch memory.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub fn new() -> Self {
        Self {
            subsets: ransac::Subsets::new(),
            #[cfg(feature = "araim")]
            araim: None,
            #[cfg(not(feature = "araim"))]
            scalar: core::marker::PhantomData,
        }
    }

    // Not inlined, so that the stack of the initialisation is free during [`judge`].
    #[cfg(feature = "araim")]
    #[inline(never)]
    fn araim(&mut self) -> &mut araim::AraimScratch<T, N> {
        self.araim.get_or_insert_with(araim::AraimScratch::new)
    }
}

impl<T: Real> Criteria<'_, T> {
    /// Applies the global test to a snapshot under the policy, and computes the protection levels
    /// for its threshold.
    ///
    /// `shared` are the shared errors of the first rows ([`EpochView::shared`]).
    ///
    /// # Errors
    /// [`NoThreshold`] names the reason why no threshold exists.
    pub fn test<const N: usize>(
        &self,
        snapshot: &Snapshot<'_, T, N>,
        shared: &[SharedError],
    ) -> Result<Test<T>, NoThreshold> {
        let exposure = LevelInputs::of(snapshot, self.levels, self.factors);
        let demand = ThresholdProblem::new(snapshot.dof(), &exposure, self.requirements, self.thresholds);
        let threshold = demand.threshold::<T>(self.policy)?;
        let detection =
            Detection { sse: snapshot.sse(), threshold: T::narrow(threshold.tau), dof: snapshot.dof() };
        let shift = self.shared_shift(snapshot, shared);
        Ok(Test { detection, levels: exposure.protect(threshold.lambda).plus(&shift) })
    }

    /// Returns the largest effect of the shared range errors on the position, horizontally and
    /// vertically, m.
    pub(crate) fn shared_shift<const N: usize>(
        &self,
        snapshot: &Snapshot<'_, T, N>,
        shared: &[SharedError],
    ) -> ProtectionLevels {
        shared_shift(snapshot, shared, self.shared_growth)
    }
}

/// Tests a solution, searches for faulty rows and leaves them out.
///
/// `forecast` is the row of a predicted clock, if there is one. A caller that knows orbits passes
/// `rates`, which distinguish wrong time tags from faulty satellites
/// ([`raim::hypotheses::time_tag`]). Afterwards, `solution` is solved without the rows of
/// [`Judgement::excluded`].
pub fn judge<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    epoch: &EpochView<'_>,
    forecast: Option<usize>,
    criteria: &Criteria<'_, T>,
    search: Search<'_>,
    rates: Option<&RangeRates<'_>>,
    scratch: &mut MethodScratch<T, N>,
) -> Judgement<T> {
    #[cfg(feature = "araim")]
    if criteria.method == Method::Araim {
        return judge_epoch(solution, epoch, criteria, rates, scratch.araim());
    }
    judge_by_residuals(solution, epoch, forecast, criteria, search, rates, &mut scratch.subsets)
}

/// Returns the row of a known height. It comes after the satellites and depends on no clock.
pub(crate) fn height_row<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    epoch: &EpochView<'_>,
) -> Option<usize> {
    if !cfg!(feature = "aiding") {
        return None;
    }
    let satellites = epoch.observations().len();
    let behind = snapshot.equations().get(satellites..)?;
    Some(satellites + behind.iter().position(|row| row.clock.is_none())?)
}
