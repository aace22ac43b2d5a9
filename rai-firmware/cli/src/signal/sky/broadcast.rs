//! A satellite's orbit and clock as it would broadcast them: messages 1019, 1042 and 1046.
//!
//! The node of a broadcast orbit is counted from the start of the week, that of a simulated one
//! from `t = 0`:
//!
//! ```text
//! Ω₀ = Ω(toe) + ω_e toe         Δn = n − √(μ/a³)         with the ω_e and μ of each system
//! ```
//!
//! Geostationary satellites of `BeiDou` are written in a plane tilted by 5° ([BDS-SIS-ICD]
//! 5.2.4.12): a satellite at rest over the longitude λ has `i = 5°`, `Ω₀ − ω_e toe = 180°`,
//! `M = λ + 180°`.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `toe` | [`TimedEphemeris::toe`] | GPS time |
//! | `a_f0`, `a_f1` | [`SatelliteClock`] | s, s/s |
//!
//! Group delays, harmonic corrections and drifts of the inclination are zero. Rounding in the
//! fields of the messages moves a satellite by less than 0.2 m.
//!
//! [BDS-SIS-ICD]: crate#references

use core::f64::consts::{PI, TAU};

use raim_core::frame::{EARTH_ROTATION_RAD_S, SPEED_OF_LIGHT_M_S};
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::time::{BEIDOU_OFFSET_MS, BEIDOU_WEEK_OFFSET, GALILEO_WEEK_OFFSET, GpsTime};
use rtcm_rs::msg::{Msg1019T, Msg1042T, Msg1046T};

use super::fleet::Satellite;
use super::orbit::Orbit;
use crate::signal::measurement::{Ephemeris, TimedEphemeris};

/// Constants of a system's interface document.
struct Convention {
    gravitation_m3_s2: f64,
    earth_rate_rad_s: f64,
}

/// [IS-GPS-200] table 20-IV.
///
/// [IS-GPS-200]: crate#references
const GPS: Convention =
    Convention { gravitation_m3_s2: 3.986_005e14, earth_rate_rad_s: EARTH_ROTATION_RAD_S };

/// [BDS-SIS-ICD] 5.2.4.12.
///
/// [BDS-SIS-ICD]: crate#references
const BEIDOU: Convention = Convention { gravitation_m3_s2: 3.986_004_418e14, earth_rate_rad_s: 7.292_115e-5 };

/// [Galileo-OS-SIS-ICD] table 58.
///
/// [Galileo-OS-SIS-ICD]: crate#references
const GALILEO: Convention =
    Convention { gravitation_m3_s2: 3.986_004_418e14, earth_rate_rad_s: 7.292_115_146_7e-5 };

/// Index of an accuracy of 3.12 m, which satellites send on ordinary days ([Galileo-OS-SIS-ICD]
/// table 76).
///
/// [Galileo-OS-SIS-ICD]: crate#references
const ORDINARY_SISA: u8 = 107;

/// Numbers of the geostationary satellites ([BDS-SIS-ICD] table 4-1).
///
/// [BDS-SIS-ICD]: crate#references
const GEOSTATIONARY: [core::ops::RangeInclusive<u8>; 2] = [1..=5, 59..=63];

/// Clock of a satellite, relative to its system's time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SatelliteClock {
    /// Offset at `t = 0`, s.
    pub offset_s: f64,
    /// Drift, s/s.
    pub drift_s_s: f64,
}

impl SatelliteClock {
    /// Returns a clock for a satellite, different from all others and exact in the fields of the
    /// messages. The units are the last digits of GPS, which `BeiDou` has too.
    pub fn of(satellite: SatelliteId) -> Self {
        const OFFSET_UNIT_S: f64 = 1.0 / (1_u64 << 31) as f64;
        const DRIFT_UNIT_S_S: f64 = 1.0 / (1_u64 << 43) as f64;
        let number = f64::from(satellite.number());
        let sign = if satellite.number().is_multiple_of(2) { 1.0 } else { -1.0 };
        Self {
            offset_s: sign * (40_000.0 + 10_007.0 * number) * OFFSET_UNIT_S,
            drift_s_s: -sign * (number - 20.0) * DRIFT_UNIT_S_S,
        }
    }

    /// Returns the offset at `t_s`, without relativity, s.
    pub fn at(self, t_s: f64) -> f64 {
        self.offset_s + self.drift_s_s * t_s
    }
}

