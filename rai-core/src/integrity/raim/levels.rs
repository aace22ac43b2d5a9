//! Protection levels: how large can the position error be while the test passes?
//!
//! A bias `b` of satellite `i` adds `b²r_i/σ_i²` to the non-centrality of SSE and moves the
//! position by `b A_i`. The bias that is missed with probability `P_md` has the non-centrality
//! `λ(dof, P_fa, P_md)`; with the noise `σ` on the position
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
//! | `k'`, `K` | [`KFactors`]: `Q⁻¹(P/2)` vertically, `√(2 ln 1/P)` horizontally, with `P_md` and `P_ff` | – |
//! | `HPL`, `VPL` | [`ProtectionLevels`] | m |
//!
//! **Proof of the bound.** Along the fault's direction in parity space the test sees `b + noise`,
//! and the position, independently, `s b + σ noise` (`b` in units of `√λ`). Up to the bias `√λ` the
//! probability of a miss is at most `Q(b − (√λ − k))`; beyond, it is below `P_md` alone. A miss and
//! an error above the level are two independent normal tails, whose product lies in a half-plane
//! through the corner (`√λ − k`, level). Turned by `tan θ = σ/s` the bias cancels in its distance,
//! and `Q(k') = P_md` remains for any bias. `√(s² + σ²)` is the standard deviation of the position
//! without that satellite. The papers' level is the limit of `σ → 0`: it bounds the mean error of
//! the worst missed bias, and an error beyond it is up to 84 times likelier than `P_md` at 1e-3,
//! and 36,000 times at 1e-6.
//!
//! **Shared errors** of all ranges, which no test sees, add to each level
//! ([`super::shared_errors`]).
//!
//! A satellite without redundancy has slope 0 if it does not move the position (the lone satellite
//! of a constellation), else an infinite one. By the identity
//! `HDOP_i² − HDOP² = (A_1i² + A_2i²)/S_ii` the change of HDOP bounds the same thing for a common
//! sigma ([Lin2016] eq. 22–26).
//!
//! **Hardly tested rows.** `r_i` is a difference to 1. If little is left, single precision is too
//! coarse: a slope would be up to a fifth too small. Below a redundancy of 0.1 both are therefore
//! computed from the prediction of this row by the other rows, where nothing cancels. With `P`,
//! `d_i` and `W_c` of the others, `q_i = 1/W_c + d_i·P d_i` is the variance of their prediction,
//! and
//!
//! ```text
//! r_i = 1 / (1 + w_i q_i)                      slope_i² = w_i r_i |P d_i|²
//! ```
//!
//! Slopes below 100 m, protection levels of some 700 m, are then understated by 3 % at most in
//! `f32`, and rarely by more than 0.1 %; the guard on the alert limit is 5 %.
//!
//! **Not monotone.** Without a satellite the position is less well known, by just the square of its
//! slope (`P_h` without `i` is `P_h + slope_h,i²`), and every other one is less well tested. Yet
//! the protection level may shrink, even with the same `λ`: the satellite that is hardest to test
//! takes the largest slope with it, and `λ` also falls with the degrees of freedom.
//!
//! The level bounds the worst bias of a single satellite. It is not an ARAIM protection level
//! ([`crate::integrity::araim`]). References: [Yang2015] eq. 6–8, [Lin2016] eq. 21–26, [Brown1992].
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
use crate::report::ProtectionLevels;

/// Largest effect of a row's bias on the position per unit of its effect on the test.
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

/// Returns true if the subtraction from 1 loses digits of a row's redundancy, although other rows
/// predict it.
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

/// Returns the squared slopes of a row from its prediction by the others, or `None` if it is
/// untestable.
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
    /// ([`crate::integrity::raim::detection::threshold::Thresholds::lambda`]), if these slopes are
    /// the largest.
    pub fn protect(&self, lambda: f64) -> ProtectionLevels {
        let root = T::narrow(lambda).sqrt_approx();
        ProtectionLevels { hpl_m: (self.horizontal * root).widen(), vpl_m: (self.vertical * root).widen() }
    }
}

/// Quantity that a protection level bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(not(feature = "unstable"), non_exhaustive)]
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
        let radial = |probability: T| (T::narrow(-2.0) * probability.ln()).sqrt();
        Self {
            detection: normal::quantile(missed),
            horizontal: AxisKFactors { missed: radial(missed), fault_free: radial(free) },
            vertical: AxisKFactors { missed: two_sided(missed), fault_free: two_sided(free) },
        }
    }
}

/// Inputs of the protection levels: largest slopes and noise.
///
/// They turn a threshold into levels, and alert limits into a threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelInputs<'f, T> {
    /// The largest slopes.
    pub slopes: Slopes<T>,
    /// Additional inputs of the bound; `None` for the papers' level.
    noise: Option<(PositionSigma<T>, &'f KFactors<T>)>,
}

impl<T> LevelInputs<'_, T> {
    /// Returns the inputs for faults alone, with these largest slopes: for the papers' level.
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

    /// Returns the protection levels against a fault that is not a satellite's, with these slopes
    /// and a w-test of `shown`.
    ///
    /// The non-centrality is that of `shown + k` standard deviations.
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

/// Returns `√δ = (f AL − k' √(s² + σ²)) / s + k`, squared; 0 if the limit is too small for any
/// threshold.
fn noncentrality_within<T: Real>(limit_m: f64, slope: T, noise: Option<(T, T, AxisKFactors<T>)>) -> f64 {
    let Some((sigma, detection, axis)) = noise else { return noncentrality_at(limit_m, slope.widen()) };
    let limit = T::narrow(limit_m);
    let spread = axis.missed * (slope * slope + sigma * sigma).sqrt_approx();
    // NaN fails these comparisons, so that nothing is available; nor is it with an infinite slope.
    let suffices = limit >= spread - detection * slope && limit >= axis.fault_free * sigma;
    if !(suffices && slope.is_finite()) {
        return 0.0;
    }
    let root = (limit - spread) / slope + detection;
    (root * root).widen().min(LARGEST)
}

/// Returns the largest change of HDOP from leaving out one satellite, `max √(HDOP_i² − HDOP²)`,
/// dimensionless.
pub fn largest_hdop_change<T: Real, const N: usize>(snapshot: &Snapshot<'_, T, N>) -> T {
    let (hdop, _) = snapshot.dilutions();
    let changes = (0..snapshot.rows().count()).filter_map(|index| {
        let without = snapshot.hdop_without(index)?;
        Some((without * without - hdop * hdop).max(T::zero()))
    });
    changes.fold(T::zero(), T::max).sqrt()
}

/// Returns the change of HDOP at which the protection level reaches the alert limit, `HAL/(σ√λ)`,
/// dimensionless ([Lin2016] eq. 25).
///
/// [Lin2016]: crate#references
pub fn hdop_change_limit(hal_m: f64, sigma_m: f64, lambda: f64) -> f64 {
    hal_m / (sigma_m * libm::sqrt(lambda))
}
