//! The parity-space part of an answer: correlations and what each isolation method makes of them.

use rai_core::integrity::raim::detection::threshold::Thresholds;
use rai_core::integrity::raim::isolation::parity::{
    ParityFinding, SearchLimits, correlation, correlation_threshold, grouping, hybrid,
    hybrid_without_grouping, sequential, simultaneous,
};
use rai_core::least_squares::Snapshot;
use rai_core::numeric::real::Real;
use serde::Serialize;

use super::MAX_ROWS;
use super::line::{Isolation, probability};
use super::number::Number;

/// Sets of up to three of as many rows as a line may have: on the host nothing is cut.
const MAX_SETS: usize = MAX_ROWS * MAX_ROWS * MAX_ROWS / 6;

/// What parity space says of an epoch; a method that fails is `null`, an empty list means that nothing was detected.
#[derive(Serialize)]
#[allow(non_snake_case, reason = "names of the published vectors")]
pub(super) struct Iso {
    rho: Vec<Number>,
    rho_T: Number,
    A: Vec<usize>,
    seq: Option<Vec<usize>>,
    B: Option<Vec<usize>>,
    C: Option<Vec<usize>>,
    D: Option<Vec<usize>>,
}

/// Runs all methods on one snapshot.
pub(super) fn evaluate<T: Real>(
    isolation: &Isolation,
    snapshot: &Snapshot<'_, T>,
    thresholds: &Thresholds<'_>,
) -> Result<Iso, String> {
    let alpha = probability("alpha", isolation.alpha)?;
    let limits = SearchLimits { rows: isolation.kmax, sets: MAX_SETS, alpha };
    let rho = snapshot.rows().map(|(_, fit)| Number(correlation(snapshot, fit).widen()));
    Ok(Iso {
        rho: rho.collect(),
        rho_T: Number(correlation_threshold::<T>(alpha, snapshot.dof()).map_or(f64::INFINITY, T::widen)),
        A: simultaneous(snapshot, thresholds, &limits).to_vec(),
        seq: rows(&sequential(snapshot, thresholds, &limits)),
        B: rows(&hybrid_without_grouping(snapshot, thresholds, &limits)),
        C: rows(&hybrid(snapshot, thresholds, &limits)),
        D: rows(&grouping(snapshot, thresholds, &limits)),
    })
}

fn rows<T: Real>(finding: &ParityFinding<T>) -> Option<Vec<usize>> {
    let removal = finding.set.as_ref().ok()?;
    Some(removal.rows().iter().map(|row| row.index).collect())
}
