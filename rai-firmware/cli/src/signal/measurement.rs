//! Measurements of a receiver and broadcasts of the satellites, before any wire format.
//!
//! | quantity | field | unit |
//! |---|---|---|
//! | code pseudorange as measured, receiver clock and atmosphere left in | `pseudorange_m` | m |
//! | carrier phase | `carrier_cycles` | cycles |
//! | carrier-to-noise density | `cn0_dbhz` | dBHz |
//! | Doppler frequency, positive when approaching | `doppler_hz` | Hz |
//! | receiver's time tag | `time` | GPS time, whole ms |
//!
//! [`recording`](super::recording) and [`sky`](super::sky) make these values,
//! [`fault`](super::fault) changes them, [`encode`](super::encode) sends them.

use raim_core::frame::Ecef;
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::time::GpsTime;
use rtcm_rs::msg::{Msg1019T, Msg1020T, Msg1042T, Msg1044T, Msg1045T, Msg1046T};

use super::skipped::Skipped;

/// Measurements of a receiver, and the broadcasts of the satellites meanwhile.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// Epochs in the order of time, no time twice.
    pub epochs: Vec<MeasuredEpoch>,
    /// Ephemerides in the order of the files.
    pub ephemerides: Vec<TimedEphemeris>,
    /// GPS coefficients of the single-frequency ionosphere model, `α0…α3, β0…β3`, in the
    /// broadcast's units.
    pub klobuchar: Option<[f64; 8]>,
    /// GPS time minus UTC in the header of a navigation file, s.
    pub leap_s: Option<u8>,
    /// Records that were skipped.
    pub skipped: Skipped,
    /// Position of the antenna in the header; in some files it is wrong by hundreds of metres.
    pub approximate_position: Option<Ecef>,
}

/// All measurements of one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredEpoch {
    /// The receiver's time tag.
    pub time: GpsTime,
    /// Satellites in the order of the file.
    pub satellites: Vec<MeasuredSatellite>,
}

/// One satellite's signals, each with a pseudorange.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredSatellite {
    /// Name of the satellite.
    pub satellite: SatelliteId,
    /// Signals in the order of the file.
    pub signals: Vec<MeasuredSignal>,
}

/// One signal's measurements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredSignal {
    /// Frequency band as RINEX 3.05 numbers it; `BeiDou`'s B1I is 2.
    pub band: u8,
    /// Component of the signal, the third letter of the RINEX code.
    pub attribute: char,
    /// Code pseudorange, m.
    pub pseudorange_m: f64,
    /// Carrier phase, cycles.
    pub carrier_cycles: Option<f64>,
    /// Carrier-to-noise density, dBHz.
    pub cn0_dbhz: Option<f64>,
    /// Doppler frequency, positive when approaching, Hz.
    pub doppler_hz: Option<f64>,
}

impl MeasuredSignal {
    /// Returns the carrier frequency, Hz, of a signal of this system, and of this channel of
    /// GLONASS; `None` for a band that the system does not have.
    pub fn frequency_hz(&self, system: Constellation, channel: i8) -> Option<f64> {
        Some(match (system, self.band) {
            (Constellation::Gps | Constellation::Galileo | Constellation::Beidou, 1) => 1_575.42e6,
            (Constellation::Gps, 2) => 1_227.6e6,
            (Constellation::Gps | Constellation::Galileo | Constellation::Beidou, 5) => 1_176.45e6,
            (Constellation::Galileo | Constellation::Beidou, 7) => 1_207.14e6,
            (Constellation::Beidou, 2) => 1_561.098e6,
            (Constellation::Beidou, 6) => 1_268.52e6,
            (Constellation::Glonass, 1) => 1602.0e6 + f64::from(channel) * 562.5e3,
            (Constellation::Glonass, 2) => 1246.0e6 + f64::from(channel) * 437.5e3,
            _ => return None,
        })
    }
}

/// A broadcast ephemeris in the units of its message.
#[derive(Clone, Debug, PartialEq)]
pub enum Ephemeris {
    /// GPS LNAV.
    Gps(Msg1019T),
    /// `BeiDou` D1 and D2.
    Beidou(Msg1042T),
    /// Galileo F/NAV.
    GalileoFnav(Msg1045T),
    /// Galileo I/NAV.
    GalileoInav(Msg1046T),
    /// The strings of GLONASS.
    Glonass(Msg1020T),
    /// QZSS LNAV.
    Qzss(Msg1044T),
}

/// An ephemeris, and the time of its broadcast.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedEphemeris {
    /// Name of the satellite.
    pub satellite: SatelliteId,
    /// Reference time of the orbit.
    pub toe: GpsTime,
    /// Time at which a receiver could first have known it.
    pub sent: GpsTime,
    /// The message.
    pub message: Ephemeris,
}
