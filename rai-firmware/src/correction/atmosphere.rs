//! Atmosphere: the delays that the troposphere and, on one frequency, the ionosphere add to a
//! range.
//!
//! Troposphere, [Saastamoinen1972] zenith delay in a standard atmosphere, mapped as in [DO-229]
//! (after Black and Eisner):
//!
//! ```text
//! p = 1013.25 (1 − 2.2557e-5 h)^5.2568      T = 288.15 − 0.0065 h
//! e = 6.108 · 0.7 · exp((17.15 T − 4684)/(T − 38.45))
//! Z = 0.0022768 p / (1 − 0.00266 cos 2φ − 2.8e-7 h) + 0.002277 (1255/T + 0.05) e
//! delay = Z · 1.001 / √(0.002001 + sin² E)
//! ```
//!
//! Ionosphere, [Klobuchar1987] with the eight coefficients that GPS broadcasts; it removes about
//! half of the delay. Delays on another frequency scale with `1/f²`. `BeiDou` broadcasts eight
//! coefficients of another model ([BDS-SIS-B1I] 5.2.4.7), which is also half a cosine over the day:
//!
//! | | GPS | `BeiDou` |
//! |---|---|---|
//! | carrier | L1 | B1I |
//! | pierced at | 350 km, approximated | 375 km, on the sphere |
//! | polynomials in | geomagnetic latitude | geographic latitude, without its sign |
//! | period | 20 h or more | 20 h to 48 h |
//! | cosine | by its series | exact |
//! | path | `1 + 16 (0.53 − E)³`, `E` in semicircles | `1/√(1 − (R cos E/(R + h))²)` |
//!
//! | symbol | here | unit |
//! |---|---|---|
//! | `h`, `φ` | height, latitude of the receiver | m, rad |
//! | `p`, `T`, `e` | pressure, temperature, vapour pressure | hPa, K, hPa |
//! | `Z` | `zenith_m` | m |
//! | `E` | elevation, given as its sine | 1 |
//!
//! The models are accurate to some per cent. Single precision, accurate to 0.01 mm, therefore
//! suffices.
//!
//! Assumes 70 % relative humidity. Accurate to about 5 % of the zenith's wet part (some
//! centimetres) and, down to 4° of elevation, to 0.2 m. References: [Saastamoinen1972], [DO-229]
//! A.4.2.4, [Klobuchar1987], [IS-GPS-200] 20.3.3.5.2.5, [BDS-SIS-B1I] 5.2.4.7.
//!
//! [BDS-SIS-B1I]: crate#references
//! [Saastamoinen1972]: crate#references
//! [DO-229]: crate#references
//! [Klobuchar1987]: crate#references
//! [IS-GPS-200]: crate#references

use core::f32::consts::PI;

use raim_core::frame::SPEED_OF_LIGHT_M_S;
use raim_core::internals::numeric::angle::arc_sine;
use raim_core::internals::numeric::sqrt;

use crate::raw::Band;
use crate::time::{BEIDOU_OFFSET_MS, GpsTime};

/// Height range of the standard atmosphere, m: below the lowest land, above the highest aircraft.
const HEIGHT_M: core::ops::RangeInclusive<f32> = -500.0..=20_000.0;

/// The troposphere above one receiver. It is computed once per epoch, because it costs a power and
/// an exponential.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Troposphere {
    zenith_m: f32,
}

impl Troposphere {
    /// Returns the troposphere above a point.
    ///
    /// Heights outside −500 m to 20,000 m count as the nearer bound, a height that is not finite as
    /// 0.
    pub fn above(height_m: f32, sin_latitude: f32) -> Self {
        let height_m = if height_m.is_finite() { height_m } else { 0.0 };
        let height_m = height_m.clamp(*HEIGHT_M.start(), *HEIGHT_M.end());
        // cos 2φ from the sine, which the receiver already has.
        let cos_doubled = (1.0 - 2.0 * sin_latitude * sin_latitude).clamp(-1.0, 1.0);
        let gravity = 1.0 - 0.00266 * cos_doubled - 2.8e-7 * height_m;
        let zenith_m = 0.0022768 * pressure_hpa(height_m) / gravity + wet_zenith_m(height_m);
        Self { zenith_m }
    }

