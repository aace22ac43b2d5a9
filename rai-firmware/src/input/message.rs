//! What a frame says, independent of its format, or why it says nothing.

use raim_core::frame::Ecef;
#[cfg(feature = "ubx")]
use raim_core::satellite::Constellation;

use super::Counters;
use super::Measured;
#[cfg(feature = "ubx")]
use super::suspicion::SelfReport;
use crate::ephemeris::Broadcast;
#[cfg(feature = "cnav")]
use crate::ephemeris::CnavFrame;
#[cfg(feature = "glonass")]
use crate::ephemeris::StateBroadcast;
use crate::time::GpsTime;

/// Content of one message, independent of its format.
#[derive(Debug)]
pub(super) enum Message<'a> {
    /// Ranges of one instant, or of a part of it.
    Ranges(Ranges<'a>),
    /// An orbit and a clock, not yet checked.
    Broadcast(Broadcast),
    /// A position, a velocity and a clock, not yet checked.
    #[cfg(feature = "glonass")]
    State(StateBroadcast),
    /// An orbit and a clock that the receiver decoded, not yet checked.
    #[cfg(feature = "sbf")]
    Decoded(Broadcast),
    /// A position, a velocity and a clock that the receiver decoded, not yet checked.
    #[cfg(all(feature = "sbf", feature = "glonass"))]
    DecodedState(StateBroadcast),
    /// Time to within seconds, and GPS time minus UTC, s.
    #[cfg(feature = "glonass")]
    Time(GpsTime, u8),
    /// Position that a station broadcasts.
    Position(Ecef),
    /// Coefficients of the ionosphere with their system, and GPS time minus UTC, s.
    #[cfg(feature = "ubx")]
    Corrections(Option<(Constellation, [f64; 8])>, Option<u8>),
    /// What a frame of CNAV says of the signals of its satellite.
    #[cfg(feature = "cnav")]
    Cnav(CnavFrame),
    /// Report of the receiver on its own signals.
    #[cfg(feature = "ubx")]
    SelfReport(SelfReport),
}

/// Message with ranges.
#[derive(Debug)]
pub(super) struct Ranges<'a> {
    /// Number of the station; 0 if the format has none.
    pub(super) station: u16,
    /// Series that the message belongs to; `None` if the message covers all systems.
    pub(super) series: Option<Series>,
    /// Milliseconds into the week of GPS time; `None` if they cannot be derived from the time that
    /// the message states.
    pub(super) tow_ms: Option<u32>,
    /// Milliseconds into the week of UTC, if the format counts UTC.
    pub(super) of_utc_ms: Option<u32>,
    /// Time with its week, and GPS time minus UTC, if the format states them.
    pub(super) stated: Option<(GpsTime, Option<u8>)>,
    /// True if the message states that more messages of the same instant follow.
    pub(super) more_follow: bool,
    /// Milliseconds by which the receiver clock has jumped so far, modulo 256, if the format states
    /// it.
    #[cfg(feature = "sbf")]
    pub(super) clock_jumps_ms: Option<u8>,
    pub(super) measured: Measured<'a>,
}

/// Number of a series of messages, below 16. Each series states by itself whether more messages
/// follow. In RTCM each system is one series.
pub(super) type Series = u8;

/// Reason for which a frame leads to no message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unread {
    /// The type is not read.
    Other,
    /// The frame is too short for its type, or contradicts itself.
    Malformed,
    /// The time of week is out of range.
    Time,
    /// The ephemeris has a value or a time that is impossible for a satellite.
    Ephemeris,
    /// The position is impossible for a receiver.
    Position,
    /// The receiver does not know the week yet.
    WithoutWeek,
    /// The system has no satellite of this number.
    Satellite,
    /// The leap seconds are unknown, which GLONASS needs.
    LeapUnknown,
    /// The ranges are scrambled.
    #[cfg(feature = "sbf")]
    Scrambled,
    /// The navigation bits are of a signal that is not read.
    BitsOther,
    /// The navigation bits have a wrong number of words, preamble or flags.
    BitsMalformed,
    /// The navigation bits have a wrong parity or CRC.
    BitsParity,
    /// The pages of a set of navigation bits are of different issues.
    BitsMixed,
    /// No slot is free for another set of navigation bits.
    BitsSurplus,
}

impl Unread {
    /// Returns the counter of this reason.
    pub(super) fn counter(self, counters: &mut Counters) -> &mut u32 {
        match self {
            Self::Other => &mut counters.messages_other,
            Self::Malformed => &mut counters.messages_malformed,
            Self::Time => &mut counters.times_out_of_range,
            Self::Ephemeris => &mut counters.ephemerides_invalid,
            Self::Position => &mut counters.positions_invalid,
            Self::WithoutWeek => &mut counters.epochs_without_week,
            Self::Satellite => &mut counters.satellites_unknown,
            Self::LeapUnknown => &mut counters.leap_unknown,
            #[cfg(feature = "sbf")]
            Self::Scrambled => &mut counters.epochs_scrambled,
            Self::BitsOther => &mut counters.subframes_other,
            Self::BitsMalformed => &mut counters.subframes_malformed,
            Self::BitsParity => &mut counters.subframes_parity,
            Self::BitsMixed => &mut counters.subframes_mixed,
            Self::BitsSurplus => &mut counters.subframes_surplus,
        }
    }
}
