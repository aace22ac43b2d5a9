//! Which band a signal of an MSM is on.

use rai_core::satellite::Constellation;

use crate::raw::Band;

/// The band of a signal by its position in the signal mask of an MSM, from 1; `None` for those that are not used.
///
/// Left out: restricted services (Galileo E1A, E1Z) and bands whose delay against the broadcast clock is not
/// broadcast while others' are (Galileo E6 and E5 alt-BOC, `BeiDou` B2b). Reference: [RTCM-10403.3] tables
/// 3.5-91, 3.5-96, 3.5-99, 3.5-108.
///
/// [RTCM-10403.3]: crate#references
pub(super) const fn band(constellation: Constellation, signal: u8) -> Option<Band> {
    match (constellation, signal) {
        (Constellation::Gps, 2..=4 | 30..=32) => Some(Band::L1),
        (Constellation::Gps, 8..=10 | 15..=17) => Some(Band::L2),
        (Constellation::Gps, 22..=24) => Some(Band::L5),
        (Constellation::Galileo, 2 | 4 | 5) => Some(Band::E1),
        (Constellation::Galileo, 14..=16) => Some(Band::E5b),
        (Constellation::Galileo, 22..=24) => Some(Band::E5a),
        (Constellation::Beidou, 2..=4) => Some(Band::B1I),
        (Constellation::Beidou, 8..=10) => Some(Band::B3I),
        (Constellation::Beidou, 14..=16) => Some(Band::B2I),
        (Constellation::Beidou, 22..=24) => Some(Band::B2a),
        (Constellation::Beidou, 30..=32) => Some(Band::B1C),
        (Constellation::Glonass, 2 | 3) => Some(Band::G1),
        (Constellation::Glonass, 8 | 9) => Some(Band::G2),
        _ => None,
    }
}

/// Whether a signal is the one code of its band that the broadcast clock is of, where another one may be beside it:
/// P and Y on L1. To C/A a GPS satellite has a delay of its own, up to a metre, that no message tells.
pub(super) const fn is_reference(constellation: Constellation, signal: u8) -> bool {
    matches!((constellation, signal), (Constellation::Gps, 3 | 4))
}

/// Whether receivers track the code without knowing it: P and Y of GPS. What is left of its strength, 10 to 20 dB less,
/// says nothing of the signal.
pub(super) const fn is_codeless(constellation: Constellation, signal: u8) -> bool {
    matches!((constellation, signal), (Constellation::Gps, 3 | 4 | 9 | 10))
}
