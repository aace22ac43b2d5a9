//! Navigation messages with orbits, and the constants of each.

use raim_core::satellite::{Constellation, SatelliteId};

/// Navigation message of the clock and the group delays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// GPS LNAV: the clock refers to the L1/L2 ionosphere-free combination.
    GpsLnav,
    /// QZSS LNAV: the clock refers to L1 C/A and L2C.
    QzssLnav,
    /// Galileo F/NAV: the clock refers to E1/E5a.
    GalileoFnav,
    /// Galileo I/NAV: the clock refers to E1/E5b.
    GalileoInav,
    /// `BeiDou` D1 or D2: the clock refers to B3I.
    BeidouD1D2,
    /// Strings of GLONASS: the clock refers to L1.
    GlonassStrings,
}

const MINUTE_MS: u64 = 60_000;
const HOUR_MS: u64 = 60 * MINUTE_MS;

impl Source {
    /// Returns the constellation of the message.
    pub const fn constellation(self) -> Constellation {
        match self {
            Self::GpsLnav | Self::QzssLnav => Constellation::Gps,
            Self::GalileoFnav | Self::GalileoInav => Constellation::Galileo,
            Self::BeidouD1D2 => Constellation::Beidou,
            Self::GlonassStrings => Constellation::Glonass,
        }
    }

    /// Returns the longest time from `toe` for which the elements are used, ms.
    ///
    /// | system | renews its sets | a set is accurate for |
    /// |---|---|---|
    /// | GPS | | ±2 h |
    /// | QZSS | hourly | ±2 h |
    /// | Galileo | every 10 min to 3 h | 4 h |
    /// | `BeiDou` | hourly | 2 h, then wrong by metres |
    /// | GLONASS | every half hour | ±15 min, by its model of the forces |
    ///
    /// Some extra minutes keep a set in use until the next one has been received.
    pub(super) const fn age_limit_ms(self) -> u64 {
        match self {
            Self::GpsLnav | Self::QzssLnav | Self::BeidouD1D2 => 2 * HOUR_MS + MINUTE_MS,
            Self::GalileoFnav | Self::GalileoInav => 4 * HOUR_MS + MINUTE_MS,
            Self::GlonassStrings => 20 * MINUTE_MS,
        }
    }

    /// Returns true for the satellites that this message can describe.
    pub(super) fn can_name(self, satellite: SatelliteId) -> bool {
        satellite.constellation() == self.constellation()
            && satellite.is_qzss() == matches!(self, Self::QzssLnav)
            && satellite.number() <= self.highest_number()
    }

    /// Returns the highest satellite number of the system's own messages.
    const fn highest_number(self) -> u8 {
        match self {
            Self::GpsLnav => 32,
            Self::QzssLnav => 202,
            Self::GalileoFnav | Self::GalileoInav => 36,
            Self::BeidouD1D2 => 63,
            Self::GlonassStrings => 24,
        }
    }
}
