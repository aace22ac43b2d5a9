//! The order of the satellites hardly changes the levels.

use std::prelude::rust_2024::*;

use super::{Dice, close, sky};
use crate::integrity::araim::modes::{ROWS, members};
use crate::integrity::araim::{Allocation, Priors, judge};
use crate::least_squares::Workspace;
use crate::least_squares::equations::LinearEpoch;
use crate::satellite::Constellation;

#[test]
fn levels_do_not_depend_on_the_order_of_the_satellites() {
    let mut dice = Dice(3);
    let sky = sky(&mut dice, 16);
    let levels = |order: &[usize]| {
        let mut epoch = LinearEpoch::<f64, ROWS>::new();
        for &index in order {
            let equation = sky.epoch.rows()[index];
            let constellation = Constellation::ALL[sky.constellations[index]];
            epoch
                .satellite(constellation, -equation.design, equation.residual, equation.sigma)
                .expect("a row");
        }
        let priors: Vec<_> = order.iter().map(|&index| sky.priors[index]).collect();
        let mut workspace = Workspace::of(epoch);
        let mut snapshot = workspace.solve().expect("a position");
        let priors = Priors { satellites: &priors, constellations: [1e-4; 4] };
        judge(&mut snapshot, &priors, &Allocation::vertical_guidance()).expect("a judgement").whole
    };
    let forwards: Vec<usize> = (0..16).collect();
    // Reversed within each constellation, because the last monitored pairs depend on the listing.
    let backwards: Vec<usize> = (0..16).rev().collect();
    let (one, other) = (levels(&forwards), levels(&backwards));
    assert_eq!(one.modes, other.modes);
    close("HPL", one.hpl_m() / other.hpl_m(), 1.0, 2e-2);
    close("VPL", one.vpl_m() / other.vpl_m(), 1.0, 2e-2);
    assert!(members(0b1011).eq([0, 1, 3]));
}
