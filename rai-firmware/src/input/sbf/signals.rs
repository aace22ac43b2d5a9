//! Numbers of satellites and signals in SBF.
//!
//! | SVID | satellite |
//! |---|---|
//! | 1 to 37 | GPS |
//! | 38 to 61, 63 to 68 | GLONASS, slots 1 to 24 and 25 to 30; 62 is a satellite of unknown slot |
//! | 71 to 106 | Galileo |
//! | 141 to 180, 223 to 245 | `BeiDou`, 1 to 40 and 41 to 63 |
//! | 181 to 190 | QZSS |
//! | others | SBAS, `NavIC`, L-band |
//!
//! Reference: [SBF] 4.1.9, 4.1.10.
//!
//! [SBF]: crate#references

use raim_core::frame::SPEED_OF_LIGHT_M_S;

use crate::input::system::System;
use crate::raw::{Band, Carrier, Code};

/// A signal, with all that its number says.
#[derive(Clone, Copy, Debug)]
pub(super) struct Signal {
    number: u8,
    /// Frequency channel of GLONASS plus 8.
    channel: u8,
}

/// Half a chip rate, of which the carriers of unused signals are multiples, Hz.
const STEP_HZ: f64 = 10.23e6 / 2.0;

impl Signal {
    /// Returns the signal of a sub-block with these bytes of type and information.
    pub(super) const fn new(kind: u8, information: u8) -> Self {
        /// Number that says that the information has the rest of it.
        const FURTHER: u8 = 31;
        let high = information >> 3;
        match kind & 31 {
            FURTHER => Self { number: 32 + high, channel: 0 },
            number => Self { number, channel: high },
        }
    }

    /// Returns the signal of a sub-block of type 2 behind this one, whose satellite has the same
    /// channel. Only type 1 states it.
    pub(super) const fn further(self, kind: u8, information: u8) -> Self {
        Self { channel: self.channel, ..Self::new(kind, information) }
    }

    /// Returns the carrier of the signal; `None` if no satellite of the system sends it, and for
    /// unused signals.
    pub(super) const fn carrier(self, system: System) -> Option<Carrier> {
        let band = match (system, self.number) {
            (System::Gps, 0 | 1 | 5) | (System::Qzss, 6 | 32 | 38) => Band::L1,
            (System::Gps, 2 | 3) | (System::Qzss, 7) => Band::L2,
            (System::Gps, 4) | (System::Qzss, 26) => Band::L5,
            (System::Galileo, 17) => Band::E1,
            (System::Galileo, 20) => Band::E5a,
            (System::Galileo, 21) => Band::E5b,
            (System::Beidou, 28) => Band::B1I,
            (System::Beidou, 13) => Band::B1C,
            (System::Beidou, 14) => Band::B2a,
            (System::Beidou, 29) => Band::B2I,
            (System::Beidou, 30) => Band::B3I,
            (System::Glonass, 8 | 9) => Band::G1,
            (System::Glonass, 10 | 11) => Band::G2,
            _ => return None,
        };
        match (system, self.channel) {
            (System::Glonass, 1..=14) => Some(Carrier { band, channel: self.channel.cast_signed() - 8 }),
            (System::Glonass, _) => None,
            _ => Some(Carrier::of(band)),
        }
    }

    /// Returns the Doppler shift of 1 m/s, Hz; `None` for a signal whose frequency is not known.
    ///
    /// The first signal of a satellite, to which the others refer, may be an unused one.
    pub(super) fn doppler_of_a_metre_hz(self, system: System) -> Option<f32> {
        const fn of(steps: u16) -> f32 {
            (steps as f64 * STEP_HZ / SPEED_OF_LIGHT_M_S) as f32
        }
        if let Some(carrier) = self.carrier(system) {
            return Some(carrier.doppler_of_a_metre_hz());
        }
        match self.number {
            12 => Some(const { of(235) }),
            19 | 33 => Some(const { of(250) }),
            22 => Some(const { of(233) }),
            34 => Some(const { of(236) }),
            39 => Some(const { of(230) }),
            _ => None,
        }
    }

