//! The broadcast Kepler orbit, in integers.
//!
//! ```text
//! n = √(µ/a³) + Δn          M = M0 + n t           E − e sin E = M
//! ρ = 1 − e cos E           ν = (cos E − e, √(1 − e²) sin E)/ρ       φ = ν + ω
//! u = φ + δu(2φ)            r = a ρ + δr(2φ)
//! i = i0 + i̇ t + δi(2φ)     Ω = Ω0 + (Ω̇ − ω_e) t − ω_e toe
//! X = R_z(−Ω) R_x(−i) r (cos u, sin u, 0)
//! geostationary BeiDou: X = R_z(ω_e t) R_x(−5°) R_z(−Ω − ω_e t) R_x(−i) …
//! Δt_r = −2 √µ/c² · e √a sin E
//! ```
//!
//! | symbol | here | unit |
//! |---|---|---|
//! | `t` | [`Elapsed`] | 2⁻⁴⁶ s of system time since `toe` |
//! | `n`, `Ω̇`, `i̇`, `ω_e` | `…_2_76`; broadcast ones `…_2_44` | 2⁻⁷⁶, 2⁻⁴⁴ turns/s |
//! | `e`, `ρ`, sines | `…_q62` | 2⁻⁶² |
//! | `ν`, `φ`, `u`, `i`, `Ω` | [`Direction`], [`Turns`] | – |
//! | `a`, `r`, `X` | `…_m36` | 2⁻³⁶ m, below 2²⁷ m |
//! | `Δt_r` | `relativity_s62` | 2⁻⁶² s |
//!
//! **Why integers.** The elements are fixed-point numbers by nature. A core without double
//! precision multiplies integers twenty times faster than soft doubles, and integers are the same
//! on every machine. Every element is stored in the finest unit in which any system broadcasts it,
//! so that it stays exact. The first guesses of the anomaly and of a reciprocal, with 24 bits, are
//! in single precision; exact remainders correct both.
//!
//! **Accuracy.** Within 0.05 mm and 1e-17 s of the equations in double precision, over all accepted
//! elements and a day on either side of `toe`. Tests bound it by 0.5 mm and 1e-13 s. The third
//! power of `δu`, 0.01 mm, is neglected.
//!
//! References: [IS-GPS-200] table 20-IV; [OS-SIS-ICD] table 64; [BDS-SIS-B1I] table 5-11.
//!
//! [IS-GPS-200]: crate#references
//! [OS-SIS-ICD]: crate#references
//! [BDS-SIS-B1I]: crate#references

use raim_core::internals::numeric::sqrt_f64;
use raim_core::satellite::SatelliteId;

use super::elapsed::Elapsed;
use super::fixed::{Direction, ONE_Q62, Turns, mul_high, nearest, nearest_i32, scaled, times_q62};
use super::motion::Motion;
use super::orbit_types::Shape;
use super::{Broadcast, BroadcastError, Source};
use crate::division::divided;
use crate::time::{BEIDOU_OFFSET_MS, WEEK_MS};

/// Constants that an interface document fixes for its elements.
struct Convention {
    /// `√µ/2π`, m^1.5 turns/s.
    motion_turns_s: f64,
    /// Rotation of the earth, 2⁻⁷⁶ turns/s.
    earth_rate_2_76: i64,
    /// `2 √µ/c²`, 2⁻⁹⁴ s/√m.
    relativity_2_94: i64,
}

/// [IS-GPS-200] table 20-IV: µ = 3.986005e14 m³/s², `ω_e` = 7.2921151467e-5 rad/s.
///
/// [IS-GPS-200]: crate#references
const GPS: Convention = Convention {
    motion_turns_s: 3_177_525.549_087_987,
    earth_rate_2_76: 876_906_561_865_128_641,
    relativity_2_94: 8_799_887_129_951_988_011,
};
/// [OS-SIS-ICD] table 64: µ = 3.986004418e14 m³/s², `ω_e` = 7.2921151467e-5 rad/s.
///
/// [OS-SIS-ICD]: crate#references
const GALILEO: Convention = Convention {
    motion_turns_s: 3_177_525.317_111_367,
    earth_rate_2_76: 876_906_561_865_128_641,
    relativity_2_94: 8_799_886_487_512_440_572,
};
/// [BDS-SIS-B1I] table 5-11: µ = 3.986004418e14 m³/s², `ω_e` = 7.292115e-5 rad/s.
///
/// [BDS-SIS-B1I]: crate#references
const BEIDOU: Convention = Convention {
    motion_turns_s: 3_177_525.317_111_367,
    earth_rate_2_76: 876_906_544_223_855_836,
    relativity_2_94: 8_799_886_487_512_440_572,
};

