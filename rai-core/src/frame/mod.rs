//! Coordinate frames, one type for each. No other module depends on WGS 84.
//!
//! | type | axes | origin |
//! |---|---|---|
//! | [`Ecef`] | earth-fixed x, y, z in metres | centre of the earth |
//! | [`Geodetic`] | latitude, longitude in radians, height in metres | ellipsoid |
//! | [`Enu`] | east, north, up in metres (or a unit vector) | a [`LocalFrame`] |
//!
//! Only [`LocalFrame::rotate`] converts to an [`Enu`].
//!
//! Assumes the WGS 84 ellipsoid; the ellipsoids of the other systems differ by less than 0.1 mm at
//! the surface. References: [WGS84], [Bowring1985] for the latitude.
//!
//! [WGS84]: crate#references
//! [Bowring1985]: crate#references

#[doc(hidden)]
mod axes;

#[doc(hidden)]
pub use axes::LocalAxes;

use nalgebra::{Matrix3, Vector3};

use crate::numeric::absolute::{Absolute, Length};
use crate::numeric::angle;
use crate::numeric::four::Four;
use crate::numeric::real::Real;
use crate::numeric::space::{columns, combination, dot, transposed_product};
use crate::numeric::sqrt_f64;

/// Speed of light in vacuum, m/s (exact by definition of the metre).
pub const SPEED_OF_LIGHT_M_S: f64 = 299_792_458.0;

/// Rotation rate of the earth in inertial space, rad/s ([WGS84], [IS-GPS-200] table 20-IV).
///
/// [WGS84]: crate#references
/// [IS-GPS-200]: crate#references
#[doc(hidden)]
pub const EARTH_ROTATION_RAD_S: f64 = 7.292_115_146_7e-5;

/// Semi-major axis of the ellipsoid, m ([WGS84]).
///
/// [WGS84]: crate#references
#[doc(hidden)]
pub const SEMI_MAJOR_AXIS_M: f64 = 6_378_137.0;

/// Flattening of the ellipsoid, dimensionless ([WGS84]).
///
/// [WGS84]: crate#references
#[doc(hidden)]
pub const FLATTENING: f64 = 1.0 / 298.257_223_563;

/// First eccentricity squared, derived.
const ECCENTRICITY_SQUARED: f64 = FLATTENING * (2.0 - FLATTENING);

/// Semi-minor axis, m, derived.
const SEMI_MINOR_AXIS_M: f64 = SEMI_MAJOR_AXIS_M * (1.0 - FLATTENING);

/// An earth-fixed position or difference of positions, in metres.
///
/// ```
/// use raim_core::Ecef;
///
/// let satellite = Ecef::new(26_560_000.0, 0.0, 0.0);
/// let receiver = Ecef::new(6_378_137.0, 0.0, 0.0);
/// assert_eq!(satellite.distance_m(receiver), 20_181_863.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ecef {
    /// Component towards the prime meridian on the equator, m.
    pub x_m: f64,
    /// Component towards 90° E on the equator, m.
    pub y_m: f64,
    /// Component towards the north pole, m.
    pub z_m: f64,
}

impl Ecef {
    /// The centre of the earth, the start of a fix without a known position.
    pub const CENTRE: Self = Self { x_m: 0.0, y_m: 0.0, z_m: 0.0 };

    /// Returns a position from its coordinates in metres.
    pub const fn new(x_m: f64, y_m: f64, z_m: f64) -> Self {
        Self { x_m, y_m, z_m }
    }

    /// Returns the distance from the centre of the earth, m.
    pub fn radius_m(self) -> f64 {
        sqrt_f64(self.x_m * self.x_m + self.y_m * self.y_m + self.z_m * self.z_m)
    }

    /// Returns the straight-line distance to another point, m.
    pub fn distance_m(self, other: Self) -> f64 {
        (other - self).radius_m()
    }

    /// Returns true if all coordinates are finite.
    #[doc(hidden)]
    pub fn is_finite(self) -> bool {
        self.x_m.is_finite() && self.y_m.is_finite() && self.z_m.is_finite()
    }
}

impl core::ops::Add for Ecef {
    type Output = Self;
    // Not inlined, so that its many callers share one copy.
    #[inline(never)]
    fn add(self, other: Self) -> Self {
        Self::new(self.x_m + other.x_m, self.y_m + other.y_m, self.z_m + other.z_m)
    }
}

