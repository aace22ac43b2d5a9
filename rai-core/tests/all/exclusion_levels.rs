//! Exclusion levels against least squares with a column for every rival explanation.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::f64::consts::TAU;

use nalgebra::{DMatrix, Vector3};
use proptest::prelude::*;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::exclusion_levels::exclusion_levels;
use raim_core::internals::integrity::raim::levels::{KFactors, LevelInputs, Levels};
use raim_core::internals::least_squares::Workspace;
use raim_core::internals::least_squares::equations::LinearEpoch;
use raim_core::internals::numeric::real::Real;
use raim_core::report::ProtectionLevels;
use raim_core::requirements::Requirements;
use raim_core::satellite::Constellation;

use crate::sky::CAPACITY;

/// Singular value, of a design in units of its sigmas, below which a column adds nothing.
const NO_COLUMN: f64 = 1e-9;

/// Redundancy below which a bias is hardly seen: the comparison then shows rounding alone.
const HARDLY: f64 = 1e-4;

/// Direction east, north, up; constellation; standard deviation in m.
type Range = ([f64; 3], usize, f64);

fn workspace<T: Real>(ranges: &[Range]) -> Workspace<T, CAPACITY> {
    let mut epoch = LinearEpoch::new();
    for &(sight, system, sigma_m) in ranges {
        epoch.satellite(Constellation::ALL[system], Vector3::from(sight), 0.0, sigma_m).unwrap();
    }
    Workspace::of(epoch)
}

fn levels<T: Real>(ranges: &[Range]) -> Option<ProtectionLevels> {
    let (thresholds, factors) = (thresholds(), factors());
    let mut workspace = workspace::<T>(ranges);
    exclusion_levels(&mut workspace.solve().ok()?, &thresholds, Levels::Bound, &factors)
}

fn thresholds() -> Thresholds<'static> {
    let Requirements { false_alarm, missed_detection, .. } = Requirements::non_precision_approach();
    Thresholds::from_tables(false_alarm, missed_detection).unwrap()
}

fn factors<T: Real>() -> KFactors<T> {
    let requirements = Requirements::non_precision_approach();
    KFactors::new(requirements.missed_detection, requirements.fault_free_risk)
}

/// A model of the ranges: a position and a clock for each constellation, and more columns.
struct Model<'r> {
    ranges: &'r [Range],
    columns: Vec<Vec<f64>>,
}

impl<'r> Model<'r> {
    fn new(ranges: &'r [Range]) -> Self {
        let column = |of: &dyn Fn(&Range) -> f64| ranges.iter().map(of).collect();
        let mut columns: Vec<Vec<f64>> = (0..3).map(|axis| column(&|range| range.0[axis])).collect();
        for system in 0..Constellation::COUNT {
            columns.push(column(&|range| f64::from(u8::from(range.1 == system))));
        }
        Self { ranges, columns }
    }

    /// Adds a bias of one range.
    fn with_bias(mut self, of: usize) -> Self {
        self.columns.push((0..self.ranges.len()).map(|row| f64::from(u8::from(row == of))).collect());
        self
    }

    /// Adds another position of a constellation.
    fn with_shift(mut self, of: usize) -> Self {
        for axis in 0..3 {
            let east_north_or_up = |range: &Range| if range.1 == of { range.0[axis] } else { 0.0 };
            self.columns.push(self.ranges.iter().map(east_north_or_up).collect());
        }
        self
    }

    /// Returns the degrees of freedom, and the matrix from normalised errors to motion and to
    /// residuals.
    fn solve(&self) -> (usize, DMatrix<f64>, DMatrix<f64>) {
        let rows = self.ranges.len();
        let normalised = |row: usize, column: usize| self.columns[column][row] / self.ranges[row].2;
        let design = DMatrix::from_fn(rows, self.columns.len(), normalised);
        let inverse = design.clone().pseudo_inverse(NO_COLUMN).unwrap();
        let projection = DMatrix::identity(rows, rows) - &design * &inverse;
        (projection.trace().round() as usize, inverse, projection)
    }
}

/// Returns the constellations of which another position is a rival: of two, one suffices.
fn shiftable(ranges: &[Range]) -> Vec<usize> {
    let of = |system: usize| ranges.iter().filter(|range| range.1 == system).count();
    let systems: Vec<usize> = (0..Constellation::COUNT).filter(|&system| of(system) > 0).collect();
    let others_have_more_than_clocks = |&system: &usize| ranges.len() - of(system) > systems.len() - 1;
    systems.iter().copied().filter(|&system| of(system) > 1).filter(others_have_more_than_clocks).collect()
}