/// Sine and cosine of −5°, the tilt of the plane of the geostationary elements ([BDS-SIS-B1I] table
/// 5-11).
///
/// [BDS-SIS-B1I]: crate#references
const GEOSTATIONARY_TILT: Direction =
    Direction { sin_q62: -401_934_920_255_029_411, cos_q62: 4_594_137_160_821_195_716 };

/// Cosine of 10°, the most that a geostationary orbit is inclined to the equator, 2⁻⁶². That is
/// eleven years of drift.
const MOST_INCLINED_COS_Q62: i64 = 4_541_624_145_405_292_122;

/// Steps of Newton's method from `e sin M`, each of which squares the error.
///
/// For an eccentricity of 0.2 the error goes from 0.04 over 2e-4 and 5e-9 to below the resolution
/// of single precision.
const NEWTON_STEPS: usize = 3;

/// Number of 2⁻³² turns in a radian.
const TURN_2_32_PER_RAD: f32 = 683_565_275.6;

/// Interface document for the elements.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Reading {
    Gps,
    Galileo,
    Beidou,
    BeidouGeostationary,
}

/// The checked elements of an orbit, each in the finest unit in which it is broadcast.
///
/// It is packed, so that the tag of the orbit's form fits in the last word.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(Rust, packed(4))]
pub struct Kepler {
    /// Mean motion with its correction, 2⁻⁷⁶ turns/s.
    motion_2_76: i64,
    flattening_q62: i64,
    /// Longitude of the node at `toe`, `Ω0 − ω_e toe`.
    node: Turns,
    /// √a, 2⁻¹⁹ √m.
    sqrt_a_2_19: u32,
    eccentricity_2_33: u32,
    /// Angles at `toe`, 2⁻³² turns.
    mean_2_32: i32,
    inclination_2_32: i32,
    perigee_2_32: i32,
    node_rate_2_44: i32,
    inclination_rate_2_44: i32,
    /// Corrections of the argument of latitude and of the inclination, 2⁻³¹ rad; of the radius, 2⁻⁶
    /// m.
    latitude: Harmonic,
    inclination: Harmonic,
    radius: Harmonic,
    reading: Reading,
}

/// A correction `c cos 2φ + s sin 2φ`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Harmonic {
    cos: i32,
    sin: i32,
}

impl Harmonic {
    /// Returns a correction with terms in 2^−`exponent`.
    fn of(cos: f32, sin: f32, exponent: i32) -> Self {
        let units = |term: f32| nearest_i32(f64::from(term), exponent);
        Self { cos: units(cos), sin: units(sin) }
    }

    /// Returns the correction, 2⁻³⁰ of the unit of its terms.
    fn at(self, doubled: Doubled) -> i64 {
        i64::from(self.cos) * doubled.cos_q30 + i64::from(self.sin) * doubled.sin_q30
    }
}

/// Cosine and sine of twice an angle, 2⁻³⁰.
#[derive(Clone, Copy)]
struct Doubled {
    cos_q30: i64,
    sin_q30: i64,
}

impl Doubled {
    fn of(angle: Direction) -> Self {
        let (cos_q30, sin_q30) = (angle.cos_q62 >> 32, angle.sin_q62 >> 32);
        Self { cos_q30: ((cos_q30 * cos_q30) >> 29) - (1 << 30), sin_q30: (cos_q30 * sin_q30) >> 29 }
    }
}

/// Place in the plane of the orbit: radius, argument of latitude, inclination.
struct InPlane {
    radius_m36: i64,
    latitude: Direction,
    inclination: Direction,
}

