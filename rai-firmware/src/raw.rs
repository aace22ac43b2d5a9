//! Raw measurements: ranges of signals on carriers, satellite by satellite, all at one instant.
//!
//! This module knows no wire format. A quantity that a format does not carry is `None`, and never
//! zero.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `P` | [`RawSignal::range_m`] | m |
//! | `f` | [`Carrier::frequency_hz`] | Hz |
//! | `k` | [`Carrier::channel`] | – |
//!
//! A signal takes 16 bytes, and an epoch of 64 satellites 3.5 KiB. Carrier to noise density has
//! steps of 1/16 dB-Hz and Doppler steps of 1/1024 Hz, which represent every value of the formats
//! exactly. In builds that read CNAV, the bits above the density hold the code ([`Code`]). Values that no module uses, such as the receiver's sigma and its lock time, are not
//! stored. References: [IS-GPS-200] 3.3.1.1, [BDS-SIS-B1I] 4.1, [GLO-ICD] 3.3.1.1.
//!
//! [IS-GPS-200]: crate#references
//! [BDS-SIS-B1I]: crate#references
//! [GLO-ICD]: crate#references

use heapless::Vec;
use raim_core::frame::SPEED_OF_LIGHT_M_S;
use raim_core::satellite::SatelliteId;

use crate::time::GpsTime;

/// Most satellites of an epoch, 64 beside room for 48 in the core: those that are used, and those
/// of systems that are not in use or below the mask, which come in the same messages.
pub const EPOCH_CAPACITY: usize = raim_single::CAPACITY + 16;

/// Most signals of one satellite. Only `BeiDou` satellites have more bands; see [`Band::is_spare`].
pub const SIGNAL_CAPACITY: usize = 3;

/// A carrier of one system. The order within a system is that of the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Band {
    /// GPS or QZSS L1, any of its codes.
    L1,
    /// GPS or QZSS L2.
    L2,
    /// GPS or QZSS L5.
    L5,
    /// Galileo E1.
    E1,
    /// Galileo E5a.
    E5a,
    /// Galileo E5b.
    E5b,
    /// `BeiDou` B1I.
    B1I,
    /// `BeiDou` B1C.
    B1C,
    /// `BeiDou` B2a.
    B2a,
    /// `BeiDou` B2I.
    B2I,
    /// `BeiDou` B3I.
    B3I,
    /// GLONASS G1, of channel 0; see [`Carrier`].
    G1,
    /// GLONASS G2, of channel 0; see [`Carrier`].
    G2,
}

/// Chip rate, Hz: all carriers except those of GLONASS are multiples of it or of a tenth of it.
const CHIP_RATE_HZ: f64 = 10.23e6;

impl Band {
    /// Returns the carrier frequency, Hz; for GLONASS that of channel 0.
    pub const fn frequency_hz(self) -> f64 {
        match self {
            Self::L1 | Self::E1 | Self::B1C => 154.0 * CHIP_RATE_HZ,
            Self::L2 => 120.0 * CHIP_RATE_HZ,
            Self::L5 | Self::E5a | Self::B2a => 115.0 * CHIP_RATE_HZ,
            Self::E5b | Self::B2I => 118.0 * CHIP_RATE_HZ,
            Self::B1I => 152.6 * CHIP_RATE_HZ,
            Self::B3I => 124.0 * CHIP_RATE_HZ,
            Self::G1 => 1602.0e6,
            Self::G2 => 1246.0e6,
        }
    }

    /// All bands, in order.
    const ALL: [Self; 13] = [
        Self::L1,
        Self::L2,
        Self::L5,
        Self::E1,
        Self::E5a,
        Self::E5b,
        Self::B1I,
        Self::B1C,
        Self::B2a,
        Self::B2I,
        Self::B3I,
        Self::G1,
        Self::G2,
    ];

    /// Returns true if a signal on this band is left out first when a satellite has more than fit.
    ///
    /// These two bands are worth less than the other three of `BeiDou`, because D1 and D2 do not
    /// broadcast their group delays. The pair that would be chosen from all five is among the other
    /// three.
    pub const fn is_spare(self) -> bool {
        matches!(self, Self::B1C | Self::B2a)
    }

    /// Returns the distance between the channels of a band, Hz; 0 if all satellites share one
    /// frequency.
    const fn channel_hz(self) -> f64 {
        match self {
            Self::G1 => 562.5e3,
            Self::G2 => 437.5e3,
            _ => 0.0,
        }
    }
}

/// A band and the channel within it, which together give the frequency of a satellite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Carrier {
    /// Band of the carrier.
    pub band: Band,
    /// Frequency slot of a GLONASS satellite, −7 to 6; 0 for all others.
    pub channel: i8,
}

