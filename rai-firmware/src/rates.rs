//! Velocity: from Doppler frequencies to range rates, and from these to what may be told.
//!
//! ```text
//! y = −λ D − e · v_s (1 − e · v_s / c) + c Δt'_sat        v_s = (r_k − r_{k−1}) / Δt + (2 a_k + a_{k−1}) Δt / 6
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `D`, `λ` | Doppler frequency, positive when approaching, and wavelength | Hz, m |
//! | `r_k`, `Δt` | place of the satellite as its signal of this epoch left, and of the last; the time between | m, s |
//! | `a` | its acceleration in the earth-fixed frame: gravity, centrifugal, Coriolis | m/s² |
//! | `e` | unit vector receiver → satellite | – |
//! | `Δt'_sat` | drift of its clock | s/s |
//!
//! Satellites are located once an epoch anyhow, which is the dear part; two epochs give their velocity for nothing. It is
//! exact while the acceleration changes evenly: what is left is below 1 mm/s up to [`LONGEST_MS`]. A satellite whose ephemeris has
//! changed between the epochs has no velocity in this one: sets differ by metres.
//!
//! The velocity has a test of its own ([`rai_core::velocity`]) with the probabilities of the position. One that does not
//! pass is none, nor is one that a receiver cannot have. Rates that have contradicted each other tell a velocity again
//! once they have agreed for as long as an alert asks of positions ([`rai_core::continuity`]): some of many false ones agree by
//! chance. Where the negative of all rates would pass, the receiver sends them with the wrong sign, as early firmware
//! of a common one does; that is counted by its name, and the rates are not used.
//!
//! Sigma is 0.05 m/s at 45 dB-Hz and above and grows below as the noise of a frequency lock does, with the root of the
//! noise density.

use heapless::Vec;
use nalgebra::Vector3;
use rai_core::continuity::{ContinuitySettings, Standing};
use rai_core::frame::{EARTH_ROTATION_RAD_S, Ecef, LocalFrame, SPEED_OF_LIGHT_M_S};
use rai_core::numeric::real::Real;
use rai_core::satellite::SatelliteId;
use rai_core::single::{self, Monitor, Workspace};
use rai_core::velocity::{RangeRate, Velocity, VelocityError};

use crate::correction::horizon::{Horizon, coordinates_m};
use crate::correction::{CAPACITY, Located, Sky};
use crate::counters::{count, count_many, counters};
use crate::ephemeris::SatelliteState;
use crate::raw::{RawEpoch, RawSatellite};
use crate::time::GpsTime;

/// Longest time between two epochs whose difference is a velocity, ms.
const LONGEST_MS: i64 = 60_000;

/// The earth's gravitational constant, m³/s² (WGS 84).
const GRAVITY_M3_S2: f32 = 3.986_004_4e14;

/// Sigma of a strong signal's rate, m/s, and the strength from which on it is that, dB-Hz.
const SIGMA_M_S: f32 = 0.05;
const STRONG_DBHZ: f32 = 45.0;

/// Strength that is assumed where none is said, dB-Hz.
const UNSAID_DBHZ: f32 = 35.0;

/// The noise of a rate doubles with every 6 dB.
const DOUBLINGS_PER_DB: f32 = 1.0 / 6.02;

/// Rates below this elevation bend through the troposphere's gradient, sine.
const SIN_MASK: f32 = 0.087;

/// What is small enough for single precision is worked out in it.
const LIGHT_M_S: f32 = SPEED_OF_LIGHT_M_S as f32;
const TURN_RAD_S: f32 = EARTH_ROTATION_RAD_S as f32;

counters! {
    /// What became of range rates.
    RateTally {
        /// Epochs with a velocity.
        velocities,
        /// Epochs whose rates contradict each other, or say what no receiver can have.
        velocities_refused,
        /// Of these, such that would agree with the opposite sign: a receiver's mistake.
        rates_of_wrong_sign,
        /// Range rates left out.
        rates_excluded,
    }
}

/// A rate as measured, and the part of it that the satellite makes.
#[derive(Clone, Copy, Debug)]
struct Measured {
    satellite: SatelliteId,
    /// Unit vector receiver → satellite, east, north, up.
    direction: [f32; 3],
    /// Of the range, as the receiver has it, m/s.
    rate_m_s: f32,
    /// Of a receiver at rest with a perfect clock, m/s.
    expected_m_s: f32,
    sigma_m_s: f32,
}

impl Measured {
    /// The equation that it gives, with the measured rate or with its negative.
    fn equation(&self, sign: f32) -> RangeRate {
        RangeRate {
            satellite: self.satellite,
            line_of_sight: Vector3::from(self.direction).map(f64::from),
            residual_m_s: f64::from(sign * self.rate_m_s - self.expected_m_s),
            sigma_m_s: f64::from(self.sigma_m_s),
        }
    }
}

