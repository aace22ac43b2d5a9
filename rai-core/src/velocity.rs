//! Velocity from range rates, with a test and levels of its own.
//!
//! ```text
//! y_i = −e_i · v + ḋ + ε_i            ε_i ~ N(0, σ_i²)
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `e_i` | [`RangeRate::line_of_sight`], receiver → satellite, east, north, up | – |
//! | `y_i` | [`RangeRate::residual_m_s`], measured rate minus the contribution of the satellite's motion and clock | m/s |
//! | `σ_i` | [`RangeRate::sigma_m_s`] | m/s |
//! | `v` | [`Velocity::east_north_up_m_s`] | m/s |
//! | `ḋ` | [`Velocity::drift_m_s`], drift of the receiver clock times the speed of light | m/s |
//!
//! The equation has the form of that of the position, and is solved by the same
//! [`Snapshot`](crate::least_squares::Snapshot). All systems have a common drift, because their
//! times drift against each other by millimetres per second only. With `n` satellites
//! `dof = n − 4`, so that there is more redundancy than for the position. The global test, the
//! exclusion of up to three satellites and the levels are those of the position, with the same
//! probabilities. After an exclusion at least two degrees of freedom must remain, and as many as it
//! has rows: of many rates that all disagree, some five always agree by chance.
//!
//! A fault here is independent of the position, because a range can be wrong and its rate right.
//! Every returned velocity passed its test. In a vehicle rates are noisier than at rest. If they fail
//! the test by little, this is noise and no sign of anything else ([`VelocityError::Noise`]). Rates
//! that fail the test show the caller their speed, for sigmas that grow with it.
//!
//! Assumes independent Gaussian errors. References: [Lin2016] §2.2 for the test,
//! [`crate::integrity::raim::levels`] for the levels.
//!
//! [Lin2016]: crate#references

use core::fmt;

use heapless::Vec;
use nalgebra::Vector3;

use crate::integrity::raim::detection::detect;
use crate::integrity::raim::detection::threshold::Thresholds;
use crate::integrity::raim::hypotheses::separability::separable;
use crate::integrity::raim::isolation::baarda::exclude_sequentially;
use crate::integrity::raim::isolation::exclusion::{ExclusionOutcome, leaves_enough};
use crate::integrity::raim::levels::{KFactors, LevelInputs, Levels};
use crate::least_squares::Workspace;
use crate::numeric::real::Real;
use crate::numeric::space::{trace, upper_triangle};
use crate::numeric::sqrt;
use crate::report::{MAX_EXCLUDED, ProtectionLevels, TestStatistic};
use crate::satellite::{Constellation, SatelliteId};

/// Largest ratio of the statistic to its threshold that noise explains: in a car the statistic is 1.5
/// to 3, its threshold 1.9, where the model's sigmas are right at rest.
const NOISY: f64 = 2.0;

/// Speed up to which the rates are as quiet as at rest, m/s. Contradictions are then no noise.
const SLOW_M_S: f64 = 1.0;

/// Constellation whose clock in the snapshot stands for the common drift of all systems.
const DRIFT: Constellation = Constellation::Gps;

/// Range rate of one satellite, in the scalar of the solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeRate<T = f64> {
    /// The satellite.
    pub satellite: SatelliteId,
    /// Unit vector receiver → satellite, east, north, up.
    pub line_of_sight: Vector3<T>,
    /// Measured rate minus that of a receiver at rest with a perfect clock, m/s.
    pub residual_m_s: T,
    /// Standard deviation, m/s.
    pub sigma_m_s: T,
}

/// A velocity that passed its test.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Velocity {
    /// East, north, up, m/s.
    pub east_north_up_m_s: [f64; 3],
    /// Covariance of east, north, up in this order: EE, EN, EU, NN, NU, UU, m²/s².
    pub covariance_m2_s2: [f64; 6],
    /// Drift of the receiver clock times the speed of light, m/s.
    pub drift_m_s: f64,
    /// The test that it passed.
    pub test: TestStatistic,
    /// Bounds on the error of the velocity by noise and a fault of one range rate together, m/s.
    pub levels_m_s: ProtectionLevels,
    /// Satellites whose rate was left out.
    pub excluded: Vec<SatelliteId, MAX_EXCLUDED>,
}

impl Velocity {
    /// Returns a velocity of zero that passed a test.
    #[doc(hidden)]
    pub const fn zero(test: TestStatistic, levels_m_s: ProtectionLevels) -> Self {
        let (east_north_up_m_s, covariance_m2_s2) = ([0.0; 3], [0.0; 6]);
        Self { east_north_up_m_s, covariance_m2_s2, drift_m_s: 0.0, test, levels_m_s, excluded: Vec::new() }
    }

    /// Returns the speed, m/s.
    pub fn speed_m_s(&self) -> f64 {
        let [east, north, up] = self.east_north_up_m_s.map(|component_m_s| component_m_s as f32);
        f64::from(sqrt(east * east + north * north + up * up))
    }