impl Carrier {
    /// Returns the carrier of a band that all satellites of a system share.
    pub const fn of(band: Band) -> Self {
        Self { band, channel: 0 }
    }

    /// Returns the carrier frequency, Hz: `f = f₀ + k Δf`.
    pub const fn frequency_hz(self) -> f64 {
        self.band.frequency_hz() + self.channel as f64 * self.band.channel_hz()
    }

    /// Returns the Doppler shift of 1 m/s, Hz.
    pub(crate) fn doppler_of_a_metre_hz(self) -> f32 {
        /// Shifts of channel 0, so that only other channels of GLONASS need a division of doubles.
        const OF_BANDS: [f32; Band::ALL.len()] = {
            let (mut shifts, mut index) = ([0.0; Band::ALL.len()], 0);
            while index < shifts.len() {
                shifts[index] = (Band::ALL[index].frequency_hz() / SPEED_OF_LIGHT_M_S) as f32;
                index += 1;
            }
            shifts
        };
        match OF_BANDS.get(self.band as usize) {
            Some(shift_hz) if self.channel == 0 => *shift_hz,
            _ => (self.frequency_hz() / SPEED_OF_LIGHT_M_S) as f32,
        }
    }
}

/// Code of a signal of GPS or QZSS, as far as CNAV has a delay of its own for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Code {
    /// Another code, such as P(Y), or an unknown one.
    Other,
    /// C/A on L1.
    Ca,
    /// The civil code on L2.
    L2c,
    /// The component of L5 with data.
    I5,
    /// The component of L5 without data.
    Q5,
    /// Both components of L5.
    Both5,
}

#[cfg(feature = "cnav")]
impl Code {
    /// All codes, in order.
    const ALL: [Self; 6] = [Self::Other, Self::Ca, Self::L2c, Self::I5, Self::Q5, Self::Both5];
}

/// One code range of one satellite, with its Doppler frequency and strength.
///
/// It is packed, because padding would otherwise waste a seventh of an epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(Rust, packed(4))]
pub struct RawSignal {
    /// Measured pseudorange, m.
    pub range_m: f64,
    /// Doppler frequency in steps of 1/1024 Hz; [`NO_DOPPLER`] if it is unknown.
    doppler: i32,
    /// Carrier to noise density in steps of 1/16 dB-Hz; 0 if it is unknown, [`CODELESS`] if it has
    /// no meaning. Above [`STRENGTH`] the code.
    cn0: u16,
    /// Carrier of the signal.
    pub carrier: Carrier,
}

const _: () = assert!(size_of::<RawSignal>() == 16 && size_of::<RawSatellite>() == 56);

/// Number of bits below the code.
const STRENGTH_BITS: u32 = 12;

/// Bits of the carrier to noise density.
const STRENGTH: u16 = if cfg!(feature = "cnav") { (1 << STRENGTH_BITS) - 1 } else { u16::MAX };

/// Stored strength of a signal that is tracked without its code.
const CODELESS: u16 = STRENGTH;

/// Stored Doppler frequency that is unknown.
const NO_DOPPLER: i32 = i32::MIN;

impl RawSignal {
    /// Returns a range without Doppler frequency and strength.
    pub const fn new(carrier: Carrier, range_m: f64) -> Self {
        Self { range_m, doppler: NO_DOPPLER, cn0: 0, carrier }
    }

    /// Sets the carrier to noise density, to 1/16 dB-Hz; a value that is not positive counts as
    /// unknown. No receiver reports 255 dB-Hz or more, for which there is no room.
    #[must_use]
    pub const fn with_cn0_dbhz(self, cn0_dbhz: f32) -> Self {
        let steps = (cn0_dbhz * 16.0 + 0.5) as u16 & STRENGTH;
        Self { cn0: self.cn0 & !STRENGTH | steps, ..self }
    }

    /// Marks a signal that the receiver tracks without its code, with the help of another signal.
    /// Its own carrier to noise density then has no meaning.
    #[must_use]
    pub const fn codeless(self) -> Self {
        Self { cn0: self.cn0 & !STRENGTH | CODELESS, ..self }
    }

    /// Sets the code. A build that does not read CNAV ignores it.
    #[must_use]
    pub const fn with_code(self, code: Code) -> Self {
        if !cfg!(feature = "cnav") {
            return self;
        }
        Self { cn0: self.cn0 & STRENGTH | (code as u16) << STRENGTH_BITS, ..self }
    }

    /// Returns the code.
    #[cfg(feature = "cnav")]
    pub(crate) fn code(&self) -> Code {
        let number = usize::from(self.cn0 >> STRENGTH_BITS);
        Code::ALL.get(number).copied().unwrap_or(Code::Other)
    }

