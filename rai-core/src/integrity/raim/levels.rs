//! Protection levels: how large can the position error be while the test passes?
//!
//! A bias `b` of satellite `i` adds `b²r_i/σ_i²` to the non-centrality of SSE and moves the
//! position by `b w_i g_i`. The bias that is missed with probability `P_md` has the non-centrality
//! `λ(dof, P_fa, P_md)`. With the noise `σ` of the position,
//!
//! ```text
//! slope_h,i = √(w_i (g_iE² + g_iN²) / r_i)     slope_v,i = √w_i |g_iU| / √r_i         s: the largest
//! BOUND    PL = max( s (√λ − k) + k' √(s² + σ²),  K σ )
//! SLOPE    PL = s √λ
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `slope_h`, `slope_v` | [`Slopes`] | m per unit of `√λ` |
//! | `σ` | [`PositionSigma`]: `σ_U`, and horizontally the longer semi-axis | m |
//! | `k = Q⁻¹(P_md)` | [`KFactors`] | – |
//! | `k'` | [`KFactors`]: `Q⁻¹(P_md/2)` vertically, `√(2 ln 1/P_md)` horizontally | – |
//! | `K` | [`KFactors`]: the same of `P_ff` | – |
//! | `P_ff` | probability that the error exceeds the level without a fault | – |
//! | `HPL`, `VPL` | [`ProtectionLevels`] | m |
//!
//! **Proof of the bound.** Let `β` be the root of the bias's non-centrality. A bias with `β = √λ`
//! is missed with the probability `P_md`. Along the bias's direction in parity space the test sees
//! `X = β + noise`. Independently, the error of the position is `Y = s β + σ noise`.
//!
//! - If `β > √λ`, a miss alone is less likely than `P_md`.
//! - If `β ≤ √λ`, a miss is at most as likely as `X < √λ − k`. A miss with an error above the level
//!   is then at most as likely as the quadrant `X < √λ − k`, `Y > PL`.
//! - This quadrant lies in the half-plane `Y − s X > PL − s (√λ − k) = k' √(s² + σ²)`. For any
//!   bias, `Y − s X` has mean 0 and standard deviation `√(s² + σ²)`. So the half-plane has the
//!   probability `Q(k')`.
//! - Vertically, errors of both signs add up to `2 Q(k') = P_md`. Horizontally, the error may have
//!   any direction, and `k'` is that of a circular distribution.
//!
//! `√(s² + σ²)` is also the standard deviation of the position without that satellite. For
//! `σ → 0` the level exceeds that of the papers, `s √λ`, by `s (k' − k)`. The papers' level bounds
//! only the mean error under the worst missed bias. An
//! error beyond it is up to 84 times likelier than `P_md = 1e-3`, and 36,000 times likelier than
//! `P_md = 1e-6`.
//!
//! **Shared errors** of all ranges add to each level, because no test sees them
//! ([`super::shared_errors`]).
//!
//! A satellite without redundancy has slope 0 if it does not move the position. A constellation's
//! lone satellite is such a case. Otherwise its slope is infinite. If all sigmas are equal,
//! [Lin2016] (eq. 22–26) computes the same horizontal slope from the change of HDOP without the
//! satellite: `slope_h,i = σ_i √(HDOP_i² − HDOP²)`.
//!
//! **Hardly tested rows.** `r_i` is computed as 1 minus a sum. If `r_i` is small, rounding in
//! single precision makes the slope up to 20 % too small. Below 0.1, `r_i` and the slope are
//! therefore computed from the other rows' prediction of this row, where nothing cancels. With `P`,
//! `d_i` and `W_c` of the other rows, this prediction has the variance `q_i = 1/W_c + d_i·P d_i`,
//! and
//!
//! ```text
//! r_i = 1 / (1 + w_i q_i)                      slope_i² = w_i r_i |P d_i|²
//! ```
//!
//! In `f32`, slopes below 100 m (levels up to some 700 m) are then understated by at most 3 %, and
//! rarely by more than 0.1 %. The guard on the alert limit is 5 %.
//!
//! **Not monotone.** Without a satellite the position is less accurate: its horizontal variance
//! `P_h` grows to `P_h + slope_h,i²`. The other satellites are also tested less well. Yet the
//! protection level may shrink: if the satellite with the largest slope is left out, this slope no
//! longer counts. `λ` also decreases with the degrees of freedom.
//!
//! The level bounds the effect of the worst bias of a single satellite. It is not an ARAIM
//! protection level ([`crate::integrity::araim`]). References: [Yang2015] eq. 6–8, [Lin2016] eq.
//! 21–26, [Brown1992].
//!
//! [Lin2016]: crate#references
//! [Yang2015]: crate#references
//! [Brown1992]: crate#references

