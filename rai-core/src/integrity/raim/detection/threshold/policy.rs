//! Threshold policies: the choice of the global test's threshold between two risks.
//!
//! ```text
//! δ      = min (f AL / max slope)²           horizontal, and vertical if a limit is set
//! T1     Q(τ1; ν) = P_fa                     as low as false alarms permit: least risk to integrity
//! T2     G(τ2; ν, δ) = P_md                  as high as missed detections permit: least risk to continuity
//! T_OP   κ f(τ; ν) = g(τ; ν, δ)              least κ P_F + P_M, limited to τ1 … τ2
//! ```
//!
//! `f(τ; ν)` is the density of SSE without a fault. `g` is its density with a fault that moves the
//! position just by its share of the alert limit. `P_F` and `P_M` are the probabilities of false
//! alarm and missed detection under `τ`. A threshold meets both probabilities if `τ1 < τ2`. This is
//! equivalent to `δ > λ(τ1)` and, by the papers' level, to `HPL < f HAL`. The code compares
//! `δ > λ(τ1)`, which needs no quantile.
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
//! Departures from [Yang2015]: its text has `HAL (1 − f)`, the guard band; its formula and figures
//! use `HAL f`, as here. A crossing above `τ2` is lowered to `τ2`, because `P_md` would be
//! exceeded; the paper does not treat this case. The sum `P_F + P_M` is a cost and not a
//! probability, because the two belong to different hypotheses. The paper weighs them equally; `κ`
//! generalises this.
//!
//! References: [Yang2015] §1–2.
//!
//! [Yang2015]: crate#references

use core::fmt;

use super::Thresholds;
use crate::integrity::raim::levels::LevelInputs;
use crate::numeric::chi_square::{ChiSquare, LARGEST};
use crate::numeric::probability::Probability;
use crate::numeric::real::Real;
use crate::numeric::sqrt_f64;
use crate::requirements::Requirements;

/// Position of the threshold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Policy {
    /// The threshold is as low as false alarms allow: the least risk to integrity, the classic
    /// threshold.
    T1,
    /// The threshold is as high as missed detections allow: the least risk to continuity.
    T2,
    /// The threshold minimises the weighted sum of both risks.
    TOp,
}

/// Cost of a false alarm relative to a missed detection.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Weights {
    /// Logarithm of the ratio.
    ln_ratio: f64,
}

impl Weights {
    /// Both cost the same, as published.
    pub const EQUAL: Self = Self { ln_ratio: 0.0 };

    /// Returns the weights if both are above 0 and their ratio is within 1e-12 to 1e12; `None`
    /// otherwise.
    pub fn new(false_alarm: f64, missed_detection: f64) -> Option<Self> {
        let ratio = false_alarm / missed_detection;
        let valid = false_alarm > 0.0 && (1e-12..=1e12).contains(&ratio);
        valid.then(|| Self { ln_ratio: libm::log(ratio) })
    }
}

/// Inputs of the threshold: geometry, probabilities and weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThresholdProblem<'t> {
    /// Degrees of freedom of the global test.
    pub dof: usize,
    /// Non-centrality of the fault that moves the position to its share of the alert limit,
    /// dimensionless.
    pub noncentrality: f64,
    /// Rows of `tau1` and `lambda` for the demanded probabilities.
    pub thresholds: Thresholds<'t>,
    /// Probability that a fault which matters is missed.
    pub missed_detection: Probability,
    /// Weights of the sum that [`Policy::TOp`] minimises.
    pub weights: Weights,
}

/// Threshold of a policy.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PolicyThreshold {
    /// Value that SSE must reach to mean a fault, dimensionless.
    pub tau: f64,
    /// Non-centrality for the protection levels under this threshold, dimensionless.
    ///
    /// For [`Policy::T2`] it equals [`ThresholdProblem::noncentrality`], so that the protection
    /// level equals its share of the alert limit. [`ThresholdProblem::threshold`] has then already
    /// checked that the limits can be met.
    pub lambda: f64,
}

/// Reason why a policy has no threshold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NoThreshold {
    /// No degrees of freedom, or more than the tables have.
    Redundancy,
    /// No threshold meets both probabilities.
    Risk,
}

impl fmt::Display for NoThreshold {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Redundancy => "degrees of freedom must be at least 1 and within the tables",
            Self::Risk => "no threshold meets both probabilities",
        })
    }
}

impl core::error::Error for NoThreshold {}

/// Source of the threshold of [`Policy::TOp`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Status {
    /// The crossing itself.
    Op,
    /// The crossing is below `τ1` and raised to it, because false alarms would be too many.
    OpIsTau1,
    /// The crossing is above `τ2` and lowered to it, because missed detections would be too many.
    OpIsTau2,
    /// No threshold meets both probabilities.
    Unavailable,
}

/// All thresholds of one geometry, for comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Decision {
    /// Lower bound `τ1`, set by false alarms.
    pub tau1: f64,
    /// Upper bound `τ2`, set by missed detections.
    pub tau2: f64,
    /// Crossing of the densities without the bounds; 0 if they do not cross.
    pub tau_op_raw: f64,
    /// Crossing within the bounds; `None` if the interval is empty.
    pub tau_op: Option<f64>,
    /// Bound that applied, if any.
    pub status: Status,
}

/// Converts a threshold on SSE to one on `√(Σv²/ν)`, m, if all ranges have the same sigma
/// ([Yang2015] eq. 5).
///
/// [Yang2015]: crate#references
pub fn range_threshold_m(tau: f64, dof: usize, sigma_m: f64) -> f64 {
    sigma_m * sqrt_f64(tau / dof as f64)
}

impl<'t> ThresholdProblem<'t> {
    /// Returns the problem for these requirements and level inputs, with equal weights.
    pub fn new<T: Real>(
        dof: usize,
        exposure: &LevelInputs<'_, T>,
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

    /// Returns the threshold of one policy. `T1` only reads the tables; `T2` needs one quantile,
    /// `TOp` one crossing and one non-centrality.
    ///
    /// `T1` is never refused with [`NoThreshold::Risk`], because its protection levels are compared
    /// with the limits later.
    ///
    /// # Errors
    /// [`NoThreshold`] names what is missing.
    pub fn threshold<T: Real>(&self, policy: Policy) -> Result<PolicyThreshold, NoThreshold> {
        let (classic, test) = self.classic::<T>().ok_or(NoThreshold::Redundancy)?;
        match policy {
            Policy::T1 => Ok(classic),
            _ if !cfg!(feature = "policies") => Err(NoThreshold::Risk),
            _ if !self.available(classic) => Err(NoThreshold::Risk),
            Policy::T2 => Ok(self.highest(&test)),
            Policy::TOp => Ok(self.optimal(classic, &test)),
        }
    }

    /// Returns all thresholds, or `None` without redundancy or beyond the tables.
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

    /// Returns true if the classic threshold meets both probabilities. A NaN non-centrality fails
    /// this comparison.
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

    /// Returns the crossing, limited to the bounds.
    ///
    /// The crossing is below `τ2` exactly if its non-centrality is below
    /// [`ThresholdProblem::noncentrality`]. So `τ2` is computed only if it applies.
    fn optimal<T: Real>(&self, classic: PolicyThreshold, test: &ChiSquare<T>) -> PolicyThreshold {
        let tau = self.crossing(test);
        if tau <= classic.tau {
            return classic;
        }
        let lambda = test.noncentrality(tau, self.missed_detection).widen();
        if lambda < self.noncentrality { PolicyThreshold { tau, lambda } } else { self.highest(test) }
    }
}