/// Returns the levels by the rule read literally; `None` if a bias is hardly seen anywhere.
fn literal(ranges: &[Range]) -> Option<(f64, f64)> {
    let thresholds = thresholds();
    let squared =
        |dof: usize, shown: f64| (shown > HARDLY).then(|| thresholds.lambda::<f64>(dof).unwrap() / shown);
    let (dof, inverse, projection) = Model::new(ranges).solve();
    // Each rival explanation is solved once, whatever range it is a rival of.
    let biased: Vec<_> = (0..ranges.len()).map(|rival| Model::new(ranges).with_bias(rival).solve()).collect();
    let shifted: Vec<_> = shiftable(ranges)
        .into_iter()
        .map(|system| (system, Model::new(ranges).with_shift(system).solve()))
        .collect();
    let (mut horizontal, mut vertical) = (0.0_f64, 0.0_f64);
    for index in 0..ranges.len() {
        let mut hidden = squared(dof, projection[(index, index)])?;
        for (_, (dof, _, projection)) in biased.iter().enumerate().filter(|(rival, _)| *rival != index) {
            hidden = hidden.max(squared(*dof, projection[(index, index)])?);
        }
        for (system, (dof, _, projection)) in &shifted {
            // Ranges that always agree with each other are no evidence for a shift.
            let part: Vec<usize> = (0..ranges.len())
                .filter(|&row| (ranges[row].1 == *system) == (ranges[index].1 == *system))
                .collect();
            if part.iter().any(|&row| projection[(row, row)] > NO_COLUMN) {
                hidden = hidden.max(squared(*dof, projection[(index, index)])?);
            }
        }
        let bias = hidden.sqrt();
        horizontal = horizontal.max(bias * inverse[(0, index)].hypot(inverse[(1, index)]));
        vertical = vertical.max(bias * inverse[(2, index)].abs());
        let without: Vec<Range> =
            ranges.iter().enumerate().filter(|(row, _)| *row != index).map(|(_, range)| *range).collect();
        let mut workspace = workspace::<f64>(&without);
        let snapshot = workspace.solve().ok()?;
        let factors = factors();
        let inputs = LevelInputs::of(&snapshot, Levels::Bound, &factors);
        let levels = inputs.protect(thresholds.lambda(snapshot.dof())?);
        horizontal = horizontal.max(levels.hpl_m);
        vertical = vertical.max(levels.vpl_m);
    }
    Some((horizontal, vertical))
}

/// Returns so many ranges of up to so many constellations.
fn any_ranges(systems: usize) -> impl Strategy<Value = Vec<Range>> {
    let range = (0.0..TAU, 0.08_f64..1.0, 0..systems, 0.5_f64..10.0);
    let range = range.prop_map(|(azimuth, up, system, sigma_m)| {
        let level = (1.0 - up * up).sqrt();
        ([level * azimuth.sin(), level * azimuth.cos(), up], system, sigma_m)
    });
    prop::collection::vec(range, 7..24)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn levels_are_those_of_the_rule_read_literally(
        ranges in (1_usize..=3).prop_flat_map(any_ranges),
    ) {
        let want = literal(&ranges);
        prop_assume!(want.is_some());
        let (hel_m, vel_m) = want.unwrap();
        let have = levels::<f64>(&ranges);
        prop_assert!(have.is_some(), "want {hel_m} m, {vel_m} m");
        let have = have.unwrap();
        prop_assert!((have.hpl_m / hel_m - 1.0).abs() < 1e-6, "{} m, not {hel_m} m", have.hpl_m);
        prop_assert!((have.vpl_m / vel_m - 1.0).abs() < 1e-6, "{} m, not {vel_m} m", have.vpl_m);
        if let Some(single) = levels::<f32>(&ranges).filter(|_| hel_m < 700.0) {
            prop_assert!((single.hpl_m / hel_m - 1.0).abs() < 0.03, "{} m, not {hel_m} m", single.hpl_m);
        }
    }
}

/// Returns satellites around the horizon, some of them high: a constellation every so many degrees.
fn ring(systems: &[usize]) -> Vec<Range> {
    let at = |(index, &system): (usize, &usize)| {
        let (azimuth, up) = (2.4 * index as f64, 0.15 + 0.13 * (index % 6) as f64);
        let level = f64::sqrt(1.0 - up * up);
        ([level * azimuth.sin(), level * azimuth.cos(), up], system, 2.0)
    };
    systems.iter().enumerate().map(at).collect()
}

#[test]
fn every_row_is_taken_back() {
    let mut workspace = workspace::<f32>(&ring(&[0, 0, 0, 0, 0, 1, 1, 1, 1, 1]));
    let mut snapshot = workspace.solve().unwrap();
    let (rows, covariance) = (snapshot.equations().to_vec(), *snapshot.covariance());
    assert!(exclusion_levels(&mut snapshot, &thresholds(), Levels::Bound, &factors()).is_some());
    assert_eq!((snapshot.equations(), *snapshot.covariance()), (&rows[..], covariance));
}

#[test]
fn level_is_above_the_protection_level_and_absent_where_a_satellite_cannot_be_told() {
    let many = ring(&[0; 10]);
    let level = levels::<f64>(&many).unwrap();
    let mut workspace = workspace::<f64>(&many);
    let snapshot = workspace.solve().unwrap();
    let factors = factors();
    let protection =
        LevelInputs::of(&snapshot, Levels::Bound, &factors).protect(thresholds().lambda(6).unwrap());
    assert!(level.hpl_m > protection.hpl_m && level.vpl_m > protection.vpl_m, "{level:?} {protection:?}");
    // One degree of freedom detects, and tells nobody apart.
    assert_eq!(levels::<f64>(&ring(&[0; 5])), None);
    // Of two satellites with a clock of their own, either explains what the other does.
    assert_eq!(levels::<f64>(&ring(&[0, 0, 0, 0, 0, 0, 0, 0, 1, 1])), None);
    // A single one moves nothing.
    assert!(levels::<f64>(&ring(&[0, 0, 0, 0, 0, 0, 0, 0, 0, 1])).is_some());
}
