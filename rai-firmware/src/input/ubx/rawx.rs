//! RXM-RAWX: the ranges of one epoch.
//!
//! | offset | type | field |
//! |---|---|---|
//! | 0, 8 | f64, u16 | time of week, s; week, 0 until the receiver knows it |
//! | 10, 12 | i8, bits | leap seconds; bit 0: they are known |
//! | 11 | u8 | number of measurements, 32 bytes each |
//! | 16 + 0 | f64 | pseudorange, m |
//! | 16 + 16 | f32 | Doppler, Hz, positive when approaching; 0 counts as not measured |
//! | 16 + 20 to 23 | u8 | system, satellite, signal, GLONASS channel + 7 |
//! | 16 + 26 | u8 | C/N0, dB-Hz |
//! | 16 + 30 | bits | 0: range valid |
//!
//! The time of an epoch is a whole millisecond, but the receiver's tag need not be. With `δ`, the
//! tag minus the nearest millisecond, each range `P` becomes `P − c δ`. The instant of transmission
//! stays the same, and the change is common to all ranges.
//!
//! A double on the wire may have any value. Times out of range and values that are not finite are
//! refused here. Assembly refuses ranges out of bounds.
//!
//! Reference: [UBX-F9] RXM-RAWX.
//!
//! [UBX-F9]: crate#references

use raim_core::frame::SPEED_OF_LIGHT_M_S;
use raim_core::satellite::SatelliteId;

use crate::counters::count;
use crate::input::protocol::Measurements;
use crate::input::system::System;
use crate::input::{Counters, Unread};
use crate::raw::{Band, Carrier, Code, RawSignal};
use crate::time::GpsTime;

/// Bytes before the measurements.
const HEADER: usize = 16;

/// Bytes of a measurement.
const MEASUREMENT: usize = 32;

/// Class and id of the message.
pub(super) const MESSAGE: [u8; 2] = [0x02, 0x15];

/// Offset of the number of measurements in the payload.
const MANY_AT: usize = 11;

/// Largest offset of the time tag that counts as zero, s: ten times the rounding of a time of week
/// in a double.
const ROUNDING_S: f64 = 1e-9;

/// Message whose header and length are valid.
#[derive(Debug)]
pub(in crate::input) struct Rawx<'a> {
    measurements: &'a [u8],
    /// Time of the epoch, to the nearest millisecond.
    pub(super) time: GpsTime,
    /// Time tag minus `time`, times the speed of light, m.
    offset_m: f64,
    /// GPS time minus UTC, s, if the receiver knows it.
    pub(super) leap_s: Option<u8>,
}

impl<'a> Rawx<'a> {
    /// Reads the header.
    pub(super) fn new(payload: &'a [u8]) -> Result<Self, Unread> {
        /// Version 0 has zeros for version and signal, and the same layout.
        const LATEST: u8 = 1;
        let (header, measurements) = payload.split_first_chunk::<HEADER>().ok_or(Unread::Malformed)?;
        let &[t0, t1, t2, t3, t4, t5, t6, t7, w0, w1, leap_s, many, status, version, _, _] = header;
        if version > LATEST || !explains(many, measurements.len()) {
            return Err(Unread::Malformed);
        }
        let week = u16::from_le_bytes([w0, w1]);
        if week == 0 {
            return Err(Unread::WithoutWeek);
        }
        let tow_s = f64::from_le_bytes([t0, t1, t2, t3, t4, t5, t6, t7]);
        if !(0.0..604_800.0).contains(&tow_s) {
            return Err(Unread::Time);
        }
        let tow_ms = libm::round(tow_s * 1e3);
        let offset_s = tow_s - tow_ms * 1e-3;
        let is_whole = offset_s.abs() < ROUNDING_S;
        let offset_m = if is_whole { 0.0 } else { offset_s * SPEED_OF_LIGHT_M_S };
        let time = GpsTime { week, tow_ms: 0 }.later_by_ms(tow_ms as u32);
        let leap_s = (status & 1 == 1 && leap_s <= 63).then_some(leap_s);
        Ok(Self { measurements, time, offset_m, leap_s })
    }
}

impl Measurements for Rawx<'_> {
    fn is_empty(&self) -> bool {
        self.measurements.is_empty()
    }

    /// Passes each range with the flag `false`: no code is marked as the one that the broadcast
    /// clock refers to. These receivers measure one code per band, so that no choice between codes
    /// is needed. Counts unusable measurements.
    fn each(
        &self,
        counters: &mut Counters,
        add: &mut impl FnMut(SatelliteId, RawSignal, bool, &mut Counters),
    ) {
        for measurement in self.measurements.chunks_exact(MEASUREMENT) {
            if let Some((satellite, signal)) = read(measurement, self.offset_m, counters) {
                add(satellite, signal, false, counters);
            }
        }
    }
}

