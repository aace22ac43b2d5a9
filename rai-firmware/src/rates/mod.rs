//! Velocity: from range rates to a velocity that may be reported, and one that may be compared with
//! the past.
//!
//! The velocity has its own test ([`raim_core::internals::velocity`]) with the probabilities of the
//! position. A velocity that fails the test, or exceeds the largest speed of a receiver, is not
//! reported. If the negatives of all rates pass the test, the receiver sends them with the wrong
//! sign, as early firmware of a common receiver does. Such epochs have a counter of their own, and
//! their rates are not used.
//!
//! **Reflections.** A reflection comes from another direction than its satellite. Beside a receiver
//! of speed `v` its rate is therefore wrong by up to `2v`, and the more, the weaker it is. In streets
//! two thirds of the residuals were below 0.01 to 0.08 `v` at 41 to 45 dB-Hz, and below 0.14 to 0.9 `v`
//! at 25 to 29 dB-Hz. Rates that fail the test are solved again with the standard deviations
//!
//! ```text
//! σ + v min(1, 0.1 σ²/σ_0²)
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `σ`, `σ_0` | those of the rate and of a strong signal's, at rest | m/s |
//! | `v` | 1 m/s; if not all rates agree so, the speed that they show together | m/s |
//!
//! This velocity is for the report alone: it is too uncertain to forgive or to contradict a position.
//! Which one is used where, [`trust`] decides.

mod measured;
mod trust;

use heapless::Vec;
use nalgebra::Vector3;
use raim_core::frame::{Ecef, LocalAxes};
use raim_core::internals::numeric::absolute::{Absolute as _, Grid};
use raim_core::internals::velocity::{Velocity, VelocityError};
use raim_single::{Monitor, Workspace};

use crate::correction::horizon::Horizon;
use crate::correction::{CAPACITY, Located, Sky};
use crate::counters::{count, count_many, counters};
use crate::raw::RawEpoch;
use crate::time::GpsTime;
use measured::{LONGEST_MS, Seen, Since};
use trust::Trust;

/// Speed whose sigmas suffice for a vehicle under an open sky, m/s.
const SLOW_M_S: f32 = 1.0;

/// Most satellites of the last epoch: none in a build that compares no rates.
const SEEN: usize = if cfg!(any(feature = "past", feature = "hypotheses")) { CAPACITY } else { 0 };

counters! {
    /// Counters of range rates.
    RateTally {
        /// Epochs with a velocity.
        velocities,
        /// Epochs whose rates contradict each other, also with sigmas of a receiver in motion, or give
        /// a speed beyond that of any receiver.
        velocities_refused,
        /// Refused epochs whose rates would agree with the opposite sign, which is a defect of the
        /// receiver.
        rates_of_wrong_sign,
        /// Range rates left out.
        rates_excluded,
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
            for speed_m_s in [shown_m_s.min(SLOW_M_S), shown_m_s] {
                velocity = agree_on(1.0, speed_m_s, &mut 0.0);
                if velocity.as_ref().is_ok_and(|velocity| velocity.excluded.is_empty()) {
                    break;
                }
            }
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