/// A satellite when its signal left.
#[derive(Clone, Copy, Debug)]
struct Seen {
    satellite: SatelliteId,
    state: SatelliteState,
    /// Range, m: it says when the signal left.
    range_m: f64,
    /// Of the ephemeris.
    edition: u32,
}

/// Whether a velocity that passed its test is to be told.
#[derive(Clone, Debug)]
struct Trust {
    standing: Standing,
    /// Of the rates that agree since: the first epoch, how many, and whether one had one degree of freedom or left rates out.
    since: GpsTime,
    epochs: u16,
    is_weak: bool,
}

impl Trust {
    const fn new() -> Self {
        Self { standing: Standing::New, since: GpsTime::from_ms(0), epochs: 0, is_weak: false }
    }

    /// Takes note of rates that agree; says whether they are to be told.
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

    /// The next rates that agree do not follow on others.
    fn interrupt(&mut self) {
        self.epochs = 0;
    }

    /// Rates contradict each other.
    fn lose(&mut self) {
        (self.standing, self.epochs) = (Standing::Lost, 0);
    }
}

/// Remembers where satellites were, and makes velocities of it.
#[derive(Clone, Debug)]
pub struct Rates {
    last: Vec<Seen, CAPACITY>,
    /// Of the last epoch; before the first it is long ago. Not an option: with one the whole would be made on the stack first.
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
    /// One that has seen nothing.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub const fn new() -> Self {
        Self { last: Vec::new(), time: GpsTime::from_ms(0), trust: Trust::new(), tally: RateTally::NONE }
    }

    /// What became of the rates so far.
    pub fn tally(&self) -> &RateTally {
        &self.tally
    }

    /// The velocity of a receiver at a place, where the rates of this epoch agree on one.
    #[inline(never)]
    pub fn velocity(
        &mut self,
        raw: &RawEpoch,
        sky: &Sky,
        place: Option<Ecef>,
        monitor: &Monitor,
        workspace: &mut Workspace,
    ) -> Option<Velocity> {
        let elapsed_ms = raw.time.since_ms(self.time);
        self.time = raw.time;
        let is_near = (1..=LONGEST_MS).contains(&elapsed_ms);
        let place = place.filter(|_| is_near);
        let velocity = place.and_then(|place| self.judge(raw, sky, place, elapsed_ms, monitor, workspace));
        if place.is_none() {
            self.trust.interrupt();
        }
        self.last.clear();
        // Both hold as many.
        self.last.extend(sky.iter().filter_map(Seen::of).take(CAPACITY));
        velocity
    }

    /// How fast a satellite of an epoch that is not judged yet moves in the earth-fixed frame, m/s; `None` where it was not seen in
    /// the last epoch, by the same ephemeris.
    #[inline(never)]
    pub fn of_satellite(&self, located: &Located, time: GpsTime) -> Option<Vector3<f32>> {
        let elapsed_ms = time.since_ms(self.time);
        let now = Seen::of(located).filter(|_| (1..=LONGEST_MS).contains(&elapsed_ms))?;
        let (before, elapsed_s) = (now.among(&self.last)?, elapsed_ms as f32 * 1e-3);
        let (velocity_m_s, _) = now.velocity_since(before, elapsed_s, coordinates_m(now.state.position))?;
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
    ) -> Option<Velocity> {
        let Self { last, trust, tally, .. } = self;
        let horizon = Horizon::at(place, &LocalFrame::at(place));
        let since = Since { last, raw, horizon, elapsed_s: elapsed_ms as f32 * 1e-3 };
        let (required, settings) = (monitor.validated(), monitor.continuity_settings());
        // Worked out as they are asked for, and nothing is stored: a second time only where the first has failed.
        let mut agree_on = |sign| {
            let rates = sky.iter().filter_map(|located| since.measure(located));
            let equations = &mut rates.map(|rate| rate.equation(sign));
            let velocity = single::velocity(workspace, equations, required.thresholds(), required.factors())?;
            let is_possible = settings.is_none_or(|settings| velocity.is_within(settings.max_speed_m_s));
            if is_possible { Ok(velocity) } else { Err(VelocityError::Fault) }
        };
        match agree_on(1.0) {
            Ok(velocity) => {
                if settings.is_some_and(|settings| !trust.agree(settings, raw.time, &velocity)) {
                    return None;
                }
                count(&mut tally.velocities);
                count_many(&mut tally.rates_excluded, velocity.excluded.len());
                Some(velocity)
            }
            Err(VelocityError::Fault) => {
                trust.lose();
                count(&mut tally.velocities_refused);
                if agree_on(-1.0).is_ok() {
                    count(&mut tally.rates_of_wrong_sign);
                }
                None
            }
            Err(VelocityError::Redundancy | VelocityError::Geometry) => {
                trust.interrupt();
                None
            }
        }
    }
}