    /// Returns the delay towards the zenith, m.
    pub const fn zenith_m(self) -> f32 {
        self.zenith_m
    }

    /// Returns the delay towards an elevation, m. Below the horizon it equals that at the horizon.
    pub fn delay_m(self, sin_elevation: f32) -> f32 {
        let sin_elevation = sin_elevation.clamp(0.0, 1.0);
        self.zenith_m * 1.001 / sqrt(0.002001 + sin_elevation * sin_elevation)
    }
}

/// Returns the pressure of the standard atmosphere, hPa.
fn pressure_hpa(height_m: f32) -> f32 {
    // The power is `exp(b log a)`, with two functions that the image has anyway.
    1013.25 * libm::expf(5.2568 * libm::logf(1.0 - 2.2557e-5 * height_m))
}

/// Returns the zenith delay of the water vapour, m.
fn wet_zenith_m(height_m: f32) -> f32 {
    const RELATIVE_HUMIDITY: f32 = 0.7;
    let temperature_k = 288.15 - 0.0065 * height_m;
    let saturation_hpa = 6.108 * libm::expf((17.15 * temperature_k - 4684.0) / (temperature_k - 38.45));
    0.002277 * (1255.0 / temperature_k + 0.05) * RELATIVE_HUMIDITY * saturation_hpa
}

/// Model of the ionosphere that the coefficients belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Model {
    Gps,
    Beidou,
}

/// The broadcast coefficients of the single-frequency ionosphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Klobuchar {
    model: Model,
    /// Amplitude polynomial: s, s/semicircle, s/semicircle², s/semicircle³.
    alpha: [f32; 4],
    /// Period polynomial, in the same units.
    beta: [f32; 4],
}

/// Night-time delay towards the zenith, s.
const NIGHT_S: f32 = 5e-9;

/// Ratio of the earth's radius to that of the ionospheric shell of `BeiDou`'s model, at a height of
/// 375 km.
const SHELL_RATIO: f32 = 6378.0 / (6378.0 + 375.0);

/// Result of the model for one line of sight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slant {
    /// Delay on L1, m.
    pub delay_m: f32,
    /// Geomagnetic latitude of the pierce point, semicircles.
    pub geomagnetic_sc: f32,
}

impl Klobuchar {
    /// Model without coefficients: the night-time constant at all hours.
    pub const NIGHT: Self = Self { model: Model::Gps, alpha: [0.0; 4], beta: [0.0; 4] };

    /// Returns the model of GPS from coefficients in the order of the message: four of the
    /// amplitude, four of the period.
    ///
    /// `None` if a coefficient is not finite or larger than its field in the message (2⁻²³ s, 2²³
    /// s, with room for the steeper powers). Also `None` if all coefficients of the amplitude or
    /// the period are zero, which means that no value is known.
    pub fn new(coefficients: [f64; 8]) -> Option<Self> {
        Self::of(Model::Gps, coefficients)
    }

    /// Returns `BeiDou`'s model from its coefficients, under the same conditions.
    pub fn of_beidou(coefficients: [f64; 8]) -> Option<Self> {
        Self::of(Model::Beidou, coefficients)
    }

    fn of(model: Model, coefficients: [f64; 8]) -> Option<Self> {
        let [a0, a1, a2, a3, b0, b1, b2, b3] = coefficients;
        let (alpha, beta) = ([a0, a1, a2, a3], [b0, b1, b2, b3]);
        let is_sound = alpha.iter().all(|a| a.abs() <= 1e-4) && beta.iter().all(|b| b.abs() <= 1e7);
        let says_something = alpha.iter().any(|a| *a != 0.0) && beta.iter().any(|b| *b != 0.0);
        let narrow = |terms: [f64; 4]| terms.map(|term| term as f32);
        (is_sound && says_something).then(|| Self { model, alpha: narrow(alpha), beta: narrow(beta) })
    }