use nalgebra::Matrix3;

use crate::bit_set::{bit, first};
use crate::least_squares::equations::Row;
use crate::least_squares::{Estimate, RowFit, Snapshot, SquaredSlopes, infinity, larger};
use crate::numeric::chi_square::LARGEST;
use crate::numeric::normal;
use crate::numeric::probability::Probability;
use crate::numeric::real::Real;
use crate::numeric::space::dot;
use crate::numeric::sqrt_f64;
use crate::report::ProtectionLevels;

/// Effect of a row's bias on the position, per unit of its effect on the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slopes<T> {
    /// Horizontal, m per unit of `√λ`.
    pub horizontal: T,
    /// Vertical, m per unit of `√λ`.
    pub vertical: T,
}

/// Returns the slopes of one row; 0 for a row that is left out.
pub fn slopes<T: Real>(row: &Row<T>, fit: &RowFit<T>) -> Slopes<T> {
    Slopes::of(&squared_slopes(row, fit))
}

fn squared_slopes<T: Real>(row: &Row<T>, fit: &RowFit<T>) -> SquaredSlopes<T> {
    if row.weight > T::zero() && !(fit.test_weight > T::zero()) {
        return untestable(row, fit);
    }
    fit.squared_slopes()
}

/// Returns the squared slopes of a row whose bias never shows.
fn untestable<T: Real>(row: &Row<T>, fit: &RowFit<T>) -> SquaredSlopes<T> {
    let unmoved = T::UNMOVED / row.weight;
    let limit = unmoved * unmoved;
    let slope = |moved: T| if moved <= limit { T::zero() } else { infinity() };
    let (horizontal, vertical) = fit.squared_gains();
    SquaredSlopes { horizontal: slope(horizontal), vertical: slope(vertical) }
}

/// Returns true if rounding spoils the redundancy of a row that other rows can predict.
fn is_hardly_tested<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    row: &Row<T>,
    fit: &RowFit<T>,
) -> bool {
    let shares_clock = |other: &Row<T>| other.clock == row.clock && other.weight > T::zero();
    row.weight > T::zero()
        && fit.is_hardly_tested()
        && snapshot.dof() > 0
        && (row.clock.is_none() || snapshot.rows().filter(|(other, _)| shares_clock(other)).count() > 1)
}

/// Returns the squared slopes of a row, computed from the others' prediction of it, or `None` if it
/// is untestable.
fn by_the_others<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    index: usize,
) -> Option<SquaredSlopes<T>> {
    let (row, _) = snapshot.row(index)?;
    let rows = snapshot.equations();
    let mut solution = Estimate::none();
    solution.solve_set(rows, first(rows.len()) & !bit(index)).ok()?;
    let fit = solution.fit(row);
    let predicted = solution.level_variance(row) + dot(&fit.centred, &fit.gain);
    let redundancy = (T::one() + row.weight * predicted).recip();
    if !(redundancy >= T::UNTESTABLE) {
        return None;
    }
    let scale = row.weight * redundancy;
    let (horizontal, vertical) = fit.squared_gains();
    Some(SquaredSlopes { horizontal: horizontal * scale, vertical: vertical * scale })
}

/// Returns the largest slopes of a snapshot.
pub fn largest_slopes<T: Real, const N: usize>(snapshot: &Snapshot<'_, T, N>) -> Slopes<T> {
    let statistics = snapshot.statistics();
    if statistics.all_are_tested {
        return Slopes::of(&statistics.slopes);
    }
    Slopes::of(&largest_with_care(snapshot))
}

/// Works like [`largest_slopes`] for rows that are hardly tested or untestable.
#[inline(never)]
fn largest_with_care<T: Real, const N: usize>(snapshot: &Snapshot<'_, T, N>) -> SquaredSlopes<T> {
    let mut largest = SquaredSlopes::none();
    for (index, (row, fit)) in snapshot.rows().enumerate() {
        let squared = if is_hardly_tested(snapshot, row, fit) {
            by_the_others(snapshot, index).unwrap_or_else(|| untestable(row, fit))
        } else {
            squared_slopes(row, fit)
        };
        largest = largest.or(&squared);
    }
    largest
}