impl core::ops::Sub for Ecef {
    type Output = Self;
    // Not inlined, so that its many callers share one copy.
    #[inline(never)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x_m - other.x_m, self.y_m - other.y_m, self.z_m - other.z_m)
    }
}

/// A position on or near the ellipsoid.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Geodetic {
    /// Geodetic latitude, rad, north positive.
    pub latitude_rad: f64,
    /// Longitude, rad, east positive.
    pub longitude_rad: f64,
    /// Height above the ellipsoid, m.
    pub height_m: f64,
}

impl Geodetic {
    /// Returns the earth-fixed position.
    pub fn to_ecef(self) -> Ecef {
        let (sin_latitude, cos_latitude) = libm::sincos(self.latitude_rad);
        let (sin_longitude, cos_longitude) = libm::sincos(self.longitude_rad);
        let normal_m = SEMI_MAJOR_AXIS_M / sqrt_f64(1.0 - ECCENTRICITY_SQUARED * sin_latitude * sin_latitude);
        let axial_m = (normal_m + self.height_m) * cos_latitude;
        Ecef::new(
            axial_m * cos_longitude,
            axial_m * sin_longitude,
            (normal_m * (1.0 - ECCENTRICITY_SQUARED) + self.height_m) * sin_latitude,
        )
    }
}

/// A vector in east, north, up.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Enu {
    /// East component.
    pub east: f64,
    /// North component.
    pub north: f64,
    /// Up component.
    pub up: f64,
}

impl Enu {
    /// Returns the length of the horizontal part, in the unit of the components.
    #[doc(hidden)]
    pub fn horizontal(self) -> f64 {
        sqrt_f64(self.east * self.east + self.north * self.north)
    }
}

/// The directions east, north and up at a point, stored as the sines and cosines of its geodetic
/// latitude and longitude.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct Directions<T> {
    sin_latitude: T,
    cos_latitude: T,
    sin_longitude: T,
    cos_longitude: T,
}

impl<T: Real> Directions<T> {
    /// Returns the directions at an earth-fixed point and its distance to the axis, m; see
    /// [`LocalFrame::at`].
    ///
    /// Returns `None` near the centre of the earth, where up is undefined.
    // Not inlined, so that its callers share one copy.
    #[inline(never)]
    fn at(point: &Vector3<T>) -> Option<(Self, T)> {
        let radius = dot(point, point).sqrt_approx();
        // NaN and infinity also return here, because they are not within the bounds.
        if !(radius >= T::narrow(1e3) && radius <= T::narrow(1e15)) {
            return None;
        }
        let axial = (point.x * point.x + point.y * point.y).sqrt_approx();
        let (sin_longitude, cos_longitude) =
            if axial > T::narrow(1e-6) { (point.y / axial, point.x / axial) } else { (T::zero(), T::one()) };
        let (sin_latitude, cos_latitude) = latitude(axial, point.z, radius);
        Some((Self { sin_latitude, cos_latitude, sin_longitude, cos_longitude }, axial))
    }

    /// Returns the directions at latitude 0, longitude 0.
    fn of_origin() -> Self {
        Self {
            sin_latitude: T::zero(),
            cos_latitude: T::one(),
            sin_longitude: T::zero(),
            cos_longitude: T::one(),
        }
    }

    /// Returns the matrix with rows east, north, up.
    fn axes(&self) -> Matrix3<T> {
        let Self { sin_latitude, cos_latitude, sin_longitude, cos_longitude } = *self;
        #[rustfmt::skip]
        let axes = Matrix3::new(
            -sin_longitude, cos_longitude, T::zero(),
            -sin_latitude * cos_longitude, -sin_latitude * sin_longitude, cos_latitude,
            cos_latitude * cos_longitude, cos_latitude * sin_longitude, sin_latitude,
        );
        axes
    }
}

/// The tangent frame at a point: rotates earth-fixed vectors into east, north, up.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LocalFrame {
    directions: Directions<f64>,
    height_m: f64,
}

impl LocalFrame {
    /// Returns the frame at an earth-fixed point.
    ///
    /// The latitude comes from one step of [Bowring1985] (error below 1e-11 rad from the ground to
    /// 30,000 km). It needs square roots but no trigonometric function. On the earth's axis the
    /// longitude is 0. Within 1 km of the centre, where up is undefined, the frame is that of
    /// latitude 0, longitude 0.
    ///
    /// [Bowring1985]: crate#references
    pub fn at(point: Ecef) -> Self {
        let Some((directions, axial_m)) = Directions::at(&Vector3::new(point.x_m, point.y_m, point.z_m))
        else {
            return Self { directions: Directions::of_origin(), height_m: -SEMI_MAJOR_AXIS_M };
        };
        let Directions { sin_latitude, cos_latitude, .. } = directions;
        let curvature = sqrt_f64(1.0 - ECCENTRICITY_SQUARED * sin_latitude * sin_latitude);
        let height_m = axial_m * cos_latitude + point.z_m * sin_latitude - SEMI_MAJOR_AXIS_M * curvature;
        Self { directions, height_m }
    }

