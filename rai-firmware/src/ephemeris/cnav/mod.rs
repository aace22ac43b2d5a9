//! What CNAV adds to the LNAV of a GPS or QZSS satellite: delays of its signals, and their health.
//!
//! ```text
//! d_x = TGD − ISC_x        x: L1 C/A, L2C, I5, Q5
//! ```
//!
//! | symbol | here | unit |
//! |---|---|---|
//! | `TGD`, `ISC_x` | [`SignalDelays::steps`] | 2⁻³⁵ s |
//! | `d_x` | [`super::GroupDelay::Corrected`] | s |
//!
//! | `σ(d_x)` | 0.067 m for L1 C/A and L2C, 0.25 m for L5 | m |
//!
//! `d_x` is the delay of a signal after the broadcast clock, in the sense of [`super::GroupDelay`].
//! `TGD` and `ISC` of a satellite come from one frame, because they are estimated together. The
//! delays change by uploads that are months apart, so that they are kept for a day, whatever the
//! ephemeris. A delay that the satellite does not know is that of LNAV. Free of the ionosphere, the
//! sigmas make 0.35 m in a range of L1 and L5, as was measured, and 0.2 m in one of L1 and L2C, where
//! 0.16 m was measured ([`super::clock`]).
//!
//! **Health.** The alert and the flags of L1 and L2 close the satellite or the band. The flag of L5
//! closes L5 only if the settings ask for it ([`Cnav::prepare`]): GPS calls L5 unhealthy on all
//! satellites, and nearly every user of L5 overrides that. Bad health counts until a frame says
//! otherwise, for a day at most; good health for as long as an ephemeris.
//!
//! **Room.** A frame names one of 32 GPS and 10 QZSS satellites. Each has a place of its own, so
//! that no satellite displaces another.
//!
//! A build without `cnav` has only [`Word`], which then says nothing and takes no room.
//!
//! References: [IS-GPS-200] 30.3.3.1.1.2 and 30.3.3.3.1.1; [IS-GPS-705] 20.3.3.1.1.2 and
//! 20.3.3.3.1.2.
//!
//! [IS-GPS-200]: crate#references
//! [IS-GPS-705]: crate#references

#[cfg(not(feature = "cnav"))]
use core::marker::PhantomData;

#[cfg(feature = "cnav")]
use raim_core::satellite::SatelliteId;

use super::GroupDelay;
#[cfg(feature = "cnav")]
use crate::raw::Code;
use crate::raw::{Band, RawSignal};

/// What a frame of CNAV says of the signals of its satellite.
#[cfg(feature = "cnav")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct CnavFrame {
    /// Satellite that sent the frame.
    pub satellite: SatelliteId,
    /// True if the errors of the satellite may exceed what it promises, so that it must not be
    /// used.
    pub is_alert: bool,
    /// The rest of the frame.
    pub content: CnavContent,
}

/// Content of a frame of CNAV.
#[cfg(feature = "cnav")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CnavContent {
    /// Type 10.
    Health {
        /// True for each of L1, L2 and L5 that is out of service.
        out: [bool; 3],
    },
    /// Type 30.
    Delays(SignalDelays),
    /// A type that is not read.
    Other,
}

/// Delays of the signals of a satellite, as broadcast.
#[cfg(feature = "cnav")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SignalDelays {
    /// `TGD`, and `ISC` of L1 C/A, L2C, I5 and Q5, 2⁻³⁵ s; −4096 if the satellite does not know it.
    pub steps: [i16; 5],
}

#[cfg(feature = "cnav")]
impl SignalDelays {
    /// Value of an unknown delay.
    const UNKNOWN: i16 = -4096;

    /// No delay is known.
    const NONE: Self = Self { steps: [Self::UNKNOWN; 5] };

    /// Returns the delay of a code, if it is known.
    // Not inlined, so that epochs without CNAV are short.
    #[inline(never)]
    fn of(&self, code: Code) -> Option<GroupDelay> {
        let is_l5 = !matches!(code, Code::Ca | Code::L2c);
        self.seconds(code).map(if is_l5 { GroupDelay::CorrectedL5 } else { GroupDelay::Corrected })
    }

    /// Returns the delay of a code after the broadcast clock, s.
    fn seconds(&self, code: Code) -> Option<f32> {
        const STEP_S: f32 = 1.0 / (1_u64 << 35) as f32;
        let known = self.steps.map(|steps| (steps != Self::UNKNOWN).then_some(steps as f32));
        let [group, of_ca, of_l2c, of_i5, of_q5] = known;
        // A satellite without L5 sends zeros.
        let [of_i5, of_q5] =
            if of_i5 == Some(0.0) && of_q5 == Some(0.0) { [None; 2] } else { [of_i5, of_q5] };
        let correction = match code {
            Code::Other => None,
            Code::Ca => of_ca,
            Code::L2c => of_l2c,
            Code::I5 => of_i5,
            Code::Q5 => of_q5,
            Code::Both5 => of_i5.zip(of_q5).map(|(i5, q5)| 0.5 * (i5 + q5)),
        };
        Some((group? - correction?) * STEP_S)
    }
}

/// What CNAV says of one satellite now.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Word<'s> {
    #[cfg(feature = "cnav")]
    delays: Option<&'s SignalDelays>,
    /// Bands that must not be used, one bit each.
    #[cfg(feature = "cnav")]
    closed: u16,
    /// True if the satellite calls its L5 out of service.
    #[cfg(feature = "cnav")]
    pub(crate) l5_is_out: bool,
    #[cfg(not(feature = "cnav"))]
    nothing: PhantomData<&'s ()>,
}

impl Word<'_> {
    /// Nothing is said.
    pub(crate) const NOTHING: Self = Self {
        #[cfg(feature = "cnav")]
        delays: None,
        #[cfg(feature = "cnav")]
        closed: 0,
        #[cfg(feature = "cnav")]
        l5_is_out: false,
        #[cfg(not(feature = "cnav"))]
        nothing: PhantomData,
    };

    /// Returns true unless the satellite must not be used on this band.
    #[cfg(feature = "cnav")]
    pub(crate) const fn serves(self, band: Band) -> bool {
        self.closed & bit(band) == 0
    }

    /// Returns true, because nothing is said.
    #[cfg(not(feature = "cnav"))]
    pub(crate) const fn serves(self, _: Band) -> bool {
        true
    }

    /// Returns the delay of a signal, if it is known.
    #[cfg(feature = "cnav")]
    #[inline]
    pub(super) fn delay(self, signal: &RawSignal) -> Option<GroupDelay> {
        self.delays.and_then(|delays| delays.of(signal.code()))
    }

    /// Returns no delay, because nothing is said.
    #[cfg(not(feature = "cnav"))]
    pub(super) const fn delay(self, _: &RawSignal) -> Option<GroupDelay> {
        None
    }
}

#[cfg(feature = "cnav")]
mod table;
#[cfg(feature = "cnav")]
pub(super) use table::Cnav;

#[cfg(feature = "cnav")]
const fn bit(band: Band) -> u16 {
    1 << band as u16
}

#[cfg(all(test, feature = "cnav"))]
mod tests;
