//! Range rates: from Doppler frequencies and the motion of the satellites.
//!
//! ```text
//! y = −λ D − e · v_s (1 − e · v_s / c) + c Δt'_sat
//! v_s = (r_k − r_{k−1}) / Δt + (2 a_k + a_{k−1}) Δt / 6
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `D`, `λ` | Doppler frequency, positive when approaching, and wavelength | Hz, m |
//! | `r_k`, `r_{k−1}`, `Δt` | place of the satellite when its signal of this epoch and of the last one left; time between the epochs | m, s |
//! | `a` | its acceleration in the earth-fixed frame: gravity, centrifugal, Coriolis | m/s² |
//! | `e` | unit vector receiver → satellite | – |
//! | `Δt'_sat` | drift of its clock | s/s |
//!
//! The places of the satellites are the expensive part, and every epoch computes them anyway. Two
//! epochs then give the velocities at little cost. The formula is exact while the acceleration
//! changes linearly; the remaining error is below 1 mm/s up to [`LONGEST_MS`]. If the ephemeris of
//! a satellite has changed between the epochs, its velocity is not computed, because ephemerides
//! differ by metres.
//!
//! The sigma of a rate is 0.05 m/s at 45 dB-Hz and above. Below 45 dB-Hz it grows with the root of
//! the noise density, like the noise of a frequency lock.

use raim_core::frame::{EARTH_ROTATION_RAD_S, SPEED_OF_LIGHT_M_S};
use raim_core::internals::numeric::absolute::{Absolute as _, Grid};
use raim_core::internals::numeric::real::Real;
use raim_core::internals::velocity::RangeRate;
use raim_core::satellite::SatelliteId;

use crate::correction::Located;
use crate::correction::horizon::Horizon;
use crate::ephemeris::difference_m;
use crate::raw::{RawEpoch, RawSatellite};

/// Longest time between two epochs whose difference is a velocity, ms.
pub(super) const LONGEST_MS: i64 = 60_000;

/// The earth's gravitational constant, m³/s² (WGS 84).
const GRAVITY_M3_S2: f32 = 3.986_004_4e14;

/// Sigma of a strong signal's rate, m/s.
const SIGMA_M_S: f32 = 0.05;

/// Part of the speed by which reflections disturb the rate of a strong signal; that of a weaker one
/// grows with the noise density, up to the speed.
const REFLECTED: f32 = 0.1;

/// Least strength of a strong signal, dB-Hz.
const STRONG_DBHZ: f32 = 45.0;

/// Strength that is assumed if the receiver reports none, dB-Hz.
const UNSAID_DBHZ: f32 = 35.0;

/// Doublings of the noise of a rate per dB: it doubles with every 6 dB.
const DOUBLINGS_PER_DB: f32 = 1.0 / 6.02;

/// Sine of the elevation below which rates are not used, because the troposphere disturbs them.
const SIN_MASK: f32 = 0.087;

/// Speed of light, m/s, and the earth's rotation, rad/s, in single precision.
const LIGHT_M_S: f32 = SPEED_OF_LIGHT_M_S as f32;
const TURN_RAD_S: f32 = EARTH_ROTATION_RAD_S as f32;

/// A measured rate with the part of it that the satellite causes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    satellite: SatelliteId,
    /// Unit vector receiver → satellite, east, north, up.
    direction: [f32; 3],
    /// Measured rate of the range, m/s.
    rate_m_s: f32,
    /// Expected rate of a receiver at rest with a perfect clock, m/s.
    expected_m_s: f32,
    sigma_m_s: f32,
}

impl Measured {
    /// Returns its equation beside reflections at a speed, with the measured rate or its negative.
    pub(super) fn equation(&self, sign: f32, speed_m_s: f32) -> RangeRate<f32> {
        RangeRate {
            satellite: self.satellite,
            line_of_sight: self.direction.into(),
            residual_m_s: sign * self.rate_m_s - self.expected_m_s,
            sigma_m_s: self.sigma_m_s + speed_m_s * reflected(self.sigma_m_s),
        }
    }
}

/// State of a satellite when its signal left, in lengths whose differences are exact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    satellite: SatelliteId,
    pub(super) position: [Grid; 3],
    /// Satellite clock times the speed of light.
    clock: Grid,
    /// Range, m. It gives the time at which the signal left, to 7 ns.
    range_m: f32,
    /// Edition of the ephemeris.
    edition: u32,
}

