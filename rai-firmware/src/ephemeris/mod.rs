//! Broadcast orbits and clocks of GPS, Galileo and `BeiDou`.
//!
//! ```text
//! Broadcast ──new()──► Ephemeris ──at(received, travel)──► SatelliteState { position, clock }
//! ```
//!
//! All three systems broadcast the same sixteen Kepler elements, so there is one [`Ephemeris`]; what differs is
//! the gravity constant, the earth rate, the time scale of `toe`, and the extra rotation of the geostationary
//! `BeiDou` satellites ([`orbit`]), and what the clock refers to ([`clock`]).
//!
//! - [`Ephemeris::new`] checks every field once: who holds one can compute with it.
//! - [`Store`] keeps the newest of every satellite and refuses those that are unhealthy or too old, with a reason.
//! - An entry takes 112 bytes: what is broadcast with at most 24 bits is kept in `f32`, which holds it exactly, and
//!   32 bit angles stay integers.
//!
//! Accuracy: position and clock follow the interface documents to better than 1 mm; how good the broadcast is
//! itself (0.5 m to 2 m) is said by [`Ephemeris::accuracy_m`].
//!
//! References: [IS-GPS-200] 20.3.3, table 20-IV; [OS-SIS-ICD] 5.1.1 to 5.1.5; [BDS-SIS-B1I] 5.2.4, table 5-11.

mod accuracy;
mod broadcast;
mod clock;
mod orbit;
mod store;

use core::fmt;

use rai_core::frame::{Ecef, SPEED_OF_LIGHT_M_S};
use rai_core::satellite::{Constellation, SatelliteId};

use crate::counters::{count, counters};
use crate::time::{BEIDOU_OFFSET_MS, GpsTime, WEEK_MS};

pub use accuracy::{galileo_sisa_m, ura_m};
pub use broadcast::{Broadcast, BroadcastError};
pub use clock::GroupDelay;
pub use store::{CAPACITY, Insertion, Store};

/// An angle as it is broadcast: 2⁻³¹ semicircles.
type BinaryAngle = i32;

/// Radians of one [`BinaryAngle`].
const BINARY_ANGLE_RAD: f64 = core::f64::consts::PI / 2_147_483_648.0;

/// Which navigation message the clock and the group delays come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// GPS LNAV: the clock refers to the L1/L2 ionosphere-free combination.
    GpsLnav,
    /// Galileo F/NAV: to E1/E5a.
    GalileoFnav,
    /// Galileo I/NAV: to E1/E5b.
    GalileoInav,
    /// `BeiDou` D1 or D2: to B3I.
    BeidouD1D2,
}

impl Source {
    /// Whose message it is.
    pub const fn constellation(self) -> Constellation {
        match self {
            Self::GpsLnav => Constellation::Gps,
            Self::GalileoFnav | Self::GalileoInav => Constellation::Galileo,
            Self::BeidouD1D2 => Constellation::Beidou,
        }
    }

    /// The largest distance from `toe` at which the elements are used, ms.
    ///
    /// GPS sets are fitted over ±2 h. Galileo renews every 10 min to 3 h and keeps a set valid for 4 h. `BeiDou`
    /// renews hourly, and what is older than 2 h is wrong by metres. A minute more keeps a set in use until the
    /// next one has been received.
    const fn age_limit_ms(self) -> u64 {
        const HOUR_MS: u64 = 3_600_000;
        const CHANGEOVER_MS: u64 = 60_000;
        CHANGEOVER_MS
            + match self {
                Self::GpsLnav | Self::BeidouD1D2 => 2 * HOUR_MS,
                Self::GalileoFnav | Self::GalileoInav => 4 * HOUR_MS,
            }
    }

    /// The highest satellite number that the system's own messages can name.
    const fn highest_number(self) -> u8 {
        match self {
            Self::GpsLnav => 32,
            Self::GalileoFnav | Self::GalileoInav => 36,
            Self::BeidouD1D2 => 63,
        }
    }
}

/// Why a satellite has no position now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EphemerisError {
    /// None has been received.
    Missing,
    /// The satellite says of itself that it is not to be used, or promises no accuracy.
    Unhealthy,
    /// The newest one is too old, or its reference time too far ahead.
    Stale,
    /// The signal's travel time is no travel time.
    TravelTime,
}

impl fmt::Display for EphemerisError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Missing => "no ephemeris",
            Self::Unhealthy => "unhealthy satellite",
            Self::Stale => "stale ephemeris",
            Self::TravelTime => "travel time out of bounds",
        })
    }
}

impl core::error::Error for EphemerisError {}

counters! {
    /// Satellites that were observed but had no usable ephemeris, by reason.
    Refusals {
        /// See [`EphemerisError::Missing`].
        ephemeris_missing,
        /// See [`EphemerisError::Unhealthy`].
        satellite_unhealthy,
        /// See [`EphemerisError::Stale`].
        ephemeris_stale,
        /// See [`EphemerisError::TravelTime`].
        travel_time_out_of_bounds,
    }
}

impl Refusals {
    /// Counts one satellite that was left out.
    pub fn count(&mut self, reason: EphemerisError) {
        count(match reason {
            EphemerisError::Missing => &mut self.ephemeris_missing,
            EphemerisError::Unhealthy => &mut self.satellite_unhealthy,
            EphemerisError::Stale => &mut self.ephemeris_stale,
            EphemerisError::TravelTime => &mut self.travel_time_out_of_bounds,
        });
    }
}

/// Where a satellite was, and what its clock showed, when it sent the signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SatelliteState {
    /// Position in the earth-fixed frame at the instant of transmission.
    pub position: Ecef,
    /// Satellite clock minus system time, relativity included, group delay not, s.
    pub clock_s: f64,
}

