//! Directions as seen from the receiver.
//!
//! Single precision suffices: a coordinate is accurate to 1 m in 26,000 km, and a direction to
//! 1e-7. Ranges need more and do not come from here.

use raim_core::frame::{Ecef, LocalAxes};
use raim_core::internals::numeric::sqrt;

/// Place of the receiver, with its axes east, north, up.
#[derive(Clone, Debug)]
pub(crate) struct Horizon {
    place_m: [f32; 3],
    axes: [[f32; 3]; 3],
}

/// The straight path to a satellite.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    /// Difference of the places in the earth-fixed frame, m.
    pub(crate) difference_m: [f32; 3],
    /// Inverse of its length, 1/m.
    pub(crate) inverse_length: f32,
}

impl Horizon {
    /// Returns the horizon at a point with known axes.
    pub(crate) fn at(point: Ecef, axes: &LocalAxes) -> Self {
        Self { place_m: coordinates_m(point), axes: axes.east_north_up() }
    }

    /// Returns the path to a point.
    pub(crate) fn way_to(&self, coordinates_m: [f32; 3]) -> Way {
        let [x, y, z] = coordinates_m;
        let [from_x, from_y, from_z] = self.place_m;
        let (x, y, z) = (x - from_x, y - from_y, z - from_z);
        Way { difference_m: [x, y, z], inverse_length: 1.0 / sqrt(x * x + y * y + z * z) }
    }

    /// Returns the unit vector along a path: east, north, up.
    pub(crate) fn direction(&self, way: &Way) -> [f32; 3] {
        let [x, y, z] = way.difference_m;
        let along = |[a, b, c]: [f32; 3]| way.inverse_length * (a * x + b * y + c * z);
        // By components, because code compiled for size calls a function for an array's `map`.
        let [east, north, up] = self.axes;
        [along(east), along(north), along(up)]
    }
}

/// Returns earth-fixed coordinates, m.
pub(crate) fn coordinates_m(point: Ecef) -> [f32; 3] {
    [point.x_m, point.y_m, point.z_m].map(|coordinate_m| coordinate_m as f32)
}
