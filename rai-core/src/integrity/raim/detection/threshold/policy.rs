//! Threshold policies: between which two risks is the threshold of the global test placed?
//!
//! ```text
//! δ      = min (f AL / max slope)²           horizontal, and vertical where a limit is set
//! T1     Q(τ1; ν) = P_fa                     as low as false alarms allow: least risk to integrity
//! T2     G(τ2; ν, δ) = P_md                  as high as missed detections allow: least risk to continuity
//! T_OP   κ f(τ; ν) = g(τ; ν, δ)              least κ P_F + P_M, held between τ1 and τ2
//! ```
//!
//! `f` and `g` are the densities of the statistic without a fault and with one that moves the position just to its
//! share of the alert limit. A threshold meets both probabilities if `τ1 < τ2`, which is the same as `δ > λ(τ1)` and
//! as `HPL < f HAL`; it is decided by `δ > λ(τ1)`, which needs no quantile.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `δ` | `noncentrality` | dimensionless: a squared bias in units of sigma² |
//! | `ν` | `dof` | degrees of freedom |
//! | `τ1`, `τ2`, `τ` | `tau1`, `tau2`, `tau` | dimensionless: a sum of squares in units of sigma² |
//! | `λ` | `lambda` | dimensionless: non-centrality of the bias that `τ` misses with `P_md` |
//! | `κ` | [`Weights`] | dimensionless: cost of a false alarm over that of a missed detection |
//! | `f` | `guard_fraction` | dimensionless |
//!
//! Departures from [Yang2015]: the text's `HAL (1 − f)` is the guard band, its formula and figures use `HAL f`, as
//! here. A crossing above `τ2` is lowered to `τ2`, on which the paper is silent: `P_md` would be exceeded. The sum
//! `P_F + P_M` is a cost, not a probability, since the two hold under different hypotheses; equal weights are the
//! paper's, other ones its natural generalisation.
//!
//! References: [Yang2015] §1–2.
//!
//! [Yang2015]: crate#references

use super::Thresholds;
use crate::integrity::raim::levels::Exposure;
use crate::numeric::chi_square::{ChiSquare, LARGEST};
use crate::numeric::probability::Probability;
use crate::numeric::real::Real;
use crate::requirements::Requirements;

/// Where the threshold is placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Policy {
    /// As low as false alarms allow: the least risk to integrity, the classic threshold.
    T1,
    /// As high as missed detections allow: the least risk to continuity.
    T2,
    /// Where the weighted sum of both risks is smallest.
    TOp,
}

/// What a false alarm costs, compared with a missed detection.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Weights {
    /// Logarithm of the ratio.
    ln_ratio: f64,
}

impl Weights {
    /// Both cost the same, as published.
    pub const EQUAL: Self = Self { ln_ratio: 0.0 };

    /// Checks once that both are above 0 and their ratio within 1e-12 to 1e12; `None` otherwise.
    pub fn new(false_alarm: f64, missed_detection: f64) -> Option<Self> {
        let ratio = false_alarm / missed_detection;
        let valid = false_alarm > 0.0 && (1e-12..=1e12).contains(&ratio);
        valid.then(|| Self { ln_ratio: libm::log(ratio) })
    }
}

/// What a geometry and its user demand of the threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demand<'t> {
    /// Degrees of freedom of the global test.
    pub dof: usize,
    /// Non-centrality of the fault that moves the position to its share of the alert limit, dimensionless.
    pub noncentrality: f64,
    /// Rows of `tau1` and `lambda` for the demanded probabilities.
    pub thresholds: Thresholds<'t>,
    /// Probability that a fault which matters is missed.
    pub missed_detection: Probability,
    /// What is minimised by [`Policy::TOp`].
    pub weights: Weights,
}

/// The threshold of a policy.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PolicyThreshold {
    /// What SSE must reach to mean a fault, dimensionless.
    pub tau: f64,
    /// Non-centrality for the protection levels under this threshold, dimensionless.
    ///
    /// For [`Policy::T2`] it is the demanded one: the protection level then is its share of the alert limit, neither
    /// more nor less. That the limits are met is decided before, not by comparing the levels with them again.
    pub lambda: f64,
}

/// Why a policy has no threshold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NoThreshold {
    /// No degrees of freedom, or more than the tables have.
    Redundancy,
    /// No threshold meets both probabilities.
    Risk,
}

/// Which threshold [`Policy::TOp`] came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Status {
    /// The crossing itself.
    Op,
    /// The crossing is below `τ1`, and raised to it: false alarms would be too many.
    OpIsTau1,
    /// The crossing is above `τ2`, and lowered to it: missed detections would be too many.
    OpIsTau2,
    /// No threshold meets both probabilities.
    Unavailable,
}

