//! What the monitor says of one epoch: plain data.
//!
//! Three states, never two: [`Verdict::Protected`], [`Verdict::Alert`], [`Verdict::Unavailable`], each with its
//! reason. An alert is a value; what could not be computed is an unavailability with a reason, not a silence.

use heapless::Vec;

use crate::frame::{Ecef, Geodetic};
use crate::satellite::{Constellation, SatelliteId};

/// How many satellites may be left out of one epoch ([Tian2024] treats no more than 3 faults, nor does any source here).
///
/// [Tian2024]: crate#references
pub const MAX_EXCLUDED: usize = 3;

/// May the position be used?
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Verdict {
    /// No fault was detected in what is used, and an undetected one of a single satellite stays within the alert
    /// limits ([`ProtectionLevels`]).
    Protected(Protected),
    /// The position must not be used: something is wrong with it.
    Alert(Alert),
    /// Nothing can be promised: the means to tell are missing.
    Unavailable(Unavailable),
}

/// Why a position is protected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Protected {
    /// All satellites agree.
    Ok,
    /// The satellites agree after the faulty ones were left out.
    Excluded,
}

/// Why a position must not be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Alert {
    /// A fault was detected and could not be isolated.
    Fault,
    /// Several exclusions explain the data equally.
    Ambiguous,
    /// A wrong time tag of all ranges explains the data, and no exclusion does better.
    Time,
    /// No epoch came within the time to alert. Said by the receiver around the core, which has a clock.
    Stale,
    /// The position moved farther than it can since it was last protected: satellites that agree on it agree by chance,
    /// or on somebody's purpose.
    Jump,
    /// The receiver that measures is sure that its signals are counterfeit. Said by the receiver around the core.
    Spoofed,
}

/// Why nothing can be promised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Unavailable {
    /// Too few satellites for a position, or the fix did not converge.
    NoFix,
    /// A position, but no redundancy to test it with.
    Redundancy,
    /// The satellites' geometry is singular, or leaves a satellite untestable that moves the position.
    Geometry,
    /// No threshold meets both probabilities (T1 ≥ T2).
    Risk,
    /// The horizontal protection level exceeds its share of the alert limit.
    Hpl,
    /// The vertical protection level exceeds its share of the alert limit.
    Vpl,
    /// The declared work budget cut the search.
    Budget,
    /// The input was refused as a whole.
    Input,
    /// The satellites agree again after an alert, not yet for long enough.
    Recovering,
    /// No receiver can be at this height or place.
    Place,
    /// A known answer was missed. Said by the receiver around the core, as are the next two.
    SelfTest,
    /// Ranges came, orbits did not.
    Ephemeris,
    /// An unexpected restart: the settings in force are those at start, and nobody has confirmed them.
    Settings,
}

/// A position with its uncertainty.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Solution {
    /// Earth-fixed position.
    pub position: Ecef,
    /// The same on the ellipsoid.
    pub geodetic: Geodetic,
    /// Covariance of east, north, up in this order: EE, EN, EU, NN, NU, UU, m².
    pub covariance_m2: [f64; 6],
    /// Receiver clock times the speed of light for each constellation id, m; `None` where it has no satellite.
    pub clocks_m: [Option<f64>; Constellation::COUNT],
    /// Horizontal dilution of precision, dimensionless.
    pub hdop: f64,
    /// Vertical dilution of precision, dimensionless.
    pub vdop: f64,
}

impl Solution {
    /// Position dilution of precision, dimensionless.
    pub fn pdop(&self) -> f64 {
        let (hdop, vdop) = (self.hdop as f32, self.vdop as f32);
        f64::from(libm::sqrtf(hdop * hdop + vdop * vdop))
    }
}

/// The global test that the verdict rests on.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TestStatistic {
    /// `√(SSE/dof)`, dimensionless.
    pub statistic: f64,
    /// What it was held against, dimensionless.
    pub threshold: f64,
    /// Degrees of freedom.
    pub dof: u8,
}

/// How wrong a position can be, m, that is called good although one satellite is faulty; infinite where a satellite moves
/// it but cannot be tested ([`crate::integrity::raim::levels`]).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ProtectionLevels {
    /// Horizontal protection level, m.
    pub hpl_m: f64,
    /// Vertical protection level, m.
    pub vpl_m: f64,
}