/// One satellite's orbit and clock, checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ephemeris {
    sqrt_a_sqrt_m: f64,
    eccentricity: f64,
    af0_s: f64,
    m0: BinaryAngle,
    omega0: BinaryAngle,
    i0: BinaryAngle,
    omega: BinaryAngle,
    delta_n_sc_s: f32,
    omegadot_sc_s: f32,
    idot_sc_s: f32,
    cuc_rad: f32,
    cus_rad: f32,
    crc_m: f32,
    crs_m: f32,
    cic_rad: f32,
    cis_rad: f32,
    af1_s_s: f32,
    af2_s_s2: f32,
    group_delays_s: [f32; 2],
    accuracy_m: Option<f32>,
    toe: GpsTime,
    /// `toc − toe`.
    toc_offset_s: i32,
    satellite: SatelliteId,
    source: Source,
    healthy: bool,
}

impl Ephemeris {
    /// Checks a message, field by field.
    ///
    /// # Errors
    /// [`BroadcastError`] names the first field that no satellite could have sent.
    pub fn new(broadcast: &Broadcast) -> Result<Self, BroadcastError> {
        broadcast::check(broadcast)?;
        Ok(Self {
            sqrt_a_sqrt_m: broadcast.sqrt_a_sqrt_m,
            eccentricity: broadcast.eccentricity,
            af0_s: broadcast.af0_s,
            m0: binary_angle(broadcast.m0_sc),
            omega0: binary_angle(broadcast.omega0_sc),
            i0: binary_angle(broadcast.i0_sc),
            omega: binary_angle(broadcast.omega_sc),
            delta_n_sc_s: broadcast.delta_n_sc_s as f32,
            omegadot_sc_s: broadcast.omegadot_sc_s as f32,
            idot_sc_s: broadcast.idot_sc_s as f32,
            cuc_rad: broadcast.cuc_rad,
            cus_rad: broadcast.cus_rad,
            crc_m: broadcast.crc_m,
            crs_m: broadcast.crs_m,
            cic_rad: broadcast.cic_rad,
            cis_rad: broadcast.cis_rad,
            af1_s_s: broadcast.af1_s_s as f32,
            af2_s_s2: broadcast.af2_s_s2 as f32,
            group_delays_s: broadcast.group_delays_s,
            accuracy_m: broadcast.accuracy_m,
            toe: broadcast.toe,
            toc_offset_s: (broadcast.toc.since_ms(broadcast.toe) / 1000) as i32,
            satellite: broadcast.satellite,
            source: broadcast.source,
            healthy: broadcast.healthy,
        })
    }

    /// Whose it is.
    pub fn satellite(&self) -> SatelliteId {
        self.satellite
    }

    /// Which message it came from.
    pub fn source(&self) -> Source {
        self.source
    }

    /// Reference time of the elements.
    pub fn toe(&self) -> GpsTime {
        self.toe
    }

    /// One sigma of the range error that the satellite promises, m; `None` when it promises nothing.
    pub fn accuracy_m(&self) -> Option<f64> {
        self.accuracy_m.map(f64::from)
    }

    /// Whether it may be used at that time.
    ///
    /// # Errors
    /// [`EphemerisError::Unhealthy`] or [`EphemerisError::Stale`].
    pub fn usable_at(&self, time: GpsTime) -> Result<(), EphemerisError> {
        if !self.healthy || self.accuracy_m.is_none() {
            return Err(EphemerisError::Unhealthy);
        }
        if self.is_stale(time) { Err(EphemerisError::Stale) } else { Ok(()) }
    }

    /// True when the elements are too far from their reference time.
    fn is_stale(&self, time: GpsTime) -> bool {
        time.since_ms(self.toe).unsigned_abs() > self.source.age_limit_ms()
    }

    /// Position and clock when a signal left that was received at `received` with this pseudorange.
    ///
    /// `received` is the receiver's own time tag and the range is measured against the same clock, so the clock's
    /// offset cancels: `received − range/c` is what the satellite's clock showed.
    ///
    /// # Errors
    /// [`EphemerisError::TravelTime`] when the range is not finite, negative or longer than a second of light, or
    /// when `received` is more than a day from the reference time.
    pub fn at(&self, received: GpsTime, range_m: f64) -> Result<SatelliteState, EphemerisError> {
        const DAY_MS: u64 = 86_400_000;
        let since_toe_ms = received.since_ms(self.toe);
        let travel_s = range_m / SPEED_OF_LIGHT_M_S;
        if !(0.0..=1.0).contains(&travel_s) || since_toe_ms.unsigned_abs() > DAY_MS {
            return Err(EphemerisError::TravelTime);
        }
        // Seconds from the reference time, never seconds since 1980: the latter would cost 0.2 µs in an f64.
        let shown_s = since_toe_ms as f64 * 1e-3 - travel_s;
        let polynomial_s = self.clock_polynomial_s(shown_s);
        let orbit = self.orbit_at(shown_s - polynomial_s);
        Ok(SatelliteState { position: orbit.position, clock_s: polynomial_s + orbit.relativity_s })
    }

    /// Reference time of the elements within the week of the satellite's own system, s.
    fn toe_of_system_s(&self) -> f64 {
        let offset_ms = match self.satellite.constellation() {
            Constellation::Beidou => WEEK_MS - BEIDOU_OFFSET_MS,
            _ => 0,
        };
        f64::from((self.toe.tow_ms + offset_ms) % WEEK_MS) * 1e-3
    }
}

/// The nearest [`BinaryAngle`]; exact for what was broadcast.
fn binary_angle(semicircles: f64) -> BinaryAngle {
    libm::round(semicircles * 2_147_483_648.0) as BinaryAngle
}