/// The last epoch, and where the receiver is now.
struct Since<'r> {
    last: &'r [Seen],
    raw: &'r RawEpoch,
    horizon: Horizon,
    elapsed_s: f32,
}

impl Since<'_> {
    /// The rate of a satellite, less what the satellite makes of it.
    fn measure(&self, located: &Located) -> Option<Measured> {
        let now = Seen::of(located)?;
        let before = now.among(self.last)?;
        let satellite = self.raw.satellites.iter().find(|one| one.satellite == now.satellite)?;
        let (rate_m_s, sigma_m_s) = rate(satellite)?;
        let (expected_m_s, direction) = now.range_rate_since(before, self.elapsed_s, &self.horizon)?;
        Some(Measured { satellite: now.satellite, direction, rate_m_s, expected_m_s, sigma_m_s })
    }
}

/// How fast a satellite's range grows by its best signal, and with which sigma, m/s.
fn rate(satellite: &RawSatellite) -> Option<(f32, f32)> {
    satellite.signals.iter().find_map(|signal| {
        let weaker_db = (STRONG_DBHZ - signal.cn0_dbhz().unwrap_or(UNSAID_DBHZ)).max(0.0);
        let rate_m_s = -signal.doppler_hz()? / signal.carrier.doppler_of_a_metre_hz();
        Some((rate_m_s, SIGMA_M_S * power_of_two(weaker_db * DOUBLINGS_PER_DB)))
    })
}

/// `2^x` for `x` from 0 to 60, within 0.4 %, which is more than enough for a sigma.
fn power_of_two(x: f32) -> f32 {
    let whole = x.min(60.0) as u32;
    let rest = x.min(60.0) - whole as f32;
    // Right at both ends, so that it is continuous.
    f32::from_bits((127 + whole) << 23) * (1.0 + rest * (0.6565 + 0.3435 * rest))
}

impl Seen {
    fn of(located: &Located) -> Option<Self> {
        let (satellite, state) = (located.satellite(), located.state());
        Some(Self { satellite, state, range_m: located.measured_m()?, edition: located.edition() })
    }

    /// The same satellite in another epoch, by the same ephemeris.
    fn among<'s>(&self, others: &'s [Self]) -> Option<&'s Self> {
        others.iter().find(|seen| seen.satellite == self.satellite && seen.edition == self.edition)
    }

    /// Its velocity in the earth-fixed frame at the place where it is, m/s, and how much earlier its signal left before, s.
    fn velocity_since(&self, before: &Self, elapsed_s: f32, place_m: [f32; 3]) -> Option<([f32; 3], f32)> {
        // The signals left as much less apart as the range has shrunk.
        let apart_s = elapsed_s - (self.range_m - before.range_m) as f32 / LIGHT_M_S;
        let moved_m = coordinates_m(self.state.position - before.state.position);
        Some((velocity_at_the_end(place_m, moved_m, apart_s), apart_s)).filter(|_| apart_s > 0.0)
    }

    /// How fast the range of a receiver at rest would grow, with a perfect clock of its own, m/s, and the direction of the
    /// satellite; `None` below the mask.
    fn range_rate_since(&self, before: &Self, elapsed_s: f32, horizon: &Horizon) -> Option<(f32, [f32; 3])> {
        // The earth turns while the signal is under way.
        let angle_rad = TURN_RAD_S / LIGHT_M_S * self.range_m as f32;
        let place_m = coordinates_m(self.state.position);
        let way = horizon.way_to(turned(place_m, angle_rad));
        let direction = horizon.direction(&way);
        let [.., up] = direction;
        if !(up >= SIN_MASK) {
            return None;
        }
        let (velocity_m_s, apart_s) = self.velocity_since(before, elapsed_s, place_m)?;
        let velocity_m_s = turned(velocity_m_s, angle_rad);
        let away_m_s = way.inverse_length * dot(way.difference_m, velocity_m_s);
        let drift = (self.state.clock_s - before.state.clock_s) as f32 / apart_s;
        Some((away_m_s * (1.0 - away_m_s / LIGHT_M_S) - LIGHT_M_S * drift, direction))
    }
}

/// An earth-fixed vector in axes that have turned eastwards by a small angle.
fn turned([x, y, z]: [f32; 3], angle_rad: f32) -> [f32; 3] {
    [x + angle_rad * y, y - angle_rad * x, z]
}

fn dot([a, b, c]: [f32; 3], [x, y, z]: [f32; 3]) -> f32 {
    a * x + b * y + c * z
}

/// Velocity at the end of a way, m/s: `v = m + Δt/6 (2 a(r, v) + a(r₀, v₀))` with `v₀ = 2m − v`, of which what turns with the frame is
/// linear, `a(r, v) = g(r) + 2Ω (v_y, −v_x, 0)`, and solved for. By components: what is compiled for size calls for every sum of vectors.
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

/// What a satellite's place alone accelerates it by in the frame that turns with the earth: gravity and what drives it
/// outwards, m/s².
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