impl Kepler {
    /// Returns the elements of a checked message.
    pub(super) fn new(broadcast: &Broadcast) -> Result<Self, BroadcastError> {
        let reading = reading(broadcast)?;
        let convention = reading.convention();
        let sqrt_a_2_19 = nearest(broadcast.sqrt_a_sqrt_m, 19) as u32;
        let sqrt_a_sqrt_m = scaled(i64::from(sqrt_a_2_19), -19);
        let undisturbed_turns_s = convention.motion_turns_s / (sqrt_a_sqrt_m * sqrt_a_sqrt_m * sqrt_a_sqrt_m);
        let eccentricity_2_33 = nearest(broadcast.eccentricity, 33) as u32;
        let e = scaled(i64::from(eccentricity_2_33), -33);
        let at_week_start = Turns::of_broadcast(angle(broadcast.omega0_sc));
        let node = at_week_start.minus(earth_turn(convention, toe_of_system_ms(broadcast)));
        check_orbit(broadcast, reading, node)?;
        Ok(Self {
            motion_2_76: nearest(undisturbed_turns_s, 76) + wide(rate(broadcast.delta_n_sc_s)),
            flattening_q62: nearest(sqrt_f64((1.0 - e) * (1.0 + e)), 62),
            node,
            sqrt_a_2_19,
            eccentricity_2_33,
            mean_2_32: angle(broadcast.m0_sc),
            inclination_2_32: angle(broadcast.i0_sc),
            perigee_2_32: angle(broadcast.omega_sc),
            node_rate_2_44: rate(broadcast.omegadot_sc_s),
            inclination_rate_2_44: rate(broadcast.idot_sc_s),
            latitude: Harmonic::of(broadcast.cuc_rad, broadcast.cus_rad, 31),
            inclination: Harmonic::of(broadcast.cic_rad, broadcast.cis_rad, 31),
            radius: Harmonic::of(broadcast.crc_m, broadcast.crs_m, 6),
            reading,
        })
    }

    /// Returns the motion at an instant.
    pub(super) fn at(&self, since_toe: Elapsed) -> Motion {
        let anomaly = self.eccentric_anomaly(since_toe);
        let plane = self.in_plane(anomaly, since_toe);
        Motion {
            position_m36: self.earth_fixed(&plane, since_toe).coordinates(),
            relativity_s62: self.relativity_s62(anomaly.sin_q62),
        }
    }

    const fn eccentricity_q62(&self) -> i64 {
        (self.eccentricity_2_33 as i64) << 29
    }

    /// Solves `E − e sin E = M` for e of at most 0.2.
    ///
    /// The difference of the anomalies is found in single precision, to 10⁻⁸ rad. Its remainder is
    /// exact, and one more step of Newton's method corrects it.
    fn eccentric_anomaly(&self, since_toe: Elapsed) -> Direction {
        let mean = Turns::of_broadcast(self.mean_2_32).plus(since_toe.turned(self.motion_2_76));
        let eccentricity = single(self.eccentricity_q62());
        let ahead_2_32 = (ahead_rad(mean.direction(), eccentricity) * TURN_2_32_PER_RAD) as i32;
        let anomaly = mean.plus(Turns::of_broadcast(ahead_2_32));
        let direction = anomaly.direction();
        let pulled = times_q62(Turns::of_radians(self.eccentricity_q62()).units(), direction.sin_q62);
        let missing = mean.plus(Turns::new(pulled)).minus(anomaly);
        // It is below 2⁻²² rad, of which single precision loses nothing that counts.
        let missing_q52 = (missing.to_radians_q62() >> 10) as i32 as f32;
        let step_q52 = missing_q52 / (1.0 - eccentricity * single(direction.cos_q62));
        direction.plus_small(i64::from(step_q52 as i32) << 10)
    }

    fn in_plane(&self, anomaly: Direction, since_toe: Elapsed) -> InPlane {
        let eccentricity_q62 = self.eccentricity_q62();
        let ratio_q62 = ONE_Q62 - times_q62(eccentricity_q62, anomaly.cos_q62);
        let inverse_q62 = reciprocal_q62(ratio_q62);
        let true_anomaly = Direction {
            cos_q62: times_q62(anomaly.cos_q62 - eccentricity_q62, inverse_q62),
            sin_q62: times_q62(times_q62(anomaly.sin_q62, self.flattening_q62), inverse_q62),
        };
        let latitude = true_anomaly.plus(Turns::of_broadcast(self.perigee_2_32).direction());
        let doubled = Doubled::of(latitude);
        let tilt = Turns::of_radians(self.inclination.at(doubled) << 1);
        let turned = since_toe.turned(wide(self.inclination_rate_2_44));
        InPlane {
            radius_m36: times_q62(self.axis_m36(), ratio_q62) + self.radius.at(doubled),
            latitude: latitude.plus_small(self.latitude.at(doubled) << 1),
            inclination: Turns::of_broadcast(self.inclination_2_32).plus(turned).plus(tilt).direction(),
        }
    }