impl<T: Real> Slopes<T> {
    fn of(squared: &SquaredSlopes<T>) -> Self {
        Self { horizontal: squared.horizontal.sqrt_approx(), vertical: squared.vertical.sqrt_approx() }
    }

    /// Returns the papers' protection levels for a non-centrality `λ`
    /// ([`crate::integrity::raim::detection::threshold::Thresholds::lambda`]). These slopes must be
    /// the largest.
    pub fn protect(&self, lambda: f64) -> ProtectionLevels {
        let root = T::narrow(lambda).sqrt_approx();
        ProtectionLevels { hpl_m: (self.horizontal * root).widen(), vpl_m: (self.vertical * root).widen() }
    }
}

/// Quantity that a protection level bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Levels {
    /// The error of a position that is reported as protected: fault and noise together.
    Bound,
    /// The mean error under the worst missed fault, as in the papers.
    Slope,
}

/// Standard deviation of a position along its worst horizontal axis and upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionSigma<T> {
    /// Longer semi-axis of the horizontal ellipse, m.
    pub horizontal: T,
    /// Vertical, m.
    pub vertical: T,
}

impl<T: Real> PositionSigma<T> {
    /// Returns the standard deviations for a covariance of east, north, up, m².
    pub fn of(covariance: &Matrix3<T>) -> Self {
        let half = T::narrow(0.5);
        let (mean, difference) =
            ((covariance.m11 + covariance.m22) * half, (covariance.m11 - covariance.m22) * half);
        let radius = (difference * difference + covariance.m21 * covariance.m21).sqrt_approx();
        Self { horizontal: (mean + radius).sqrt_approx(), vertical: covariance.m33.sqrt_approx() }
    }
}

/// Factors of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct AxisKFactors<T> {
    /// `k'`, for a missed fault.
    missed: T,
    /// `K`, for the fault-free case.
    fault_free: T,
}

/// Numbers of standard deviations for the required probabilities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KFactors<T> {
    /// `k = Q⁻¹(P_md)`.
    detection: T,
    horizontal: AxisKFactors<T>,
    vertical: AxisKFactors<T>,
}

impl<T: Real> KFactors<T> {
    /// Returns `k = Q⁻¹(P_md)`.
    pub(super) const fn detection(&self) -> T {
        self.detection
    }

    /// Returns the factors for a probability of missed detection and one of exceeding the level
    /// without a fault.
    pub fn new(missed_detection: Probability, fault_free: Probability) -> Self {
        let [missed, free] = [missed_detection, fault_free].map(|probability| T::narrow(probability.get()));
        let two_sided = |probability: T| normal::quantile(probability * T::narrow(0.5));
        // Circular normal distribution with the standard deviation of the longer axis.
        let radial = |probability: T| (T::narrow(-2.0) * probability.ln()).sqrt_approx();
        Self {
            detection: normal::quantile(missed),
            horizontal: AxisKFactors { missed: radial(missed), fault_free: radial(free) },
            vertical: AxisKFactors { missed: two_sided(missed), fault_free: two_sided(free) },
        }
    }
}

/// Inputs of the protection levels: largest slopes and noise.
///
/// They convert a threshold to levels, and alert limits to a threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelInputs<'f, T> {
    /// The largest slopes.
    pub slopes: Slopes<T>,
    /// Additional inputs of the bound; `None` for the papers' level.
    noise: Option<(PositionSigma<T>, &'f KFactors<T>)>,
}

impl<T> LevelInputs<'_, T> {
    /// Returns the inputs of the papers' level, which needs no noise, with these largest slopes.
    pub const fn to_faults(slopes: Slopes<T>) -> Self {
        Self { slopes, noise: None }
    }
}

impl<'f, T: Real> LevelInputs<'f, T> {
    /// Returns the inputs of a snapshot.
    pub fn of<const N: usize>(
        snapshot: &Snapshot<'_, T, N>,
        levels: Levels,
        factors: &'f KFactors<T>,
    ) -> Self {
        let noise = match levels {
            Levels::Bound => Some((PositionSigma::of(snapshot.covariance()), factors)),
            Levels::Slope => None,
        };
        Self { slopes: largest_slopes(snapshot), noise }
    }

