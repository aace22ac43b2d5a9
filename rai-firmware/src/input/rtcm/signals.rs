//! Bands and codes of the signals of an MSM.

use crate::input::system::System;
use crate::raw::{Band, Code};

/// Returns the band of a signal by its position in the signal mask of an MSM, from 1; `None` for
/// unused signals.
///
/// Unused are restricted services (Galileo E1A, E1Z). Unused are also bands for which the
/// satellites do not broadcast a group delay, although they do for others: Galileo E6 and E5
/// alt-BOC, `BeiDou` B2b, QZSS L6. Reference: [RTCM-10403.3] tables 3.5-91, 3.5-96, 3.5-99,
/// 3.5-105, 3.5-108.
///
/// [RTCM-10403.3]: crate#references
pub(super) const fn band(system: System, signal: u8) -> Option<Band> {
    match (system, signal) {
        (System::Gps, 2..=4) | (System::Qzss, 2) | (System::Gps | System::Qzss, 30..=32) => Some(Band::L1),
        (System::Gps, 8..=10) | (System::Gps | System::Qzss, 15..=17) => Some(Band::L2),
        (System::Gps | System::Qzss, 22..=24) => Some(Band::L5),
        (System::Galileo, 2 | 4 | 5) => Some(Band::E1),
        (System::Galileo, 14..=16) => Some(Band::E5b),
        (System::Galileo, 22..=24) => Some(Band::E5a),
        (System::Beidou, 2..=4) => Some(Band::B1I),
        (System::Beidou, 8..=10) => Some(Band::B3I),
        (System::Beidou, 14..=16) => Some(Band::B2I),
        (System::Beidou, 22..=24) => Some(Band::B2a),
        (System::Beidou, 30..=32) => Some(Band::B1C),
        (System::Glonass, 2 | 3) => Some(Band::G1),
        (System::Glonass, 8 | 9) => Some(Band::G2),
        _ => None,
    }
}

/// Returns true if the broadcast clock refers to this signal, but not to another code of the same
/// band: P and Y on L1. Each GPS satellite delays C/A differently from them, by up to a metre, and
/// RTCM does not contain this delay.
pub(super) const fn is_reference(system: System, signal: u8) -> bool {
    matches!((system, signal), (System::Gps, 3 | 4))
}

/// Returns the code of a signal of GPS or QZSS.
pub(super) const fn code(system: System, signal: u8) -> Code {
    match (system, signal) {
        (System::Gps | System::Qzss, 2) => Code::Ca,
        (System::Gps | System::Qzss, 15..=17) => Code::L2c,
        (System::Gps | System::Qzss, 22) => Code::I5,
        (System::Gps | System::Qzss, 23) => Code::Q5,
        (System::Gps | System::Qzss, 24) => Code::Both5,
        _ => Code::Other,
    }
}

/// Returns true if receivers track the code without knowing it: P and Y of GPS. The strength that
/// they report, 10 to 20 dB less, does not describe the signal.
pub(super) const fn is_codeless(system: System, signal: u8) -> bool {
    matches!((system, signal), (System::Gps, 3 | 4 | 9 | 10))
}
