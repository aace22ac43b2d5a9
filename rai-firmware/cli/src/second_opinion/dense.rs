//! Second opinion on the core: plain least squares with all columns, in `f64`, by matrix inversion.
//!
//! It is slow, memory-hungry and obvious, for comparison only. It shares no formula with the core:
//! clocks are columns here, and rows are left out by solving again.

use nalgebra::{DMatrix, DVector};
use raim_core::satellite::Constellation;

/// One range: direction east, north, up; constellation; residual and standard deviation in metres.
#[derive(Clone, Copy, Debug)]
pub struct Range {
    /// Unit vector from the receiver to the satellite.
    pub line_of_sight: [f64; 3],
    /// Constellation whose clock affects it.
    pub constellation: Constellation,
    /// Measured minus predicted, m.
    pub residual_m: f64,
    /// Standard deviation, m.
    pub sigma_m: f64,
}

/// Full least-squares solution of one epoch.
#[derive(Clone, Debug)]
pub struct Dense {
    /// East, north, up, then the clocks in ascending id, m.
    pub unknowns_m: DVector<f64>,
    /// Residuals, m.
    pub residuals_m: DVector<f64>,
    /// Residual projection matrix of the normalised system.
    pub projection: DMatrix<f64>,
    /// Gain: unknowns over ranges.
    pub gain: DMatrix<f64>,
    /// Covariance of the unknowns, m².
    pub covariance_m2: DMatrix<f64>,
    /// Weighted sum of squared residuals.
    pub sse: f64,
    /// Degrees of freedom.
    pub dof: usize,
    /// Dilution of precision, horizontal, unweighted.
    pub hdop: f64,
    /// Dilution of precision, vertical, unweighted.
    pub vdop: f64,
}

/// Solves all columns at once; returns `None` if the matrix cannot be inverted or rows are missing.
pub fn solve(ranges: &[Range]) -> Option<Dense> {
    let mut clocks: Vec<Constellation> = ranges.iter().map(|range| range.constellation).collect();
    clocks.sort_unstable();
    clocks.dedup();
    let columns = 3 + clocks.len();
    let dof = ranges.len().checked_sub(columns)?;
    let design = DMatrix::from_fn(ranges.len(), columns, |row, column| match column {
        0..3 => -ranges[row].line_of_sight[column],
        _ => f64::from(u8::from(ranges[row].constellation == clocks[column - 3])),
    });
    let y = DVector::from_iterator(ranges.len(), ranges.iter().map(|range| range.residual_m));
    let scale = DVector::from_iterator(ranges.len(), ranges.iter().map(|range| 1.0 / range.sigma_m));
    let normalised = DMatrix::from_diagonal(&scale) * &design;
    let covariance_m2 = (normalised.transpose() * &normalised).try_inverse()?;
    let plain = (design.transpose() * &design).try_inverse()?;
    let normalised_gain = &covariance_m2 * normalised.transpose();
    let projection = DMatrix::identity(ranges.len(), ranges.len()) - &normalised * &normalised_gain;
    let gain = normalised_gain * DMatrix::from_diagonal(&scale);
    let first_m = &gain * &y;
    // One step of refinement: otherwise the inverse's rounding of clocks of 1e5 m reaches
    // micrometres.
    let unknowns_m = &first_m + &gain * (&y - &design * &first_m);
    let residuals_m = &y - &design * &unknowns_m;
    let sse = residuals_m.component_mul(&scale).norm_squared();
    let (hdop, vdop) = ((plain[(0, 0)] + plain[(1, 1)]).sqrt(), plain[(2, 2)].sqrt());
    Some(Dense { unknowns_m, residuals_m, projection, gain, covariance_m2, sse, dof, hdop, vdop })
}

/// Solves as [`solve`] does, without the ranges listed.
pub fn solve_without(ranges: &[Range], excluded: &[usize]) -> Option<Dense> {
    let kept: Vec<Range> = ranges
        .iter()
        .enumerate()
        .filter(|(index, _)| !excluded.contains(index))
        .map(|(_, range)| *range)
        .collect();
    solve(&kept)
}