    /// Sets the Doppler frequency, positive when approaching, to 1/1024 Hz (0.2 mm/s). A value
    /// above 1 MHz, beyond that of any satellite, counts as unknown.
    #[must_use]
    pub const fn with_doppler_hz(self, doppler_hz: f32) -> Self {
        let doppler = if doppler_hz.abs() <= 1e6 { (doppler_hz * 1024.0) as i32 } else { NO_DOPPLER };
        Self { doppler, ..self }
    }

    /// Returns the carrier to noise density, dB-Hz.
    pub const fn cn0_dbhz(&self) -> Option<f32> {
        let strength = self.cn0 & STRENGTH;
        if matches!(strength, 0 | CODELESS) { None } else { Some(strength as f32 / 16.0) }
    }

    /// Returns true if the signal's own carrier to noise density has no meaning.
    pub const fn is_codeless(&self) -> bool {
        self.cn0 & STRENGTH == CODELESS
    }

    /// Returns the Doppler frequency, Hz, positive when approaching.
    pub const fn doppler_hz(&self) -> Option<f32> {
        if self.doppler == NO_DOPPLER { None } else { Some(self.doppler as f32 / 1024.0) }
    }
}

/// Signals of one satellite.
#[derive(Clone, Debug, PartialEq)]
pub struct RawSatellite {
    /// Satellite that sent the signals.
    pub satellite: SatelliteId,
    /// Signals, at most one per band.
    pub signals: Vec<RawSignal, SIGNAL_CAPACITY, u8>,
}

/// All measured ranges of one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct RawEpoch {
    /// Time tag of the receiver.
    pub time: GpsTime,
    /// Satellites, in the order of arrival, each at most once.
    pub satellites: Vec<RawSatellite, EPOCH_CAPACITY>,
    /// Milliseconds by which the receiver clock has jumped so far, modulo 256. After a change,
    /// carrier phases of earlier epochs do not continue.
    #[cfg(feature = "sbf")]
    pub clock_jumps_ms: Option<u8>,
}

impl RawEpoch {
    /// Returns an epoch without satellites.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub const fn new(time: GpsTime) -> Self {
        Self {
            time,
            satellites: Vec::new(),
            #[cfg(feature = "sbf")]
            clock_jumps_ms: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BARE: RawSignal = RawSignal::new(Carrier::of(Band::L1), 2.2e7);

    #[test]
    fn channels_of_glonass_are_those_of_its_document() {
        // GLONASS ICD 5.1 (2008), table 3.1: k = −7 and 6 on L1 and L2, MHz.
        for (band, channel, want_mhz) in [
            (Band::G1, -7, 1598.0625),
            (Band::G1, 6, 1605.375),
            (Band::G2, -7, 1242.9375),
            (Band::G2, 6, 1248.625),
        ] {
            let have = Carrier { band, channel }.frequency_hz();
            assert!((have - want_mhz * 1e6).abs() < 1e-3, "{band:?} {channel}: {have}");
        }
    }

    #[test]
    fn what_a_format_does_not_say_is_none() {
        let nothing = BARE.with_cn0_dbhz(0.0).with_doppler_hz(f32::NAN);
        for signal in [BARE, nothing] {
            assert_eq!((signal.cn0_dbhz(), signal.doppler_hz()), (None, None));
        }
    }

    #[cfg(feature = "cnav")]
    #[test]
    fn the_code_and_the_strength_do_not_touch_each_other() {
        for code in Code::ALL {
            for (signal, want) in [
                (BARE, None),
                (BARE.with_cn0_dbhz(63.9375), Some(63.9375)),
                (BARE.codeless(), None),
                (BARE.with_cn0_dbhz(255.0), Some(255.0)),
            ] {
                let have = signal.with_code(code);
                assert_eq!((have.code(), have.cn0_dbhz()), (code, want));
                assert_eq!(have.is_codeless(), signal.is_codeless());
                let again = have.with_cn0_dbhz(40.0);
                assert_eq!((again.code(), again.cn0_dbhz()), (code, Some(40.0)));
                assert_eq!(have.codeless().code(), code);
            }
        }
    }

    #[test]
    fn every_step_of_every_format_is_kept() {
        // MSM7 sends C/N0 in steps of 1/16 dB-Hz.
        for sixteenths in 1..1024_u16 {
            let want = f32::from(sixteenths) / 16.0;
            assert_eq!(BARE.with_cn0_dbhz(want).cn0_dbhz(), Some(want));
        }
        for want in [-5_432.125, 0.0, 4_999.5] {
            assert_eq!(BARE.with_doppler_hz(want).doppler_hz(), Some(want));
        }
    }
}
