//! A satellite's message before it is accepted, with its checks.
//!
//! Bounds come from existing orbits (with a margin) and from the widest fields of the messages.

use core::fmt;

use raim_core::satellite::SatelliteId;

use super::{Health, Source};
use crate::time::{GpsTime, WEEK_MS};

/// One satellite's message with the week resolved, in the units of the interface documents.
///
/// The suffix `_sc` means semicircles. It may hold any values;
/// [`Ephemeris::new`](super::Ephemeris::new) checks them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Broadcast {
    /// Satellite of the message.
    pub satellite: SatelliteId,
    /// Kind of the message.
    pub source: Source,
    /// Health and validity flags of the message.
    pub health: Health,
    /// Broadcast standard deviation of the range error, m; `None` if the satellite promises none.
    pub accuracy_m: Option<f32>,
    /// Reference time of the elements.
    pub toe: GpsTime,
    /// Reference time of the clock.
    pub toc: GpsTime,
    /// Square root of the semi-major axis, √m.
    pub sqrt_a_sqrt_m: f64,
    /// Eccentricity.
    pub eccentricity: f64,
    /// Mean anomaly at `toe`.
    pub m0_sc: f64,
    /// Longitude of the ascending node at the start of the week.
    pub omega0_sc: f64,
    /// Inclination at `toe`.
    pub i0_sc: f64,
    /// Argument of perigee.
    pub omega_sc: f64,
    /// Correction of the mean motion, semicircles per second.
    pub delta_n_sc_s: f64,
    /// Rate of the node, semicircles per second.
    pub omegadot_sc_s: f64,
    /// Rate of the inclination, semicircles per second.
    pub idot_sc_s: f64,
    /// Cosine correction of the argument of latitude.
    pub cuc_rad: f32,
    /// Sine correction of the argument of latitude.
    pub cus_rad: f32,
    /// Cosine correction of the radius.
    pub crc_m: f32,
    /// Sine correction of the radius.
    pub crs_m: f32,
    /// Cosine correction of the inclination.
    pub cic_rad: f32,
    /// Sine correction of the inclination.
    pub cis_rad: f32,
    /// Clock offset at `toc`.
    pub af0_s: f64,
    /// Clock drift.
    pub af1_s_s: f64,
    /// Clock drift rate.
    pub af2_s_s2: f64,
    /// Group delays: GPS `[TGD, 0]`, Galileo `[BGD E1/E5a, BGD E1/E5b]`, `BeiDou` `[TGD1, TGD2]`.
    pub group_delays_s: [f32; 2],
}

/// Field for which a message is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BroadcastError {
    /// The satellite does not belong to the message's system.
    Satellite,
    /// The system's message has no elements of this form.
    Form,
    /// `toe` or `toc` is outside the week, or they are more than a day apart.
    ReferenceTime,
    /// The eccentricity is not in 0 to 0.2: the most eccentric in use are two Galileo satellites,
    /// 0.17.
    Eccentricity,
    /// The semi-major axis, or the distance from the centre, is not in 16,000 km to 64,000 km.
    SemiMajorAxis,
    /// Axis, eccentricity and inclination together fit no orbit of the system.
    OrbitType,
    /// An angle is not within ±1 semicircle.
    Angle,
    /// A rate or a correction is not finite or exceeds its field in the message.
    Correction,
    /// A clock term or a group delay is not finite or exceeds its field in the message.
    Clock,
}

impl fmt::Display for BroadcastError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Satellite => "satellite number outside its system",
            Self::Form => "no elements of this form in the system's message",
            Self::ReferenceTime => "reference times outside the week or far apart",
            Self::Eccentricity => "eccentricity outside 0 to 0.2",
            Self::SemiMajorAxis => "semi-major axis outside 16,000 km to 64,000 km",
            Self::OrbitType => "axis, eccentricity and inclination of no orbit of its system",
            Self::Angle => "angle outside one turn",
            Self::Correction => "orbit correction out of bounds",
            Self::Clock => "clock term out of bounds",
        })
    }
}

impl core::error::Error for BroadcastError {}

/// Checks every field. NaN is in no range.
pub(super) fn check(broadcast: &Broadcast) -> Result<(), BroadcastError> {
    let verdicts = [
        (is_of_system(broadcast), BroadcastError::Satellite),
        (has_reference_times(broadcast), BroadcastError::ReferenceTime),
        ((0.0..=0.2).contains(&broadcast.eccentricity), BroadcastError::Eccentricity),
        ((4_000.0..=8_000.0).contains(&broadcast.sqrt_a_sqrt_m), BroadcastError::SemiMajorAxis),
        (has_angles(broadcast), BroadcastError::Angle),
        (has_corrections(broadcast), BroadcastError::Correction),
        (has_clock(broadcast), BroadcastError::Clock),
    ];
    verdicts.into_iter().try_for_each(|(holds, error)| if holds { Ok(()) } else { Err(error) })
}

fn is_of_system(broadcast: &Broadcast) -> bool {
    broadcast.source.can_name(broadcast.satellite)
}

fn has_reference_times(broadcast: &Broadcast) -> bool {
    let distance_ms = broadcast.toc.since_ms(broadcast.toe).unsigned_abs();
    broadcast.toe.tow_ms < WEEK_MS && broadcast.toc.tow_ms < WEEK_MS && distance_ms <= 86_400_000
}

fn has_angles(broadcast: &Broadcast) -> bool {
    let angles = [broadcast.m0_sc, broadcast.omega0_sc, broadcast.i0_sc, broadcast.omega_sc];
    angles.iter().all(|angle| angle.abs() <= 1.0)
}

/// Returns true if the corrections fit. The widest fields are those of `BeiDou`: 18 bits of 2⁻³¹
/// rad and of 2⁻⁶ m.
fn has_corrections(broadcast: &Broadcast) -> bool {
    const WIDEST_RAD: f32 = 1.0 / (1 << 14) as f32;
    const WIDEST_M: f32 = 2048.0;
    let rates = [broadcast.delta_n_sc_s, broadcast.omegadot_sc_s, broadcast.idot_sc_s];
    let angles = [broadcast.cuc_rad, broadcast.cus_rad, broadcast.cic_rad, broadcast.cis_rad];
    let lengths = [broadcast.crc_m, broadcast.crs_m];
    rates.iter().all(|rate| rate.abs() <= 1e-6)
        && angles.iter().all(|angle| angle.abs() <= WIDEST_RAD)
        && lengths.iter().all(|length| length.abs() <= WIDEST_M)
}

/// Returns true if the clock fits. The widest offset is that of Galileo: 31 bits of 2⁻³⁴ s.
fn has_clock(broadcast: &Broadcast) -> bool {
    let accuracy_m = broadcast.accuracy_m.unwrap_or(0.0);
    broadcast.af0_s.abs() <= 0.0625
        && broadcast.af1_s_s.abs() <= 1e-7
        && broadcast.af2_s_s2.abs() <= 1e-12
        && broadcast.group_delays_s.iter().all(|delay| delay.abs() <= 1e-6)
        && (0.0..=1e4).contains(&accuracy_m)
}
