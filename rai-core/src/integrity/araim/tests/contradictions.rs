//! The test that dismisses an exclusion because another satellite is still far off.

use std::prelude::rust_2024::*;

use nalgebra::Vector3;

use super::worked_example::EXAMPLE;
use super::{Epoch, solutions};
use crate::integrity::araim::Prior;
use crate::integrity::araim::modes::{Hypothesis, members, row};
use crate::least_squares::Workspace;
use crate::satellite::Constellation;

/// Error of a faulty range, m: hundreds of sigmas.
const FAULT_M: f64 = 1e3;

/// Rows whose exclusion is contradicted if these rows are faulty.
fn contradicted(faulty: &[usize]) -> Vec<usize> {
    let mut epoch = Epoch::new();
    let mut priors = Vec::new();
    for (index, ([east, north, up], constellation, variance_m2, accuracy_m2)) in
        EXAMPLE.into_iter().enumerate()
    {
        let error_m = if faulty.contains(&index) { FAULT_M } else { 0.0 };
        let sight = Vector3::new(east, north, up);
        epoch
            .satellite(Constellation::ALL[constellation], sight, error_m, variance_m2.sqrt())
            .expect("a row");
        priors.push(Prior { accuracy_m: f64::sqrt(accuracy_m2), bias_m: 0.5, fault: 1e-5 });
    }
    let mut workspace = Workspace::of(epoch);
    let snapshot = workspace.solve().expect("a position");
    let mut solutions = solutions(&snapshot, &priors);
    // A threshold of five sigmas.
    let limits = Vector3::repeat(25.0);
    let all = (0..EXAMPLE.len()).fold(0, |set, index| set | row(index));
    let is_contradicted =
        |&index: &usize| solutions.contradict(Hypothesis::of_row(index), all & !row(index), &limits);
    members(all).filter(is_contradicted).collect()
}

#[test]
fn without_the_faulty_satellite_no_other_is_off() {
    for faulty in 0..EXAMPLE.len() {
        let want: Vec<usize> = (0..EXAMPLE.len()).filter(|&index| index != faulty).collect();
        assert_eq!(contradicted(&[faulty]), want, "{faulty} is faulty");
    }
}

#[test]
fn two_faulty_satellites_contradict_every_exclusion_of_one() {
    let all: Vec<usize> = (0..EXAMPLE.len()).collect();
    for (one, other) in [(1, 7), (0, 9), (3, 4)] {
        assert_eq!(contradicted(&[one, other]), all, "{one} and {other} are faulty");
    }
}
