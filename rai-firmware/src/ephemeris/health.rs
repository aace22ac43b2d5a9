//! Health: which signals a satellite reports as in service.
//!
//! | flag | effect | assumed when the flag is absent |
//! |---|---|---|
//! | GPS LNAV, 1019: SV health (6 bits) not 0 | closes all signals of the satellite | always there |
//! | GPS LNAV: alert flag of a subframe 1 to 3 | no accuracy is promised: closes the set | 1019 has none: not raised |
//! | GPS, QZSS, `BeiDou`: URA or URAI 15 | no accuracy is promised: closes the set | always there |
//! | QZSS LNAV, 1044: health (6 bits, without the last) not 0 | closes all signals of the satellite | always there |
//! | GPS, QZSS CNAV: alert flag of any frame | closes all signals of the satellite until its next frame | not raised |
//! | GPS, QZSS CNAV: L1, L2, L5 health of type 10 is 1 | closes that signal; L5 only under `L5,HEALTHY` and ARAIM's presets of ICAO | good for L1 and L2; L5 is closed where only a healthy one is used |
//! | Galileo I/NAV, 1046: `E1B` or `E5b` HS not 0 | closes that signal | the worst HS that any message of the satellite reports |
//! | Galileo F/NAV, 1045: `E5a` HS not 0 | closes `E5a` | the worst HS that any message of the satellite reports |
//! | Galileo I/NAV, F/NAV, 1045, 1046: DVS of any signal is 1 | closes all signals of the satellite | the other message's DVS counts alone |
//! | Galileo I/NAV, 1046: SISA is NAPA (126 to 255) | closes the set, unless F/NAV alone is known | F/NAV's SISA counts |
//! | Galileo F/NAV, 1045: SISA is NAPA (126 to 255) | closes ranges with `E5a` | I/NAV's SISA counts |
//! | `BeiDou` D1, D2, 1042: `SatH1` is 1 | closes all signals of the satellite | always there; flags of B-CNAV are not read: `B1C` and `B2a` follow `SatH1` |
//! | GLONASS strings, 1020: first bit of `B_n` or `l_n` is 1 | closes all signals of the satellite | always there; `C_n` of the almanac is not read |
//! | GLONASS strings, 1020: `F_T` is 15 | no accuracy is promised: closes the set | always there |
//!
//! Galileo's I/NAV reports on E1 and E5b, its F/NAV on E5a. The health of a signal stays until a
//! message reports on that signal again ([`Health::over`]). If the set is out of date, only bad
//! health stays ([`Health::bad_alone`]).
//!
//! References: [IS-GPS-200] 20.3.3.2 and 20.3.3.3.1.4; [OS-SIS-ICD] 5.1.9.3; [OS-SDD] 2.3.1,
//! signal-in-space status: a signal is healthy when DVS is 0, HS is 0 and SISA is not NAPA;
//! [BDS-SIS-B1I] 5.2.4.6; [GLO-ICD] 4.4.
//!
//! [IS-GPS-200]: crate#references
//! [OS-SIS-ICD]: crate#references
//! [OS-SDD]: crate#references
//! [BDS-SIS-B1I]: crate#references
//! [GLO-ICD]: crate#references

use crate::raw::Band;

/// The carriers that a message reports on, with those that are out of service or have data without
/// guarantee.
///
/// Both sets have one bit for each [`Band`], and above them one for the data of each Galileo band.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Health {
    /// Carriers out of service, and data without guarantee.
    out: u16,
    /// Carriers and data that the message mentions.
    mentioned: u16,
}

/// The bits that stand for data.
const DATA: u16 = data_bit(Band::E1) | data_bit(Band::E5a) | data_bit(Band::E5b);

impl Health {
    /// All carriers are in service.
    pub const GOOD: Self = Self { out: 0, mentioned: u16::MAX };

    /// All carriers are out of service.
    pub const BAD: Self = Self { out: u16::MAX, mentioned: u16::MAX };

    /// No carrier is mentioned, and thus none may be used.
    pub const UNKNOWN: Self = Self { out: 0, mentioned: 0 };

    /// Returns good or bad health of the satellite as a whole, for messages that distinguish no
    /// signals.
    pub const fn of_satellite(is_good: bool) -> Self {
        if is_good { Self::GOOD } else { Self::BAD }
    }

    /// Returns the health in the six bits of QZSS's LNAV. Each bit is for one signal or for the
    /// message. The last bit is for an L1 code that satellites do not send in addition to C/A; it
    /// is always set.
    ///
    /// [IS-QZSS-PNT] table 4.1.2-4.
    ///
    /// [IS-QZSS-PNT]: crate#references
    pub const fn of_qzss(field: u8) -> Self {
        Self::of_satellite(field & 0b11_1110 == 0)
    }

    /// Returns the same with this carrier in or out of service.
    #[must_use]
    pub const fn with(self, band: Band, is_good: bool) -> Self {
        self.stating(bit(band), is_good)
    }

    /// Returns the same with two flags of Galileo for this carrier. In the signal's health status
    /// only 0 is good. In the data validity status 1 means data without guarantee.
    #[must_use]
    pub const fn with_galileo(self, band: Band, signal_status: u32, is_without_guarantee: bool) -> Self {
        self.with(band, signal_status == 0).stating(data_bit(band), !is_without_guarantee)
    }

    const fn stating(self, bits: u16, is_good: bool) -> Self {
        let out = if is_good { self.out & !bits } else { self.out | bits };
        Self { out, mentioned: self.mentioned | bits }
    }

    /// Returns the health of this message, and the earlier health of carriers that it does not
    /// report on.
    #[must_use]
    pub const fn over(self, before: Self) -> Self {
        Self { out: self.out | before.out & !self.mentioned, mentioned: self.mentioned | before.mentioned }
    }

    /// Returns only the bad health, without the good.
    #[must_use]
    pub const fn bad_alone(self) -> Self {
        Self { mentioned: self.mentioned & self.out, ..self }
    }

    /// Returns true if this carrier may be used. A carrier that no message reports on has the worst
    /// health of the others.
    pub const fn serves(self, band: Band) -> bool {
        let asked = if self.mentions(band) { bit(band) } else { u16::MAX };
        self.mentioned != 0 && self.out & (asked | DATA) == 0
    }

    /// Returns true when a message has mentioned this carrier.
    pub const fn mentions(self, band: Band) -> bool {
        self.mentioned & bit(band) != 0
    }

    /// Returns true when no carrier may be used.
    pub const fn is_bad(self) -> bool {
        let carriers = self.mentioned & !DATA;
        self.out & DATA != 0 || self.out & carriers == carriers
    }
}

const fn bit(band: Band) -> u16 {
    1 << band as u16
}

/// Returns the bit for the data of a Galileo band; no other band has one.
const fn data_bit(band: Band) -> u16 {
    match band {
        Band::E1 => 1 << 13,
        Band::E5a => 1 << 14,
        Band::E5b => 1 << 15,
        _ => 0,
    }
}

const _: () = assert!(bit(Band::G2) < DATA & DATA.wrapping_neg(), "no band has a bit of the data");