    /// Returns the protection levels for the non-centrality `λ` of the threshold in use.
    // Compiled once for both callers.
    #[inline(never)]
    pub fn protect(&self, lambda: f64) -> ProtectionLevels {
        let Some((spread, factors)) = self.noise else { return self.slopes.protect(lambda) };
        let beyond = T::narrow(lambda).sqrt_approx() - factors.detection;
        let level = |slope: T, sigma: T, axis: AxisKFactors<T>| {
            let missed = slope * beyond + axis.missed * (slope * slope + sigma * sigma).sqrt_approx();
            larger(missed, axis.fault_free * sigma).widen()
        };
        ProtectionLevels {
            hpl_m: level(self.slopes.horizontal, spread.horizontal, factors.horizontal),
            vpl_m: level(self.slopes.vertical, spread.vertical, factors.vertical),
        }
    }

    /// Returns the protection levels against a fault that affects several satellites at once, such
    /// as a wrong time tag. `slopes` are the slopes of this fault, and `shown` is its w-test.
    ///
    /// The root of the non-centrality is `shown + k`.
    pub(crate) fn protect_against(
        self,
        slopes: Slopes<T>,
        shown: T,
        factors: &KFactors<T>,
    ) -> ProtectionLevels {
        let root = shown + factors.detection;
        Self { slopes, ..self }.protect((root * root).widen())
    }

    /// Returns the largest non-centrality whose horizontal level is within a limit, or 0.
    pub fn horizontal_noncentrality(&self, limit_m: f64) -> f64 {
        let noise =
            self.noise.map(|(spread, factors)| (spread.horizontal, factors.detection, factors.horizontal));
        noncentrality_within(limit_m, self.slopes.horizontal, noise)
    }

    /// Returns the largest non-centrality whose vertical level is within a limit, or 0.
    pub fn vertical_noncentrality(&self, limit_m: f64) -> f64 {
        let noise =
            self.noise.map(|(spread, factors)| (spread.vertical, factors.detection, factors.vertical));
        noncentrality_within(limit_m, self.slopes.vertical, noise)
    }
}

/// Returns the non-centrality of the bias that moves the position by `limit_m` with the slope
/// `slope_m`.
///
/// 0 for an infinite or NaN slope; [`LARGEST`] for a slope of 0.
pub fn noncentrality_at(limit_m: f64, slope_m: f64) -> f64 {
    let ratio = limit_m / slope_m;
    // A NaN ratio fails this comparison.
    if ratio > 0.0 { (ratio * ratio).min(LARGEST) } else { 0.0 }
}

/// Returns the non-centrality `((limit − k' √(s² + σ²)) / s + k)²`; 0 if the limit is too small for
/// any threshold.
fn noncentrality_within<T: Real>(limit_m: f64, slope: T, noise: Option<(T, T, AxisKFactors<T>)>) -> f64 {
    let Some((sigma, detection, axis)) = noise else { return noncentrality_at(limit_m, slope.widen()) };
    let limit = T::narrow(limit_m);
    let spread = axis.missed * (slope * slope + sigma * sigma).sqrt_approx();
    // NaN fails these comparisons. It then returns 0, as for an infinite slope.
    let suffices = limit >= spread - detection * slope && limit >= axis.fault_free * sigma;
    if !(suffices && slope.is_finite()) {
        return 0.0;
    }
    let root = (limit - spread) / slope + detection;
    (root * root).widen().min(LARGEST)
}

/// Returns the largest increase of HDOP without one satellite, `max √(HDOP_i² − HDOP²)`,
/// dimensionless.
pub fn largest_hdop_change<T: Real, const N: usize>(snapshot: &Snapshot<'_, T, N>) -> T {
    let (hdop, _) = snapshot.dilutions();
    let changes = (0..snapshot.rows().count()).filter_map(|index| {
        let without = snapshot.hdop_without(index)?;
        Some((without * without - hdop * hdop).max(T::zero()))
    });
    changes.fold(T::zero(), T::max).sqrt_approx()
}

/// Returns the change of HDOP at which the protection level reaches the alert limit, `HAL/(σ√λ)`,
/// dimensionless ([Lin2016] eq. 25).
///
/// [Lin2016]: crate#references
pub fn hdop_change_limit(hal_m: f64, sigma_m: f64, lambda: f64) -> f64 {
    hal_m / (sigma_m * sqrt_f64(lambda))
}
