//! Global test: are the residuals larger than noise explains?
//!
//! `SSE = Σ w_i v_i²` follows χ² with `n − 3 − C` degrees of freedom if no satellite is faulty. A
//! fault is detected if `SSE ≥ τ1(dof, P_fa)`.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `SSE` | `sse` | – |
//! | `τ1` | `threshold` | – |
//!
//! [`Detection::fault`] is the only comparison of a sum of squares with a threshold.
//!
//! Assumes independent Gaussian errors. The test does not see a bias common to a constellation,
//! which its clock absorbs, nor a fault of a constellation's lone satellite. References: [Yang2015]
//! §1, [Lin2016] §2.2.
//!
//! [Yang2015]: crate#references
//! [Lin2016]: crate#references

pub mod threshold;

use crate::least_squares::Snapshot;
use crate::numeric::real::Real;
use crate::report::TestStatistic;
use threshold::Thresholds;

/// Result of the global test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detection<T> {
    /// Weighted sum of squared residuals, dimensionless.
    pub sse: T,
    /// Threshold that it was compared with, dimensionless.
    pub threshold: T,
    /// Degrees of freedom, at least 1.
    pub dof: usize,
}

impl<T: Real> Detection<T> {
    /// Tests a sum of squares. Returns `None` without redundancy, or beyond the table's degrees of
    /// freedom.
    pub fn of(sse: T, dof: usize, thresholds: &Thresholds<'_>) -> Option<Self> {
        Some(Self { sse, threshold: thresholds.tau1(dof)?, dof })
    }

    /// Returns true if the residuals are larger than noise explains.
    pub fn fault(&self) -> bool {
        // A NaN SSE fails this comparison, so that it counts as a fault.
        !(self.sse < self.threshold)
    }

    /// Returns true if a snapshot can be tested and no fault is detected in it.
    pub fn passes<const N: usize>(snapshot: &Snapshot<'_, T, N>, thresholds: &Thresholds<'_>) -> bool {
        detect(snapshot, thresholds).is_some_and(|detection| !detection.fault())
    }

    /// Returns the test as root mean squares: `√(SSE/dof)` and `√(τ/dof)`.
    pub fn statistic(&self) -> TestStatistic {
        let root = |value: T| (value / T::narrow(self.dof as f64)).sqrt_approx().widen();
        TestStatistic { statistic: root(self.sse), threshold: root(self.threshold), dof: self.dof as u8 }
    }
}

/// Tests a snapshot. Returns `None` without redundancy, or beyond the table's degrees of freedom.
///
/// With `dof = 0` the residuals vanish for any ranges, so that there is no test to pass.
pub fn detect<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    thresholds: &Thresholds<'_>,
) -> Option<Detection<T>> {
    Detection::of(snapshot.sse(), snapshot.dof(), thresholds)
}
