//! Separability: does another set of satellites explain the data as well as the one that was left
//! out, or does a shifted constellation?
//!
//! Compared with dense least squares solved again without each set of up to three, and with a
//! position for each constellation.
#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use nalgebra::{DMatrix, DVector, Vector3};
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::hypotheses::separability::separable;
use raim_core::internals::integrity::raim::isolation::exclusion::leave_out;
use raim_core::internals::least_squares::equations::{LinearEpoch, MAX_ROWS};
use raim_core::internals::numeric::probability::Probability;
use raim_core::internals::numeric::real::Real;
use raim_core::satellite::Constellation;

use crate::noise::Noise;
use crate::sky::SIGMA_M;
use crate::solved::solved;

const SKIES: u64 = 3000;
/// Least number of satellites of each of two constellations from which their positions are
/// compared.
const TESTED: usize = 5;
const SYSTEMS: [Constellation; 2] = [Constellation::Gps, Constellation::Galileo];

/// Relative distance to a limit within which rounding may decide.
const CLOSE: f64 = 1e-3;

fn thresholds() -> Thresholds<'static> {
    let probability = |tail| Probability::new(tail).unwrap();
    Thresholds::from_tables(probability(1e-5), probability(1e-3)).unwrap()
}

/// Satellites as one equation each, and the faulty ones.
struct Sky {
    /// Towards the satellite, the number of its clock, and its residual in m.
    rows: Vec<(Vector3<f64>, usize, f64)>,
    faulty: Vec<usize>,
}

