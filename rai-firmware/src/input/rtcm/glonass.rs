//! Message 1020: the state vector of a GLONASS satellite. Message 1013: the date and the leap
//! seconds, without which GLONASS alone has no GPS time.
//!
//! | offset in 1013 | width | field |
//! |---|---|---|
//! | 24, 40, 62 | 16, 17, 8 | modified Julian day, second of that day in UTC, GPS time minus UTC in s |
//!
//! | offset in 1020 | width | field |
//! |---|---|---|
//! | 12, 39, 41 | 6, 1, 7 | satellite, health `B_n`, `t_b` in quarters of an hour of GLONASS time |
//! | 48, 104, 160 | 24, 27, 5 each | velocity, position, acceleration of x, y, z |
//! | 217, 230, 231, 253, 264 | 11, 1, 22, 5, 4 | `γ_n`, `l_n`, `τ_n`, `Δτ_n`, `F_T` |
//!
//! Numbers of 1020 are a sign bit and a magnitude. References: [RTCM-10403.3] 3.5.11.2, table
//! 3.5-21, and 3.5.8, table 3.5-17.
//!
//! [RTCM-10403.3]: crate#references

use raim_core::satellite::{Constellation, SatelliteId};

use crate::ephemeris::{Health, StateBroadcast, glonass_accuracy_m};
use crate::input::Unread;
use crate::input::bits::Bits;
use crate::input::calendar::Calendar;
use crate::input::calendar::MOST_S;
use crate::time::{DAY_MS, GpsTime, glonass_time};

/// Bytes of the message.
const LENGTH: usize = 45;

/// Bytes of 1013 up to the leap seconds.
const TIME_LENGTH: usize = 9;

/// Modified Julian day on which GPS time began, 1980-01-06.
const FIRST_DAY: u32 = 44_244;

/// Last day after that, in 2099. A day beyond it is one before 1980, such as that with which a clock
/// begins that was never set.
const LAST_DAY: u32 = 43_600;

/// Reads 1013: the time to within seconds, and the leap seconds.
///
/// Zero leap seconds are refused: UTC has not equalled GPS time since June 1981, so that the sender
/// has left the field empty.
pub(super) fn read_time(payload: &[u8]) -> Result<(GpsTime, u8), Unread> {
    let bits = Bits(payload.get(..TIME_LENGTH).ok_or(Unread::Malformed)?);
    // The field counts days modulo 2¹⁶, which it reaches in April 2038.
    let day = bits.unsigned(24, 16).wrapping_sub(FIRST_DAY) & 0xFFFF;
    let leap_s = bits.small(62, 8);
    if day > LAST_DAY || !(1..=MOST_S as u8).contains(&leap_s) {
        return Err(Unread::Time);
    }
    // A second beyond the day moves the time by less than half a day, and the week by none.
    let seconds = day * (DAY_MS / 1000) + bits.unsigned(40, 17) + u32::from(leap_s);
    Ok((GpsTime::from_ms(1000 * u64::from(seconds)), leap_s))
}

/// Reads the message, for which the present time and the leap seconds must be known.
pub(super) fn read(payload: &[u8], calendar: &Calendar) -> Result<StateBroadcast, Unread> {
    const KM: f64 = 1e3;
    let bits = Bits(payload.get(..LENGTH).ok_or(Unread::Malformed)?);
    let leap = calendar.leap_second().ok_or(Unread::LeapUnknown)?;
    let now = calendar.present().ok_or(Unread::WithoutWeek)?;
    // Each axis has a block of fields. The closure reads one field of the three blocks, from its
    // offset in the block, its width and its power of two.
    let along = |behind: usize, width, exponent| {
        [48, 104, 160].map(|axis| bits.magnitude(axis + behind, width, exponent) * KM)
    };
    let is_well = !bits.is_set(39) && !bits.is_set(230);
    Ok(StateBroadcast {
        satellite: SatelliteId::new(Constellation::Glonass, bits.small(12, 6)).ok_or(Unread::Satellite)?,
        health: Health::of_satellite(is_well),
        accuracy_m: glonass_accuracy_m(bits.small(264, 4)),
        toe: glonass_time(900 * bits.unsigned(41, 7), leap.seconds, now).ok_or(Unread::Ephemeris)?,
        velocity_m_s: along(0, 24, -20),
        position_m: along(24, 27, -11),
        acceleration_m_s2: along(51, 5, -30).map(|acceleration| acceleration as f32),
        clock_s: -bits.magnitude(231, 22, -30),
        clock_s_s: bits.magnitude(217, 11, -40),
        delay_l2_s: bits.magnitude(253, 5, -30) as f32,
    })
}
