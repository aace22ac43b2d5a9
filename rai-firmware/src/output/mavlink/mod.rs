//! `MAVLink` 2: the epoch for an autopilot.
//!
//! | message | id | content |
//! |---|---|---|
//! | `HEARTBEAT` | 0 | state: active while protected, critical in an alert, standby otherwise |
//! | `GPS_INPUT` | 232 | position and velocity, or that there is no fix |
//! | `GNSS_INTEGRITY` | 441 | use of the position, protection levels, authentication, jamming and spoofing |
//!
//! Autopilots use `GPS_INPUT` without a check. Its fix type is therefore 3 only while the position
//! is protected. Otherwise it is 1, or 0 without a position, and there are no coordinates. Its
//! accuracies are sigmas that also cover the protection levels: `max(σ, PL / 5.33)`, because a
//! level of 1e-7 is 5.33 sigmas. The altitude is above mean sea level ([`super::geoid`]), as the
//! message requires. Its accuracy is that of the height above the ellipsoid.
//!
//! `GNSS_INTEGRITY` carries the protection levels in `raim_hfom` and `raim_vfom`, rounded up to a
//! centimetre. Its layout follows the dialect [`DIALECT`], which will change; only [`dialect`]
//! depends on it. The authentication state is that of the module's own authentication of ephemerides,
//! if it has a key: initialising until the first proof, `OK` with four satellites proved, an error if
//! one is false, disabled under `AUTH,OFF`. Without a key it is `OK` while the receiver reports an
//! authenticated signal, otherwise `UNKNOWN`. The integrity state is `OK` in a protected epoch, `FAILED` in an alert
//! and `UNKNOWN` in an unavailable epoch, in which nothing has failed. Unless the epoch is
//! protected, both levels are invalid.
//!
//! References: [MAVLINK], the guide, `common.xml` and `development.xml`.
//!
//! [MAVLINK]: crate#references

use embedded_io::Write;
use raim_core::internals::numeric::sqrt;
use raim_core::report::{Solution, Unavailable, Verdict};

use super::geoid::Altitude;
use super::schedule::{Due, Item};
use super::{Interference, Statement};
use crate::time::GpsTime;

pub mod dialect;
mod frame;

pub use dialect::DIALECT;
use dialect::{GNSS_INTEGRITY, GPS_INPUT, HEARTBEAT};
use frame::Frame;

/// Number of sigmas in a protection level: the two-sided quantile of 1e-7.
const SIGMAS_OF_A_LEVEL: f32 = 5.33;

/// 1980-01-06 in UNIX time, ms.
const GPS_EPOCH_UNIX_MS: u64 = 315_964_800_000;

/// Invalid figure of `GNSS_INTEGRITY`.
const INVALID: u64 = 65_535;

/// States of `GNSS_INTEGRITY`: of anything, and of the authentication.
const UNKNOWN: u64 = 0;
const AUTHENTICATED: u64 = 3;

/// Unknown quality of `GNSS_INTEGRITY`.
const UNKNOWN_QUALITY: u64 = 255;

/// Ignore flags of `GPS_INPUT` for dilutions, velocities and accuracies: all flags except that for
/// the height.
const IGNORE_ALL: u64 = 0xFF;
const IGNORE_VELOCITY: u64 = 8 | 16 | 32;

/// Fix types of `GPS_INPUT`.
const NO_RECEIVER: u64 = 0;
const NO_FIX: u64 = 1;
const FIX_3D: u64 = 3;

/// Sender of numbered frames.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sender {
    sequence: u8,
    /// State of the module's own authentication, if there is one.
    #[cfg(feature = "osnma")]
    pub(crate) authentication: Option<u8>,
}