    /// Returns the code, of a signal of GPS or QZSS. Of L5 receivers measure the component without
    /// data.
    pub(super) const fn code(self, system: System) -> Code {
        match (system, self.number) {
            (System::Gps, 0) | (System::Qzss, 6) => Code::Ca,
            (System::Gps, 3) | (System::Qzss, 7) => Code::L2c,
            (System::Gps, 4) | (System::Qzss, 26) => Code::Q5,
            _ => Code::Other,
        }
    }

    /// Returns true if receivers track the code without knowing it: P(Y) of GPS.
    pub(super) const fn is_codeless(self) -> bool {
        matches!(self.number, 1 | 2)
    }

    /// Returns true if the broadcast clock refers to this signal, but not to another code of the
    /// same band: P(Y) on L1.
    pub(super) const fn is_reference(self) -> bool {
        self.number == 1
    }
}

/// Returns the system of a satellite, and its number there.
pub(super) const fn numbered(svid: u8) -> Option<(System, u8)> {
    Some(match svid {
        1..=37 => (System::Gps, svid),
        38..=61 => (System::Glonass, svid - 37),
        63..=68 => (System::Glonass, svid - 38),
        71..=106 => (System::Galileo, svid - 70),
        141..=180 => (System::Beidou, svid - 140),
        181..=190 => (System::Qzss, svid - 180),
        223..=245 => (System::Beidou, svid - 182),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unused_signals_have_the_frequencies_of_their_documents() {
        // GLONASS L3 (ICD CDMA L3, 2016), Galileo E6 and AltBOC (OS SIS ICD 2.1), BeiDou B2b, MHz.
        for (system, number, want_mhz) in [
            (System::Glonass, 12, 1202.025),
            (System::Galileo, 19, 1278.75),
            (System::Galileo, 22, 1191.795),
            (System::Beidou, 34, 1207.14),
            (System::Qzss, 33, 1278.75),
            (System::Qzss, 39, 1176.45),
        ] {
            let signal = Signal { number, channel: 8 };
            let have = f64::from(signal.doppler_of_a_metre_hz(system).unwrap()) * SPEED_OF_LIGHT_M_S;
            assert!((have / 1e6 - want_mhz).abs() < 1e-3, "{number}: {have}");
        }
    }

    #[test]
    fn numbers_beyond_the_five_bits_are_in_the_information() {
        assert_eq!(Signal::new(31, 0).carrier(System::Qzss), Some(Carrier::of(Band::L1)));
        assert_eq!(Signal::new(0b0011_0001, 0).carrier(System::Galileo), Some(Carrier::of(Band::E1)));
        let glonass = Signal::new(8, 1 << 3).further(11, 0).carrier(System::Glonass);
        assert_eq!(glonass, Some(Carrier { band: Band::G2, channel: -7 }));
        assert_eq!(Signal::new(8, 0).carrier(System::Glonass), None);
        assert_eq!(Signal::new(8, 15 << 3).carrier(System::Glonass), None);
        assert_eq!(Signal::new(17, 0).carrier(System::Gps), None);
    }

    #[test]
    fn satellites_are_those_of_the_table() {
        for (svid, want) in [
            (1, Some((System::Gps, 1))),
            (61, Some((System::Glonass, 24))),
            (62, None),
            (63, Some((System::Glonass, 25))),
            (71, Some((System::Galileo, 1))),
            (106, Some((System::Galileo, 36))),
            (120, None),
            (141, Some((System::Beidou, 1))),
            (180, Some((System::Beidou, 40))),
            (190, Some((System::Qzss, 10))),
            (198, None),
            (223, Some((System::Beidou, 41))),
            (245, Some((System::Beidou, 63))),
            (0, None),
            (255, None),
        ] {
            assert_eq!(numbered(svid), want, "{svid}");
        }
    }
}
