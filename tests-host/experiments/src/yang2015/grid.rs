//! The grid of table 1, and what its cells see.
//!
//! Satellites are taken where they are at the time of reception: what they go on during the signal's travel turns a
//! direction by 2e-5 rad, of which no statistic can tell, and leaves one set of positions for all cells.

use nalgebra::Vector3;
use rai_core::frame::{Ecef, Enu};
use rai_core::least_squares::Workspace;
use rai_core::least_squares::equations::LinearEpoch;
use rai_core::numeric::real::Real;
use rai_core::satellite::Constellation;

use super::{MASK_DEG, ROWS, SIGMA_M};
use tests_host::sky::{Fleet, Satellite, Site};

/// Rows of cells, from 10 to 55 degrees north.
pub(super) const LATITUDES: usize = 9;
/// Cells in a row, from 75 to 135 degrees east.
const LONGITUDES: usize = 12;
/// All of them.
pub(super) const CELLS: usize = LATITUDES * LONGITUDES;

/// Latitude of the centres of a row, degrees.
pub(super) fn latitude_deg(row: usize) -> f64 {
    12.5 + 5.0 * row as f64
}

/// A receiver in the centre of a cell.
pub(super) struct Cell {
    /// Its row, from the south.
    pub(super) row: usize,
    site: Site,
}

impl Cell {
    /// All cells, row by row from the south.
    pub(super) fn all() -> Vec<Self> {
        let cell = |index: usize| {
            let (row, column) = (index / LONGITUDES, index % LONGITUDES);
            let longitude_deg = 77.5 + 5.0 * column as f64;
            Self { row, site: Site::geodetic(latitude_deg(row), longitude_deg, 0.0) }
        };
        (0..CELLS).map(cell).collect()
    }

    /// Unit vectors to the satellites above the mask.
    pub(super) fn directions(&self, sky: &Sky, positions: &[Ecef]) -> Vec<Enu> {
        let directions = positions.iter().map(|&position| self.site.direction(position));
        directions.filter(|direction| direction.up >= sky.sin_mask).collect()
    }
}

/// The satellites above.
pub(super) struct Sky {
    satellites: Vec<Satellite>,
    sin_mask: f64,
}

impl Sky {
    /// The global system.
    pub(super) fn global() -> Self {
        Self { satellites: Fleet::BeidouGlobal.satellites(), sin_mask: libm::sin(MASK_DEG.to_radians()) }
    }

    /// Where they are.
    pub(super) fn positions(&self, t_s: f64) -> Vec<Ecef> {
        self.satellites.iter().map(|satellite| satellite.orbit.position(t_s)).collect()
    }
}

/// Ranges with the given errors, in metres, to be solved.
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
