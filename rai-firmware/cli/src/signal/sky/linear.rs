//! Linearised epochs for experiments, without orbits, atmosphere and wire formats.
//!
//! ```text
//! y_i = b_c + σ_i ε_i          h_i = −LOS_i
//! ```
//!
//! The linearisation point is the true position, so that a solved position *is* the position error.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `y` | `Row::y_m` | m, measured minus predicted range |
//! | `σ` | `Row::sigma_m` | m |
//! | `b` | `clocks_m` | m, receiver clock of each constellation times the speed of light |

use nalgebra::Vector3;
use raim_core::frame::Enu;
use raim_core::internals::least_squares::equations::{LinearEpoch, RowError};
use raim_core::internals::numeric::real::Real;
use raim_core::satellite::{Constellation, SatelliteId};

use super::noise::Noise;
use super::sight::Sight;

/// Dependence of a range's standard deviation on the elevation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sigma {
    /// The same everywhere, m ([Yang2015], [Lin2016], [Chen2009]).
    ///
    /// [Yang2015]: crate#references
    /// [Lin2016]: crate#references
    /// [Chen2009]: crate#references
    Constant(f64),
    /// `σ₀ / sin(elevation)`, m ([Tian2024]).
    ///
    /// [Tian2024]: crate#references
    Cosecant(f64),
}

impl Sigma {
    /// Returns the standard deviation in one direction, m.
    pub fn at(self, line_of_sight: Enu) -> f64 {
        match self {
            Self::Constant(sigma_m) => sigma_m,
            // Below half a degree no measurement is possible; the bound keeps the number finite.
            Self::Cosecant(zenith_m) => zenith_m / line_of_sight.up.max(0.01),
        }
    }
}

/// One satellite's row of a linearised epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Satellite of the row.
    pub satellite: SatelliteId,
    /// Unit vector from the receiver to the satellite.
    pub line_of_sight: Enu,
    /// Standard deviation of `y_m`, m.
    pub sigma_m: f64,
    /// Measured minus predicted range, m.
    pub y_m: f64,
}

/// Returns the rows of one epoch without a fault; add a fault by adding to `y_m`.
pub fn rows(
    sights: &[Sight],
    sigma: Sigma,
    clocks_m: [f64; Constellation::COUNT],
    noise: &Noise,
    epoch: u64,
) -> Vec<Row> {
    let row = |sight: &Sight| {
        let sigma_m = sigma.at(sight.line_of_sight);
        let clock_m = clocks_m.get(sight.satellite.constellation() as usize).copied().unwrap_or(0.0);
        Row {
            satellite: sight.satellite,
            line_of_sight: sight.line_of_sight,
            sigma_m,
            y_m: clock_m + sigma_m * noise.normal(sight.satellite, 0, epoch),
        }
    };
    sights.iter().map(row).collect()
}

/// Returns the rows as equations of the core, in the same order.
///
/// # Errors
/// As [`LinearEpoch::satellite`].
pub fn equations<T: Real, const N: usize>(rows: &[Row]) -> Result<LinearEpoch<T, N>, RowError> {
    let mut epoch = LinearEpoch::new();
    for row in rows {
        let Enu { east, north, up } = row.line_of_sight;
        let direction = Vector3::new(east, north, up);
        epoch.satellite(row.satellite.constellation(), direction, row.y_m, row.sigma_m)?;
    }
    Ok(epoch)
}
