//! Orbits broadcast as a state vector: GLONASS.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `r`, `v`, `a` at `t_b` | [`StateBroadcast::position_m`], `velocity_m_s`, `acceleration_m_s2` | m, m/s, m/s², PZ-90 |
//! | `−τ_n`, `γ_n` | [`StateBroadcast::clock_s`], `clock_s_s` | s, s/s |
//! | `Δτ_n` | [`StateBroadcast::delay_l2_s`]: L2 later than L1 | s |
//!
//! Where the satellite is at another instant follows from the forces on it ([`super::forces`]). Relativity is in `γ_n`.
//!
//! Reference: [GLO-ICD] 5.1, appendix J.1.
//!
//! [GLO-ICD]: crate#references

use rai_core::frame::Ecef;
use rai_core::satellite::SatelliteId;

use super::elapsed::Elapsed;
use super::forces::State;
use super::motion::Motion;
use super::{BroadcastError, Health};
use crate::time::GpsTime;

/// One GLONASS satellite's message with the day resolved. Any value may stand here;
/// [`Ephemeris::of_state`](super::Ephemeris::of_state) judges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateBroadcast {
    /// Which satellite, by its slot.
    pub satellite: SatelliteId,
    /// What the satellite says of itself.
    pub health: Health,
    /// One sigma of the range error as broadcast (`F_T`), m; `None` when the satellite does not promise any.
    pub accuracy_m: Option<f32>,
    /// Reference time `t_b`, leap seconds added.
    pub toe: GpsTime,
    /// Position at `toe`, m.
    pub position_m: [f64; 3],
    /// Velocity at `toe` in the earth-fixed frame, m/s.
    pub velocity_m_s: [f64; 3],
    /// Pull of sun and moon, m/s².
    pub acceleration_m_s2: [f32; 3],
    /// Satellite clock minus system time at `toe`, `−τ_n`, s.
    pub clock_s: f64,
    /// Its rate, `γ_n`, s/s.
    pub clock_s_s: f64,
    /// How much later L2 leaves than L1, `Δτ_n`, s.
    pub delay_l2_s: f32,
}

/// A state vector, checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateVector {
    position_m: [f64; 3],
    velocity_m_s: [f32; 3],
    acceleration_m_s2: [f32; 3],
}

impl StateVector {
    /// The judged elements.
    pub(super) fn new(broadcast: &StateBroadcast) -> Result<Self, BroadcastError> {
        check(broadcast)?;
        Ok(Self {
            position_m: broadcast.position_m,
            // Multiples of 2⁻²⁰ km/s with 24 bits: exact.
            velocity_m_s: broadcast.velocity_m_s.map(|velocity| velocity as f32),
            acceleration_m_s2: broadcast.acceleration_m_s2,
        })
    }

    /// The motion at an instant counted from the reference time; none where that is too far off.
    pub(super) fn at(&self, since_toe: Elapsed) -> Option<Motion> {
        let start = State { position: self.position_m, velocity: self.velocity_m_s.map(f64::from) };
        let pull_m_s2 = self.acceleration_m_s2.map(f64::from);
        let [x_m, y_m, z_m] = start.after(since_toe.to_s(), pull_m_s2)?.position;
        Some(Motion { position: Ecef::new(x_m, y_m, z_m), relativity_s62: 0 })
    }
}

/// Judges every field by what a satellite 16,000 km to 64,000 km from the centre can have. A NaN is in no range.
fn check(broadcast: &StateBroadcast) -> Result<(), BroadcastError> {
    let [x_m, y_m, z_m] = broadcast.position_m;
    let radius_m2 = x_m * x_m + y_m * y_m + z_m * z_m;
    let has_state = (1.6e7 * 1.6e7..=6.4e7 * 6.4e7).contains(&radius_m2);
    let has_rates = broadcast.velocity_m_s.iter().all(|velocity| velocity.abs() <= 1e4)
        && broadcast.acceleration_m_s2.iter().all(|acceleration| acceleration.abs() <= 1e-4);
    let has_clock = broadcast.clock_s.abs() <= 0.0625
        && broadcast.clock_s_s.abs() <= 1e-7
        && broadcast.delay_l2_s.abs() <= 1e-6
        && (0.0..=1e4).contains(&broadcast.accuracy_m.unwrap_or(0.0));
    match (has_state, has_rates, has_clock) {
        (false, _, _) => Err(BroadcastError::SemiMajorAxis),
        (_, false, _) => Err(BroadcastError::Correction),
        (_, _, false) => Err(BroadcastError::Clock),
        _ => Ok(()),
    }
}
