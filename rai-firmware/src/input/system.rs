//! Systems that wire formats distinguish, and the satellite numbers of each.
//!
//! | system | numbers | the core's constellation |
//! |---|---|---|
//! | GPS | 1 to 32 | GPS |
//! | QZSS | 1 to 10, on the air 193 to 202 | GPS, because its ranges refer to the same clock ([`raim_core::satellite`]) |
//! | Galileo, `BeiDou` | 1 to 36, 63 | their own |
//! | GLONASS | 1 to 32: 24 slots, and numbers beyond them that spare satellites have had since 2011 | its own |

use raim_core::satellite::{Constellation, SatelliteId};

/// System that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum System {
    Gps,
    Qzss,
    Galileo,
    Beidou,
    Glonass,
}

impl System {
    /// Returns the constellation whose clock affects the ranges.
    pub(super) const fn constellation(self) -> Constellation {
        match self {
            Self::Gps | Self::Qzss => Constellation::Gps,
            Self::Galileo => Constellation::Galileo,
            Self::Beidou => Constellation::Beidou,
            Self::Glonass => Constellation::Glonass,
        }
    }

    /// Returns the satellite with this number; `None` if the system has no such satellite.
    pub(super) const fn satellite(self, number: u8) -> Option<SatelliteId> {
        let highest = match self {
            Self::Gps | Self::Glonass => 32,
            Self::Qzss => return SatelliteId::qzss(number),
            Self::Galileo => 36,
            Self::Beidou => 63,
        };
        if number <= highest { SatelliteId::new(self.constellation(), number) } else { None }
    }
}
