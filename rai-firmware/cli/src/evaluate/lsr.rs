//! Least-squares part of an answer: global test, w-test, sequential exclusion, protection levels.
//!
//! The core computes everything that it can. Fields have the names of the published vectors.

use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::detection::{Detection, detect};
use raim_core::internals::integrity::raim::isolation::baarda::{exclude_sequentially, identify};
use raim_core::internals::integrity::raim::isolation::exclusion::{ExclusionOutcome, Unidentified};
use raim_core::internals::integrity::raim::levels::noncentrality_at;
use raim_core::internals::integrity::raim::levels::{largest_slopes, slopes};
use raim_core::internals::least_squares::equations::{LinearEpoch, Row, RowError};
use raim_core::internals::least_squares::{RowFit, Snapshot, SnapshotError, Workspace};
use raim_core::internals::numeric::real::Real;
use raim_core::satellite::Constellation;
use serde::Serialize;

use super::MAX_ROWS;
use super::line::Line;
use super::number::Number;
use super::thresholds::{Policies, decide};

/// Least-squares results of an epoch, as far as its status allows.
#[derive(Serialize)]
pub(super) struct Lsr {
    status: &'static str,
    n: usize,
    m: usize,
    dof: isize,
    #[serde(flatten)]
    solution: Option<Solution>,
    #[serde(flatten)]
    test: Option<Test>,
    #[serde(flatten)]
    exclusion: Option<Exclusion>,
    #[serde(skip_serializing_if = "Option::is_none")]
    why: Option<String>,
}

#[derive(Serialize)]
struct Solution {
    x: Vec<Number>,
    v: Vec<Number>,
    sse: Number,
    hdop: Number,
    vdop: Number,
}

#[derive(Serialize)]
#[allow(non_snake_case, clippy::struct_field_names, reason = "names of the published vectors")]
struct Test {
    tau1: Number,
    lam: Number,
    test: Number,
    T1n: Number,
    detected: bool,
    w: Vec<Number>,
    Td: Number,
    Sii: Vec<Number>,
    slope_h: Vec<Number>,
    slope_v: Vec<Number>,
    hpl: Number,
    vpl: Number,
    hdop_i: Vec<Number>,
    delta: Number,
    #[serde(flatten)]
    policies: Policies,
    raim_available: bool,
    /// Row of the epoch, or −1.
    ident: isize,
    ident_reason: &'static str,
}

#[derive(Serialize)]
struct Exclusion {
    excluded: Vec<usize>,
    fde_status: &'static str,
    sse_after: Number,
    dof_after: usize,
    /// Solution after exclusion, if the fault was isolated or there was none.
    x_after: Option<Vec<Number>>,
}

impl Lsr {
    /// Returns the answer for an epoch with invalid numbers.
    pub(super) fn invalid(line: &Line, why: String) -> Self {
        Self { why: Some(why), ..Self::status("invalid_input", line) }
    }

    fn status(status: &'static str, line: &Line) -> Self {
        let (n, m) = (line.rows(), line.unknowns());
        let dof = n.cast_signed() - m.cast_signed();
        Self { status, n, m, dof, solution: None, test: None, exclusion: None, why: None }
    }
}

/// Runs the core on one line.
///
/// The error names the value that the tables do not cover.
pub(super) fn evaluate<T: Real>(line: &Line, thresholds: &Thresholds<'_>) -> Result<Lsr, String> {
    if line.rows() == 0 {
        return Ok(Lsr::invalid(line, "no satellites".to_owned()));
    }
    let epoch = match rows::<T>(line) {
        Ok(epoch) => epoch,
        Err(why) => return Ok(Lsr::invalid(line, why)),
    };
    let mut workspace = Workspace::of(epoch);
    let snapshot = match workspace.solve() {
        Ok(snapshot) => snapshot,
        Err(SnapshotError::Insufficient) => return Ok(Lsr::status("insufficient", line)),
        Err(SnapshotError::Singular) => return Ok(Lsr::status("singular", line)),
    };
    let solution = Some(solution(&snapshot));
    if snapshot.dof() == 0 {
        return Ok(Lsr { solution, ..Lsr::status("no_redundancy", line) });
    }
    let test = Some(test(line, &snapshot, thresholds)?);
    let exclusion = Some(exclude(snapshot, thresholds));
    Ok(Lsr { solution, test, exclusion, ..Lsr::status("ok", line) })
}

/// Returns the equations of a line, ready to be solved; `None` if its status says why there are
/// none.
pub(super) fn workspace<T: Real>(line: &Line) -> Option<Workspace<T, MAX_ROWS>> {
    Some(Workspace::of(rows(line).ok()?))
}

fn rows<T: Real>(line: &Line) -> Result<LinearEpoch<T, MAX_ROWS>, String> {
    let mut epoch = LinearEpoch::new();
    for (index, satellite) in line.satellites.iter().enumerate() {
        let (constellation, direction) = (satellite.constellation, satellite.line_of_sight);
        epoch
            .satellite(constellation, direction, satellite.residual_m, satellite.sigma_m)
            .map_err(|error| format!("satellite {index}: {error}"))?;
    }
    if let Some(clock) = line.clock {
        let named = |error: RowError| format!("clock: {error}");
        epoch.clock(clock.constellation, clock.value_m, clock.sigma_m).map_err(named)?;
    }
    Ok(epoch)
}