/// Returns the length of a payload with this number of measurements, bytes.
pub(super) const fn payload_of(measurements: usize) -> usize {
    HEADER + measurements * MEASUREMENT
}

/// Returns true if a payload that begins with these bytes may have this length: the number of
/// measurements explains it, or has not come yet. The length must be at least that of the header.
pub(super) fn may_have(begun: &[u8], length: usize) -> bool {
    begun.get(MANY_AT).is_none_or(|&many| explains(many, length.saturating_sub(HEADER)))
}

/// Returns true if this number of measurements takes this number of bytes. Some receivers also set
/// the highest bit of the number.
fn explains(many: u8, bytes: usize) -> bool {
    [many, many & 0x7F].map(|many| usize::from(many) * MEASUREMENT).contains(&bytes)
}

/// Reads one measurement; counts an unusable one.
fn read(measurement: &[u8], offset_m: f64, counters: &mut Counters) -> Option<(SatelliteId, RawSignal)> {
    let &[
        p0,
        p1,
        p2,
        p3,
        p4,
        p5,
        p6,
        p7, //
        _,
        _,
        _,
        _,
        _,
        _,
        _,
        _, //
        d0,
        d1,
        d2,
        d3,
        system,
        number,
        signal,
        channel, //
        _,
        _,
        cn0_dbhz,
        _,
        _,
        _,
        status,
        _,
    ] = measurement.first_chunk::<MEASUREMENT>()?;
    let Some(system) = system_of(system) else {
        count(&mut counters.observations_other);
        return None;
    };
    let Some(satellite) = system.satellite(number) else {
        count(&mut counters.satellites_unknown);
        return None;
    };
    let Some(carrier) = carrier(system, signal, channel) else {
        count(&mut counters.signals_other);
        return None;
    };
    let range_m = f64::from_le_bytes([p0, p1, p2, p3, p4, p5, p6, p7]);
    if status & 1 == 0 {
        count(&mut counters.ranges_missing);
        return None;
    }
    if !range_m.is_finite() {
        count(&mut counters.ranges_out_of_bounds);
        return None;
    }
    let doppler_hz = f32::from_le_bytes([d0, d1, d2, d3]);
    // The message has no flag for a Doppler frequency that was not measured, and converters write zero.
    let doppler_hz = if doppler_hz == 0.0 { f32::NAN } else { doppler_hz };
    let signal = RawSignal::new(carrier, range_m - offset_m)
        .with_code(code(system, signal))
        .with_cn0_dbhz(f32::from(cn0_dbhz))
        .with_doppler_hz(doppler_hz);
    Some((satellite, signal))
}

/// Returns the system with this number in UBX, if it is used.
pub(super) const fn system_of(number: u8) -> Option<System> {
    match number {
        0 => Some(System::Gps),
        2 => Some(System::Galileo),
        3 => Some(System::Beidou),
        5 => Some(System::Qzss),
        6 => Some(System::Glonass),
        _ => None,
    }
}

/// Returns the carrier of a signal; `None` for unused signals. Receivers with a single band write 0
/// as the signal of every system.
const fn carrier(system: System, signal: u8, channel: u8) -> Option<Carrier> {
    let band = match (system, signal) {
        (System::Gps | System::Qzss, 0) => Band::L1,
        (System::Gps, 3 | 4) | (System::Qzss, 4 | 5) => Band::L2,
        (System::Gps, 6 | 7) | (System::Qzss, 8 | 9) => Band::L5,
        (System::Galileo, 0 | 1) => Band::E1,
        (System::Galileo, 3 | 4) => Band::E5a,
        (System::Galileo, 5 | 6) => Band::E5b,
        (System::Beidou, 0 | 1) => Band::B1I,
        (System::Beidou, 2 | 3) => Band::B2I,
        (System::Beidou, 4 | 10) => Band::B3I,
        (System::Beidou, 5 | 6) => Band::B1C,
        (System::Beidou, 7 | 8) => Band::B2a,
        (System::Glonass, 0) => Band::G1,
        (System::Glonass, 2) => Band::G2,
        _ => return None,
    };
    match system {
        System::Glonass if channel > 13 => None,
        System::Glonass => Some(Carrier { band, channel: channel.cast_signed() - 7 }),
        _ => Some(Carrier::of(band)),
    }
}

/// Returns the code of a signal of GPS or QZSS.
const fn code(system: System, signal: u8) -> Code {
    match (system, signal) {
        (System::Gps | System::Qzss, 0) => Code::Ca,
        (System::Gps, 3 | 4) | (System::Qzss, 4 | 5) => Code::L2c,
        (System::Gps, 6) | (System::Qzss, 8) => Code::I5,
        (System::Gps, 7) | (System::Qzss, 9) => Code::Q5,
        _ => Code::Other,
    }
}
