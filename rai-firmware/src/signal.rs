//! Signals: their carrier frequencies, and which of a satellite's ranges are used.
//!
//! Two frequencies remove the ionosphere, at the price of noise:
//!
//! ```text
//! P = k_a P_a + k_b P_b        k_a = f_a² / (f_a² − f_b²)        k_b = 1 − k_a
//! σ(P) / σ(P_a) = √(k_a² + k_b²)        τ = k_a τ_a + k_b τ_b
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `f` | [`Band::frequency_hz`] | Hz |
//! | `P` | `range_m` | m |
//! | `τ` | `group_delay_s`: what the satellite's clock differs by from the time on that band | s |
//! | `√(k_a² + k_b²)` | `noise_factor` | 1 |
//!
//! Assumes that both codes are equally noisy and that the ionosphere's delay goes with `1/f²` (the neglected
//! higher orders are below 0.1 m). References: [IS-GPS-200] 20.3.3.3.3, [IS-GPS-705], [OS-SIS-ICD] 5.1.5,
//! [BDS-SIS-B1I] 5.2.4.10, [BDS-SIS-B3I].

use rai_core::frame::SPEED_OF_LIGHT_M_S;
use rai_core::satellite::Constellation;

use crate::ephemeris::Ephemeris;

/// A carrier of one system. The order within a system is that of the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Band {
    /// GPS L1, any of its codes.
    L1,
    /// GPS L2.
    L2,
    /// GPS L5.
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
}

/// What all carriers are multiples of, or of a tenth of, Hz ([IS-GPS-200] 3.3.1.1, [BDS-SIS-B1I] 4.1).
const CHIP_RATE_HZ: f64 = 10.23e6;

impl Band {
    /// Carrier frequency, Hz.
    pub const fn frequency_hz(self) -> f64 {
        match self {
            Self::L1 | Self::E1 | Self::B1C => 154.0 * CHIP_RATE_HZ,
            Self::L2 => 120.0 * CHIP_RATE_HZ,
            Self::L5 | Self::E5a | Self::B2a => 115.0 * CHIP_RATE_HZ,
            Self::E5b | Self::B2I => 118.0 * CHIP_RATE_HZ,
            Self::B1I => 152.6 * CHIP_RATE_HZ,
            Self::B3I => 124.0 * CHIP_RATE_HZ,
        }
    }

    /// The band of a signal by its position in the signal mask of an MSM, from 1; `None` for those that are not used.
    ///
    /// Left out: restricted services (Galileo E1A, E1Z) and bands whose delay against the broadcast clock is not
    /// broadcast while others' are (Galileo E6 and E5 alt-BOC, `BeiDou` B2b). Reference: [RTCM-10403.3] tables
    /// 3.5-91, 3.5-99, 3.5-108.
    pub const fn from_msm(constellation: Constellation, signal: u8) -> Option<Self> {
        match (constellation, signal) {
            (Constellation::Gps, 2..=4 | 30..=32) => Some(Self::L1),
            (Constellation::Gps, 8..=10 | 15..=17) => Some(Self::L2),
            (Constellation::Gps, 22..=24) => Some(Self::L5),
            (Constellation::Galileo, 2 | 4 | 5) => Some(Self::E1),
            (Constellation::Galileo, 14..=16) => Some(Self::E5b),
            (Constellation::Galileo, 22..=24) => Some(Self::E5a),
            (Constellation::Beidou, 2..=4) => Some(Self::B1I),
            (Constellation::Beidou, 8..=10) => Some(Self::B3I),
            (Constellation::Beidou, 14..=16) => Some(Self::B2I),
            (Constellation::Beidou, 22..=24) => Some(Self::B2a),
            (Constellation::Beidou, 30..=32) => Some(Self::B1C),
            _ => None,
        }
    }
}

/// One code range of one satellite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signal {
    /// On which carrier.
    pub band: Band,
    /// Carrier to noise density, dB-Hz; 0 when the receiver does not say.
    pub cn0_dbhz: f32,
    /// Pseudorange as measured, m.
    pub range_m: f64,
}