/// The last epoch, with the present epoch and the place of the receiver.
pub(super) struct Since<'r> {
    pub(super) last: &'r [Seen],
    pub(super) raw: &'r RawEpoch,
    pub(super) horizon: Horizon,
    pub(super) elapsed_s: f32,
}

impl Since<'_> {
    /// Returns the measured rate of a satellite, with the part of it that the satellite causes.
    ///
    /// `index` is its index in the sky; in the last epoch and in the raw epoch it has a similar
    /// one.
    pub(super) fn measure(&self, located: &Located, index: usize) -> Option<Measured> {
        let now = Seen::of(located)?;
        let before = now.among(self.last, index)?;
        let is_it = |one: &&RawSatellite| one.satellite == now.satellite;
        // The sky has the order of the raw epoch, but may lack some of its satellites.
        let later = self.raw.satellites.get(index..).unwrap_or_default().iter().find(is_it);
        let satellite = later.or_else(|| self.raw.satellites.iter().find(is_it))?;
        let (rate_m_s, sigma_m_s) = rate(satellite)?;
        let (expected_m_s, direction) = now.range_rate_since(before, self.elapsed_s, &self.horizon)?;
        Some(Measured { satellite: now.satellite, direction, rate_m_s, expected_m_s, sigma_m_s })
    }
}

/// Returns the range rate of a satellite by its best signal and its sigma, m/s.
fn rate(satellite: &RawSatellite) -> Option<(f32, f32)> {
    satellite.signals.iter().find_map(|signal| {
        let weaker_db = (STRONG_DBHZ - signal.cn0_dbhz().unwrap_or(UNSAID_DBHZ)).max(0.0);
        let rate_m_s = -signal.doppler_hz()? / signal.carrier.doppler_of_a_metre_hz();
        Some((rate_m_s, SIGMA_M_S * power_of_two(weaker_db * DOUBLINGS_PER_DB)))
    })
}

/// Returns the part of the speed by which reflections disturb the rate of a signal with this sigma at
/// rest.
fn reflected(sigma_m_s: f32) -> f32 {
    let ratio = sigma_m_s * (1.0 / SIGMA_M_S);
    let part = REFLECTED * ratio * ratio;
    if part < 1.0 { part } else { 1.0 }
}

/// Returns `2^x` for `x` from 0 to 60, within 0.4 %, which suffices for a sigma.
fn power_of_two(x: f32) -> f32 {
    let whole = x.min(60.0) as u32;
    let rest = x.min(60.0) - whole as f32;
    // The polynomial is exact at 0 and 1, so that the function is continuous.
    f32::from_bits((127 + whole) << 23) * (1.0 + rest * (0.6565 + 0.3435 * rest))
}

impl Seen {
    pub(super) fn of(located: &Located) -> Option<Self> {
        Some(Self {
            satellite: located.satellite(),
            position: located.place(),
            clock: located.clock(),
            range_m: located.measured_m()? as f32,
            edition: located.edition(),
        })
    }

