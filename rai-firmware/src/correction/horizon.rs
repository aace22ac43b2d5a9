//! Directions as seen from the receiver.
//!
//! Single precision suffices: a coordinate is accurate to 1 m in 26,000 km, and a direction to
//! 1e-7. Ranges need more and do not come from here.

use raim_core::frame::{Ecef, LocalFrame};
use raim_core::numeric::sqrt;

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
    /// Returns the horizon at a point with a known frame.
    pub(crate) fn at(point: Ecef, frame: &LocalFrame) -> Self {
        let sin_latitude = frame.sin_latitude() as f32;
        let cos_latitude = cosine_of_latitude(sin_latitude);
        let (east, outward) = level_axes(point);
        Self {
            place_m: coordinates_m(point),
            axes: [
                [east[0], east[1], 0.0],
                [-sin_latitude * outward[0], -sin_latitude * outward[1], cos_latitude],
                [cos_latitude * outward[0], cos_latitude * outward[1], sin_latitude],
            ],
        }
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
        self.axes.map(|[a, b, c]| way.inverse_length * (a * x + b * y + c * z))
    }
}

/// Returns the cosine of a geodetic latitude, which is never negative.
pub(crate) fn cosine_of_latitude(sin_latitude: f32) -> f32 {
    sqrt((1.0 - sin_latitude * sin_latitude).max(0.0))
}

/// Returns earth-fixed coordinates, m.
pub(crate) fn coordinates_m(point: Ecef) -> [f32; 3] {
    [point.x_m, point.y_m, point.z_m].map(|coordinate_m| coordinate_m as f32)
}

/// Returns unit vectors to the east and away from the axis, x and y; on the axis those of longitude
/// 0.
fn level_axes(point: Ecef) -> ([f32; 2], [f32; 2]) {
    let (x, y) = (point.x_m as f32, point.y_m as f32);
    let axial = sqrt(x * x + y * y);
    if axial > 1e-6 { ([-y / axial, x / axial], [x / axial, y / axial]) } else { ([0.0, 1.0], [1.0, 0.0]) }
}