impl Sender {
    /// Writes the messages that are due with an epoch.
    ///
    /// # Errors
    /// The writer's own.
    pub fn write_epoch<W: Write, const N: usize>(
        &mut self,
        statement: &Statement<'_, N>,
        due: Due,
        out: &mut W,
    ) -> Result<(), W::Error> {
        let verdict = statement.report.verdict;
        if due.has(Item::Heartbeat) {
            self.send(&heartbeat(verdict), out)?;
        }
        if due.has(Item::GpsInput) {
            self.send(&gps_input(statement), out)?;
        }
        if due.has(Item::GnssIntegrity) {
            let authentication = self.authentication(statement.interference);
            let message =
                gnss_integrity(verdict, statement.levels_m(), statement.interference, authentication);
            self.send(&message, out)?;
        }
        Ok(())
    }

    /// Writes the messages that are due without an epoch: no fix, and a position that must not be
    /// used.
    ///
    /// # Errors
    /// The writer's own.
    pub fn write_stale<W: Write>(&mut self, verdict: Verdict, due: Due, out: &mut W) -> Result<(), W::Error> {
        if due.has(Item::Heartbeat) {
            self.send(&heartbeat(verdict), out)?;
        }
        if due.has(Item::GpsInput) {
            self.send(
                &Frame::of(&GPS_INPUT, &nowhere(0, GpsTime { week: 0, tow_ms: 0 }, NO_RECEIVER, 0)),
                out,
            )?;
        }
        if due.has(Item::GnssIntegrity) {
            let message = gnss_integrity(verdict, (None, None), Interference::default(), UNKNOWN);
            self.send(&message, out)?;
        }
        Ok(())
    }

    /// Returns the state of the authentication: that of the module, or else of the receiver.
    fn authentication(self, interference: Interference) -> u64 {
        #[cfg(feature = "osnma")]
        if let Some(state) = self.authentication {
            return u64::from(state);
        }
        if interference.authenticated > Some(0) { AUTHENTICATED } else { UNKNOWN }
    }

    fn send<W: Write>(&mut self, frame: &Frame, out: &mut W) -> Result<(), W::Error> {
        let bytes = frame.numbered(self.sequence);
        self.sequence = self.sequence.wrapping_add(1);
        let mut rest = bytes.as_slice();
        while !rest.is_empty() {
            let taken = out.write(rest)?;
            rest = rest.get(taken.max(1)..).unwrap_or_default();
        }
        // Flushes, because a writer sends a sentence at its line feed, and a frame does not end
        // with one.
        out.flush()
    }
}

/// Returns `HEARTBEAT` with the state of this verdict.
fn heartbeat(verdict: Verdict) -> Frame {
    const TYPE_GPS: u64 = 29;
    const NO_AUTOPILOT: u64 = 8;
    const VERSION: u64 = 3;
    let state = match verdict {
        Verdict::Unavailable(_) => 3,
        Verdict::Protected(_) => 4,
        Verdict::Alert(_) => 5,
    };
    Frame::of(&HEARTBEAT, &[0, TYPE_GPS, NO_AUTOPILOT, 0, state, VERSION])
}

/// Returns `GNSS_INTEGRITY` with the use of the position.
fn gnss_integrity(
    verdict: Verdict,
    levels_m: (Option<f64>, Option<f64>),
    interference: Interference,
    authentication: u64,
) -> Frame {
    const OK: u64 = 2;
    const FAILED: u64 = 3;
    const SOFTWARE_ERROR: u64 = 4;
    let is_protected = matches!(verdict, Verdict::Protected(_));
    let state = match verdict {
        Verdict::Protected(_) => OK,
        Verdict::Unavailable(_) => UNKNOWN,
        Verdict::Alert(_) => FAILED,
    };
    let errors =
        if matches!(verdict, Verdict::Unavailable(Unavailable::SelfTest)) { SOFTWARE_ERROR } else { 0 };
    let figure = |level_m: Option<f64>| level_m.filter(|_| is_protected).map_or(INVALID, centimetres);
    Frame::of(
        &GNSS_INTEGRITY,
        &[
            errors,
            figure(levels_m.0),
            figure(levels_m.1),
            0,
            authentication,
            u64::from(interference.jamming),
            u64::from(interference.spoofing),
            state,
            UNKNOWN_QUALITY,
            UNKNOWN_QUALITY,
            UNKNOWN_QUALITY,
            UNKNOWN_QUALITY,
        ],
    )
}

