//! The monitor's report on one epoch: plain values.
//!
//! A verdict has three states, never two: [`Verdict::Protected`], [`Verdict::Alert`],
//! [`Verdict::Unavailable`], each with its reason. An alert is a value and not an error. If
//! something cannot be computed, the verdict is unavailable, with the reason.

use heapless::Vec;

use crate::epoch::Observation;
use crate::frame::{Ecef, Geodetic, LinearisationPoint};
use crate::numeric::absolute::Absolute as _;
use crate::numeric::real::Real;
use crate::numeric::sqrt;
use crate::satellite::{Constellation, SatelliteId};

pub use crate::reasons::{Alert, Protected, Unavailable};
pub use crate::velocity::Velocity;

/// Largest number of single satellites that may be left out of one epoch, because the sources treat
/// at most 3 faults ([Tian2024]). Whole systems may be left out besides.
///
/// [Tian2024]: crate#references
pub const MAX_EXCLUDED: usize = 3;

/// The answer to one question: may the position be used?
///
/// ```
/// use raim_core::Verdict;
/// use raim_core::report::{Protected, Unavailable};
///
/// let may_use = |verdict: Verdict| matches!(verdict, Verdict::Protected(_));
/// assert!(may_use(Verdict::Protected(Protected::Ok)));
/// assert!(!may_use(Verdict::Unavailable(Unavailable::NoFix)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Verdict {
    /// No fault was detected in the satellites used. The position error that an undetected fault of
    /// one satellite can cause is within the alert limits ([`ProtectionLevels`]).
    Protected(Protected),
    /// The position must not be used: a fault or a contradiction was detected, or no epoch could be
    /// judged in time.
    Alert(Alert),
    /// The position must not be used, because its integrity cannot be established.
    Unavailable(Unavailable),
}

/// A position with its uncertainty.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Solution {
    /// Earth-fixed position.
    pub position: Ecef,
    /// Position on the ellipsoid.
    pub geodetic: Geodetic,
    /// Covariance of east, north, up in this order: EE, EN, EU, NN, NU, UU, m².
    pub covariance_m2: [f64; 6],
    /// Receiver clock times the speed of light for each constellation id, m; `None` for a
    /// constellation without a satellite.
    #[doc(hidden)]
    pub clocks_m: [Option<f64>; Constellation::COUNT],
    /// Horizontal dilution of precision, dimensionless.
    pub hdop: f64,
    /// Vertical dilution of precision, dimensionless.
    pub vdop: f64,
}

impl Solution {
    /// Returns a position without uncertainty and clocks.
    #[doc(hidden)]
    pub const fn at(position: Ecef, geodetic: Geodetic) -> Self {
        let clocks_m = [None; Constellation::COUNT];
        Self { position, geodetic, covariance_m2: [0.0; 6], clocks_m, hdop: 0.0, vdop: 0.0 }
    }

    /// Returns the receiver clock times the speed of light, m, by the time scale of a constellation;
    /// `None` without a satellite of it.
    pub fn clock_m(&self, constellation: Constellation) -> Option<f64> {
        *self.clocks_m.get(constellation as usize)?
    }

    /// Returns the residual of a range at this position, m: the range minus the distance and the
    /// receiver clock. `None` if the satellite's constellation has no clock.
    ///
    /// The residual of a range that is too long is positive. That of an excluded satellite is its
    /// estimated bias. `T` is the scalar for directions, as in [`Monitor`](crate::Monitor).
    #[doc(hidden)]
    pub fn residual_m<T: Real>(&self, observation: &Observation) -> Option<f64> {
        let constellation = observation.satellite.constellation();
        let clock_m = self.clock_m(constellation)?;
        let sight = LinearisationPoint::<T>::at(self.position).sight(observation.position);
        let longer = T::Absolute::of(observation.range_m).less(sight.distance.whole);
        let rest = longer.less(T::Absolute::of(clock_m)).narrow();
        Some((rest - (sight.distance.rest + sight.rotation)).widen())
    }