    /// Returns the delay towards a satellite.
    ///
    /// `line_of_sight` is the unit vector receiver → satellite, east, north, up. The delay is zero
    /// for a direction or a place that is not finite.
    pub fn slant(&self, place: Place, line_of_sight: [f32; 3]) -> Slant {
        let [east, north, up] = line_of_sight;
        let horizontal = sqrt(east * east + north * north);
        let elevation_sc = libm::atan2f(up.max(0.0), horizontal) / PI;
        let pierce = PiercePoint::of(place, [east, north], horizontal, elevation_sc);
        let (vertical_s, longer) = match self.model {
            // Only the messages of u-blox receivers bring the coefficients of `BeiDou`.
            Model::Beidou if cfg!(feature = "ubx") => {
                self.beidou(place, [east, north, up.max(0.0)], horizontal)
            }
            _ => {
                let local_s = local_time_s(pierce.longitude_sc, place.time_of_day_s);
                let lower = 0.53 - elevation_sc;
                (self.vertical_s(pierce.geomagnetic_sc, local_s), 1.0 + 16.0 * lower * lower * lower)
            }
        };
        let delay_m = SPEED_OF_LIGHT_M_S as f32 * longer * vertical_s;
        let delay_m = if delay_m.is_finite() { delay_m } else { 0.0 };
        Slant { delay_m, geomagnetic_sc: pierce.geomagnetic_sc }
    }

    /// Returns `BeiDou`'s delay towards the zenith on L1, s, and the ratio of the slant path to the
    /// vertical one.
    fn beidou(&self, place: Place, [east, north, up]: [f32; 3], horizontal: f32) -> (f32, f32) {
        /// Factor from B1I to L1: `f²/f₁²`.
        const TO_L1: f32 = {
            let ratio = Band::B1I.frequency_hz() / Band::L1.frequency_hz();
            (ratio * ratio) as f32
        };
        // Cosine of the elevation, for a unit vector above the horizon.
        let cos_elevation = (horizontal / sqrt(horizontal * horizontal + up * up)).min(1.0);
        let (latitude_sc, longitude_sc) = on_the_sphere(place, [east, north], horizontal, cos_elevation);
        let local_s = local_time_s(longitude_sc, place.time_of_day_s - BEIDOU_OFFSET_MS as f32 * 1e-3);
        let slanted = SHELL_RATIO * cos_elevation;
        let vertical_s = TO_L1 * self.beidou_vertical_s(latitude_sc.abs(), local_s);
        (vertical_s, 1.0 / sqrt(1.0 - slanted * slanted))
    }

    /// Returns the vertical delay on B1I by `BeiDou`'s model, s; `latitude_sc` is geographic,
    /// without its sign.
    fn beidou_vertical_s(&self, latitude_sc: f32, local_s: f32) -> f32 {
        let amplitude_s = polynomial(&self.alpha, latitude_sc).max(0.0);
        let period_s = polynomial(&self.beta, latitude_sc).clamp(72_000.0, 172_800.0);
        let since_peak_s = local_s - 50_400.0;
        if since_peak_s.abs() >= 0.25 * period_s {
            return NIGHT_S;
        }
        NIGHT_S + amplitude_s * cosine(2.0 * since_peak_s / period_s)
    }

    /// Returns the vertical delay on L1, s: 5 ns at night, half a cosine about two in the
    /// afternoon.
    fn vertical_s(&self, geomagnetic_sc: f32, local_s: f32) -> f32 {
        let amplitude_s = polynomial(&self.alpha, geomagnetic_sc).max(0.0);
        let period_s = polynomial(&self.beta, geomagnetic_sc).max(72_000.0);
        let phase_rad = 2.0 * PI * (local_s - 50_400.0) / period_s;
        if phase_rad.abs() >= 1.57 {
            return NIGHT_S;
        }
        let square = phase_rad * phase_rad;
        NIGHT_S + amplitude_s * (1.0 - square / 2.0 + square * square / 24.0)
    }
}

/// Place and time of a receiver below the ionosphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Geodetic latitude, semicircles.
    pub latitude_sc: f32,
    /// Longitude, semicircles.
    pub longitude_sc: f32,
    /// GPS time of day, s.
    pub time_of_day_s: f32,
}