/// Returns the ephemeris of a satellite for the time around `t_s`, on a sky whose `t = 0` is at
/// `origin`; `None` for systems that are not simulated.
///
/// `t_s` and `origin` are multiples of 16 s, as the messages require. The ephemeris is sent from
/// half an hour before on.
pub fn ephemeris(satellite: &Satellite, origin: GpsTime, t_s: f64, number: u8) -> Option<TimedEphemeris> {
    /// Shift of the reference time for `BeiDou`, ms: its messages count 8 s of its own time, of
    /// which 14 s is not a multiple.
    const EARLIER_MS: u64 = 2000;
    const LEAD_MS: u64 = 30 * 60_000;
    let reference_ms = (origin.to_s() * 1e3 + t_s * 1e3) as u64;
    let (toe_ms, message) = match satellite.id.constellation() {
        Constellation::Gps => {
            let reference = GpsTime::from_ms(reference_ms);
            (reference_ms, Ephemeris::Gps(gps(satellite, reference, t_s, number)))
        }
        Constellation::Beidou => {
            let toe_ms = reference_ms - EARLIER_MS;
            let own = GpsTime::from_ms(toe_ms - u64::from(BEIDOU_OFFSET_MS));
            (toe_ms, Ephemeris::Beidou(beidou(satellite, own, t_s - EARLIER_MS as f64 * 1e-3, number)))
        }
        Constellation::Galileo => {
            let reference = GpsTime::from_ms(reference_ms);
            (reference_ms, Ephemeris::GalileoInav(galileo(satellite, reference, t_s, number)))
        }
        _ => return None,
    };
    Some(TimedEphemeris {
        satellite: satellite.id,
        toe: GpsTime::from_ms(toe_ms),
        sent: GpsTime::from_ms(reference_ms - LEAD_MS),
        message,
    })
}

/// Returns the same GPS set with a clock that is right only at its reference time: it drifts by
/// `error_m` in `time_s`. Sets of other systems are unchanged.
#[must_use]
pub fn drifting(mut set: TimedEphemeris, error_m: f64, time_s: f64) -> TimedEphemeris {
    if let Ephemeris::Gps(message) = &mut set.message {
        message.af1_s_s += (error_m / SPEED_OF_LIGHT_M_S / time_s) as f32;
    }
    set
}

/// Angles of an orbit at its reference time, semicircles, as the messages have them.
struct Angles {
    m0_sc: f64,
    delta_n_sc_s: f64,
    omega0_sc: f64,
    omegadot_sc_s: f64,
    i0_sc: f64,
    omega_sc: f64,
}

impl Angles {
    fn of(orbit: &Orbit, t_s: f64, week_s: f64, convention: &Convention) -> Self {
        let kepler_rad_s =
            libm::sqrt(convention.gravitation_m3_s2 / orbit.semi_major_axis_m) / orbit.semi_major_axis_m;
        let fixed_node_rad_s = orbit.node_rate_rad_s - EARTH_ROTATION_RAD_S;
        let node_rad = orbit.node_rad + fixed_node_rad_s * t_s + convention.earth_rate_rad_s * week_s;
        Self {
            m0_sc: semicircles(orbit.mean_anomaly_rad + orbit.mean_motion_rad_s * t_s),
            delta_n_sc_s: (orbit.mean_motion_rad_s - kepler_rad_s) / PI,
            omega0_sc: semicircles(node_rad),
            omegadot_sc_s: (fixed_node_rad_s + convention.earth_rate_rad_s) / PI,
            i0_sc: orbit.inclination_rad / PI,
            omega_sc: semicircles(orbit.perigee_rad),
        }
    }

    /// Returns the angles of a satellite at rest over the equator, in the tilted plane.
    fn at_rest(orbit: &Orbit, week_s: f64, convention: &Convention) -> Self {
        let longitude_rad = orbit.node_rad + orbit.perigee_rad + orbit.mean_anomaly_rad;
        let moving = Self::of(orbit, 0.0, 0.0, convention);
        let kepler_rad_s = orbit.mean_motion_rad_s - moving.delta_n_sc_s * PI;
        Self {
            m0_sc: semicircles(longitude_rad + PI),
            delta_n_sc_s: (convention.earth_rate_rad_s - kepler_rad_s) / PI,
            omega0_sc: semicircles(PI + convention.earth_rate_rad_s * week_s),
            omegadot_sc_s: 0.0,
            i0_sc: 5.0 / 180.0,
            omega_sc: 0.0,
        }
    }
}

