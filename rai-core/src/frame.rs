//! Coordinate frames. A coordinate's frame is its type; this is the only file that knows WGS 84.
//!
//! | type | axes | origin |
//! |---|---|---|
//! | [`Ecef`] | earth-fixed x, y, z in metres | centre of the earth |
//! | [`Geodetic`] | latitude, longitude in radians, height in metres | ellipsoid |
//! | [`Enu`] | east, north, up in metres (or a unit vector) | a [`LocalFrame`] |
//!
//! [`LocalFrame::rotate`] is the only way to an [`Enu`].
//!
//! Assumes the WGS 84 ellipsoid; the ellipsoids of the other systems differ by less than 0.1 mm at the surface.
//! References: [WGS84], [Bowring1985] for the latitude.
//!
//! [WGS84]: crate#references
//! [Bowring1985]: crate#references

use nalgebra::{Matrix3, Vector3};

use crate::numeric::real::Real;

/// Speed of light in vacuum, m/s (exact by definition of the metre).
pub const SPEED_OF_LIGHT_M_S: f64 = 299_792_458.0;

/// Rotation rate of the earth in inertial space, rad/s ([WGS84], [IS-GPS-200] table 20-IV).
///
/// [WGS84]: crate#references
/// [IS-GPS-200]: crate#references
pub const EARTH_ROTATION_RAD_S: f64 = 7.292_115_146_7e-5;

/// Semi-major axis of the ellipsoid, m ([WGS84]).
///
/// [WGS84]: crate#references
pub const SEMI_MAJOR_AXIS_M: f64 = 6_378_137.0;

/// Flattening of the ellipsoid, dimensionless ([WGS84]).
///
/// [WGS84]: crate#references
pub const FLATTENING: f64 = 1.0 / 298.257_223_563;

/// First eccentricity squared, derived.
const ECCENTRICITY_SQUARED: f64 = FLATTENING * (2.0 - FLATTENING);

/// Semi-minor axis, m, derived.
const SEMI_MINOR_AXIS_M: f64 = SEMI_MAJOR_AXIS_M * (1.0 - FLATTENING);

/// An earth-fixed position or difference of positions, in metres.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ecef {
    /// Towards the prime meridian on the equator, m.
    pub x_m: f64,
    /// Towards 90° E on the equator, m.
    pub y_m: f64,
    /// Towards the north pole, m.
    pub z_m: f64,
}

impl Ecef {
    /// The centre of the earth: where a fix starts that knows nothing.
    pub const CENTRE: Self = Self { x_m: 0.0, y_m: 0.0, z_m: 0.0 };

    /// A position from its coordinates in metres.
    pub const fn new(x_m: f64, y_m: f64, z_m: f64) -> Self {
        Self { x_m, y_m, z_m }
    }

    /// Distance from the centre of the earth, m.
    pub fn radius_m(self) -> f64 {
        libm::sqrt(self.x_m * self.x_m + self.y_m * self.y_m + self.z_m * self.z_m)
    }

    /// Straight-line distance to another point, m.
    pub fn distance_m(self, other: Self) -> f64 {
        (other - self).radius_m()
    }

    /// True when all coordinates are finite.
    pub fn is_finite(self) -> bool {
        self.x_m.is_finite() && self.y_m.is_finite() && self.z_m.is_finite()
    }
}

impl core::ops::Add for Ecef {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.x_m + other.x_m, self.y_m + other.y_m, self.z_m + other.z_m)
    }
}

impl core::ops::Sub for Ecef {
    type Output = Self;
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
    /// The earth-fixed position.
    pub fn to_ecef(self) -> Ecef {
        let (sin_latitude, cos_latitude) = libm::sincos(self.latitude_rad);
        let (sin_longitude, cos_longitude) = libm::sincos(self.longitude_rad);
        let normal_m =
            SEMI_MAJOR_AXIS_M / libm::sqrt(1.0 - ECCENTRICITY_SQUARED * sin_latitude * sin_latitude);
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
    /// Length of the horizontal part, in the unit of the components.
    pub fn horizontal(self) -> f64 {
        libm::sqrt(self.east * self.east + self.north * self.north)
    }
}

/// The tangent frame at a point: rotates earth-fixed vectors into east, north, up.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LocalFrame {
    sin_latitude: f64,
    cos_latitude: f64,
    sin_longitude: f64,
    cos_longitude: f64,
    height_m: f64,
}

