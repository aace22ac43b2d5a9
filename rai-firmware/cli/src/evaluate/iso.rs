//! Parity-space part of an answer: correlations, and the result of each isolation method.

use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::isolation::parity::{
    ParityFinding, SearchLimits, correlation, correlation_threshold, grouping, hybrid,
    hybrid_without_grouping, sequential, simultaneous,
};
use raim_core::internals::least_squares::Snapshot;
use raim_core::internals::numeric::real::Real;
use serde::Serialize;

use super::MAX_ROWS;
use super::line::{Isolation, probability};
use super::number::Number;

/// Number of sets of up to three rows in the longest line, so that the host never cuts a search.
const MAX_SETS: usize = MAX_ROWS * MAX_ROWS * MAX_ROWS / 6;

/// Parity-space results of an epoch. A method that fails is `null`; an empty list means that
/// nothing was detected.
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