impl Place {
    /// Returns a place at an instant.
    pub fn at(latitude_rad: f32, longitude_rad: f32, time: GpsTime) -> Self {
        const DAY_MS: u32 = 86_400_000;
        Self {
            latitude_sc: latitude_rad / PI,
            longitude_sc: longitude_rad / PI,
            time_of_day_s: (time.tow_ms % DAY_MS) as f32 * 1e-3,
        }
    }
}

/// Crossing of the line of sight with the ionosphere.
struct PiercePoint {
    longitude_sc: f32,
    /// Geomagnetic latitude, semicircles.
    geomagnetic_sc: f32,
}

impl PiercePoint {
    fn of(place: Place, [east, north]: [f32; 2], horizontal: f32, elevation_sc: f32) -> Self {
        let central_sc = 0.0137 / (elevation_sc + 0.11) - 0.022;
        // The zenith has no azimuth. Any serves, because the angle at the centre is nearly 0 there.
        let scale = if horizontal > 1e-6 { central_sc / horizontal } else { 0.0 };
        let latitude_sc = (place.latitude_sc + scale * north).clamp(-0.416, 0.416);
        let longitude_sc = place.longitude_sc + scale * east / cosine(latitude_sc);
        let geomagnetic_sc = latitude_sc + 0.064 * cosine(longitude_sc - 1.617);
        Self { longitude_sc, geomagnetic_sc }
    }
}

/// Returns latitude and longitude at which a line of sight crosses the shell of `BeiDou`'s model,
/// semicircles.
fn on_the_sphere(place: Place, [east, north]: [f32; 2], horizontal: f32, cos_elevation: f32) -> (f32, f32) {
    // A right angle minus the elevation is the arc sine of the elevation's cosine.
    let central_rad = arc_sine(cos_elevation) - arc_sine(SHELL_RATIO * cos_elevation);
    let [(sin_central, cos_central), (sin_latitude, cos_latitude)] =
        [central_rad / PI, place.latitude_sc].map(|angle_sc| (cosine(angle_sc - 0.5), cosine(angle_sc)));
    // The zenith has no azimuth, and the angle at the centre is 0 there.
    let scale = if horizontal > 1e-6 { 1.0 / horizontal } else { 0.0 };
    let sine = sin_latitude * cos_central + cos_latitude * sin_central * north * scale;
    let latitude_sc = arc_sine(sine) / PI;
    let turn = sin_central * east * scale / cosine(latitude_sc);
    (latitude_sc, place.longitude_sc + arc_sine(turn) / PI)
}

/// Returns the local solar time at the pierce point, s in 0..86,400.
fn local_time_s(longitude_sc: f32, time_of_day_s: f32) -> f32 {
    let sum_s = 43_200.0 * longitude_sc + time_of_day_s;
    sum_s - 86_400.0 * libm::floorf(sum_s / 86_400.0)
}

/// Returns `c0 + c1 x + c2 x² + c3 x³`.
fn polynomial(coefficients: &[f32; 4], x: f32) -> f32 {
    coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
}

/// Returns the cosine of an angle in semicircles, to 3e-7, because the library's function works in
/// double precision.
///
/// `cos 2x = 1 − 2 sin² x`, with the series of the sine to the eleventh power on ±π/2.
fn cosine(semicircles: f32) -> f32 {
    let x = 0.5 * PI * (semicircles - 2.0 * libm::roundf(0.5 * semicircles));
    let q = x * x;
    let series = 1.0
        + q * (-1.0 / 6.0
            + q * (1.0 / 120.0 + q * (-1.0 / 5040.0 + q * (1.0 / 362_880.0 - q / 39_916_800.0))));
    let sine = x * series;
    1.0 - 2.0 * sine * sine
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cosine_of_semicircles_is_that_of_the_library() {
        for step in -4000_i16..=4000 {
            let semicircles = f32::from(step) * 1e-3;
            let want = libm::cos(core::f64::consts::PI * f64::from(semicircles)) as f32;
            let have = cosine(semicircles);
            assert!((have - want).abs() < 1e-6, "{semicircles}: have {have}, want {want}");
        }
    }
}