impl LocalFrame {
    /// The frame at an earth-fixed point.
    ///
    /// Latitude by one step of [Bowring1985] (error below 1e-11 rad from the ground to 30,000 km), with square
    /// roots only, no trigonometric function. On the earth's axis the longitude is 0; within 1 km of the centre,
    /// where no direction is up, the frame is that of latitude 0, longitude 0.
    ///
    /// [Bowring1985]: crate#references
    pub fn at(point: Ecef) -> Self {
        let radius_m = point.radius_m();
        // Also the way out for NaN and infinity, which no range contains.
        if !(1e3..=1e15).contains(&radius_m) {
            let height_m = -SEMI_MAJOR_AXIS_M;
            return Self {
                sin_latitude: 0.0,
                cos_latitude: 1.0,
                sin_longitude: 0.0,
                cos_longitude: 1.0,
                height_m,
            };
        }
        let axial_m = libm::sqrt(point.x_m * point.x_m + point.y_m * point.y_m);
        let (sin_longitude, cos_longitude) =
            if axial_m > 1e-6 { (point.y_m / axial_m, point.x_m / axial_m) } else { (0.0, 1.0) };
        let (sin_latitude, cos_latitude) = latitude(axial_m, point.z_m, radius_m);
        let curvature = libm::sqrt(1.0 - ECCENTRICITY_SQUARED * sin_latitude * sin_latitude);
        let height_m = axial_m * cos_latitude + point.z_m * sin_latitude - SEMI_MAJOR_AXIS_M * curvature;
        Self { sin_latitude, cos_latitude, sin_longitude, cos_longitude, height_m }
    }

    /// The origin's coordinates on the ellipsoid.
    pub fn geodetic(&self) -> Geodetic {
        Geodetic {
            latitude_rad: libm::atan2(self.sin_latitude, self.cos_latitude),
            longitude_rad: libm::atan2(self.sin_longitude, self.cos_longitude),
            height_m: self.height_m,
        }
    }

    /// Height of the origin above the ellipsoid, m.
    pub fn height_m(&self) -> f64 {
        self.height_m
    }

    /// Sine of the origin's geodetic latitude.
    pub fn sin_latitude(&self) -> f64 {
        self.sin_latitude
    }

    /// An earth-fixed vector in east, north, up.
    pub fn rotate(&self, vector: Ecef) -> Enu {
        let outward = self.cos_longitude * vector.x_m + self.sin_longitude * vector.y_m;
        Enu {
            east: self.cos_longitude * vector.y_m - self.sin_longitude * vector.x_m,
            north: self.cos_latitude * vector.z_m - self.sin_latitude * outward,
            up: self.cos_latitude * outward + self.sin_latitude * vector.z_m,
        }
    }

    /// An east, north, up vector back in the earth-fixed frame.
    pub fn unrotate(&self, vector: Enu) -> Ecef {
        let outward = self.cos_latitude * vector.up - self.sin_latitude * vector.north;
        Ecef::new(
            self.cos_longitude * outward - self.sin_longitude * vector.east,
            self.sin_longitude * outward + self.cos_longitude * vector.east,
            self.cos_latitude * vector.north + self.sin_latitude * vector.up,
        )
    }
}

