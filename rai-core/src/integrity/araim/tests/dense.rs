//! Solutions without any set of events, against dense least squares.

use std::prelude::rust_2024::*;
use std::{format, println};

use nalgebra::{DMatrix, DVector};

use super::{Dice, Each, Sky, close, sky, solutions, watched};
use crate::integrity::araim::modes::{Hypothesis, Mode, ROWS, row};
use crate::integrity::araim::subsets::SubsetSolutions;
use crate::integrity::araim::{Allocation, Prior, Priors};
use crate::least_squares::Workspace;

/// Gains (three rows of `S`) and position.
type Dense = (DMatrix<f64>, DVector<f64>);

/// Returns the result of dense least squares with a column for each clock.
fn dense(sky: &Sky, taken: u64) -> Dense {
    let kept: Vec<usize> = (0..sky.priors.len()).filter(|index| taken >> index & 1 == 0).collect();
    let mut clocks: Vec<usize> = kept.iter().map(|&index| sky.constellations[index]).collect();
    clocks.sort_unstable();
    clocks.dedup();
    let rows = sky.epoch.rows();
    let design = DMatrix::from_fn(kept.len(), 3 + clocks.len(), |i, j| {
        let index = kept[i];
        if j < 3 {
            rows[index].design[j]
        } else {
            f64::from(u8::from(clocks[j - 3] == sky.constellations[index]))
        }
    });
    let weights =
        DMatrix::from_diagonal(&DVector::from_iterator(kept.len(), kept.iter().map(|&i| rows[i].weight)));
    let normal = design.transpose() * &weights * &design;
    let gains = normal.try_inverse().expect("a position") * design.transpose() * weights;
    let mut full = DMatrix::zeros(3, sky.priors.len());
    for (column, &index) in kept.iter().enumerate() {
        for axis in 0..3 {
            full[(axis, index)] = gains[(axis, column)];
        }
    }
    let measured = DVector::from_iterator(sky.priors.len(), rows.iter().map(|row| row.residual));
    let position = &full * measured;
    (full, position)
}

/// Returns the same without the rows that a hypothesis loses.
fn dense_without(sky: &Sky, hypothesis: Hypothesis) -> Dense {
    let lost = (0..sky.priors.len()).filter(|&i| hypothesis.constellations >> sky.constellations[i] & 1 != 0);
    dense(sky, lost.chain(hypothesis.rows()).fold(0, |set, index| set | row(index)))
}

fn compare(
    sky: &Sky,
    (all, at_all): &Dense,
    (hypothesis, (without, at)): &(Hypothesis, Dense),
    solutions: &mut SubsetSolutions<'_, f64, ROWS>,
) {
    let hypothesis = *hypothesis;
    let have = solutions.without(hypothesis).expect("a solution");
    let bound = solutions.bias_bound();
    let bias = solutions.bias();
    for axis in 0..3 {
        let (mut variance, mut separation, mut want_bias) = (0.0, 0.0, 0.0);
        for (index, (row, prior)) in sky.epoch.rows().iter().zip(&sky.priors).enumerate() {
            let (gain, moved) = (without[(axis, index)], without[(axis, index)] - all[(axis, index)]);
            variance += gain * gain / row.weight;
            separation += moved * moved * prior.accuracy_m * prior.accuracy_m;
            want_bias += gain.abs() * prior.bias_m;
        }
        let what = format!("{hypothesis:?} axis {axis}");
        close(&what, have.variance[axis] / variance, 1.0, 1e-8);
        close(&what, (have.separation[axis] - separation) / variance, 0.0, 1e-8);
        let shift = (have.shift[axis] - (at[axis] - at_all[axis])) / variance.sqrt();
        close(&what, shift, 0.0, 1e-7);
        close(&what, bias[axis] / want_bias, 1.0, 1e-8);
        if let Some(bound) = bound {
            assert!(
                bound[axis] >= want_bias * (1.0 - 1e-9),
                "{what}: bound {} below {want_bias}",
                bound[axis]
            );
        }
    }
}

#[test]
fn every_set_of_three_events_is_as_dense_least_squares_has_it() {
    let mut dice = Dice(11);
    let mut compared = 0;
    for _ in 0..6 {
        let sky = sky(&mut dice, 15);
        let mut workspace = Workspace::of(sky.epoch.clone());
        let snapshot = workspace.solve().expect("a position");
        let constellations = [1e-4, 1e-4, 1e-4, 1e-4];
        // Faults so likely that three at once must be monitored, and hardly any may be unmonitored.
        let priors: Vec<_> = sky.priors.iter().map(|&prior| Prior { fault: 0.05, ..prior }).collect();
        let all = Priors { satellites: &priors, constellations };
        let allocation = Allocation {
            unmonitored_probability: 1e-12,
            consolidation: 0.0,
            ..Allocation::vertical_guidance()
        };
        let monitored = watched(&snapshot, &all, &allocation);
        let mut solutions = solutions(&snapshot, &sky.priors);
        let mut hypotheses = Vec::new();
        let _ = monitored.modes.visit(
            &monitored.modes.remains(0),
            &(1..=3),
            &|_| true,
            &mut Each(|mode: &Mode<_>| {
                if monitored.leaves_enough(monitored.modes.taken_by(mode.hypothesis), 0) {
                    hypotheses.push(mode.hypothesis);
                }
                core::ops::ControlFlow::Continue(())
            }),
        );
        let all = dense(&sky, 0);
        let wanted: Vec<_> =
            hypotheses.into_iter().map(|hypothesis| (hypothesis, dense_without(&sky, hypothesis))).collect();
        // Intermediate results of neighbours are kept: any order must give the same.
        for step in [1, 2, 7] {
            for offset in 0..step {
                for one in wanted.iter().skip(offset).step_by(step) {
                    compare(&sky, &all, one, &mut solutions);
                    compared += 1;
                }
            }
        }
        wanted.iter().rev().for_each(|one| compare(&sky, &all, one, &mut solutions));
    }
    println!("{compared} sets");
    assert!(compared > 3000, "{compared} sets");
}