/// All thresholds of one geometry, for comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Decision {
    /// Lower bound: demanded by false alarms.
    pub tau1: f64,
    /// Upper bound: demanded by missed detections.
    pub tau2: f64,
    /// Where the densities cross, whatever the bounds are; 0 where they do not.
    pub tau_op_raw: f64,
    /// The same, held between the bounds; `None` where there is nothing between them.
    pub tau_op: Option<f64>,
    /// Which bound held, if any.
    pub status: Status,
}

/// A threshold on SSE as one on `√(Σv²/ν)`, in m, where all ranges have the same sigma ([Yang2015] eq. 5).
///
/// [Yang2015]: crate#references
pub fn range_threshold_m(tau: f64, dof: usize, sigma_m: f64) -> f64 {
    sigma_m * libm::sqrt(tau / dof as f64)
}

impl<'t> Demand<'t> {
    /// What `requirements` demand of a position so exposed; both risks weigh the same.
    pub fn new<T: Real>(
        dof: usize,
        exposure: &Exposure<'_, T>,
        requirements: &Requirements,
        thresholds: Thresholds<'t>,
    ) -> Self {
        let share = |limit_m: f64| requirements.guard_fraction * limit_m;
        let horizontal = exposure.horizontal_noncentrality(share(requirements.hal_m));
        let vertical =
            requirements.val_m.map_or(LARGEST, |val_m| exposure.vertical_noncentrality(share(val_m)));
        Self {
            dof,
            noncentrality: horizontal.min(vertical),
            thresholds,
            missed_detection: requirements.missed_detection,
            weights: Weights::EQUAL,
        }
    }

    /// The threshold of one policy, with no more work than it needs: none for `T1`, one quantile for `T2`, one crossing
    /// and one non-centrality for `TOp`.
    ///
    /// `T1` is never refused for its risk: its protection levels say whether they are within the limits.
    ///
    /// # Errors
    /// [`NoThreshold`] says what is missing.
    pub fn threshold<T: Real>(&self, policy: Policy) -> Result<PolicyThreshold, NoThreshold> {
        let (classic, test) = self.classic::<T>().ok_or(NoThreshold::Redundancy)?;
        match policy {
            Policy::T1 => Ok(classic),
            _ if !self.available(classic) => Err(NoThreshold::Risk),
            Policy::T2 => Ok(self.highest(&test)),
            Policy::TOp => Ok(self.optimal(classic, &test)),
        }
    }

    /// All thresholds; `None` without redundancy or beyond the tables.
    pub fn decide<T: Real>(&self) -> Option<Decision> {
        let (classic, test) = self.classic::<T>()?;
        let tau1 = classic.tau;
        let tau2 = self.highest(&test).tau;
        let tau_op_raw = self.crossing(&test);
        let (status, tau_op) = match () {
            () if !self.available(classic) => (Status::Unavailable, None),
            () if tau_op_raw <= tau1 => (Status::OpIsTau1, Some(tau1)),
            () if tau_op_raw >= tau2 => (Status::OpIsTau2, Some(tau2)),
            () => (Status::Op, Some(tau_op_raw)),
        };
        Some(Decision { tau1, tau2, tau_op_raw, tau_op, status })
    }

    fn classic<T: Real>(&self) -> Option<(PolicyThreshold, ChiSquare<T>)> {
        let tau: T = self.thresholds.tau1(self.dof)?;
        let lambda: T = self.thresholds.lambda(self.dof)?;
        Some((PolicyThreshold { tau: tau.widen(), lambda: lambda.widen() }, ChiSquare::new(self.dof)?))
    }

    /// Written so that a non-centrality which is not a number makes nothing available.
    fn available(&self, classic: PolicyThreshold) -> bool {
        self.noncentrality > classic.lambda
    }

    fn highest<T: Real>(&self, test: &ChiSquare<T>) -> PolicyThreshold {
        let tau = test.quantile(self.missed_detection, self.noncentrality).widen();
        PolicyThreshold { tau, lambda: self.noncentrality.min(LARGEST) }
    }

    fn crossing<T: Real>(&self, test: &ChiSquare<T>) -> f64 {
        test.crossing(self.noncentrality, self.weights.ln_ratio).widen()
    }

    /// The crossing, held within the bounds. It is below `τ2` exactly if its own non-centrality is below the demanded one:
    /// the upper bound itself is needed only where it holds.
    fn optimal<T: Real>(&self, classic: PolicyThreshold, test: &ChiSquare<T>) -> PolicyThreshold {
        let tau = self.crossing(test);
        if tau <= classic.tau {
            return classic;
        }
        let lambda = test.noncentrality(tau, self.missed_detection).widen();
        if lambda < self.noncentrality { PolicyThreshold { tau, lambda } } else { self.highest(test) }
    }
}