    /// Returns the position dilution of precision, dimensionless.
    pub fn pdop(&self) -> f64 {
        let (hdop, vdop) = (self.hdop as f32, self.vdop as f32);
        f64::from(sqrt(hdop * hdop + vdop * vdop))
    }
}

/// The global test behind the verdict.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct TestStatistic {
    /// `√(SSE/dof)`, dimensionless.
    pub statistic: f64,
    /// Threshold that it was compared with, dimensionless.
    pub threshold: f64,
    /// Degrees of freedom.
    pub dof: u8,
}

impl TestStatistic {
    /// Returns a test that was made.
    #[doc(hidden)]
    pub const fn new(statistic: f64, threshold: f64, dof: u8) -> Self {
        Self { statistic, threshold, dof }
    }
}

/// Protection levels, m. Those of classic RAIM bound the effect of one faulty satellite, those of
/// ARAIM also the effect of several.
///
/// Infinite if a satellite moves the position but cannot be tested
/// ([`crate::integrity::raim::levels`]).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct ProtectionLevels {
    /// Horizontal protection level, m.
    pub hpl_m: f64,
    /// Vertical protection level, m.
    pub vpl_m: f64,
}

impl ProtectionLevels {
    /// Returns a horizontal and a vertical level, m.
    #[doc(hidden)]
    pub const fn new(hpl_m: f64, vpl_m: f64) -> Self {
        Self { hpl_m, vpl_m }
    }

    /// Returns the sums of both horizontal and both vertical levels.
    #[must_use]
    #[doc(hidden)]
    pub fn plus(&self, other: &Self) -> Self {
        Self { hpl_m: self.hpl_m + other.hpl_m, vpl_m: self.vpl_m + other.vpl_m }
    }

    /// Returns both levels, multiplied by a factor.
    #[must_use]
    #[doc(hidden)]
    pub fn times(&self, factor: f64) -> Self {
        Self { hpl_m: factor * self.hpl_m, vpl_m: factor * self.vpl_m }
    }

    /// Returns the larger horizontal and the larger vertical level of two; NaN counts as the
    /// largest.
    #[must_use]
    // Not inlined, so that its many callers share one copy.
    #[inline(never)]
    #[doc(hidden)]
    pub fn or_larger(&self, other: &Self) -> Self {
        let larger = |a: f64, b: f64| if a > b || a.is_nan() { a } else { b };
        Self { hpl_m: larger(self.hpl_m, other.hpl_m), vpl_m: larger(self.vpl_m, other.vpl_m) }
    }
}

/// Results of ARAIM, except for its levels.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct AraimReport {
    /// Number of monitored modes.
    pub modes: u16,
    /// Probability of unmonitored faults.
    pub unmonitored_probability: f64,
    /// Share of the risk for this outcome. All outcomes share equally: no exclusion, and each
    /// possible exclusion.
    pub share: f64,
    /// Largest separation divided by its threshold, dimensionless. Above 1 there is an alarm.
    pub ratio: f64,
    /// Largest vertical threshold among the modes whose prior is at least
    /// [`crate::requirements::Allocation::emt_prior`], m.
    pub effective_monitor_threshold_m: f64,
    /// Standard deviation of the height, computed with the URE instead of the URA, m. The accuracy
    /// limit applies to it.
    pub accuracy_m: f64,
    /// The fault mode that dominates the HPL.
    pub horizontal: DominantMode,
    /// The fault mode that dominates the VPL.
    pub vertical: DominantMode,
    /// Constellations left out as a whole, a bit for each id.
    pub excluded_constellations: u8,
    /// True if the unmonitored faults use up the risk, so that no level exists.
    pub is_risk_spent: bool,
}

/// A fault mode by its satellites; empty if the noise of all satellites dominates the level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct DominantMode {
    /// Whole constellations, a bit for each id.
    pub constellations: u8,
    /// Satellites of other constellations.
    pub satellites: [Option<SatelliteId>; 3],
}