fn solution<T: Real>(snapshot: &Snapshot<'_, T>) -> Solution {
    let (hdop, vdop) = snapshot.dilutions();
    Solution {
        x: unknowns(snapshot),
        v: each_row(snapshot, |_, fit| fit.residual),
        sse: wide(snapshot.sse()),
        hdop: wide(hdop),
        vdop: wide(vdop),
    }
}

fn test<T: Real>(
    line: &Line,
    snapshot: &Snapshot<'_, T>,
    thresholds: &Thresholds<'_>,
) -> Result<Test, String> {
    let dof = snapshot.dof();
    let beyond = || format!("{dof} degrees of freedom: beyond the tables");
    let detection = detect(snapshot, thresholds).ok_or_else(beyond)?;
    let lambda = thresholds.lambda(dof).ok_or_else(beyond)?;
    let rows = snapshot.used();
    let w_threshold =
        thresholds.w_test::<f64>(rows).ok_or_else(|| format!("{rows} rows: beyond the tables"))?;
    let statistic = detection.statistic();
    let levels = largest_slopes(snapshot).protect(lambda);
    let limit_m = line.guard_fraction * line.hal_m;
    let delta = noncentrality_at(limit_m, largest_slopes(snapshot).horizontal.widen());
    let (_, missed_detection) = line.probabilities()?;
    let policies = decide::<T>(dof, delta, *thresholds, missed_detection).ok_or_else(beyond)?;
    let (ident, ident_reason) = identification(snapshot, &detection, thresholds);
    Ok(Test {
        tau1: wide(detection.threshold),
        lam: lambda.into(),
        test: statistic.statistic.into(),
        T1n: statistic.threshold.into(),
        detected: detection.fault(),
        w: each_row(snapshot, |_, fit| fit.w_test()),
        Td: w_threshold.into(),
        Sii: each_row(snapshot, |_, fit| fit.redundancy),
        slope_h: each_row(snapshot, |row, fit| slopes(row, fit).horizontal),
        slope_v: each_row(snapshot, |row, fit| slopes(row, fit).vertical),
        hpl: levels.hpl_m.into(),
        vpl: levels.vpl_m.into(),
        hdop_i: (0..line.rows()).filter_map(|index| snapshot.hdop_without(index)).map(wide).collect(),
        delta: delta.into(),
        policies,
        raim_available: levels.hpl_m < limit_m,
        ident,
        ident_reason,
    })
}

fn identification<T: Real>(
    snapshot: &Snapshot<'_, T>,
    detection: &Detection<T>,
    thresholds: &Thresholds<'_>,
) -> (isize, &'static str) {
    if !detection.fault() {
        return (-1, "not_detected");
    }
    match identify(snapshot, thresholds) {
        Ok(index) => (index.cast_signed(), "ok"),
        Err(Unidentified::NoRedundancy) => (-1, "dof<2"),
        Err(Unidentified::BelowThreshold) => (-1, "below_threshold"),
        Err(Unidentified::Ambiguous) => (-1, "ambiguous"),
        // These reasons concern only sets of rows, and epochs with orbits.
        Err(Unidentified::NoSet | Unidentified::Budget | Unidentified::Time) => (-1, "no_set"),
    }
}

fn exclude<T: Real>(mut snapshot: Snapshot<'_, T>, thresholds: &Thresholds<'_>) -> Exclusion {
    let exclusion = exclude_sequentially(&mut snapshot, thresholds);
    let (fde_status, settled) = match exclusion.outcome {
        ExclusionOutcome::Passed => ("passed", true),
        ExclusionOutcome::Isolated => ("isolated", true),
        ExclusionOutcome::NotIsolated(_) => ("not_isolated", false),
    };
    Exclusion {
        excluded: exclusion.rows.iter().map(|excluded| excluded.index).collect(),
        fde_status,
        sse_after: wide(snapshot.sse()),
        dof_after: snapshot.dof(),
        x_after: settled.then(|| unknowns(&snapshot)),
    }
}

/// Returns east, north, up, then the clocks in ascending id.
fn unknowns<T: Real>(snapshot: &Snapshot<'_, T>) -> Vec<Number> {
    let position = snapshot.correction();
    let clocks = Constellation::ALL.into_iter().filter_map(|constellation| snapshot.clock_m(constellation));
    position.iter().map(|&coordinate| wide(coordinate)).chain(clocks.map(Number)).collect()
}

fn each_row<T: Real>(snapshot: &Snapshot<'_, T>, value: impl Fn(&Row<T>, &RowFit<T>) -> T) -> Vec<Number> {
    snapshot.rows().map(|(row, fit)| wide(value(row, fit))).collect()
}

fn wide<T: Real>(value: T) -> Number {
    Number(value.widen())
}
