//! Velocity: from Doppler frequencies to range rates, and from range rates to a velocity that may
//! be reported.
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
//! The velocity has its own test ([`raim_core::internals::velocity`]) with the probabilities of the position.
//! A velocity that fails the test, or exceeds the largest speed of a receiver, is not reported.
//! Some of many false rates agree by chance. After contradictory rates, a velocity is therefore
//! compared with the past again only if rates have agreed for the recovery time of positions
//! ([`raim_core::internals::continuity`]). If the negatives of all rates pass the test, the receiver sends
//! them with the wrong sign, as early firmware of a common receiver does. Such epochs have a
//! counter of their own, and their rates are not used.
//!
//! The sigma `σ` of a rate is `σ_0` = 0.05 m/s at 45 dB-Hz and above. Below 45 dB-Hz it grows with the
//! root of the noise density, like the noise of a frequency lock.
//!
//! **Reflections.** A reflection comes from another direction than its satellite. Beside a receiver
//! of speed `v` its rate is therefore wrong by up to `2v`, and the more, the weaker it is. In streets
//! two thirds of the residuals were below 0.01 to 0.08 `v` at 41 to 45 dB-Hz, and below 0.14 to 0.9 `v`
//! at 25 to 29 dB-Hz. Rates that fail the test are solved again with
//!
//! ```text
//! σ + v min(1, 0.1 σ²/σ_0²)
//! ```
//!
//! where `v` is the speed that all rates together show. This velocity is for the report alone: it is
//! too uncertain to forgive or to contradict a position. It is reported if ten epochs in a row agreed
//! so, it has three degrees of freedom, and its horizontal level is at most 10 m/s.

use heapless::Vec;
use nalgebra::Vector3;
use raim_core::frame::{EARTH_ROTATION_RAD_S, Ecef, LocalAxes, SPEED_OF_LIGHT_M_S};
use raim_core::internals::continuity::{ContinuitySettings, Standing};
use raim_core::internals::numeric::absolute::{Absolute as _, Grid};
use raim_core::internals::numeric::real::Real;
use raim_core::internals::velocity::{RangeRate, Velocity, VelocityError};
use raim_core::satellite::SatelliteId;
use raim_single::{Monitor, Workspace};

use crate::correction::horizon::Horizon;
use crate::correction::{CAPACITY, Located, Sky};
use crate::counters::{count, count_many, counters};
use crate::ephemeris::difference_m;
use crate::raw::{RawEpoch, RawSatellite};
use crate::time::GpsTime;

/// Most satellites of the last epoch: none in a build that compares no rates.
const SEEN: usize = if cfg!(any(feature = "past", feature = "hypotheses")) { CAPACITY } else { 0 };

/// Longest time between two epochs whose difference is a velocity, ms.
const LONGEST_MS: i64 = 60_000;

/// The earth's gravitational constant, m³/s² (WGS 84).
const GRAVITY_M3_S2: f32 = 3.986_004_4e14;

/// Sigma of a strong signal's rate, m/s.
const SIGMA_M_S: f32 = 0.05;

/// Part of the speed by which reflections disturb the rate of a strong signal; that of a weaker one
/// grows with the noise density, up to the speed.
const REFLECTED: f32 = 0.1;

/// Largest horizontal level of a velocity that reflections disturb, m/s.
const WIDEST_M_S: f64 = 10.0;

/// Least degrees of freedom of rates that hardly agree by chance.
const CONVINCING: u8 = 3;

/// Least number of epochs in a row whose rates agree in motion.
const ENOUGH: u8 = 10;

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

counters! {
    /// Counters of range rates.
    RateTally {
        /// Epochs with a velocity.
        velocities,
        /// Epochs whose rates contradict each other, or give a speed beyond that of any receiver.
        velocities_refused,
        /// Refused epochs whose rates would agree with the opposite sign, which is a defect of the
        /// receiver.
        rates_of_wrong_sign,
        /// Range rates left out.
        rates_excluded,
    }
}

