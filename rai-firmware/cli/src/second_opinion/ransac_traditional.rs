//! Traditional range consensus: every minimal subset of the ranges votes. It is the baseline of
//! [Tian2024] §1.
//!
//! Each subset of `m = 3 + C` ranges gives a solution without redundancy; the other ranges are
//! compared with it. A satellite is faulty if most subsets that contain it are contradicted:
//!
//! ```text
//! x_k = H_k⁻¹ y_k     v_i = h_i x_k − y_i     s_i² = σ_i² + h_i Cov_k h_iᵀ     Cov_k = H_k⁻¹ diag(σ²) H_k⁻ᵀ
//! f_i = contradicted subsets with i,  faulty: f_i ≥ ratio · (subsets with i)
//! ```
//!
//! `C(n, m)` subsets are far too many for a microcontroller, so this runs on the host only, in
//! `f64`, with plain dense matrices. The printed criterion is a root mean square against a limit
//! tuned by hand. Counting the ranges that disagree is the consensus that it stands for. Both are
//! here.
//!
//! [Tian2024]: crate#references

use nalgebra::{DMatrix, DVector};
use raim_core::satellite::Constellation;

use crate::second_opinion::dense::Range;

/// Smallest determinant of a valid subset.
const SINGULAR: f64 = 1e-6;

/// Smallest share of contradicted subsets at which a satellite counts as faulty.
pub const RATIO: f64 = 0.7;

/// Criterion by which the other ranges contradict a subset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Criterion {
    /// More than `min(3, n − m − 2)` of them deviate by this many standard deviations.
    Count {
        /// Two-sided threshold on `|v_i| / s_i`.
        threshold: f64,
    },
    /// The root mean square of `v` reaches a limit, as printed.
    RootMeanSquare {
        /// The limit, m.
        limit_m: f64,
    },
}

/// Result of the vote.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Votes {
    /// Number of subsets with a solution.
    pub valid: usize,
    /// Number of subsets that the others contradict.
    pub contradicted: usize,
    /// Number of contradicted subsets with each range.
    pub contradicted_with: Vec<usize>,
    /// Number of valid subsets with each range.
    pub valid_with: Vec<usize>,
}

impl Votes {
    /// Returns the ranges whose subsets are contradicted with at least this share.
    pub fn faulty(&self, ratio: f64) -> Vec<usize> {
        let counts = self.contradicted_with.iter().zip(&self.valid_with).enumerate();
        let faulty = counts.filter(|&(_, (&bad, &all))| all > 0 && bad as f64 >= ratio * all as f64);
        faulty.map(|(index, _)| index).collect()
    }
}

/// Rows of all unknowns, one for each range.
struct Design {
    rows: DMatrix<f64>,
    residuals_m: DVector<f64>,
    sigmas_m: DVector<f64>,
}

impl Design {
    fn of(ranges: &[Range]) -> Self {
        let occurs = |clock: &Constellation| ranges.iter().any(|range| range.constellation == *clock);
        let clocks: Vec<Constellation> = Constellation::ALL.into_iter().filter(occurs).collect();
        let rows = DMatrix::from_fn(ranges.len(), 3 + clocks.len(), |row, column| match column {
            0..3 => -ranges[row].line_of_sight[column],
            _ => f64::from(u8::from(ranges[row].constellation == clocks[column - 3])),
        });
        let column =
            |value: fn(&Range) -> f64| DVector::from_iterator(ranges.len(), ranges.iter().map(value));
        Self { rows, residuals_m: column(|range| range.residual_m), sigmas_m: column(|range| range.sigma_m) }
    }

    /// Returns the residuals of all ranges from one subset's solution, and their standard
    /// deviations outside it; `None` if the subset gives no solution.
    fn predict(&self, subset: &[usize]) -> Option<(DVector<f64>, DVector<f64>)> {
        let square = self.rows.select_rows(subset);
        let inverse = (square.determinant().abs() > SINGULAR).then(|| square.try_inverse())??;
        let solution_m = &inverse * self.residuals_m.select_rows(subset);
        let spread = &self.rows * inverse * DMatrix::from_diagonal(&self.sigmas_m.select_rows(subset));
        let deviations = |row: usize| self.sigmas_m[row].hypot(spread.row(row).norm());
        let deviations_m = DVector::from_fn(self.rows.nrows(), |row, _| deviations(row));
        Some((&self.rows * solution_m - &self.residuals_m, deviations_m))
    }
}