    const fn axis_m36(&self) -> i64 {
        ((self.sqrt_a_2_19 as u64 * self.sqrt_a_2_19 as u64) >> 2).cast_signed()
    }

    fn earth_fixed(&self, plane: &InPlane, since_toe: Elapsed) -> Point {
        let earth_rate_2_76 = self.reading.convention().earth_rate_2_76;
        let node_rate_2_76 = wide(self.node_rate_2_44);
        if self.reading == Reading::BeidouGeostationary {
            let at_toe = plane.towards(self.node.plus(since_toe.turned(node_rate_2_76)).direction());
            at_toe.about_x(GEOSTATIONARY_TILT).about_z(since_toe.turned(earth_rate_2_76).direction())
        } else {
            let turned = since_toe.turned(node_rate_2_76 - earth_rate_2_76);
            plane.towards(self.node.plus(turned).direction())
        }
    }

    /// Returns the periodic relativistic clock error from the eccentricity, 2⁻⁶² s.
    fn relativity_s62(&self, sin_anomaly_q62: i64) -> i64 {
        let size_2_52 = (u64::from(self.eccentricity_2_33) * u64::from(self.sqrt_a_2_19)).cast_signed();
        let size_2_50 = mul_high(size_2_52, sin_anomaly_q62);
        -(mul_high(size_2_50, self.reading.convention().relativity_2_94) >> 18)
    }
}

impl InPlane {
    /// Returns the position for this direction of the ascending node.
    fn towards(&self, node: Direction) -> Point {
        let along_m36 = times_q62(self.radius_m36, self.latitude.cos_q62);
        let across_m36 = times_q62(self.radius_m36, self.latitude.sin_q62);
        let level_m36 = times_q62(across_m36, self.inclination.cos_q62);
        let height_m36 = times_q62(across_m36, self.inclination.sin_q62);
        Point { x: along_m36, y: level_m36, z: height_m36 }.about_z(node.reversed())
    }
}

/// A point; coordinates in 2⁻³⁶ m.
#[derive(Clone, Copy)]
struct Point {
    x: i64,
    y: i64,
    z: i64,
}

impl Point {
    fn about_x(self, by: Direction) -> Self {
        Self {
            y: times_q62(self.y, by.cos_q62) + times_q62(self.z, by.sin_q62),
            z: times_q62(self.z, by.cos_q62) - times_q62(self.y, by.sin_q62),
            ..self
        }
    }

    fn about_z(self, by: Direction) -> Self {
        Self {
            x: times_q62(self.x, by.cos_q62) + times_q62(self.y, by.sin_q62),
            y: times_q62(self.y, by.cos_q62) - times_q62(self.x, by.sin_q62),
            ..self
        }
    }

    const fn coordinates(self) -> [i64; 3] {
        [self.x, self.y, self.z]
    }
}

impl Reading {
    const fn convention(self) -> &'static Convention {
        match self {
            Self::Gps => &GPS,
            Self::Galileo => &GALILEO,
            Self::Beidou | Self::BeidouGeostationary => &BEIDOU,
        }
    }
}

/// Returns the interface document of these elements, or an error for a message without elements.
fn reading(broadcast: &Broadcast) -> Result<Reading, BroadcastError> {
    match broadcast.source {
        Source::GpsLnav | Source::QzssLnav => Ok(Reading::Gps),
        Source::GalileoFnav | Source::GalileoInav => Ok(Reading::Galileo),
        Source::BeidouD1D2 if is_geostationary(broadcast.satellite) => Ok(Reading::BeidouGeostationary),
        Source::BeidouD1D2 => Ok(Reading::Beidou),
        Source::GlonassStrings => Err(BroadcastError::Form),
    }
}

/// Checks that satellites of the system have such an orbit; `node` is the longitude of the node at
/// `toe`.
fn check_orbit(broadcast: &Broadcast, reading: Reading, node: Turns) -> Result<(), BroadcastError> {
    let is_geostationary = reading == Reading::BeidouGeostationary;
    let inclination_sc = if !is_geostationary {
        broadcast.i0_sc
    } else if cos_to_equator_q62(broadcast.i0_sc, node) >= MOST_INCLINED_COS_Q62 {
        0.0
    } else {
        return Err(BroadcastError::OrbitType);
    };
    let shape = Shape {
        sqrt_a_sqrt_m: broadcast.sqrt_a_sqrt_m,
        eccentricity: broadcast.eccentricity,
        inclination_sc,
    };
    if shape.is_of(broadcast.source, is_geostationary) { Ok(()) } else { Err(BroadcastError::OrbitType) }
}

