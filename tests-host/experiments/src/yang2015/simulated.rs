//! Table 1 by simulation: every second of the day in every cell through the core, as the target
//! runs it.
//!
//! Each second has its own stream of random numbers, so that the counts do not depend on the
//! division of the work.

use indicatif::ProgressBar;
use raim::in_order::Together as _;
use raim_core::internals::integrity::raim::detection::Detection;
use raim_core::internals::integrity::raim::detection::threshold::policy::Policy;
use raim_core::internals::least_squares::Snapshot;
use raim_core::internals::numeric::real::Real as _;
use rand::RngExt as _;
use rand_distr::{Distribution as _, StandardNormal};

use super::case::{Case, Errors, ErrorsByCase, FAULT_M, FAULT_S};
use super::grid::{CELLS, Cell, Sky, pose};
use super::{ROWS, SIGMA_M};
use crate::draw::generator;

/// Seed of all random choices.
pub(super) const SEED: u64 = 2015;
/// Length of a day, s.
pub(super) const DAY_S: f64 = 86_400.0;

/// Returns the number of simulated seconds, every `stride_s`-th of the day.
pub(super) fn seconds(stride_s: usize) -> usize {
    (DAY_S as usize).div_ceil(stride_s)
}

/// Returns the number of samples with the fault among them, in all cells.
pub(super) fn faulty_samples(stride_s: usize) -> usize {
    let times = (0..seconds(stride_s)).map(|number| (number * stride_s) as f64);
    CELLS * times.filter(|t_s| FAULT_S.contains(t_s)).count()
}

/// Counts errors in every `stride_s`-th second.
pub(super) fn tally(
    cases: &[Case],
    sky: &Sky,
    cells: &[Cell],
    stride_s: usize,
    bar: &ProgressBar,
) -> anyhow::Result<ErrorsByCase> {
    let second = |number: usize| {
        let tally = of_second(cases, sky, cells, number * stride_s);
        bar.inc(1);
        tally
    };
    (0..seconds(stride_s)).together_sum(second, ErrorsByCase::default(), |a, b| a.plus(&b))
}

fn of_second(cases: &[Case], sky: &Sky, cells: &[Cell], second: usize) -> anyhow::Result<ErrorsByCase> {
    let positions = sky.positions(second as f64);
    let faulty = FAULT_S.contains(&(second as f64));
    let mut random = generator(SEED, second as u64);
    let mut tally = ErrorsByCase::default();
    for cell in cells {
        let directions = cell.directions(sky, &positions);
        let chosen = faulty.then(|| random.random_range(0..directions.len()));
        let mut workspace = pose::<f32>(&directions, |index| {
            let noise: f64 = StandardNormal.sample(&mut random);
            SIGMA_M * noise + if chosen == Some(index) { FAULT_M } else { 0.0 }
        })?;
        let snapshot = workspace.solve()?;
        for (index, case) in cases.iter().enumerate() {
            let classic = detects(case, Policy::T1, &snapshot)?;
            // T_OP is never below T1, so it does not detect what T1 does not detect.
            let optimal = classic && detects(case, Policy::TOp, &snapshot)?;
            tally.add(index, 0, cell.row, errors(faulty, classic));
            tally.add(index, 1, cell.row, errors(faulty, optimal));
        }
    }
    Ok(tally)
}

fn detects(case: &Case, policy: Policy, snapshot: &Snapshot<'_, f32, ROWS>) -> anyhow::Result<bool> {
    let threshold = f32::narrow(case.threshold(policy, snapshot)?);
    Ok(Detection { sse: snapshot.sse(), threshold, dof: snapshot.dof() }.fault())
}

fn errors(faulty: bool, detected: bool) -> Errors {
    let one = |counted: bool| f64::from(u8::from(counted));
    Errors { false_alarms: one(!faulty && detected), missed: one(faulty && !detected) }
}