    /// Returns the same satellite with the same ephemeris from another epoch, where it mostly has a
    /// similar index.
    pub(super) fn among<'s>(&self, others: &'s [Self], index: usize) -> Option<&'s Self> {
        let here = others.get(index).filter(|seen| self.is(seen));
        here.or_else(|| others.iter().find(|seen| self.is(seen)))
    }

    /// Returns true if satellite and ephemeris are the same.
    fn is(&self, other: &Self) -> bool {
        other.satellite == self.satellite && other.edition == self.edition
    }

    /// Returns the velocity in the earth-fixed frame, m/s, and the time between the transmissions
    /// of the two signals, s.
    pub(super) fn velocity_since(
        &self,
        before: &Self,
        elapsed_s: f32,
        place_m: [f32; 3],
    ) -> Option<([f32; 3], f32)> {
        // The time between the transmissions is shorter than that between the arrivals by the
        // growth of the range.
        let apart_s = elapsed_s - (self.range_m - before.range_m) / LIGHT_M_S;
        let moved_m = difference_m(self.position, before.position);
        Some((velocity_at_the_end(place_m, moved_m, apart_s), apart_s)).filter(|_| apart_s > 0.0)
    }

    /// Returns the range rate of a receiver at rest with a perfect clock, m/s, and the direction of
    /// the satellite, or `None` below the mask.
    fn range_rate_since(&self, before: &Self, elapsed_s: f32, horizon: &Horizon) -> Option<(f32, [f32; 3])> {
        // The earth turns while the signal travels.
        let angle_rad = TURN_RAD_S / LIGHT_M_S * self.range_m;
        let place_m = Grid::vector(self.position);
        let way = horizon.way_to(turned(place_m, angle_rad));
        let direction = horizon.direction(&way);
        let [.., up] = direction;
        if !(up >= SIN_MASK) {
            return None;
        }
        let (velocity_m_s, apart_s) = self.velocity_since(before, elapsed_s, place_m)?;
        let velocity_m_s = turned(velocity_m_s, angle_rad);
        let away_m_s = way.inverse_length * dot(way.difference_m, velocity_m_s);
        let drift_m_s = self.clock.less(before.clock).narrow() / apart_s;
        Some((away_m_s * (1.0 - away_m_s / LIGHT_M_S) - drift_m_s, direction))
    }
}

/// Returns an earth-fixed vector in axes that have turned eastwards by a small angle.
fn turned([x, y, z]: [f32; 3], angle_rad: f32) -> [f32; 3] {
    [x + angle_rad * y, y - angle_rad * x, z]
}

fn dot([a, b, c]: [f32; 3], [x, y, z]: [f32; 3]) -> f32 {
    a * x + b * y + c * z
}

/// Returns the velocity at the end of a displacement, m/s: `v = m + Δt/6 (2 a(r, v) + a(r₀, v₀))`
/// with `v₀ = 2m − v`.
///
/// The acceleration `a(r, v) = g(r) + 2Ω (v_y, −v_x, 0)` is linear in `v`, so that the equation can
/// be solved. It is written by components, because code compiled for size calls a function for
/// every sum of vectors.
fn velocity_at_the_end(end_m: [f32; 3], moved_m: [f32; 3], apart_s: f32) -> [f32; 3] {
    let (sixth_s, per_s) = (apart_s * (1.0 / 6.0), apart_s.recip());
    let [x_m, y_m, z_m] = end_m;
    let [over_x_m, over_y_m, over_z_m] = moved_m;
    let [end_x, end_y, end_z] = pull_m_s2(end_m);
    let [begin_x, begin_y, begin_z] = pull_m_s2([x_m - over_x_m, y_m - over_y_m, z_m - over_z_m]);
    let turn = 2.0 * TURN_RAD_S * sixth_s;
    let (mean_x, mean_y) = (over_x_m * per_s, over_y_m * per_s);
    let x = mean_x + sixth_s * (end_x + end_x + begin_x) + 2.0 * turn * mean_y;
    let y = mean_y + sixth_s * (end_y + end_y + begin_y) - 2.0 * turn * mean_x;
    let z = over_z_m * per_s + sixth_s * (end_z + end_z + begin_z);
    let scale = (1.0 + turn * turn).recip();
    [(x + turn * y) * scale, (y - turn * x) * scale, z]
}

/// Returns the acceleration of a satellite at rest in the frame that turns with the earth: gravity
/// and the centrifugal part, m/s².
fn pull_m_s2([x_m, y_m, z_m]: [f32; 3]) -> [f32; 3] {
    let inverse = (x_m * x_m + y_m * y_m + z_m * z_m).inverse_sqrt_approx();
    let inward = -GRAVITY_M3_S2 * inverse * inverse * inverse;
    let across = inward + TURN_RAD_S * TURN_RAD_S;
    [across * x_m, across * y_m, inward * z_m]
}

#[cfg(test)]
mod tests {
    use super::power_of_two;

    #[test]
    fn powers_of_two_are_those_of_libm() {
        for tenth in 0_u16..=600 {
            let x = f32::from(tenth) * 0.1;
            let (have, want) = (power_of_two(x), libm::exp2f(x));
            assert!((have / want - 1.0).abs() < 4e-3, "{x}: {have}, not {want}");
        }
        assert!(power_of_two(f32::INFINITY).is_finite());
    }
}