/// A satellite with the bias that its w-test suggests.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Suspect {
    /// The satellite.
    pub satellite: SatelliteId,
    /// Signed w-test when it was suspected, dimensionless.
    pub w_test: f64,
    /// Estimated bias of its range, m.
    pub bias_m: f64,
    /// Standard deviation of `bias_m`, m.
    pub bias_sigma_m: f64,
}

impl Suspect {
    /// Returns a satellite with its w-test, its bias and the sigma of that, m.
    #[doc(hidden)]
    pub const fn new(satellite: SatelliteId, w_test: f64, bias_m: f64, bias_sigma_m: f64) -> Self {
        Self { satellite, w_test, bias_m, bias_sigma_m }
    }
}

/// Comparison of a known height with the satellites of an epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct HeightReport {
    /// False if the known height contradicts the satellites and was left out.
    pub is_used: bool,
    /// True if the satellites cannot be tested without the known height.
    pub is_needed: bool,
    /// Known height minus the height from the satellites alone, m; 0 if they determine no height.
    pub difference_m: f64,
}

/// Results for one epoch, at most `N` satellites.
///
/// ```
/// use raim_core::{Epoch, Monitor, Requirements, Verdict};
/// use raim_core::report::Unavailable;
///
/// let mut monitor = Monitor::<f32, 16>::new(Requirements::terminal())?;
/// let report = monitor.process(&Epoch::new(0.0)); // no satellite
/// assert_eq!(report.verdict, Verdict::Unavailable(Unavailable::NoFix));
/// assert!(report.solution.is_none() && report.protection.is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Report<const N: usize> {
    /// The verdict with its reason.
    pub verdict: Verdict,
    /// The position, if there is one; after an exclusion, without the excluded satellites.
    pub solution: Option<Solution>,
    /// The last global test, if there was redundancy.
    pub test: Option<TestStatistic>,
    /// Protection levels of the satellites used, if there was redundancy.
    pub protection: Option<ProtectionLevels>,
    /// Satellites left out, in the order of exclusion.
    pub excluded: Vec<Suspect, MAX_EXCLUDED>,
    /// Constellations left out as a whole, a bit for each id: found broken in this epoch, or kept
    /// out because of earlier epochs. Some of their satellites are also in [`Self::excluded`].
    pub excluded_constellations: u8,
    /// Satellite in use whose w-test is the largest; `None` without redundancy.
    pub suspect: Option<Suspect>,
    /// Satellites in the solution, in the order of the epoch.
    pub used: Vec<SatelliteId, N>,
    /// Root mean square of the residuals of the satellites used, m; 0 without a position.
    pub residual_rms_m: f64,
    /// Satellites in the epoch.
    pub tracked: u8,
    /// Results of ARAIM, if that is the method; its levels are in [`Self::protection`].
    pub araim: Option<AraimReport>,
    /// The known height, if the epoch came with one.
    pub height: Option<HeightReport>,
    /// Mean of SSE/dof over the last epochs: about 1 if sigma is right, `None` before the first
    /// test.
    pub sigma_check: Option<f64>,
}

impl<const N: usize> Report<N> {
    /// Returns a report without an epoch.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    #[doc(hidden)]
    pub fn nothing() -> Self {
        Self {
            verdict: Verdict::Unavailable(Unavailable::NoFix),
            solution: None,
            test: None,
            protection: None,
            excluded: Vec::new(),
            excluded_constellations: 0,
            suspect: None,
            used: Vec::new(),
            residual_rms_m: 0.0,
            tracked: 0,
            araim: None,
            height: None,
            sigma_check: None,
        }
    }

    /// Resets the report to one without an epoch.
    pub(crate) fn clear(&mut self) {
        let Self { excluded, used, .. } = self;
        excluded.clear();
        used.clear();
        self.excluded_constellations = 0;
        (self.verdict, self.residual_rms_m, self.tracked) =
            (Verdict::Unavailable(Unavailable::NoFix), 0.0, 0);
        (self.solution, self.test, self.protection) = (None, None, None);
        (self.suspect, self.araim, self.height, self.sigma_check) = (None, None, None, None);
    }
}