/// The range that is used of a satellite, corrected for group delays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Pseudorange, corrected for the group delay, m. The satellite clock is still in it.
    pub range_m: f64,
    /// The carriers it is made of; with the first alone, its ionospheric delay is still in the range.
    pub bands: (Band, Option<Band>),
    /// How much noisier it is than one code range.
    pub noise_factor: f64,
    /// Standard deviation of a group delay that is not broadcast, m; 0 where it is.
    pub uncalibrated_m: f64,
    /// The lower carrier to noise density of what was combined, dB-Hz; 0 when unknown.
    pub cn0_dbhz: f32,
}

/// Pairs by preference: what the broadcast clock refers to comes first, what it knows no delay of comes last.
const PAIRS: [(Band, Band); 7] = [
    (Band::L1, Band::L2),
    (Band::L1, Band::L5),
    (Band::E1, Band::E5a),
    (Band::E1, Band::E5b),
    (Band::B1I, Band::B3I),
    (Band::B1I, Band::B2I),
    (Band::B1C, Band::B2a),
];

/// Single bands by preference.
const SINGLES: [Band; 11] = [
    Band::L1,
    Band::L2,
    Band::L5,
    Band::E1,
    Band::E5b,
    Band::E5a,
    Band::B1I,
    Band::B3I,
    Band::B2I,
    Band::B1C,
    Band::B2a,
];

/// Chooses among a satellite's signals: an ionosphere-free pair where there is one, else one frequency.
///
/// `None` when there is no signal whose relation to the broadcast clock is known.
pub fn choose(signals: &[Signal], ephemeris: &Ephemeris) -> Option<Choice> {
    let find = |band| signals.iter().find(|signal| signal.band == band);
    let pair = |&(a, b): &(Band, Band)| combine(find(a)?, find(b)?, ephemeris);
    let single = |&band: &Band| alone(find(band)?, ephemeris);
    PAIRS.iter().find_map(pair).or_else(|| SINGLES.iter().find_map(single))
}

/// The ionosphere-free combination of two signals.
fn combine(first: &Signal, second: &Signal, ephemeris: &Ephemeris) -> Option<Choice> {
    let (k_first, k_second) = ionosphere_free(first.band, second.band);
    let (delay_first, delay_second) =
        (ephemeris.group_delay(first.band)?, ephemeris.group_delay(second.band)?);
    let delay_s = k_first * delay_first.seconds() + k_second * delay_second.seconds();
    Some(Choice {
        bands: (first.band, Some(second.band)),
        range_m: k_first * first.range_m + k_second * second.range_m - SPEED_OF_LIGHT_M_S * delay_s,
        noise_factor: libm::sqrt(k_first * k_first + k_second * k_second),
        uncalibrated_m: delay_first.uncalibrated_m().max(delay_second.uncalibrated_m()),
        cn0_dbhz: first.cn0_dbhz.min(second.cn0_dbhz),
    })
}

/// One signal by itself.
fn alone(signal: &Signal, ephemeris: &Ephemeris) -> Option<Choice> {
    let delay = ephemeris.group_delay(signal.band)?;
    Some(Choice {
        bands: (signal.band, None),
        range_m: signal.range_m - SPEED_OF_LIGHT_M_S * delay.seconds(),
        noise_factor: 1.0,
        uncalibrated_m: delay.uncalibrated_m(),
        cn0_dbhz: signal.cn0_dbhz,
    })
}

/// The two factors `k_a`, `k_b` of the ionosphere-free combination.
pub const fn ionosphere_free(first: Band, second: Band) -> (f64, f64) {
    let (first_hz, second_hz) = (first.frequency_hz(), second.frequency_hz());
    let squared = first_hz * first_hz;
    let k_first = squared / (squared - second_hz * second_hz);
    (k_first, 1.0 - k_first)
}
