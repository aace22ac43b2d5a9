//! Events of the stream, which [`super::Input`] passes on in order.

use raim_core::frame::Ecef;
use raim_core::satellite::Constellation;

use super::suspicion::SelfReport;
#[cfg(feature = "cnav")]
use crate::ephemeris::CnavFrame;
use crate::ephemeris::Ephemeris;
use crate::raw::RawEpoch;
use crate::time::GpsTime;

/// Event in the stream of bytes.
#[derive(Debug)]
#[non_exhaustive]
pub enum Event<'a> {
    /// All observations of one instant, and the arrival of their first byte, ms.
    Epoch(&'a RawEpoch, u64),
    /// A checked ephemeris.
    Ephemeris(Ephemeris),
    /// The present, after its week was determined or corrected. Ephemerides that came before may
    /// have a wrong week, and are moved ([`crate::ephemeris::Store::redate`]).
    Redated(GpsTime),
    /// Position that a station broadcasts, which serves as a first guess.
    Position(Ecef),
    /// Coefficients `α0…α3, β0…β3` of the ionosphere from the satellites of GPS or `BeiDou`, each
    /// for the model of its system.
    Ionosphere(Constellation, [f64; 8]),
    /// What a frame of CNAV says of the signals of its satellite.
    #[cfg(feature = "cnav")]
    Cnav(CnavFrame),
    /// Report of the receiver on its own signals.
    SelfReport(SelfReport),
    /// Evidence that the ranges of an epoch are not all from one antenna at one instant.
    Rivalry(Rivalry),
}

/// Evidence against the ranges of the last epoch or of the next one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Rivalry {
    /// Two receivers share the line: after an epoch, its ranges came again with other values.
    Receivers,
    /// Ranges came twice with different values within the epoch that is judged next. One of its
    /// messages may be forged, which proves nothing about later epochs.
    Joined,
    /// Two receivers may share the line: the ranges have moved to and fro once.
    Suspected,
    /// One instant came as two epochs with different systems, so that the tag of one is wrong.
    Halves,
}