impl Sky {
    /// Returns seven to twelve satellites of one or two constellations; one to three are faulty, by
    /// 10 m to 10 km.
    fn drawn(seed: u64) -> Self {
        let mut noise = Noise(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let mut below = |count: usize| (noise.uniform() * count as f64) as usize;
        let (count, systems, faults) = (7 + below(6), 1 + below(2), 1 + below(3));
        let mut faulty: Vec<usize> = (0..faults).map(|_| below(count)).collect();
        faulty.sort_unstable();
        faulty.dedup();
        let rows = (0..count).map(|index| {
            let (azimuth, sin_elevation) =
                (std::f64::consts::TAU * noise.uniform(), 0.1 + 0.9 * noise.uniform());
            let horizontal = (1.0 - sin_elevation * sin_elevation).sqrt();
            let towards = Vector3::new(horizontal * azimuth.sin(), horizontal * azimuth.cos(), sin_elevation);
            let bias_m = if faulty.contains(&index) { 10.0 * 1e3_f64.powf(noise.uniform()) } else { 0.0 };
            let sign = if noise.uniform() < 0.5 { -1.0 } else { 1.0 };
            (towards, index % systems, SIGMA_M * noise.normal() + sign * bias_m)
        });
        Self { rows: rows.collect(), faulty }
    }

    /// Returns true if the core finds the faulty satellites separable.
    fn is_separable<T: Real>(&self) -> bool {
        let mut epoch = LinearEpoch::<T, MAX_ROWS>::new();
        for &(towards, clock, residual_m) in &self.rows {
            epoch.satellite(SYSTEMS[clock], towards, residual_m, SIGMA_M).unwrap();
        }
        let mut snapshot = solved(epoch).unwrap();
        let exclusion = leave_out(&mut snapshot, &self.faulty, &thresholds());
        assert_eq!(exclusion.rows.len(), self.faulty.len());
        separable(&mut snapshot, &exclusion, &thresholds())
    }

    /// Returns the design matrix in sigmas, of all rows but some.
    fn design(&self, without: &[usize]) -> DMatrix<f64> {
        let kept: Vec<_> = self.kept(without).collect();
        let clocks = 1 + self.rows.iter().map(|&(_, clock, _)| clock).max().unwrap();
        DMatrix::from_fn(kept.len(), 3 + clocks, |row, column| {
            let (towards, clock, _) = kept[row];
            let entry = if column < 3 { -towards[column] } else { f64::from(u8::from(clock + 3 == column)) };
            entry / SIGMA_M
        })
    }

    fn kept(&self, without: &[usize]) -> impl Iterator<Item = (Vector3<f64>, usize, f64)> {
        let kept = self.rows.iter().enumerate().filter(|(index, _)| !without.contains(index));
        kept.map(|(_, row)| *row)
    }

    /// Returns the sum of squares and degrees of freedom without a set.
    fn left(&self, without: &[usize]) -> (f64, usize) {
        let design = self.design(without);
        let residuals = DVector::from_iterator(design.nrows(), self.kept(without).map(|(.., m)| m / SIGMA_M));
        let solved = design.clone().svd(true, true).solve(&residuals, 1e-12).unwrap();
        let clocks = (0..SYSTEMS.len()).filter(|&clock| self.kept(without).any(|row| row.1 == clock)).count();
        ((&residuals - &design * solved).norm_squared(), design.nrows() - 3 - clocks)
    }

    /// Returns the sum of squares of all rows with a position for each of two constellations. Four
    /// satellites or fewer always agree on one; `None` if only those are to blame.
    fn left_by_places(&self) -> Option<(f64, usize)> {
        let of = |clock: usize| {
            let others = self.rows.iter().enumerate().filter(|(_, row)| row.1 != clock);
            let without: Vec<usize> = others.map(|(index, _)| index).collect();
            let is_tested = self.rows.len() - without.len() >= TESTED;
            let has_blamed = self.faulty.iter().any(|row| !without.contains(row));
            is_tested.then_some((without, has_blamed))
        };
        if self.rows.iter().all(|row| row.1 == 0) {
            return None;
        }
        let parts: Vec<_> = (0..SYSTEMS.len()).filter_map(of).collect();
        let left = parts.iter().map(|(without, _)| self.left(without));
        let total = left.fold((0.0, 0), |total, left| (total.0 + left.0, total.1 + left.1));
        parts.iter().any(|&(_, has_blamed)| has_blamed).then_some(total)
    }

    /// Returns `I − A(AᵀA)⁻¹Aᵀ`.
    fn projection(&self) -> DMatrix<f64> {
        let design = self.design(&[]);
        let normal = (design.transpose() * &design).try_inverse().unwrap();
        DMatrix::identity(design.nrows(), design.nrows()) - &design * normal * design.transpose()
    }

    /// Returns the smallest eigenvalue of the block of the projection that belongs to a set: 0 where
    /// its rows are needed.
    fn redundancy(projection: &DMatrix<f64>, set: &[usize]) -> f64 {
        let block = DMatrix::from_fn(set.len(), set.len(), |row, column| projection[(set[row], set[column])]);
        block.symmetric_eigenvalues().min()
    }

    /// Returns true if no other set of as many satellites or fewer passes the test within `T_d²`,
    /// and no separate positions do, or beside one satellite with less. `None` if rounding decides.
    fn is_unrivalled(&self) -> Option<bool> {
        let thresholds = thresholds();
        let margin = thresholds.w_test::<f64>(self.rows.len()).unwrap().powi(2);
        let projection = self.projection();
        let (found, _) = self.left(&self.faulty);
        let near = |value: f64, limit: f64| (value - limit).abs() < CLOSE * limit;
        let mut unrivalled = true;
        if let Some((sse, dof)) = self.left_by_places() {
            let most = found + if self.faulty.len() > 1 { margin } else { 0.0 };
            let threshold = thresholds.tau1(dof)?;
            if near(sse, most) || near(sse, threshold) {
                return None;
            }
            unrivalled &= sse > most || sse > threshold;
        }
        for set in sets(self.rows.len(), self.faulty.len()) {
            let redundancy = Self::redundancy(&projection, &set);
            if set.iter().all(|row| self.faulty.contains(row)) || redundancy < f64::UNTESTABLE / 2.0 {
                continue;
            }
            let (sse, dof) = self.left(&set);
            let Some(threshold) = thresholds.tau1(dof) else { continue };
            if sse > 2.0 * (found + margin + threshold) {
                continue;
            }
            if redundancy < 2.0 * f64::from(f32::UNTESTABLE)
                || near(sse, found + margin)
                || near(sse, threshold)
            {
                return None;
            }
            unrivalled &= sse > found + margin || sse > threshold;
        }
        Some(unrivalled)
    }
}

/// Returns all sets of 1 to `largest` of the rows.
fn sets(rows: usize, largest: usize) -> Vec<Vec<usize>> {
    let masks = (1_u32..1 << rows).filter(|mask| mask.count_ones() as usize <= largest);
    masks.map(|mask| (0..rows).filter(|row| mask >> row & 1 == 1).collect()).collect()
}

#[test]
fn a_set_is_separable_where_no_other_explains_the_data_as_well() {
    let mut seen = [[0_usize; 2]; 3];
    for seed in 0..SKIES {
        let sky = Sky::drawn(seed);
        if Sky::redundancy(&sky.projection(), &sky.faulty) < 0.01 {
            continue;
        }
        let Some(want) = sky.is_unrivalled() else { continue };
        assert_eq!((sky.is_separable::<f64>(), sky.is_separable::<f32>()), (want, want), "seed {seed}");
        seen[sky.faulty.len() - 1][usize::from(want)] += 1;
    }
    // Both answers, for each number of faults.
    assert!(seen.iter().flatten().all(|&count| count > 40), "{seen:?}");
}
