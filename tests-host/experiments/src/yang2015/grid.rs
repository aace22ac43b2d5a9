//! Grid of table 1, and the satellites in view of its cells.
//!
//! Satellites are taken at the time of reception. Their motion during the signal's travel turns a
//! direction by 2e-5 rad, which no statistic shows, and so one set of positions serves all cells.

use nalgebra::Vector3;
use raim::signal::sky::{Fleet, Satellite, Site};
use raim_core::frame::{Ecef, Enu};
use raim_core::internals::least_squares::Workspace;
use raim_core::internals::least_squares::equations::LinearEpoch;
use raim_core::internals::numeric::real::Real;
use raim_core::satellite::Constellation;

use super::{MASK_DEG, ROWS, SIGMA_M};

/// Number of rows of cells, from 10 to 55 degrees north.
pub(super) const LATITUDES: usize = 9;
/// Number of cells in a row, from 75 to 135 degrees east.
const LONGITUDES: usize = 12;
/// Number of all cells.
pub(super) const CELLS: usize = LATITUDES * LONGITUDES;

/// Returns the latitude of the centres of a row, degrees.
pub(super) fn latitude_deg(row: usize) -> f64 {
    12.5 + 5.0 * row as f64
}

/// A receiver in the centre of a cell.
pub(super) struct Cell {
    /// Row of the cell, from the south.
    pub(super) row: usize,
    site: Site,
}

impl Cell {
    /// Returns all cells, row by row from the south.
    pub(super) fn all() -> Vec<Self> {
        let cell = |index: usize| {
            let (row, column) = (index / LONGITUDES, index % LONGITUDES);
            let longitude_deg = 77.5 + 5.0 * column as f64;
            Self { row, site: Site::geodetic(latitude_deg(row), longitude_deg, 0.0) }
        };
        (0..CELLS).map(cell).collect()
    }

    /// Returns unit vectors to the satellites above the mask.
    pub(super) fn directions(&self, sky: &Sky, positions: &[Ecef]) -> Vec<Enu> {
        let directions = positions.iter().map(|&position| self.site.direction(position));
        directions.filter(|direction| direction.up >= sky.sin_mask).collect()
    }
}

/// Satellites of a sky.
pub(super) struct Sky {
    satellites: Vec<Satellite>,
    sin_mask: f64,
}

impl Sky {
    /// Returns the global system.
    pub(super) fn global() -> Self {
        Self { satellites: Fleet::BeidouGlobal.satellites(), sin_mask: libm::sin(MASK_DEG.to_radians()) }
    }

    /// Returns the positions of the satellites.
    pub(super) fn positions(&self, t_s: f64) -> Vec<Ecef> {
        self.satellites.iter().map(|satellite| satellite.orbit.position(t_s)).collect()
    }
}

/// Returns ranges with the given errors, m, ready to be solved.
pub(super) fn pose<T: Real>(
    directions: &[Enu],
    mut error_m: impl FnMut(usize) -> f64,
) -> anyhow::Result<Workspace<T, ROWS>> {
    let mut epoch = LinearEpoch::new();
    for (index, direction) in directions.iter().enumerate() {
        let direction = Vector3::new(direction.east, direction.north, direction.up);
        epoch.satellite(Constellation::Beidou, direction, error_m(index), SIGMA_M)?;
    }
    Ok(Workspace::of(epoch))
}
