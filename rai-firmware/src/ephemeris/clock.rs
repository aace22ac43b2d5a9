//! Satellite clocks, and the delay of each band relative to them.
//!
//! ```text
//! Δt = af0 + af1 (t − toc) + af2 (t − toc)² + Δt_r          clock of band b: Δt − τ_b
//! ```
//!
//! `τ_b` depends on the signals that the broadcast clock refers to; `γ_ab = f_a²/f_b²`:
//!
//! | message | clock refers to | `τ` |
//! |---|---|---|
//! | GPS LNAV | L1/L2 | L1: `TGD`, L2: `γ_12 TGD`, L5: `TGD` (the inter-signal correction is in CNAV only: uncalibrated) |
//! | GPS, QZSS CNAV | L1/L2 | L1 C/A, L2C, L5: `TGD − ISC` ([`super::cnav`]), in place of those of LNAV |
//! | QZSS LNAV | L1/L2C | as GPS; 0 if the satellite does not know `TGD` (uncalibrated) |
//! | Galileo F/NAV | E1/E5a | E1: `BGD_a`, E5a: `γ_15a BGD_a`, E5b: unknown |
//! | Galileo I/NAV | E1/E5b | E1: `BGD_b`, E5b: `γ_15b BGD_b`, E5a: `BGD_b + (γ_15a − 1) BGD_a` |
//! | `BeiDou` D1/D2 | B3I | B1I: `TGD1`, B3I: 0, B2I: `TGD2`; B1C: `TGD1`, B2a and B2b: 0 (their delays are in CNAV only: uncalibrated) |
//! | GLONASS strings | L1/L2 | L1 and L2: 0 (each receiver delays each channel by itself, some metres: uncalibrated) |
//!
//! Receivers report B2b of the third generation as B2I, which it replaced. The sigma of an
//! uncalibrated delay is 2 m. The delays of these bands differ by, rms:
//!
//! | bands | m | measured on |
//! |---|---|---|
//! | B1C from B1I, whose path it shares | 0.6 | 18 satellites, two receivers, `TGD1` of up to 8 m |
//! | B2a and B2b from B3I | 1.4 | the same |
//! | L5 from L1 | 1.1 | 14 satellites |
//!
//! After the corrections of CNAV, ranges of L1 C/A and L5 keep 0.35 m rms (7 satellites), those of
//! L1 C/A and L2C 0.16 m (11 satellites), free of the ionosphere and compared with those of P(Y) at
//! one station. Without them it is 1.6 m and 0.55 m.
//!
//! The ionosphere-free pair that the clock refers to then has no delay, and every other pair has
//! the right one ([`crate::correction::choose`]).
//!
//! References: [IS-GPS-200] 20.3.3.3.3.2; [IS-QZSS-PNT] 5.3; [OS-SIS-ICD] 5.1.5; [BDS-SIS-B1I]
//! 5.2.4.10.
//!
//! [IS-GPS-200]: crate#references
//! [IS-QZSS-PNT]: crate#references
//! [OS-SIS-ICD]: crate#references
//! [BDS-SIS-B1I]: crate#references

use raim_core::internals::weighting::UNCALIBRATED_DELAY_M;

use super::cnav::Word;
use super::elapsed::Elapsed;
use super::fixed::{mul_high, nearest_i32};
use super::{Ephemeris, Source};
use crate::raw::{Band, RawSignal};

/// Delay of a band at the antenna, relative to the satellite's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GroupDelay {
    /// Delay that is broadcast, s.
    Known(f32),
    /// Best delay that the message allows, s; the error is some nanoseconds.
    Uncalibrated(f32),
    /// Delay of L1 or L2 by an inter-signal correction, s.
    #[cfg(feature = "cnav")]
    Corrected(f32),
    /// Delay of L5 by an inter-signal correction, s.
    #[cfg(feature = "cnav")]
    CorrectedL5(f32),
}

/// Standard deviation of a corrected delay of L1 C/A or L2C, m.
#[cfg(feature = "cnav")]
const OF_L1_AND_L2_M: f32 = 0.067;

/// Standard deviation of a corrected delay of L5, m.
#[cfg(feature = "cnav")]
const OF_L5_M: f32 = 0.25;

impl GroupDelay {
    /// Returns the delay, s.
    pub const fn seconds(self) -> f32 {
        match self {
            Self::Known(delay_s) | Self::Uncalibrated(delay_s) => delay_s,
            #[cfg(feature = "cnav")]
            Self::Corrected(delay_s) | Self::CorrectedL5(delay_s) => delay_s,
        }
    }

    /// Returns the standard deviation of a delay that is not broadcast or was corrected, m; 0 for a
    /// known delay.
    pub const fn uncalibrated_m(self) -> f32 {
        match self {
            Self::Known(_) => 0.0,
            Self::Uncalibrated(_) => UNCALIBRATED_DELAY_M,
            #[cfg(feature = "cnav")]
            Self::Corrected(_) => OF_L1_AND_L2_M,
            #[cfg(feature = "cnav")]
            Self::CorrectedL5(_) => OF_L5_M,
        }
    }
}

