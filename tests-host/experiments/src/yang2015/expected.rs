//! Table 1 by expectation: exact, with the day in steps of 300 s.
//!
//! ```text
//! false alarms = Σ samples · Q(τ; ν)      missed = Σ samples · mean_i G(τ; ν, (b/σ)² S_ii)
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `Q`, `G` | upper tail of χ², lower tail of the non-central one ([`raim::second_opinion::chi_square`]) | – |
//! | `τ` | threshold of the core | – |
//! | `S_ii` | redundancy number of the faulty satellite, each in view with equal probability | – |
//! | `b` | fault | m |
//!
//! The geometry of a step represents its 300 samples of one second.

use std::ops::Range;

use raim::in_order::Together as _;
use raim::second_opinion::chi_square::{noncentral_lower_tail, upper_tail};
use raim_core::internals::least_squares::Snapshot;

use super::case::{CASES, Case, Errors, ErrorsByCase, FAULT_M, FAULT_S, POLICIES};
use super::grid::{CELLS, Cell, Sky, pose};
use super::{ROWS, SIGMA_M};

/// Time that one geometry represents, s.
const STEP_S: f64 = 300.0;
/// Number of steps of a day.
const STEPS: usize = 288;

/// Expectation of table 1.
#[derive(Clone, Copy, Default)]
pub(super) struct Expectation {
    /// Expected counts.
    pub(super) tally: ErrorsByCase,
    /// Number of geometries in which no threshold meets both probabilities, by case.
    pub(super) unavailable: [usize; CASES],
}

impl Expectation {
    /// Number of all geometries.
    pub(super) const GEOMETRIES: usize = STEPS * CELLS;

    /// Returns the expectation over a day.
    pub(super) fn of_day(cases: &[Case], sky: &Sky, cells: &[Cell]) -> anyhow::Result<Self> {
        of_steps(0..STEPS, |t_s| Self::of_step(cases, sky, cells, 0.0, t_s))
    }

    /// Returns the expectation of a step. Time counts from a day's origin, as does the fault.
    fn of_step(cases: &[Case], sky: &Sky, cells: &[Cell], origin_s: f64, t_s: f64) -> anyhow::Result<Self> {
        let positions = sky.positions(origin_s + t_s);
        let mut step = Self::default();
        for cell in cells {
            let mut workspace = pose::<f64>(&cell.directions(sky, &positions), |_| 0.0)?;
            let snapshot = workspace.solve()?;
            for (index, case) in cases.iter().enumerate() {
                step.unavailable[index] += usize::from(!case.is_available(&snapshot));
                for (policy_index, &policy) in POLICIES.iter().enumerate() {
                    let errors =
                        errors(case.threshold(policy, &snapshot)?, &snapshot, FAULT_S.contains(&t_s));
                    step.tally.add(index, policy_index, cell.row, errors);
                }
            }
        }
        Ok(step)
    }

    fn plus(&self, other: &Self) -> Self {
        let unavailable = std::array::from_fn(|case| self.unavailable[case] + other.unavailable[case]);
        Self { tally: self.tally.plus(&other.tally), unavailable }
    }
}

/// Returns the misses that each threshold of one case expects during the fault, on the day that
/// begins at `origin_s`.
pub(super) fn missed_on(case: &Case, sky: &Sky, cells: &[Cell], origin_s: f64) -> anyhow::Result<[f64; 2]> {
    let steps = (FAULT_S.start / STEP_S) as usize..(FAULT_S.end / STEP_S) as usize;
    let cases = std::slice::from_ref(case);
    let tally = of_steps(steps, |t_s| Expectation::of_step(cases, sky, cells, origin_s, t_s))?.tally;
    Ok([0, 1].map(|policy| tally.total(0, policy).missed))
}

fn of_steps(
    steps: Range<usize>,
    of_step: impl Fn(f64) -> anyhow::Result<Expectation> + Sync,
) -> anyhow::Result<Expectation> {
    let each = steps.together(|step| of_step(step as f64 * STEP_S));
    let each: Vec<Expectation> = each.collect::<anyhow::Result<_>>()?;
    // The sum is taken in order, so that rounding is the same on every machine.
    Ok(each.iter().fold(Expectation::default(), |sum, step| sum.plus(step)))
}

/// Returns the expected errors of the samples that one geometry represents.
fn errors(tau: f64, snapshot: &Snapshot<'_, f64, ROWS>, faulty: bool) -> Errors {
    if faulty {
        Errors { missed: STEP_S * missed(tau, snapshot), false_alarms: 0.0 }
    } else {
        Errors { false_alarms: STEP_S * upper_tail(tau, snapshot.dof()), missed: 0.0 }
    }
}

/// Returns the probability to miss the fault: the mean over the satellites that may have it.
fn missed(tau: f64, snapshot: &Snapshot<'_, f64, ROWS>) -> f64 {
    let size = (FAULT_M / SIGMA_M).powi(2);
    let of_satellite = |redundancy: f64| noncentral_lower_tail(tau, snapshot.dof(), size * redundancy).0;
    snapshot.rows().map(|(_, fit)| of_satellite(fit.redundancy)).sum::<f64>() / snapshot.used() as f64
}
