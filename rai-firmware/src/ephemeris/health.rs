//! What a satellite says about the service of its signals.
//!
//! GPS, QZSS, `BeiDou` and GLONASS speak of the satellite as a whole. Galileo's I/NAV speaks of E1 and E5b, its F/NAV of E5a:
//! only both together say what a pair of signals is worth, so what one says stays when the other comes
//! ([`Health::over`]).

use crate::raw::Band;

/// Which carriers a message speaks of, and which of them it declares out of service.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Health {
    /// One bit for each [`Band`]; all when the satellite as a whole is out of service.
    out: u16,
    /// Those that the message says anything of.
    spoken_of: u16,
}

impl Health {
    /// Nothing is out of service.
    pub const GOOD: Self = Self { out: 0, spoken_of: u16::MAX };

    /// The satellite as a whole is.
    pub const BAD: Self = Self { out: u16::MAX, spoken_of: u16::MAX };

    /// Nothing has been said: good until it is.
    pub const UNKNOWN: Self = Self { out: 0, spoken_of: 0 };

    /// Good or bad as a whole, for messages that know no more.
    pub const fn of_satellite(is_good: bool) -> Self {
        if is_good { Self::GOOD } else { Self::BAD }
    }

    /// By the six bits of QZSS's LNAV: each stands for one signal or for the message, but the last, which is of the L1 code
    /// that a satellite does not send beside C/A and stays set.
    ///
    /// [IS-QZSS-PNT] table 4.1.2-4.
    ///
    /// [IS-QZSS-PNT]: crate#references
    pub const fn of_qzss(field: u8) -> Self {
        Self::of_satellite(field & 0b11_1110 == 0)
    }

    /// The same, and this carrier in or out of service.
    #[must_use]
    pub const fn with(self, band: Band, is_good: bool) -> Self {
        let out = if is_good { self.out & !bit(band) } else { self.out | bit(band) };
        Self { out, spoken_of: self.spoken_of | bit(band) }
    }

    /// What this says, and of the other carriers what was said before.
    #[must_use]
    pub const fn over(self, before: Self) -> Self {
        Self { out: self.out | before.out & !self.spoken_of, spoken_of: self.spoken_of | before.spoken_of }
    }

    /// True when this carrier may be used.
    pub const fn serves(self, band: Band) -> bool {
        self.out & bit(band) == 0
    }

    /// True when something has been said of this carrier.
    pub const fn speaks_of(self, band: Band) -> bool {
        self.spoken_of & bit(band) != 0
    }

    /// True when none may be used.
    pub const fn is_bad(self) -> bool {
        self.out == u16::MAX
    }
}

const fn bit(band: Band) -> u16 {
    1 << band as u16
}
