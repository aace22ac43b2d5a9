//! Range-consensus part of an answer: the improved method by the core, the traditional one as its
//! baseline.

use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::isolation::ransac::{
    ConsensusLimits, MAX_WORK, NoConsensus, Refinement, Selection, consensus, refine,
};
use raim_core::internals::least_squares::Snapshot;
use raim_core::internals::numeric::real::Real;
use serde::Serialize;

use super::line::Line;
use crate::second_opinion::ransac_traditional::{Criterion, RATIO, combination_count, combinations, vote};

/// Number of subsets above which an answer omits the traditional method.
const MOST_COMBINATIONS: f64 = 1500.0;

/// Range-consensus result of an epoch, before the fall-back.
#[derive(Serialize)]
pub(super) struct Ransac {
    subsets: Vec<Vec<usize>>,
    best: Option<usize>,
    fault: Vec<usize>,
    status: &'static str,
    fault_refined: Vec<usize>,
    status_refined: &'static str,
}

/// Result over all minimal subsets.
#[derive(Serialize)]
#[allow(non_snake_case, reason = "names of the published vectors")]
pub(super) struct Traditional {
    K: usize,
    n_out: usize,
    f: Vec<usize>,
    tot: Vec<usize>,
    fault: Vec<usize>,
}

/// Runs the improved method; `None` with too few satellites for two subsets.
pub(super) fn evaluate<T: Real>(
    line: &Line,
    snapshot: &Snapshot<'_, T>,
    limits: &ConsensusLimits<'_>,
) -> Option<Ransac> {
    if line.satellites.len() < 2 * line.unknowns() {
        return None;
    }
    // The work for 40 rows does not suffice for the longest line, and time does not matter on the
    // host.
    let selection: Selection = Selection::choose(snapshot.equations(), 8 * MAX_WORK);
    let members = |subset| (0..line.rows()).filter(|&row| selection.contains(subset, row)).collect();
    let subsets = (0..selection.subsets()).map(members).collect();
    let (status, best, fault, refined) = match consensus(snapshot.equations(), &selection, limits) {
        Ok(found) => {
            let refined = refine(snapshot.equations(), &selection, &found, limits);
            ("ok", Some(found.subset), found.rows.to_vec(), Some(refined))
        }
        Err(NoConsensus::TooFewSubsets) => ("too_few_subsets", None, Vec::new(), None),
        Err(NoConsensus::NoInlier) => ("no_inlier_subset", None, Vec::new(), None),
    };
    let status_refined = match &refined {
        Some(Refinement { passed: false, .. }) => "refine_fail",
        _ => status,
    };
    let fault_refined = refined.map_or_else(Vec::new, |refined| refined.rows.to_vec());
    Some(Ransac { subsets, best, fault, status, fault_refined, status_refined })
}

/// Runs the traditional method; `None` with too few satellites, or too many combinations.
pub(super) fn traditional(line: &Line, disagreement: &Thresholds<'_>) -> Option<Traditional> {
    let (count, unknowns) = (line.satellites.len(), line.unknowns());
    let threshold = disagreement.w_test(count)?;
    if count < 2 * unknowns || combination_count(count, unknowns) > MOST_COMBINATIONS {
        return None;
    }
    let votes = vote(&line.ranges(), combinations(count, unknowns), Criterion::Count { threshold });
    Some(Traditional {
        K: votes.valid,
        n_out: votes.contradicted,
        fault: votes.faulty(RATIO),
        f: votes.contradicted_with,
        tot: votes.valid_with,
    })
}
