//! Satellite clocks, and what each band's delay is against them.
//!
//! ```text
//! Δt = af0 + af1 (t − toc) + af2 (t − toc)² + Δt_r          clock of band b: Δt − τ_b
//! ```
//!
//! `τ_b` follows from what the broadcast clock refers to; `γ_ab = f_a²/f_b²`:
//!
//! | message | clock refers to | `τ` |
//! |---|---|---|
//! | GPS LNAV | L1/L2 | L1: `TGD`, L2: `γ_12 TGD`, L5: `TGD` (the inter-signal correction is in CNAV only: uncalibrated) |
//! | Galileo F/NAV | E1/E5a | E1: `BGD_a`, E5a: `γ_15a BGD_a`, E5b: unknown |
//! | Galileo I/NAV | E1/E5b | E1: `BGD_b`, E5b: `γ_15b BGD_b`, E5a: `BGD_b + (γ_15a − 1) BGD_a` |
//! | `BeiDou` D1/D2 | B3I | B1I: `TGD1`, B2I: `TGD2`, B3I: 0, B1C and B2a: 0 (their delays are in CNAV only: uncalibrated) |
//!
//! The ionosphere-free pair of the reference then comes out without delay by itself, every other pair with the
//! right one ([`crate::signal`]).
//!
//! References: [IS-GPS-200] 20.3.3.3.3.2; [OS-SIS-ICD] 5.1.5; [BDS-SIS-B1I] 5.2.4.10.

use super::{Ephemeris, Source};
use crate::signal::Band;

/// Standard deviation of a group delay that the message does not carry, m.
///
/// The inter-signal corrections that GPS and `BeiDou` publish in CNAV scatter by some nanoseconds.
const UNCALIBRATED_M: f64 = 2.0;

/// How much later than the satellite's clock a band leaves the antenna.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GroupDelay {
    /// As broadcast, s.
    Known(f64),
    /// The best that the message allows, s; the remainder is some nanoseconds.
    Uncalibrated(f64),
}

impl GroupDelay {
    /// The delay, s.
    pub const fn seconds(self) -> f64 {
        match self {
            Self::Known(delay_s) | Self::Uncalibrated(delay_s) => delay_s,
        }
    }

    /// Standard deviation of what is not broadcast, m; 0 for a known delay.
    pub const fn uncalibrated_m(self) -> f64 {
        match self {
            Self::Known(_) => 0.0,
            Self::Uncalibrated(_) => UNCALIBRATED_M,
        }
    }
}

impl Ephemeris {
    /// Clock offset without relativity, s, at `since_toe_s` of the satellite's own clock.
    pub(super) fn clock_polynomial_s(&self, since_toe_s: f64) -> f64 {
        let since_toc_s = since_toe_s - f64::from(self.toc_offset_s);
        let drift_s_s = f64::from(self.af1_s_s) + f64::from(self.af2_s_s2) * since_toc_s;
        self.af0_s + drift_s_s * since_toc_s
    }

    /// The delay of a band; `None` when the band is another system's, or when this message cannot relate it to
    /// its clock.
    pub fn group_delay(&self, band: Band) -> Option<GroupDelay> {
        use GroupDelay::{Known, Uncalibrated};
        let [first_s, second_s] = self.group_delays_s.map(f64::from);
        match self.source {
            Source::GpsLnav => match band {
                Band::L1 => Some(Known(first_s)),
                Band::L2 => Some(Known(squared_ratio(Band::L1, Band::L2) * first_s)),
                Band::L5 => Some(Uncalibrated(first_s)),
                _ => None,
            },
            Source::GalileoFnav => match band {
                Band::E1 => Some(Known(first_s)),
                Band::E5a => Some(Known(squared_ratio(Band::E1, Band::E5a) * first_s)),
                _ => None,
            },
            Source::GalileoInav => match band {
                Band::E1 => Some(Known(second_s)),
                Band::E5b => Some(Known(squared_ratio(Band::E1, Band::E5b) * second_s)),
                Band::E5a => Some(Known(second_s + (squared_ratio(Band::E1, Band::E5a) - 1.0) * first_s)),
                _ => None,
            },
            Source::BeidouD1D2 => match band {
                Band::B1I => Some(Known(first_s)),
                Band::B2I => Some(Known(second_s)),
                Band::B3I => Some(Known(0.0)),
                Band::B1C | Band::B2a => Some(Uncalibrated(0.0)),
                _ => None,
            },
        }
    }
}

/// `γ_ab = f_a²/f_b²`.
const fn squared_ratio(a: Band, b: Band) -> f64 {
    let ratio = a.frequency_hz() / b.frequency_hz();
    ratio * ratio
}