    /// Returns the origin's coordinates on the ellipsoid.
    pub fn geodetic(&self) -> Geodetic {
        let Directions { sin_latitude, cos_latitude, sin_longitude, cos_longitude } = self.directions;
        Geodetic {
            latitude_rad: angle::of_unit_vector(sin_latitude, cos_latitude),
            longitude_rad: angle::of_unit_vector(sin_longitude, cos_longitude),
            height_m: self.height_m,
        }
    }

    /// Returns the height of the origin above the ellipsoid, m.
    #[doc(hidden)]
    pub fn height_m(&self) -> f64 {
        self.height_m
    }

    /// Returns the sine of the origin's geodetic latitude.
    #[doc(hidden)]
    pub fn sin_latitude(&self) -> f64 {
        self.directions.sin_latitude
    }

    /// Rotates an earth-fixed vector into east, north, up.
    pub fn rotate(&self, vector: Ecef) -> Enu {
        let Directions { sin_latitude, cos_latitude, sin_longitude, cos_longitude } = self.directions;
        let outward = cos_longitude * vector.x_m + sin_longitude * vector.y_m;
        Enu {
            east: cos_longitude * vector.y_m - sin_longitude * vector.x_m,
            north: cos_latitude * vector.z_m - sin_latitude * outward,
            up: cos_latitude * outward + sin_latitude * vector.z_m,
        }
    }

    /// Rotates an east, north, up vector back into the earth-fixed frame.
    pub fn unrotate(&self, vector: Enu) -> Ecef {
        let Directions { sin_latitude, cos_latitude, sin_longitude, cos_longitude } = self.directions;
        let outward = cos_latitude * vector.up - sin_latitude * vector.north;
        Ecef::new(
            cos_longitude * outward - sin_longitude * vector.east,
            sin_longitude * outward + cos_longitude * vector.east,
            cos_latitude * vector.north + sin_latitude * vector.up,
        )
    }
}

/// Returns the sine and cosine of the geodetic latitude. The arguments are the distances to the
/// axis, to the equatorial plane (northwards) and to the centre, m.
fn latitude<T: Real>(axial: T, z: T, radius: T) -> (T, T) {
    const SECOND_ECCENTRICITY_SQUARED: f64 = ECCENTRICITY_SQUARED / (1.0 - ECCENTRICITY_SQUARED);
    let [semi_major, semi_minor] = [SEMI_MAJOR_AXIS_M, SEMI_MINOR_AXIS_M].map(T::narrow);
    let [first, second] = [ECCENTRICITY_SQUARED, SECOND_ECCENTRICITY_SQUARED].map(T::narrow);
    // Reduced latitude, Bowring's improved start.
    let top = z * semi_minor * (T::one() + second * semi_minor / radius);
    let bottom = semi_major * axial;
    let length = (top * top + bottom * bottom).sqrt_approx();
    let (sin_reduced, cos_reduced) = (top / length, bottom / length);
    let north = z + second * semi_minor * sin_reduced * sin_reduced * sin_reduced;
    let outward = axial - first * semi_major * cos_reduced * cos_reduced * cos_reduced;
    let length = (north * north + outward * outward).sqrt_approx();
    if length > T::zero() { (north / length, outward / length) } else { (T::zero(), T::one()) }
}

/// Line of sight from a receiver to a satellite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LineOfSight<T: Real> {
    /// Straight distance between the satellite at transmission and the receiver.
    pub(crate) distance: Length<T::Absolute, T>,
    /// Increase of the distance by the earth's rotation while the signal travels, m.
    pub(crate) rotation: T,
    /// Unit vector satellite → receiver, east, north, up: the derivative of the distance with
    /// respect to the receiver's position.
    pub(crate) design: Vector3<T>,
}