impl ProtectionLevels {
    /// Both added.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self { hpl_m: self.hpl_m + other.hpl_m, vpl_m: self.vpl_m + other.vpl_m }
    }

    /// The larger of each; what is not a number is the largest.
    #[must_use]
    pub fn or_larger(&self, other: &Self) -> Self {
        let larger = |a: f64, b: f64| if a > b || a.is_nan() { a } else { b };
        Self { hpl_m: larger(self.hpl_m, other.hpl_m), vpl_m: larger(self.vpl_m, other.vpl_m) }
    }
}

/// What ARAIM says beside its levels.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Separation {
    /// Watched modes.
    pub modes: u16,
    /// Probability of what is not watched.
    pub not_watched: f64,
    /// Share of the risk that this outcome has: one of every possible exclusion and of none.
    pub share: f64,
    /// The largest separation over its threshold: an alarm from 1 on.
    pub ratio: f64,
    /// The largest threshold of a likely mode, up, m.
    pub effective_monitor_threshold_m: f64,
    /// Standard deviation of the height for accuracy, m.
    pub accuracy_m: f64,
    /// The mode that makes the horizontal level.
    pub horizontal: Dominant,
    /// The mode that makes the vertical level.
    pub vertical: Dominant,
    /// Constellations left out as a whole, a bit for each id.
    pub excluded_constellations: u8,
    /// Whether what is not watched uses up the risk, so that no level exists.
    pub is_risk_spent: bool,
}

/// A mode, by what it takes away; nothing where the noise of all satellites makes the level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Dominant {
    /// Whole constellations, a bit for each id.
    pub constellations: u8,
    /// Satellites of others.
    pub satellites: [Option<SatelliteId>; 3],
}

/// A satellite with the bias that its w-test suggests.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Suspect {
    /// Which satellite.
    pub satellite: SatelliteId,
    /// Signed w-test at the moment of suspicion, dimensionless.
    pub w_test: f64,
    /// Estimated bias of its range, m.
    pub bias_m: f64,
    /// Standard deviation of `bias_m`, m.
    pub bias_sigma_m: f64,
}

/// All that is known about one epoch, at most `N` satellites.
#[derive(Clone, Debug, PartialEq)]
pub struct Report<const N: usize> {
    /// May the position be used, and why (not).
    pub verdict: Verdict,
    /// The position, where there is one; after exclusion, without the excluded.
    pub solution: Option<Solution>,
    /// The last global test, where there was redundancy.
    pub test: Option<TestStatistic>,
    /// Protection levels of the satellites used, where there was redundancy.
    pub protection: Option<ProtectionLevels>,
    /// Satellites left out, in the order of exclusion.
    pub excluded: Vec<Suspect, MAX_EXCLUDED>,
    /// Among the satellites used, the one that fits worst; `None` without redundancy.
    pub suspect: Option<Suspect>,
    /// Satellites in the solution, in the order of the epoch.
    pub used: Vec<SatelliteId, N>,
    /// Root mean square of the residuals of the satellites used, m; 0 without a position.
    pub residual_rms_m: f64,
    /// Satellites in the epoch.
    pub tracked: u8,
    /// What ARAIM says beside its levels, where it judged.
    pub separation: Option<Separation>,
    /// Mean of SSE/dof over the last epochs: about 1 where sigma is right, `None` before the first test.
    pub sigma_check: Option<f64>,
}

impl<const N: usize> Report<N> {
    /// On no epoch.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(crate) fn nothing() -> Self {
        Self {
            verdict: Verdict::Unavailable(Unavailable::NoFix),
            solution: None,
            test: None,
            protection: None,
            excluded: Vec::new(),
            suspect: None,
            used: Vec::new(),
            residual_rms_m: 0.0,
            tracked: 0,
            separation: None,
            sigma_check: None,
        }
    }

    /// Back to that.
    pub(crate) fn clear(&mut self) {
        let Self { excluded, used, .. } = self;
        excluded.clear();
        used.clear();
        (self.verdict, self.residual_rms_m, self.tracked) =
            (Verdict::Unavailable(Unavailable::NoFix), 0.0, 0);
        (self.solution, self.test, self.protection) = (None, None, None);
        (self.suspect, self.separation, self.sigma_check) = (None, None, None);
    }
}
