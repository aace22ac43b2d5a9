//! Tangent frame in single precision, for models of the atmosphere and for elevations.

use nalgebra::Vector3;

use super::{Directions, ECCENTRICITY_SQUARED, Ecef, FLATTENING, SEMI_MAJOR_AXIS_M, coordinates};
use crate::numeric::absolute::{Absolute, Grid};

/// The tangent frame at a point in single precision: axes to 3e-7, height to 1 cm.
///
/// On a processor that emulates doubles it costs a tenth of a [`LocalFrame`](super::LocalFrame).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LocalAxes {
    directions: Directions<f32>,
    height_m: f32,
}

impl LocalAxes {
    /// Returns the axes at an earth-fixed point; see [`LocalFrame::at`](super::LocalFrame::at) for
    /// points without axes.
    pub fn at(point: Ecef) -> Self {
        let position = Vector3::new(point.x_m as f32, point.y_m as f32, point.z_m as f32);
        match Directions::at(&position) {
            Some((directions, _)) => Self { directions, height_m: height_m(point) },
            None => Self { directions: Directions::of_origin(), height_m: -SEMI_MAJOR_AXIS_M as f32 },
        }
    }

    /// Returns the axes east, north and up in the earth-fixed frame.
    pub fn east_north_up(&self) -> [[f32; 3]; 3] {
        let axes = self.directions.axes();
        [[axes.m11, axes.m12, axes.m13], [axes.m21, axes.m22, axes.m23], [axes.m31, axes.m32, axes.m33]]
    }

    /// Returns the height of the origin above the ellipsoid, m; unspecified beyond 100,000 km.
    pub fn height_m(&self) -> f32 {
        self.height_m
    }

    /// Returns the sine of the origin's geodetic latitude.
    pub fn sin_latitude(&self) -> f32 {
        self.directions.sin_latitude
    }

    /// Returns the origin's geodetic latitude and its longitude, rad.
    pub fn latitude_and_longitude_rad(&self) -> [f32; 2] {
        let Directions { sin_latitude, cos_latitude, sin_longitude, cos_longitude } = self.directions;
        [libm::atan2f(sin_latitude, cos_latitude), libm::atan2f(sin_longitude, cos_longitude)]
    }
}

/// Returns the height above the ellipsoid, m:
///
/// ```text
/// h = (R − r)(1 − 2 f² s² (1 − s²))      r = a/√(1 + e'² s²)      s = z/R
/// ```
///
/// `R` is the distance to the centre, `r` that of the ellipsoid in the same direction, `e'` its
/// second eccentricity. `R − a` is exact before rounding, and `r − a` is a series, so that no
/// digits are lost. The factor converts a height along the radius to one along the vertical.
fn height_m(point: Ecef) -> f32 {
    const SQUARED: f32 = (ECCENTRICITY_SQUARED / (1.0 - ECCENTRICITY_SQUARED)) as f32;
    const TURNED: f32 = (2.0 * FLATTENING * FLATTENING) as f32;
    let radius = Grid::length(coordinates::<f32>(point));
    let beyond_axis_m = radius.whole.less(Grid::of(SEMI_MAJOR_AXIS_M)).narrow() + radius.rest;
    let sine = point.z_m as f32 / (radius.rounded * <Grid as Absolute<f32>>::UNIT_M);
    let square = sine * sine;
    let u = SQUARED * square;
    // 1 − 1/√(1 + u).
    let flattened = u * (0.5 - u * (0.375 - u * (0.3125 - u * 0.273_437_5)));
    let along_radius_m = beyond_axis_m + SEMI_MAJOR_AXIS_M as f32 * flattened;
    along_radius_m * (1.0 - TURNED * square * (1.0 - square))
}