/// A receiver's position and axes, in the scalar for directions.
///
/// A range must be accurate to a millimetre in 26,000 km ([`Absolute`]). Single precision, accurate
/// to 1e-7, suffices for directions and for the 40 m of the earth's rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LinearisationPoint<T: Real> {
    point: Ecef,
    /// Position in the scalar's absolute lengths, x, y, z.
    place: [T::Absolute; 3],
    /// East, north and up of a step along x, y and z, dimensionless, each with the increase of the
    /// distance by the rotation, `ω/c (y_r, −x_r, 0)`, in m for each [`Absolute::UNIT_M`].
    steps: [T::Four; 3],
}

impl<T: Real> LinearisationPoint<T> {
    /// Returns the linearisation point at an earth-fixed point.
    pub(crate) fn at(point: Ecef) -> Self {
        const RATE: f64 = EARTH_ROTATION_RAD_S / SPEED_OF_LIGHT_M_S;
        let position = Vector3::new(T::narrow(point.x_m), T::narrow(point.y_m), T::narrow(point.z_m));
        let directions =
            Directions::at(&position).map_or_else(Directions::of_origin, |(directions, _)| directions);
        let rate = T::narrow(RATE) * T::Absolute::UNIT_M;
        let [x, y, z] = columns(&directions.axes());
        Self {
            point,
            place: coordinates::<T>(point),
            steps: [
                T::Four::join([x.x, x.y, x.z, rate * position.y]),
                T::Four::join([y.x, y.y, y.z, -rate * position.x]),
                T::Four::join([z.x, z.y, z.z, T::zero()]),
            ],
        }
    }

    /// Returns the earth-fixed point.
    pub(crate) fn point(&self) -> Ecef {
        self.point
    }

    /// Returns the line of sight to a satellite that sent its signal from `satellite`.
    ///
    /// The satellite's coordinates are in the earth-fixed frame at transmission. While the signal
    /// travels, the earth turns. To first order in the angle this adds `ω/c (x_s y_r − y_s x_r)` to
    /// the range (second order: 0.3 mm). The code uses `s − r` in place of `s`, which gives the
    /// same product.
    // Called for every satellite of an epoch.
    #[allow(clippy::inline_always, reason = "a host keeps the result in registers")]
    #[cfg_attr(not(target_os = "none"), inline(always))]
    pub(crate) fn sight(&self, satellite: Ecef) -> LineOfSight<T> {
        let [here_x, here_y, here_z] = self.place;
        let away = |metres, here| T::Absolute::of_admitted(metres).less(here);
        let difference =
            [away(satellite.x_m, here_x), away(satellite.y_m, here_y), away(satellite.z_m, here_z)];
        let sight = Vector3::from(T::Absolute::units(difference));
        let distance = T::Absolute::length(difference);
        let away = combination(&self.steps, &sight);
        let [.., rotation] = away.numbers();
        let [east, north, up, _] = (away * T::Four::repeat(-distance.rounded.recip())).numbers();
        LineOfSight { distance, rotation, design: Vector3::new(east, north, up) }
    }

    /// Returns the point at an offset of east, north, up, m.
    // Not inlined, so that its many callers share one copy.
    #[inline(never)]
    pub(crate) fn beside(&self, vector: &Vector3<T>) -> Ecef {
        let axes = self.steps.map(Four::numbers);
        let [x, y, z] = axes.map(|[east, north, up, _]| east * vector.x + north * vector.y + up * vector.z);
        let away = Vector3::new(x, y, z);
        self.point + Ecef::new(away.x.widen(), away.y.widen(), away.z.widen())
    }
}

/// Rotates east, north, up at a point into the earth-fixed frame, in single precision.
pub(crate) fn earth_fixed(point: Ecef, east_north_up: [f64; 3]) -> Vector3<f32> {
    let position = Vector3::new(point.x_m as f32, point.y_m as f32, point.z_m as f32);
    let directions =
        Directions::at(&position).map_or_else(Directions::of_origin, |(directions, _)| directions);
    let [east, north, up] = east_north_up.map(|component| component as f32);
    transposed_product(&directions.axes(), &Vector3::new(east, north, up))
}

fn coordinates<T: Real>(point: Ecef) -> [T::Absolute; 3] {
    [point.x_m, point.y_m, point.z_m].map(T::Absolute::of)
}

impl LocalFrame {
    /// Returns the sine of the elevation of a point seen from the origin.
    #[doc(hidden)]
    pub fn sin_elevation(&self, origin: Ecef, point: Ecef) -> f64 {
        let difference = point - origin;
        let distance_m = difference.radius_m();
        if distance_m > 0.0 { self.rotate(difference).up / distance_m } else { 1.0 }
    }
}
