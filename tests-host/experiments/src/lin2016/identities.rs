//! Identities on which the algorithms rest, checked over the whole day.
//!
//! ```text
//! p·p = SSE      PᵀP = S      ρ_i = p·p_i / (|p| |p_i|) = w_i / √SSE
//! HDOP_i² − HDOP² = (A_1i² + A_2i²) / S_ii
//! τ1 < τ2  ⇔  HPL < f HAL
//! ```
//!
//! | symbol | meaning | source |
//! |---|---|---|
//! | `P` | orthonormal basis of the complement of the design | dense matrices |
//! | `p = P y / σ` | parity vector; `p_i` its columns | dense matrices |
//! | `SSE`, `S`, `ρ`, `A` | see [`raim_core::internals::least_squares`], [`raim_core::internals::integrity::raim::isolation::parity`] | the core |
//! | `HDOP_i` | dilution without satellite `i` | the core, solved again without it |
//! | `τ1`, `τ2` | see [`raim_core::internals::integrity::raim::detection::threshold::policy`] | the core |

use anyhow::Context as _;
use nalgebra::{DMatrix, DVector};
use raim::signal::sky::linear;
use raim_core::internals::integrity::raim::detection::threshold::policy::{ThresholdProblem, Weights};
use raim_core::internals::integrity::raim::isolation::parity::correlation;
use raim_core::internals::integrity::raim::levels::largest_slopes;
use raim_core::internals::integrity::raim::levels::noncentrality_at;
use raim_core::internals::least_squares::{Snapshot, Workspace};
use raim_core::internals::numeric::probability::Probability;

use super::{Day, EPOCHS, Finding, HAL_M, Judgement, MISSED_DETECTION, ROWS, Row, SIGMA_M, Section};

/// Largest relative difference that counts as rounding.
const ROUNDING: f64 = 1e-9;

/// Differences of one epoch.
struct Differences {
    sse: f64,
    projection: f64,
    correlation: f64,
    dilution: f64,
    /// Number of alert limits for which the thresholds and the protection level disagree.
    limits: usize,
}

/// Returns the table of all identities.
pub(super) fn section(day: &Day) -> anyhow::Result<Section> {
    let epochs: Vec<Differences> =
        (0..EPOCHS).map(|epoch| differences(day, &day.rows(epoch, 0))).collect::<anyhow::Result<_>>()?;
    let row = |what: &str, difference: fn(&Differences) -> f64| {
        // In this form NaN counts as a difference.
        let differing = epochs.iter().filter(|epoch| !(difference(epoch) <= ROUNDING)).count();
        let ours = Finding::exact(differing as f64, 0);
        Row::new(what, "", ours, Judgement::Ours).held_to(4, 0.0, 0.0)
    };
    let rows = vec![
        row("p·p = SSE", |epoch| epoch.sse),
        row("PᵀP = S", |epoch| epoch.projection),
        row("p·p_i / (|p| |p_i|) = w_i / √SSE", |epoch| epoch.correlation),
        row("HDOP_i² − HDOP² = (A_1i² + A_2i²) / S_ii", |epoch| epoch.dilution),
        row("tau1 < tau2 where HPL < f HAL, and nowhere else", |epoch| epoch.limits as f64),
    ];
    let title = format!("Identities: epochs of {EPOCHS} that differ by more than 1e-9, relatively");
    Ok(Section { title, rows })
}

fn differences(day: &Day, rows: &[linear::Row]) -> anyhow::Result<Differences> {
    let mut workspace = super::pose::<f64>(rows)?;
    let snapshot = workspace.solve()?;
    let basis = parity_matrix(rows);
    let residuals = DVector::from_iterator(rows.len(), rows.iter().map(|row| row.y_m / SIGMA_M));
    let parity = &basis * residuals;
    Ok(Differences {
        sse: relative(parity.norm_squared(), snapshot.sse()),
        projection: worst(pairs(rows.len()).map(|(i, j)| {
            let core = snapshot.projection(i, j).unwrap_or(f64::NAN);
            (basis.column(i).dot(&basis.column(j)) - core).abs()
        })),
        correlation: worst((0..).zip(snapshot.rows()).map(|(index, (_, fit))| {
            let column = basis.column(index);
            let cosine = parity.dot(&column) / (parity.norm() * column.norm());
            (cosine - correlation(&snapshot, fit)).abs()
        })),
        dilution: worst((0..rows.len()).map(|index| dilution(&snapshot, index))),
        limits: disagreements(day, &snapshot)?,
    })
}

/// Returns orthonormal rows that span the complement of the four columns.
fn parity_matrix(rows: &[linear::Row]) -> DMatrix<f64> {
    let design = DMatrix::from_fn(rows.len(), 4, |row, column| {
        let direction = rows[row].line_of_sight;
        [-direction.east, -direction.north, -direction.up, 1.0][column]
    });
    let reached = design.qr().q();
    let projection = DMatrix::identity(rows.len(), rows.len()) - &reached * reached.transpose();
    let eigen = projection.symmetric_eigen();
    let kept: Vec<usize> = (0..rows.len()).filter(|&index| eigen.eigenvalues[index] > 0.5).collect();
    eigen.eigenvectors.select_columns(&kept).transpose()
}

/// Returns the relative difference between the increase of HDOP² solved again and by the identity.
fn dilution(snapshot: &Snapshot<'_, f64, ROWS>, index: usize) -> f64 {
    let by_identity = snapshot.row(index).map_or(f64::NAN, |(row, fit)| {
        let moved = fit.gain.x.powi(2) + fit.gain.y.powi(2);
        row.weight.powi(2) * moved / fit.redundancy
    });
    let mut workspace = Workspace::<f64, ROWS>::new();
    let Some(mut without) = workspace.copy_of(snapshot) else { return f64::NAN };
    if without.leave_out(index).is_err() {
        return f64::NAN;
    }
    let ((with, _), (without, _)) = (snapshot.dilutions(), without.dilutions());
    (without * without - with * with - by_identity).abs() / (with * with)
}

/// Counts disagreements at alert limits around the protection level, and at the paper's own.
fn disagreements(day: &Day, snapshot: &Snapshot<'_, f64, ROWS>) -> anyhow::Result<usize> {
    let slopes = largest_slopes(snapshot);
    let dof = snapshot.dof();
    let hpl_m = slopes.protect(day.thresholds.lambda(dof).context("beyond the tables")?).hpl_m;
    let limits_m = [0.5, 0.9, 0.999, 1.001, 1.1, 2.0].map(|factor| factor * hpl_m);
    let disagrees = |limit_m: f64| {
        let demand = ThresholdProblem {
            dof,
            noncentrality: noncentrality_at(limit_m, slopes.horizontal),
            thresholds: day.thresholds,
            missed_detection: Probability::new(MISSED_DETECTION)?,
            weights: Weights::EQUAL,
        };
        let decision = demand.decide::<f64>()?;
        Some((decision.tau1 < decision.tau2) != (hpl_m < limit_m))
    };
    let disagree = limits_m.into_iter().chain([HAL_M]).map(disagrees).collect::<Option<Vec<_>>>();
    Ok(disagree.context("beyond the tables")?.into_iter().filter(|&disagrees| disagrees).count())
}

fn relative(have: f64, want: f64) -> f64 {
    (have / want - 1.0).abs()
}

/// Returns the largest difference; NaN counts as larger than any number.
fn worst(differences: impl Iterator<Item = f64>) -> f64 {
    differences.max_by(f64::total_cmp).unwrap_or(0.0)
}

fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(move |i| (0..count).map(move |j| (i, j)))
}
