//! Geoid: from the height above the ellipsoid to the altitude above mean sea level.
//!
//! `H = h − N`, `N = Σ wᵢⱼ Nᵢⱼ` over the four corners of a cell of 6° by 6°.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `h`: height above the ellipsoid | [`Geodetic::height_m`] | m |
//! | `N`: undulation, or geoid separation | [`Altitude::separation_m`] | m |
//! | `H`: altitude above mean sea level | [`Altitude::above_sea_m`] | m |
//! | `Nᵢⱼ`: corner | the table | m |
//! | `w`: weight of bilinear interpolation | – | – |
//!
//! The corners are not samples of EGM96. They are whole metres, chosen so that their interpolation
//! fits EGM96's grid of 15' best by least squares. `cargo xtask tables --geoid` computes them and
//! measures the error over that grid:
//!
//! | error of `N` | m |
//! |---|---|
//! | root mean square over the Earth | [`RMS_ERROR_M`] |
//! | 95 % of the Earth | 4 |
//! | largest, near Hawaii | [`LARGEST_ERROR_M`] |
//!
//! Assumes that mean sea level is the geoid; the sea departs from it by up to 2 m. The separation
//! is a multiple of a decimetre, so that the printed altitude and separation add up to the height.
//! The error of the table affects only the altitude: protection levels bound the error of the
//! height above the ellipsoid.
//!
//! References: [EGM96].
//!
//! [EGM96]: crate#references

use raim_core::frame::Geodetic;

mod table;

use table::UNDULATION_M;

/// Width of a cell, degrees.
const CELL_DEG: f32 = 6.0;

/// Number of cells around the equator.
const COLUMNS: usize = 60;

/// Number of cells from pole to pole.
const ROWS: usize = 30;

/// Root mean square of the error over the Earth's surface, m.
pub const RMS_ERROR_M: f64 = 1.98;

/// Largest error, m.
pub const LARGEST_ERROR_M: f64 = 22.5;

/// Altitude of a place, with the geoid separation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Altitude {
    /// Altitude above mean sea level, m.
    pub above_sea_m: f64,
    /// Height of the geoid above the ellipsoid, m, in whole decimetres.
    pub separation_m: f64,
}

impl Altitude {
    /// Converts the height of a place.
    // Not inlined, so that its callers share one copy.
    #[inline(never)]
    pub fn of(place: &Geodetic) -> Self {
        let separation_m = f64::from(libm::roundf(10.0 * undulation_m(place))) / 10.0;
        Self { above_sea_m: place.height_m - separation_m, separation_m }
    }
}

/// Returns the height of the geoid above the ellipsoid, m. A coordinate that is NaN counts as that
/// of the first cell.
fn undulation_m(place: &Geodetic) -> f32 {
    let [north, east] = [place.latitude_rad, place.longitude_rad]
        .map(|angle_rad| (angle_rad as f32) * (180.0 / core::f32::consts::PI / CELL_DEG));
    let (row, northwards) = cell(north + ROWS as f32 / 2.0, ROWS);
    let (column, eastwards) = cell(if east < 0.0 { east + COLUMNS as f32 } else { east }, COLUMNS);
    let corner = |row: usize, column: usize| {
        UNDULATION_M
            .get(row)
            .and_then(|row| row.get(column % COLUMNS))
            .map_or(0.0, |&corner| f32::from(corner))
    };
    let along = |row| between(corner(row, column), corner(row, column + 1), eastwards);
    between(along(row), along(row + 1), northwards)
}

/// Returns the cell of a coordinate that counts cells from 0, and the place inside it, from 0 to 1.
fn cell(cells: f32, count: usize) -> (usize, f32) {
    // NaN becomes 0, because every comparison with it is false.
    let cells = cells.max(0.0).min(count as f32);
    (cells as usize, cells - (cells as usize) as f32)
}

fn between(here: f32, there: f32, share: f32) -> f32 {
    here + (there - here) * share
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(latitude_deg: f64, longitude_deg: f64) -> f32 {
        undulation_m(&Geodetic {
            latitude_rad: latitude_deg.to_radians(),
            longitude_rad: longitude_deg.to_radians(),
            height_m: 0.0,
        })
    }

    #[test]
    fn separation_has_no_step_across_cells_the_date_line_and_the_poles() {
        let cases = [
            [(6.0, 12.0), (6.000_01, 11.999_99)],
            [(-17.0, 180.0), (-17.0, -180.0)],
            [(48.0, -0.000_01), (48.0, 0.000_01)],
            [(48.0, 359.999_99), (48.0, 0.0)],
            [(90.0, 10.0), (90.0, -120.0)],
            [(-90.0, 10.0), (-90.0, -120.0)],
        ];
        for [one, other] in cases {
            let [one_m, other_m] = [one, other].map(|(latitude, longitude)| at(latitude, longitude));
            assert!((one_m - other_m).abs() < 0.01, "{one:?} {one_m}, {other:?} {other_m}");
        }
    }

    #[test]
    fn altitude_and_separation_add_up_to_the_height() {
        for height_m in [-412.3, 0.0, 8848.86, 35_786e3] {
            let place = Geodetic { latitude_rad: 0.48, longitude_rad: 1.51, height_m };
            let Altitude { above_sea_m, separation_m } = Altitude::of(&place);
            assert!((above_sea_m + separation_m - height_m).abs() < 1e-9);
            assert!((separation_m * 10.0).fract().abs() < 1e-9, "{separation_m}");
        }
    }

    #[test]
    fn no_place_gives_an_undulation_that_the_earth_does_not_have() {
        for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            for (latitude_deg, longitude_deg) in [(wrong, 0.0), (0.0, wrong), (wrong, wrong)] {
                assert!(at(latitude_deg, longitude_deg).abs() < 110.0);
            }
        }
    }
}