/// Last `BeiDou` satellite that sends B2I.
const SECOND_GENERATION: u8 = 18;

/// Value of the field with which a QZSS satellite reports an unknown `TGD`: the most negative one,
/// −128 · 2⁻³¹ s ([IS-QZSS-PNT] 4.1.2.3). GPS reserves no value of this field.
///
/// [IS-QZSS-PNT]: crate#references
const QZSS_UNKNOWN_S: f32 = -1.0 / (1 << 24) as f32;

/// A checked satellite clock; each term in the finest unit in which it is broadcast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Clock {
    /// Offset, 2⁻³⁴ s.
    offset_2_34: i32,
    /// Drift, 2⁻⁵⁰ s/s.
    drift_2_50: i32,
    /// Ageing, 2⁻⁶⁶ s/s².
    ageing_2_66: i32,
    /// Reference time of the clock minus that of the orbit, s.
    toc_offset_s: i32,
    group_delays_s: [f32; 2],
}

impl Clock {
    /// Returns a checked polynomial about an instant `toc_offset_s` after the reference time of the
    /// orbit.
    pub(super) fn new(polynomial: [f64; 3], toc_offset_s: i32, group_delays_s: [f32; 2]) -> Self {
        let [af0_s, af1_s_s, af2_s_s2] = polynomial;
        Self {
            offset_2_34: nearest_i32(af0_s, 34),
            drift_2_50: nearest_i32(af1_s_s, 50),
            ageing_2_66: nearest_i32(af2_s_s2, 66),
            toc_offset_s,
            group_delays_s,
        }
    }

    /// Returns the clock offset without relativity, 2⁻⁶² s, at an instant of the satellite's own
    /// clock.
    pub(super) fn polynomial_s62(&self, since_toe: Elapsed) -> i64 {
        let since_toc_2_44 = since_toe.units_2_44() - (i64::from(self.toc_offset_s) << 44);
        let aged_2_82 = mul_high(i64::from(self.ageing_2_66) << 30, since_toc_2_44) << 6;
        let drift_2_82 = (i64::from(self.drift_2_50) << 32) + aged_2_82;
        (i64::from(self.offset_2_34) << 28) + mul_high(drift_2_82, since_toc_2_44)
    }
}

impl Ephemeris {
    /// Returns the delay of a signal on a band: that of CNAV if it is known, else that of the band.
    pub(crate) fn delay_of(&self, band: Band, signal: &RawSignal, word: Word<'_>) -> Option<GroupDelay> {
        word.delay(signal).or_else(|| self.group_delay(band))
    }

    /// Returns the delay of a band by its own message, or `None` if the band belongs to another system or this message
    /// cannot relate it to its clock.
    pub fn group_delay(&self, band: Band) -> Option<GroupDelay> {
        use GroupDelay::{Known, Uncalibrated};
        let [first_s, second_s] = self.clock.group_delays_s;
        match self.source {
            Source::QzssLnav if self.clock.group_delays_s == [QZSS_UNKNOWN_S, 0.0] => match band {
                Band::L1 | Band::L2 | Band::L5 => Some(Uncalibrated(0.0)),
                _ => None,
            },
            Source::GpsLnav | Source::QzssLnav => match band {
                Band::L1 => Some(Known(first_s)),
                Band::L2 => Some(Known(const { squared_ratio(Band::L1, Band::L2) } * first_s)),
                Band::L5 => Some(Uncalibrated(first_s)),
                _ => None,
            },
            Source::GalileoFnav => match band {
                Band::E1 => Some(Known(first_s)),
                Band::E5a => Some(Known(const { squared_ratio(Band::E1, Band::E5a) } * first_s)),
                _ => None,
            },
            Source::GalileoInav => match band {
                Band::E1 => Some(Known(second_s)),
                Band::E5b => Some(Known(const { squared_ratio(Band::E1, Band::E5b) } * second_s)),
                Band::E5a => {
                    Some(Known(second_s + (const { squared_ratio(Band::E1, Band::E5a) } - 1.0) * first_s))
                }
                _ => None,
            },
            Source::BeidouD1D2 => match band {
                Band::B1I => Some(Known(first_s)),
                Band::B2I if self.satellite.number() <= SECOND_GENERATION => Some(Known(second_s)),
                Band::B3I => Some(Known(0.0)),
                Band::B1C => Some(Uncalibrated(first_s)),
                Band::B2I | Band::B2a => Some(Uncalibrated(0.0)),
                _ => None,
            },
            Source::GlonassStrings => match band {
                Band::G1 | Band::G2 => Some(Uncalibrated(0.0)),
                _ => None,
            },
        }
    }
}

/// Returns `γ_ab = f_a²/f_b²`.
const fn squared_ratio(a: Band, b: Band) -> f32 {
    let ratio = a.frequency_hz() / b.frequency_hz();
    (ratio * ratio) as f32
}
