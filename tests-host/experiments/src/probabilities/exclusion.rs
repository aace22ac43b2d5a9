//! Failed exclusions of the satellite that is hardest to exclude.
//!
//! The module's exclusion level promises that a fault which moves the position by the level or more
//! is excluded. Two series of faults test this: those that move the position by the alert limit or
//! more, and those that every other explanation just fails to explain. The second is the harder one
//! if a level without a satellite is larger than what it takes to tell the satellites apart.
//!
//! ```text
//! n² = max( λ(ν)/S_ii,  λ(ν−1)/(S_ii − S_ij²/S_jj),  λ(ν')/S'_ii )         told apart: a bias of n sigmas
//! ```
//!
//! The symbols are those of [`exclusion_levels`]. Here the projections are those of dense least
//! squares, for `S'` of each constellation alone.

use anyhow::{Context as _, Result};
use nalgebra::{Vector2, Vector3};
use raim_core::frame::Enu;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::exclusion_levels::exclusion_levels;
use raim_core::internals::integrity::raim::levels::{KFactors, Levels};
use raim_core::internals::least_squares::Workspace;
use raim_core::internals::least_squares::equations::LinearEpoch;
use raim_core::requirements::Requirements;

use super::CAPACITY;
use super::geometry::{Geometry, UNTESTABLE};
use crate::{Finding, Interval, Judgement, Row};

/// Required probability that a fault is not excluded, as that of a missed alert.
pub(super) const FAILED_EXCLUSION: f64 = 1e-3;

/// Sizes of the bias, as multiples of the one that moves the position by the alert limit.
const OF_LIMIT: [f64; 5] = [1.0, 1.25, 1.5, 2.0, 4.0];

/// Sizes of the bias, as multiples of the one that is told apart.
const TOLD_APART: [f64; 2] = [1.0, 1.1];

/// Number of rates of failed exclusions.
pub(super) const RATES: usize = OF_LIMIT.len() + TOLD_APART.len();

/// True for each size of the fault after which nothing was promised.
pub(super) type Failures = [bool; RATES];

/// The satellite whose fault moves the position farthest before it is the only explanation.
#[derive(Clone, Copy)]
pub(super) struct HardestExclusion {
    /// Index among the rows.
    pub(super) index: usize,
    /// Horizontal exclusion level of the module, m.
    pub(super) level_m: f64,
    /// Bias that is told apart, m.
    bias_m: f64,
    /// Horizontal motion of the position by this bias, m.
    moved_m: f64,
}

impl HardestExclusion {
    /// Returns the hardest exclusion of a geometry, or `None` if the module has no level.
    pub(super) fn of(geometry: &Geometry, requirements: &Requirements) -> Result<Option<Self>> {
        let Requirements { false_alarm, missed_detection, .. } = *requirements;
        let thresholds = Thresholds::from_tables(false_alarm, missed_detection)?;
        let Some(level_m) = level_m(geometry, requirements, &thresholds)? else { return Ok(None) };
        let shifts = Shifts::of(geometry);
        let told = |index: usize| told_apart(geometry, shifts.as_ref(), &thresholds, index);
        let all = (0..geometry.rows.len()).filter_map(told);
        let hardest = all.max_by(|(.., a), (.., b)| a.total_cmp(b));
        let (index, bias_m, moved_m) = hardest.context("a level, but no satellite is told apart")?;
        Ok(Some(Self { index, level_m, bias_m, moved_m }))
    }

    /// Judges a bias of each size. `fails` returns true if nothing is promised.
    pub(super) fn failures(
        &self,
        hal_m: f64,
        mut fails: impl FnMut(f64) -> Result<bool>,
    ) -> Result<Failures> {
        let at_limit_m = hal_m / self.moved_m * self.bias_m;
        let sizes_m = OF_LIMIT.map(|size| size * at_limit_m).into_iter();
        let sizes_m = sizes_m.chain(TOLD_APART.map(|size| size * self.bias_m));
        let mut failures = [false; RATES];
        for (failed, bias_m) in failures.iter_mut().zip(sizes_m) {
            *failed = fails(bias_m)?;
        }
        Ok(failures)
    }
}

/// Returns the horizontal exclusion level that the core computes in the module's precision, m.
fn level_m(
    geometry: &Geometry,
    requirements: &Requirements,
    thresholds: &Thresholds<'_>,
) -> Result<Option<f64>> {
    let factors = KFactors::new(requirements.missed_detection, requirements.fault_free_risk);
    let mut rows = LinearEpoch::<f32, CAPACITY>::new();
    for row in &geometry.rows {
        let Enu { east, north, up } = row.line_of_sight;
        rows.satellite(row.satellite.constellation(), Vector3::new(east, north, up), row.y_m, row.sigma_m)?;
    }
    let mut workspace = Workspace::of(rows);
    let mut snapshot = workspace.solve()?;
    let levels = exclusion_levels(&mut snapshot, thresholds, Levels::Bound, &factors);
    Ok(levels.map(|levels| levels.hpl_m))
}