/// Returns the number of unknowns of these ranges: the size of a minimal subset.
pub fn unknowns(ranges: &[Range]) -> usize {
    Design::of(ranges).rows.ncols()
}

/// Lets subsets vote, all of them ([`combinations`]) or a sample.
pub fn vote(ranges: &[Range], subsets: impl IntoIterator<Item = Vec<usize>>, criterion: Criterion) -> Votes {
    let design = Design::of(ranges);
    let (count, redundancy) = (ranges.len(), ranges.len().saturating_sub(design.rows.ncols()));
    let nothing = || vec![0; count];
    let mut votes = Votes { valid: 0, contradicted: 0, contradicted_with: nothing(), valid_with: nothing() };
    for subset in subsets {
        let Some((residuals_m, deviations_m)) = design.predict(&subset) else { continue };
        let others = || (0..count).filter(|index| !subset.contains(index));
        let contradicted = match criterion {
            Criterion::Count { threshold } => {
                let deviates = |&index: &usize| residuals_m[index].abs() >= threshold * deviations_m[index];
                others().filter(deviates).count() > redundancy.saturating_sub(2).min(3)
            }
            Criterion::RootMeanSquare { limit_m } => {
                let squares: f64 = others().map(|index| residuals_m[index] * residuals_m[index]).sum();
                (squares / redundancy as f64).sqrt() >= limit_m
            }
        };
        votes.valid += 1;
        votes.contradicted += usize::from(contradicted);
        for index in subset {
            votes.valid_with[index] += 1;
            votes.contradicted_with[index] += usize::from(contradicted);
        }
    }
    votes
}

/// Returns all subsets of `size` of the first `count` numbers, in lexicographic order.
pub fn combinations(count: usize, size: usize) -> impl Iterator<Item = Vec<usize>> {
    let first = (size <= count).then(|| (0..size).collect::<Vec<_>>());
    std::iter::successors(first, move |last| {
        let mut next = last.clone();
        // The last element that can still grow; those after it follow it closely.
        let grows = (0..size).rev().find(|&position| next[position] < count - size + position)?;
        let start = next[grows] + 1;
        for (offset, element) in next[grows..].iter_mut().enumerate() {
            *element = start + offset;
        }
        Some(next)
    })
}

/// Returns the number of [`combinations`].
pub fn combination_count(count: usize, size: usize) -> f64 {
    (0..size).fold(1.0, |product, step| product * (count - step) as f64 / (step + 1) as f64).round()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn combinations_come_in_lexicographic_order() {
        let want = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
        assert_eq!(combinations(4, 2).collect::<Vec<_>>(), want);
        assert_eq!(combinations(3, 4).count(), 0);
        assert_eq!((combinations(9, 4).count(), combination_count(9, 4) as usize), (126, 126));
    }

    #[test]
    fn a_fault_without_noise_contradicts_exactly_its_subsets() {
        let directions = [0.3, 1.4, 2.6, 3.9, 5.1, 5.9, 4.4, 0.9];
        let mut ranges: Vec<Range> = (1u8..)
            .zip(directions)
            .map(|(step, azimuth)| {
                let up = 0.1 * f64::from(step);
                let level = (1.0 - up * up).sqrt();
                let line_of_sight = [level * f64::sin(azimuth), level * f64::cos(azimuth), up];
                Range { line_of_sight, constellation: Constellation::Gps, residual_m: 0.0, sigma_m: 1e-3 }
            })
            .collect();
        ranges[2].residual_m = 100.0;
        let votes = vote(&ranges, combinations(8, 4), Criterion::Count { threshold: 5.0 });
        let containing_the_fault = combination_count(7, 3) as usize;
        assert_eq!(votes.contradicted, containing_the_fault);
        assert_eq!(votes.faulty(RATIO), [2]);
    }
}