/// Rounds up to centimetres; invalid for NaN and for a level too large for the field.
fn centimetres(level_m: f64) -> u64 {
    let level_cm = libm::ceil(level_m * 100.0);
    if level_cm >= 0.0 && level_cm < INVALID as f64 { level_cm as u64 } else { INVALID }
}

/// Returns `GPS_INPUT`, with the position if it is protected.
fn gps_input<const N: usize>(statement: &Statement<'_, N>) -> Frame {
    let unix_us = (statement.time.to_ms() + GPS_EPOCH_UNIX_MS)
        .saturating_sub(u64::from(statement.gps_minus_utc_s) * 1000)
        * 1000;
    let satellites = statement.report.used.len() as u64;
    let is_protected = matches!(statement.report.verdict, Verdict::Protected(_));
    let values = match statement.usable_solution() {
        Some(solution) if is_protected => position(statement, solution, unix_us),
        _ if statement.report.solution.is_some() => nowhere(unix_us, statement.time, NO_FIX, satellites),
        _ => nowhere(unix_us, statement.time, NO_RECEIVER, satellites),
    };
    Frame::of(&GPS_INPUT, &values)
}

/// Returns the values of `GPS_INPUT` without a position.
fn nowhere(unix_us: u64, time: GpsTime, fix_type: u64, satellites: u64) -> [u64; 18] {
    let mut values = [0; 18];
    values[0] = unix_us;
    values[1] = time.tow_ms.into();
    values[13] = IGNORE_ALL;
    values[14] = time.week.into();
    values[16] = fix_type;
    values[17] = satellites;
    values
}

fn position<const N: usize>(statement: &Statement<'_, N>, solution: &Solution, unix_us: u64) -> [u64; 18] {
    let float = |value: f64| u64::from((value as f32).to_bits());
    let [east, _, _, north, _, up] = solution.covariance_m2;
    let (hpl_m, vpl_m) = statement.levels_m();
    let accuracy = |variance: f64, level_m: Option<f64>| {
        let of_level_m = level_m.map_or(f32::INFINITY, |level_m| level_m as f32 / SIGMAS_OF_A_LEVEL);
        // The root of a negative variance is NaN, which `max` passes over.
        u64::from(of_level_m.max(sqrt(variance as f32)).to_bits())
    };
    let motion = statement.usable_motion();
    let along = |component: f32| u64::from(component.to_bits());
    let [north_m_s, east_m_s, down_m_s, speed_sigma] = match motion {
        Some(motion) => [motion.north_m_s, motion.east_m_s, -motion.up_m_s, motion.sigma_m_s].map(along),
        None => [0; 4],
    };
    [
        unix_us,
        statement.time.tow_ms.into(),
        degrees_e7(solution.geodetic.latitude_rad),
        degrees_e7(solution.geodetic.longitude_rad),
        float(Altitude::of(&solution.geodetic).above_sea_m),
        float(solution.hdop),
        float(solution.vdop),
        north_m_s,
        east_m_s,
        down_m_s,
        speed_sigma,
        accuracy(east + north, hpl_m),
        accuracy(up, vpl_m),
        if motion.is_some() { 0 } else { IGNORE_VELOCITY },
        statement.time.week.into(),
        0,
        FIX_3D,
        statement.report.used.len() as u64,
    ]
}

/// Returns degrees times 1e7, as a signed integer in the low 32 bits.
fn degrees_e7(angle_rad: f64) -> u64 {
    let scaled = libm::round(angle_rad * (180.0e7 / core::f64::consts::PI));
    u64::from((scaled as i32).cast_unsigned())
}