    /// Returns true if a receiver with this maximum speed can have the velocity. The horizontal and
    /// the vertical part are each compared with the speed plus their level.
    ///
    /// A NaN speed returns false.
    #[doc(hidden)]
    pub fn is_within(&self, max_speed_m_s: f64) -> bool {
        let [east, north, up] = self.east_north_up_m_s.map(|component_m_s| component_m_s as f32);
        let reach = |level_m_s: f64| (max_speed_m_s + level_m_s) as f32;
        let ground = reach(self.levels_m_s.hpl_m);
        east * east + north * north <= ground * ground && up.abs() <= reach(self.levels_m_s.vpl_m)
    }
}

/// Reason why there is no velocity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum VelocityError {
    /// Fewer than five usable rates, so that no test is possible.
    Redundancy,
    /// The geometry is singular.
    Geometry,
    /// The rates contradict each other, and the wrong one cannot be identified.
    Fault,
    /// The same, but noise explains it: the receiver moves, and the statistic is at most twice its
    /// threshold.
    Noise,
}

impl VelocityError {
    /// Returns true if the rates contradict each other.
    pub fn is_contradiction(&self) -> bool {
        matches!(self, Self::Fault | Self::Noise)
    }
}

impl fmt::Display for VelocityError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Redundancy => "too few range rates to test a velocity",
            Self::Geometry => "geometry of the range rates singular",
            Self::Fault => "range rates contradict each other",
            Self::Noise => "range rates noisier than their sigmas",
        })
    }
}

impl core::error::Error for VelocityError {}

/// Returns the velocity on which the range rates agree. A NaN rate, or one without a direction, is
/// discarded.
///
/// If all rates together fail the test, and their speed exceeds the standard deviation that their
/// residuals show, `√(SSE/dof · tr C)`, then `shown_m_s` becomes this speed, m/s.
///
/// # Errors
/// [`VelocityError`] if there is no velocity, or none that passes the test.
pub fn estimate<T: Real, const N: usize>(
    workspace: &mut Workspace<T, N>,
    rates: impl IntoIterator<Item = RangeRate<T>>,
    thresholds: &Thresholds<'_>,
    factors: &KFactors<T>,
    shown_m_s: &mut T,
) -> Result<Velocity, VelocityError> {
    workspace.equations_mut().clear();
    let mut satellites = Vec::<SatelliteId, N>::new();
    for rate in rates {
        let RangeRate { line_of_sight, residual_m_s, sigma_m_s, .. } = &rate;
        if workspace.equations_mut().rate(DRIFT, line_of_sight, *residual_m_s, *sigma_m_s).is_ok() {
            // Never full, because both have the capacity `N`.
            let _ = satellites.push(rate.satellite);
        }
    }
    let mut snapshot = workspace.solve().map_err(|_| VelocityError::Geometry)?;
    let mut excluded = Vec::new();
    let all = detect(&snapshot, thresholds).ok_or(VelocityError::Redundancy)?;
    if all.fault() {
        let squared = snapshot.correction().norm_squared();
        let dof = T::narrow(snapshot.dof() as f64);
        if squared * dof > all.sse * trace(snapshot.covariance()) {
            *shown_m_s = squared.sqrt_approx();
        }
        let is_moving = squared > T::narrow(SLOW_M_S * SLOW_M_S);
        let is_noise = is_moving && all.sse <= T::narrow(NOISY * NOISY) * all.threshold;
        let exclusion = exclude_sequentially(&mut snapshot, thresholds);
        let is_isolated = matches!(exclusion.outcome, ExclusionOutcome::Isolated | ExclusionOutcome::Passed);
        let is_told = snapshot.dof() > 1 && leaves_enough(exclusion.rows.len(), snapshot.dof());
        if !is_isolated || !is_told || !separable(&mut snapshot, &exclusion, thresholds) {
            return Err(if is_noise { VelocityError::Noise } else { VelocityError::Fault });
        }
        let named = exclusion.rows.iter().filter_map(|row| satellites.get(row.index));
        // Never full, because its capacity is that of an exclusion.
        named.for_each(|satellite| _ = excluded.push(*satellite));
    }
    let detection = detect(&snapshot, thresholds).ok_or(VelocityError::Redundancy)?;
    if detection.fault() {
        return Err(VelocityError::Fault);
    }
    let lambda: T = thresholds.lambda(snapshot.dof()).ok_or(VelocityError::Redundancy)?;
    Ok(Velocity {
        east_north_up_m_s: snapshot.correction().map(Real::widen).into(),
        covariance_m2_s2: upper_triangle(snapshot.covariance()),
        drift_m_s: snapshot.clock_m(DRIFT).unwrap_or_default(),
        test: detection.statistic(),
        levels_m_s: LevelInputs::of(&snapshot, Levels::Bound, factors).protect(lambda.widen()),
        excluded,
    })
}