/// Returns the seconds of the week; a full number below 2²⁰, exact in `f32`.
fn seconds(time: GpsTime) -> f32 {
    (time.tow_ms / 1000) as f32
}

/// Converts an angle to between −1 and 1 semicircle.
fn semicircles(angle_rad: f64) -> f64 {
    (angle_rad + PI).rem_euclid(TAU) / PI - 1.0
}

fn gps(satellite: &Satellite, reference: GpsTime, t_s: f64, number: u8) -> Msg1019T {
    let week_s = f64::from(reference.tow_ms) * 1e-3;
    let orbit = &satellite.orbit;
    let angles = Angles::of(orbit, t_s, week_s, &GPS);
    let clock = SatelliteClock::of(satellite.id);
    Msg1019T {
        gps_satellite_id: satellite.id.number(),
        gps_week_number: reference.week % 1024,
        iode: number,
        iodc: u16::from(number),
        toc_s: seconds(reference),
        toe_s: seconds(reference),
        af1_s_s: clock.drift_s_s as _,
        af0_s: clock.at(t_s) as _,
        sqrt_a_sqrt_m: libm::sqrt(orbit.semi_major_axis_m),
        eccentricity: orbit.eccentricity as _,
        m0_sc: angles.m0_sc,
        delta_n_sc_s: angles.delta_n_sc_s as _,
        omega0_sc: angles.omega0_sc,
        omegadot_sc_s: angles.omegadot_sc_s as _,
        i0_sc: angles.i0_sc,
        omega_sc: angles.omega_sc,
        ..Msg1019T::default()
    }
}

fn galileo(satellite: &Satellite, reference: GpsTime, t_s: f64, number: u8) -> Msg1046T {
    let week_s = f64::from(reference.tow_ms) * 1e-3;
    let orbit = &satellite.orbit;
    let angles = Angles::of(orbit, t_s, week_s, &GALILEO);
    let clock = SatelliteClock::of(satellite.id);
    Msg1046T {
        gal_satellite_id: satellite.id.number(),
        gal_week_number: reference.week - GALILEO_WEEK_OFFSET,
        iodnav: u16::from(number),
        sisa_e1_e5b_index: ORDINARY_SISA,
        toc_s: seconds(reference) as _,
        toe_s: seconds(reference) as _,
        af1_s_s: clock.drift_s_s as _,
        af0_s: clock.at(t_s) as _,
        sqrt_a_sqrt_m: libm::sqrt(orbit.semi_major_axis_m),
        eccentricity: orbit.eccentricity as _,
        m0_sc: angles.m0_sc,
        delta_n_sc_s: angles.delta_n_sc_s as _,
        omega0_sc: angles.omega0_sc,
        omegadot_sc_s: angles.omegadot_sc_s as _,
        i0_sc: angles.i0_sc,
        omega_sc: angles.omega_sc,
        ..Msg1046T::default()
    }
}

/// Encodes a `BeiDou` satellite. `own` is `BeiDou` time, `t_s` the same instant on the sky's clock.
fn beidou(satellite: &Satellite, own: GpsTime, t_s: f64, number: u8) -> Msg1042T {
    let week_s = f64::from(own.tow_ms) * 1e-3;
    let orbit = &satellite.orbit;
    let is_at_rest = GEOSTATIONARY.iter().any(|numbers| numbers.contains(&satellite.id.number()));
    let angles = if is_at_rest {
        Angles::at_rest(orbit, week_s, &BEIDOU)
    } else {
        Angles::of(orbit, t_s, week_s, &BEIDOU)
    };
    let clock = SatelliteClock::of(satellite.id);
    Msg1042T {
        bds_satellite_id: satellite.id.number(),
        bds_week_number: own.week - BEIDOU_WEEK_OFFSET,
        aode: number % 25,
        aodc: number % 25,
        toc_s: seconds(own),
        toe_s: seconds(own),
        a1_s_s: clock.drift_s_s as _,
        a0_s: clock.at(t_s) as _,
        sqrt_a_sqrt_m: libm::sqrt(orbit.semi_major_axis_m),
        eccentricity: orbit.eccentricity as _,
        m0_sc: angles.m0_sc,
        delta_n_sc_s: angles.delta_n_sc_s as _,
        omega0_sc: angles.omega0_sc,
        omegadot_sc_s: angles.omegadot_sc_s as _,
        i0_sc: angles.i0_sc,
        omega_sc: angles.omega_sc,
        ..Msg1042T::default()
    }
}
