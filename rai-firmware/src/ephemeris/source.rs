//! Which message an orbit comes from, and what each message fixes.

use rai_core::satellite::{Constellation, SatelliteId};

/// Which navigation message the clock and the group delays come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// GPS LNAV: the clock refers to the L1/L2 ionosphere-free combination.
    GpsLnav,
    /// QZSS LNAV: to L1 C/A and L2C.
    QzssLnav,
    /// Galileo F/NAV: to E1/E5a.
    GalileoFnav,
    /// Galileo I/NAV: to E1/E5b.
    GalileoInav,
    /// `BeiDou` D1 or D2: to B3I.
    BeidouD1D2,
    /// The strings of GLONASS: to L1.
    GlonassStrings,
}

const MINUTE_MS: u64 = 60_000;
const HOUR_MS: u64 = 60 * MINUTE_MS;

impl Source {
    /// Whose message it is.
    pub const fn constellation(self) -> Constellation {
        match self {
            Self::GpsLnav | Self::QzssLnav => Constellation::Gps,
            Self::GalileoFnav | Self::GalileoInav => Constellation::Galileo,
            Self::BeidouD1D2 => Constellation::Beidou,
            Self::GlonassStrings => Constellation::Glonass,
        }
    }

    /// The largest distance from `toe` at which the elements are used, ms.
    ///
    /// GPS sets are fitted over ±2 h, and those of QZSS, which renews hourly, too. Galileo renews every 10 min to 3 h and keeps a set valid for 4 h. `BeiDou`
    /// renews hourly, and what is older than 2 h is wrong by metres. GLONASS renews every half hour, and its model of
    /// the forces holds for a quarter of an hour either way. Some minutes more keep a set in use until the next one
    /// has been received.
    pub(super) const fn age_limit_ms(self) -> u64 {
        match self {
            Self::GpsLnav | Self::QzssLnav | Self::BeidouD1D2 => 2 * HOUR_MS + MINUTE_MS,
            Self::GalileoFnav | Self::GalileoInav => 4 * HOUR_MS + MINUTE_MS,
            Self::GlonassStrings => 20 * MINUTE_MS,
        }
    }

    /// True for the satellites that this message can be of.
    pub(super) fn can_name(self, satellite: SatelliteId) -> bool {
        satellite.constellation() == self.constellation()
            && satellite.is_qzss() == matches!(self, Self::QzssLnav)
            && satellite.number() <= self.highest_number()
    }

    /// The highest satellite number that the system's own messages can name.
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
