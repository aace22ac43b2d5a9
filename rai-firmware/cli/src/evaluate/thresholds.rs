//! Thresholds of the policies: of one line `{nu, pfa, pmd, delta}`, and of an epoch's geometry.

use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::detection::threshold::policy::{
    Decision, Status, ThresholdProblem, Weights,
};
use raim_core::internals::numeric::probability::Probability;
use raim_core::internals::numeric::real::Real;
use serde::Serialize;
use serde_json::{Map, Value};

use super::RowCache;
use super::line::{number, probability};
use super::number::Number;

/// Thresholds of the policies.
#[derive(Serialize)]
pub(super) struct Policies {
    tau2: Number,
    tau_op_raw: Number,
    /// `null` if no threshold meets both probabilities.
    tau_op: Option<Number>,
    op_status: &'static str,
}

/// An input line with its answer.
#[derive(Serialize)]
pub(super) struct Answered {
    #[serde(flatten)]
    input: Map<String, Value>,
    tau1: Number,
    lam: Number,
    tau2: Number,
    tau_op_raw: Number,
    tau_op: Option<Number>,
    status: &'static str,
}

/// Returns the policies' thresholds for a non-centrality; `None` beyond the tables.
pub(super) fn decide<T: Real>(
    dof: usize,
    noncentrality: f64,
    thresholds: Thresholds<'_>,
    missed_detection: Probability,
) -> Option<Policies> {
    let demand =
        ThresholdProblem { dof, noncentrality, thresholds, missed_detection, weights: Weights::EQUAL };
    let Decision { tau2, tau_op_raw, tau_op, status, .. } = demand.decide::<T>()?;
    Some(Policies {
        tau2: tau2.into(),
        tau_op_raw: tau_op_raw.into(),
        tau_op: tau_op.map(Into::into),
        op_status: word(status),
    })
}

const fn word(status: Status) -> &'static str {
    match status {
        Status::Op => "op",
        Status::OpIsTau1 => "op_is_tau1",
        Status::OpIsTau2 => "op_is_tau2",
        Status::Unavailable => "unavailable",
    }
}

/// Answers one line of `--thresholds`.
pub(super) fn evaluate<T: Real>(
    object: &Map<String, Value>,
    rows: &mut RowCache,
) -> Result<Answered, String> {
    let dof = number(object, "nu")?;
    let noncentrality = number(object, "delta")?;
    let false_alarm = probability("pfa", number(object, "pfa")?)?;
    let missed_detection = probability("pmd", number(object, "pmd")?)?;
    rows.prepare(false_alarm, missed_detection);
    let thresholds = rows.thresholds(false_alarm, missed_detection);
    let beyond = || format!("nu: {dof} is outside the tables");
    let whole =
        (dof.fract().abs() < f64::EPSILON && dof >= 1.0).then_some(dof as usize).ok_or_else(beyond)?;
    let (tau1, lambda) =
        thresholds.tau1::<f64>(whole).zip(thresholds.lambda::<f64>(whole)).ok_or_else(beyond)?;
    let Policies { tau2, tau_op_raw, tau_op, op_status } =
        decide::<T>(whole, noncentrality, thresholds, missed_detection).ok_or_else(beyond)?;
    // A line of the vectors already has the answers; no key may occur twice.
    let is_answer = |key: &str| ["tau1", "lam", "tau2", "tau_op_raw", "tau_op", "status"].contains(&key);
    let mut input = object.clone();
    input.retain(|key, _| !is_answer(key));
    Ok(Answered { input, tau1: tau1.into(), lam: lambda.into(), tau2, tau_op_raw, tau_op, status: op_status })
}