/// Returns the cosine of the angle between the equator and an orbit whose elements refer to the
/// tilted plane, 2⁻⁶². It is the last coordinate of the orbit's normal, `(sin i sin Ω, −sin i cos
/// Ω, cos i)`, turned back by 5° about x.
fn cos_to_equator_q62(inclination_sc: f64, node: Turns) -> i64 {
    let inclination = Turns::of_broadcast(angle(inclination_sc)).direction();
    let level_q62 = -times_q62(inclination.sin_q62, node.direction().cos_q62);
    times_q62(inclination.cos_q62, GEOSTATIONARY_TILT.cos_q62)
        - times_q62(level_q62, GEOSTATIONARY_TILT.sin_q62)
}

/// Returns the reference time within the week of the satellite's own system, ms.
fn toe_of_system_ms(broadcast: &Broadcast) -> u32 {
    let behind_ms = if broadcast.source == Source::BeidouD1D2 { BEIDOU_OFFSET_MS } else { 0 };
    (broadcast.toe.tow_ms + (WEEK_MS - behind_ms)) % WEEK_MS
}

/// Returns the turn of the earth in a part of a week. Its rounding adds up to 10⁻¹³ rad in a week.
fn earth_turn(convention: &Convention, ms: u32) -> Turns {
    let per_second = (convention.earth_rate_2_76 + (1 << 11)) >> 12;
    let (seconds, rest) = (i64::from(ms / 1000), i64::from(ms % 1000));
    let (per_ms, _) = divided(per_second.cast_unsigned(), 1000);
    Turns::new(per_second.wrapping_mul(seconds).wrapping_add(per_ms.cast_signed() * rest))
}

/// Returns true for the `BeiDou` numbers of geostationary satellites ([BDS-SIS-B1I] 4.2, table
/// 4-1).
///
/// [BDS-SIS-B1I]: crate#references
const fn is_geostationary(satellite: SatelliteId) -> bool {
    matches!(satellite.number(), 1..=5 | 59..=63)
}

/// Converts semicircles to 2⁻³² turns; a full semicircle becomes minus one.
fn angle(semicircles: f64) -> i32 {
    nearest(semicircles, 31) as i32
}

/// Converts semicircles per second to 2⁻⁴⁴ turns per second.
fn rate(semicircles_s: f64) -> i32 {
    nearest_i32(semicircles_s, 43)
}

/// Converts a rate from 2⁻⁴⁴ turns per second to 2⁻⁷⁶.
const fn wide(rate_2_44: i32) -> i64 {
    (rate_2_44 as i64) << 32
}

/// Returns the eccentric anomaly minus the mean one, rad: the root of `D − e sin(M + D)`.
///
/// The slope is at least 0.8, so that no step divides by a small number. The series of a sine and
/// cosine of at most 0.25 rad end at the resolution of single precision.
fn ahead_rad(mean: Direction, eccentricity: f32) -> f32 {
    let (sin_mean, cos_mean) = (single(mean.sin_q62), single(mean.cos_q62));
    let mut ahead_rad = eccentricity * sin_mean;
    for _ in 0..NEWTON_STEPS {
        let square = ahead_rad * ahead_rad;
        let sin = ahead_rad * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0)));
        let cos = 1.0 - square * (0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0)));
        let missing_rad = ahead_rad - eccentricity * (sin_mean * cos + cos_mean * sin);
        let slope = 1.0 - eccentricity * (cos_mean * cos - sin_mean * sin);
        ahead_rad -= missing_rad / slope;
    }
    ahead_rad
}

/// Converts a ratio to single precision.
fn single(ratio_q62: i64) -> f32 {
    const SCALE: f32 = 1.0 / (1 << 24) as f32;
    (ratio_q62 >> 38) as i32 as f32 * SCALE
}

/// Returns `1/ρ` for 0.7 < ρ < 1.5, to 2⁻⁴⁴: a guess in single precision, and one step of Newton's
/// method.
fn reciprocal_q62(ratio_q62: i64) -> i64 {
    const ONE_Q30: f32 = (1 << 30) as f32;
    let guess_q62 = i64::from((ONE_Q30 / single(ratio_q62)) as i32) << 32;
    guess_q62 + times_q62(guess_q62, ONE_Q62 - times_q62(ratio_q62, guess_q62))
}