/// Returns a satellite with the bias that is told apart and the motion by it, m, or `None` for a
/// satellite that is not tested.
fn told_apart(
    geometry: &Geometry,
    shifts: Option<&Shifts>,
    thresholds: &Thresholds<'_>,
    index: usize,
) -> Option<(usize, f64, f64)> {
    let projection = &geometry.dense.projection;
    let shown = projection[(index, index)];
    let lambda = |dof: usize| thresholds.lambda::<f64>(dof);
    let is_rival = |&rival: &usize| rival != index && projection[(rival, rival)] > UNTESTABLE;
    let beside = |rival: usize| shown - projection[(index, rival)].powi(2) / projection[(rival, rival)];
    let least = (0..geometry.rows.len()).filter(is_rival).map(beside).fold(shown, f64::min);
    let mut squared = (lambda(geometry.dof())? / shown).max(lambda(geometry.dof() - 1)? / least.max(0.0));
    if let Some((shifts, shown)) = shifts.and_then(|shifts| shifts.shown[index].map(|shown| (shifts, shown)))
    {
        squared = squared.max(lambda(shifts.dof)? / shown);
    }
    let bias_m = squared.sqrt() * geometry.rows[index].sigma_m;
    let moved = Vector2::new(geometry.dense.gain[(0, index)], geometry.dense.gain[(1, index)]);
    (shown > UNTESTABLE).then(|| (index, bias_m, bias_m * moved.norm()))
}

/// Two constellations with a position each.
struct Shifts {
    /// Degrees of freedom of both.
    dof: usize,
    /// Redundancy of each satellite among its own; `None` if they test nothing.
    shown: Vec<Option<f64>>,
}

impl Shifts {
    /// Returns `None` unless there are two constellations, each with more than its clock.
    fn of(geometry: &Geometry) -> Option<Self> {
        let rows = &geometry.rows;
        let mut systems: Vec<_> = rows.iter().map(|row| row.satellite.constellation()).collect();
        systems.sort_unstable();
        systems.dedup();
        let members = |system| {
            let is_its = move |&index: &usize| rows[index].satellite.constellation() == system;
            (0..rows.len()).filter(is_its).collect::<Vec<usize>>()
        };
        let parts: Vec<_> = systems.into_iter().map(members).collect();
        if parts.len() != 2 || parts.iter().any(|part| part.len() < 2) {
            return None;
        }
        let mut shifts = Self { dof: 0, shown: vec![None; rows.len()] };
        for part in parts {
            let Some(alone) = Geometry::of(part.iter().map(|&index| rows[index]).collect()) else { continue };
            shifts.dof += alone.dof();
            for (place, index) in part.into_iter().enumerate() {
                shifts.shown[index] = Some(alone.dense.projection[(place, place)]);
            }
        }
        Some(shifts)
    }
}

/// Returns a row for each size of the fault. `None` stands for a geometry without exclusion. The
/// rates are among `family` that must hold together.
pub(super) fn rows(failures: &[Option<Failures>], family: usize) -> Vec<Row> {
    let available: Vec<&Failures> = failures.iter().flatten().collect();
    let of_limit = OF_LIMIT.map(|size| format!("bias {size} of the one that moves the position by HAL"));
    let told = TOLD_APART.map(|size| format!("bias {size} of the one that is just told apart"));
    let rate = |(index, size): (usize, String)| {
        let hits = available.iter().filter(|failed| failed[index]).count();
        let expected = FAILED_EXCLUSION * available.len() as f64;
        let relative = |Interval { low, high }| Interval { low: low / expected, high: high / expected };
        let interval = Some(relative(Interval::of_count(hits)));
        let together = relative(Interval::of_one_count_in(family, hits));
        let ours = Finding::Number { value: hits as f64 / expected, decimals: 3, interval };
        Row::new(format!("failed exclusion, {size}, over P_fe"), "", ours, Judgement::Ours)
            .because(format!("{hits} of {} geometries in which exclusion is available", available.len()))
            .holding("interval not above 1", together.low <= 1.0)
    };
    let share = Finding::exact(available.len() as f64 / failures.len() as f64, 3);
    let mut rows =
        vec![Row::new("geometries with an exclusion level within 556 m", "", share, Judgement::Ours)];
    rows.extend(of_limit.into_iter().chain(told).enumerate().map(rate));
    rows
}