/// Sine and cosine of the geodetic latitude, from the distance to the axis and the height over the equator.
fn latitude(axial_m: f64, z_m: f64, radius_m: f64) -> (f64, f64) {
    const SECOND_ECCENTRICITY_SQUARED: f64 = ECCENTRICITY_SQUARED / (1.0 - ECCENTRICITY_SQUARED);
    // Reduced latitude, Bowring's improved start.
    let tangent_top =
        z_m * SEMI_MINOR_AXIS_M * (1.0 + SECOND_ECCENTRICITY_SQUARED * SEMI_MINOR_AXIS_M / radius_m);
    let tangent_bottom = SEMI_MAJOR_AXIS_M * axial_m;
    let length = libm::sqrt(tangent_top * tangent_top + tangent_bottom * tangent_bottom);
    let (sin_reduced, cos_reduced) = (tangent_top / length, tangent_bottom / length);
    let north =
        z_m + SECOND_ECCENTRICITY_SQUARED * SEMI_MINOR_AXIS_M * sin_reduced * sin_reduced * sin_reduced;
    let outward =
        axial_m - ECCENTRICITY_SQUARED * SEMI_MAJOR_AXIS_M * cos_reduced * cos_reduced * cos_reduced;
    let length = libm::sqrt(north * north + outward * outward);
    if length > 0.0 { (north / length, outward / length) } else { (0.0, 1.0) }
}

/// What a receiver sees of a satellite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sight<T> {
    /// Straight distance between the satellite at transmission and the receiver, m.
    pub(crate) distance_m: f64,
    /// What the earth's rotation adds to the distance while the signal travels, m.
    pub(crate) rotation: T,
    /// Unit vector receiver → satellite, east, north, up.
    pub(crate) direction: Vector3<T>,
}

/// A receiver's place as a scalar of directions has it.
///
/// A range must be right to a millimetre in 26,000 km and is a double. A direction that is right to 1e-7 moves no
/// residual, nor do the 40 m of the earth's rotation with as many digits: both are worked out in what the processor
/// has in hardware.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lookout<T: Real> {
    point: Ecef,
    /// Rows east, north, up.
    axes: Matrix3<T>,
    /// `ω/c (x, y)` of the receiver, dimensionless.
    turning: [T; 2],
}

impl<T: Real> Lookout<T> {
    /// A receiver at `point`, whose frame is `frame`.
    pub(crate) fn at(point: Ecef, frame: &LocalFrame) -> Self {
        const RATE: f64 = EARTH_ROTATION_RAD_S / SPEED_OF_LIGHT_M_S;
        let [sin_latitude, cos_latitude, sin_longitude, cos_longitude] =
            [frame.sin_latitude, frame.cos_latitude, frame.sin_longitude, frame.cos_longitude].map(T::narrow);
        #[rustfmt::skip]
        let axes = Matrix3::new(
            -sin_longitude, cos_longitude, T::zero(),
            -sin_latitude * cos_longitude, -sin_latitude * sin_longitude, cos_latitude,
            cos_latitude * cos_longitude, cos_latitude * sin_longitude, sin_latitude,
        );
        Self { point, axes, turning: [RATE * point.x_m, RATE * point.y_m].map(T::narrow) }
    }

    /// What is seen of a satellite that sent its signal from `satellite`.
    ///
    /// The satellite's coordinates are those of the earth-fixed frame at transmission. While the signal travels,
    /// the earth turns; to first order in the angle this adds `ω/c (x_s y_r − y_s x_r)` to the range (second
    /// order: 0.3 mm). The difference of the positions gives the same product as the satellite's position.
    pub(crate) fn sight(&self, satellite: Ecef) -> Sight<T> {
        let difference = satellite - self.point;
        let distance_m = difference.radius_m();
        let sight = Vector3::new(difference.x_m, difference.y_m, difference.z_m).map(T::narrow);
        let [turning_x, turning_y] = self.turning;
        Sight {
            distance_m,
            rotation: sight.x * turning_y - sight.y * turning_x,
            direction: self.axes * sight * T::narrow(distance_m).recip(),
        }
    }
}

impl LocalFrame {
    /// Sine of the elevation at which the origin sees a point.
    pub fn sin_elevation(&self, origin: Ecef, point: Ecef) -> f64 {
        let difference = point - origin;
        let distance_m = difference.radius_m();
        if distance_m > 0.0 { self.rotate(difference).up / distance_m } else { 1.0 }
    }
}