/// A measured rate with the part of it that the satellite causes.
#[derive(Clone, Copy, Debug)]
struct Measured {
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
    fn equation(&self, sign: f32, speed_m_s: f32) -> RangeRate<f32> {
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
struct Seen {
    satellite: SatelliteId,
    position: [Grid; 3],
    /// Satellite clock times the speed of light.
    clock: Grid,
    /// Range, m. It gives the time at which the signal left, to 7 ns.
    range_m: f32,
    /// Edition of the ephemeris.
    edition: u32,
}

/// Trust in the rates.
#[derive(Clone, Debug)]
struct Trust {
    standing: Standing,
    /// First of the consecutive epochs whose rates agreed.
    since: GpsTime,
    /// Number of these epochs.
    epochs: u16,
    /// True if one of them had one degree of freedom or exclusions.
    is_weak: bool,
    /// Why the velocity of the last epoch must not be compared with the past.
    refusal: Option<VelocityError>,
    /// Why the trust was lost.
    loss: VelocityError,
    /// Epochs in a row whose rates agree with sigmas of a receiver in motion.
    in_motion: u8,
}

impl Trust {
    const fn new() -> Self {
        let (standing, since, loss) = (Standing::New, GpsTime::from_ms(0), VelocityError::Fault);
        Self { standing, since, epochs: 0, is_weak: false, refusal: None, loss, in_motion: 0 }
    }

    /// Notes the rates of an epoch with sigmas of a receiver at rest. Those that agree again, but
    /// not yet for long enough, are refused for the same reason as those before them.
    fn note(
        &mut self,
        settings: Option<&ContinuitySettings>,
        time: GpsTime,
        velocity: &Result<Velocity, VelocityError>,
    ) {
        self.refusal = match velocity {
            Ok(velocity) => {
                let is_good = settings.is_none_or(|settings| self.agree(settings, time, velocity));
                Some(self.loss).filter(|_| !is_good)
            }
            Err(error) => {
                self.epochs = 0;
                if error.is_contradiction() {
                    (self.standing, self.loss) = (Standing::Lost, *error);
                }
                Some(*error)
            }
        };
    }

    /// Notes rates that agree; returns true if their velocity may be compared with the past.
    fn agree(&mut self, settings: &ContinuitySettings, time: GpsTime, velocity: &Velocity) -> bool {
        let is_weak = velocity.test.dof <= 1;
        if self.standing == Standing::Good || self.standing == Standing::New && !is_weak {
            self.standing = Standing::Good;
            return true;
        }
        if self.epochs == 0 {
            (self.since, self.is_weak) = (time, false);
        }
        self.epochs = self.epochs.saturating_add(1);
        self.is_weak |= is_weak || !velocity.excluded.is_empty();
        let seconds = time.since_ms(self.since) as f64 * 1e-3;
        if settings.recovery.is_met(self.epochs, seconds, self.is_weak) {
            self.standing = Standing::Good;
        }
        self.standing == Standing::Good
    }

    /// Notes the rates of an epoch with sigmas of a receiver in motion; returns true if their velocity
    /// may be reported.
    fn note_in_motion(&mut self, velocity: &Result<Velocity, VelocityError>) -> bool {
        let mut is_precise = false;
        match velocity {
            Ok(velocity) if velocity.test.dof >= CONVINCING => {
                self.in_motion = self.in_motion.saturating_add(u8::from(velocity.excluded.is_empty()));
                is_precise = velocity.levels_m_s.hpl_m <= WIDEST_M_S;
            }
            Err(error) if error.is_contradiction() => self.in_motion = 0,
            _ => {}
        }
        self.refusal.is_none() || self.in_motion >= ENOUGH && is_precise
    }
}

/// Velocities of satellites and receiver, from two successive epochs.
#[derive(Clone, Debug)]
pub struct Rates {
    last: Vec<Seen, SEEN>,
    /// Time of the last epoch; 1980 before the first. An `Option` would put the whole struct on the
    /// stack first.
    time: GpsTime,
    trust: Trust,
    tally: RateTally,
}

impl Default for Rates {
    fn default() -> Self {
        Self::new()
    }
}

impl Rates {
    /// Returns the state before the first epoch.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub const fn new() -> Self {
        Self { last: Vec::new(), time: GpsTime::from_ms(0), trust: Trust::new(), tally: RateTally::NONE }
    }

    /// Returns the counters of range rates.
    pub fn tally(&self) -> &RateTally {
        &self.tally
    }

    /// Returns why the velocity of the last epoch must not be compared with the past.
    pub const fn refusal(&self) -> Option<VelocityError> {
        self.trust.refusal
    }

    /// Returns the velocity of a receiver at a place.
    ///
    /// # Errors
    /// [`VelocityError`] if the rates of this epoch give no velocity that may be reported.
    #[inline(never)]
    pub fn velocity(
        &mut self,
        raw: &RawEpoch,
        sky: &Sky,
        place: Option<Ecef>,
        monitor: &Monitor,
        workspace: &mut Workspace,
    ) -> Result<Velocity, VelocityError> {
        let elapsed_ms = raw.time.since_ms(self.time);
        self.time = raw.time;
        let is_near = (1..=LONGEST_MS).contains(&elapsed_ms);
        let velocity = if let Some(place) = place.filter(|_| is_near) {
            self.judge(raw, sky, place, elapsed_ms, monitor, workspace)
        } else {
            let none = Err(VelocityError::Redundancy);
            self.trust.note(None, raw.time, &none);
            none
        };
        self.last.clear();
        // Both lists have the same capacity.
        self.last.extend(sky.iter().filter_map(Seen::of).take(SEEN));
        velocity
    }

    /// Returns the velocity of a satellite of the present epoch in the earth-fixed frame, m/s.
    /// `None` if the last epoch did not have it with the same ephemeris.
    ///
    /// `index` is its index in the sky; in the last epoch it had a similar one.
    #[inline(never)]
    pub fn of_satellite(&self, located: &Located, index: usize, time: GpsTime) -> Option<Vector3<f32>> {
        let elapsed_ms = time.since_ms(self.time);
        let now = Seen::of(located).filter(|_| (1..=LONGEST_MS).contains(&elapsed_ms))?;
        let (before, elapsed_s) = (now.among(&self.last, index)?, elapsed_ms as f32 * 1e-3);
        let (velocity_m_s, _) = now.velocity_since(before, elapsed_s, Grid::vector(now.position))?;
        Some(velocity_m_s.into())
    }

    fn judge(
        &mut self,
        raw: &RawEpoch,
        sky: &Sky,
        place: Ecef,
        elapsed_ms: i64,
        monitor: &Monitor,
        workspace: &mut Workspace,
    ) -> Result<Velocity, VelocityError> {
        let Self { last, trust, tally, .. } = self;
        let horizon = Horizon::at(place, &LocalAxes::at(place));
        let since = Since { last, raw, horizon, elapsed_s: elapsed_ms as f32 * 1e-3 };
        let (required, settings) = (monitor.validated(), monitor.continuity_settings());
        let mut shown_m_s = 0.0;
        // Rates are computed on demand and not stored. They are needed again only if they fail.
        let mut agree_on = |sign, speed_m_s, shown_m_s: &mut f32| {
            let rates = sky.iter().enumerate().filter_map(|(index, located)| since.measure(located, index));
            let rates = &mut rates.map(|rate| rate.equation(sign, speed_m_s));
            let (thresholds, factors) = (required.thresholds(), required.factors());
            let velocity = raim_single::velocity(workspace, rates, thresholds, factors, shown_m_s)?;
            let is_possible = settings.is_none_or(|settings| velocity.is_within(settings.max_speed_m_s));
            if is_possible { Ok(velocity) } else { Err(VelocityError::Fault) }
        };
        let mut velocity = agree_on(1.0, 0.0, &mut shown_m_s);
        trust.note(settings, raw.time, &velocity);
        if matches!(velocity, Err(VelocityError::Fault)) && agree_on(-1.0, 0.0, &mut 0.0).is_ok() {
            count(&mut tally.rates_of_wrong_sign);
        } else if trust.refusal.is_some() && shown_m_s > 0.0 {
            velocity = agree_on(1.0, shown_m_s, &mut 0.0);
        }
        if velocity.as_ref().is_err_and(VelocityError::is_contradiction) {
            count(&mut tally.velocities_refused);
        }
        if !trust.note_in_motion(&velocity) {
            return Err(trust.loss);
        }
        if let Ok(velocity) = &velocity {
            count(&mut tally.velocities);
            count_many(&mut tally.rates_excluded, velocity.excluded.len());
        }
        velocity
    }
}

/// The last epoch, with the present epoch and the place of the receiver.
struct Since<'r> {
    last: &'r [Seen],
    raw: &'r RawEpoch,
    horizon: Horizon,
    elapsed_s: f32,
}

impl Since<'_> {
    /// Returns the measured rate of a satellite, with the part of it that the satellite causes.
    ///
    /// `index` is its index in the sky; in the last epoch and in the raw epoch it has a similar
    /// one.
    fn measure(&self, located: &Located, index: usize) -> Option<Measured> {
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
    fn of(located: &Located) -> Option<Self> {
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
    fn among<'s>(&self, others: &'s [Self], index: usize) -> Option<&'s Self> {
        let here = others.get(index).filter(|seen| self.is(seen));
        here.or_else(|| others.iter().find(|seen| self.is(seen)))
    }

    /// Returns true if satellite and ephemeris are the same.
    fn is(&self, other: &Self) -> bool {
        other.satellite == self.satellite && other.edition == self.edition
    }

    /// Returns the velocity in the earth-fixed frame, m/s, and the time between the transmissions
    /// of the two signals, s.
    fn velocity_since(&self, before: &Self, elapsed_s: f32, place_m: [f32; 3]) -> Option<([f32; 3], f32)> {
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
