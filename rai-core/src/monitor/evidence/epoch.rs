//! Residuals of one epoch, and the noise that they show: `ratio`, `P` and `κ_e` of [`super`].

use super::MOST_NOISE;
use crate::epoch::EpochView;
use crate::integrity::Judgement;
use crate::integrity::raim::hypotheses::constellation_shift;
use crate::integrity::raim::isolation::exclusion::{ExclusionOutcome, Unidentified};
use crate::least_squares::Snapshot;
use crate::numeric::real::Real;
use crate::numeric::sqrt;
use crate::satellite::SatelliteId;
use crate::weighting::residuals::Residuals;

/// `Q⁻¹(0.5)`, for the noise that an epoch adds to its span.
const MEDIAN: f32 = 0.0;

/// `Q⁻¹(1e-2)`, for the bound on the rest after an exclusion: the significance `α` of [Parity].
///
/// [Parity]: crate#references
const REST_QUANTILE: f32 = 2.326_348;

/// Limit for the square of an excluded satellite's residual divided by its sigma.
const MOST_EXCLUDED: f32 = 25.0;

/// Limit for the square of one residual, in units of the mean of the others: three sigmas.
const MOST_ONE: f32 = 9.0;

/// Limit for what a shifted constellation explains, in the same units: `χ²` with three degrees of
/// freedom exceeds it as rarely as a normal number exceeds three sigmas.
const MOST_SHIFT: f32 = 14.156;

/// Degrees of freedom with which one row explains almost any residuals: the parities of six rows
/// are lines in a plane, 30° apart.
const DOUBTFUL_DOF: u32 = 2;

/// Largest SSE/dof with which an epoch counts: ten times the sigmas in use. Two such epochs suffice
/// for any noise up to [`MOST_NOISE`].
const MOST_RATIO: f32 = 100.0;

/// Ratio below which residuals are small: below `χ²_{0.5}(ν)/ν` from two degrees of freedom on.
const SMALL: f32 = 0.69;

/// Least share of the receiver in the variances, so that rounding cannot make it 0.
const LEAST_SHARE: f32 = 0.05;

/// Residuals of an epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::monitor) struct EpochResiduals {
    /// SSE/dof of every tracked satellite.
    pub(super) ratio: f32,
    /// Their degrees of freedom.
    pub(super) dof: u32,
    /// Share of the receiver in the variances in use.
    pub(super) share: f32,
    /// Factor in use on the receiver's part.
    pub(in crate::monitor) noise: f32,
    /// Residuals of the satellites used.
    pub(super) rest: Residuals,
    /// Number of satellites that were excluded one by one; 0 if the rest does not agree.
    pub(in crate::monitor) excluded: u8,
    /// Satellite that explains most of the rest.
    pub(super) blamed: Option<SatelliteId>,
}

impl EpochResiduals {
    /// The residuals of no epoch.
    pub(in crate::monitor) const NONE: Self =
        Self { ratio: 0.0, dof: 0, share: 1.0, noise: 1.0, rest: Residuals::NONE, excluded: 0, blamed: None };

    /// Returns the factor on the receiver's part that explains the residuals.
    fn shown(&self) -> f32 {
        let expected = Residuals { sse: 0.0, dof: self.dof }.ratio_at(MEDIAN);
        // Without degrees of freedom this is NaN, which becomes 0.
        (self.noise * (1.0 + (self.ratio / expected - 1.0) / self.share)).max(0.0)
    }

    /// Returns the noise of the epoch as a sum over its degrees of freedom.
    pub(super) fn sum(&self) -> Residuals {
        Residuals { sse: self.shown() * self.dof as f32, dof: self.dof }
    }

    /// Returns this sum as it is if no satellite is to blame, where a single epoch cannot tell, and
    /// none elsewhere. Where several were excluded, more than the rest has counted already.
    pub(super) fn doubtful(&self) -> Residuals {
        if self.dof != DOUBTFUL_DOF || self.rest.dof != DOUBTFUL_DOF {
            return Residuals::NONE;
        }
        Self { ratio: self.rest.ratio().min(MOST_RATIO), ..*self }.sum()
    }

    /// Returns the factor on the levels of this epoch, at least 1, or `None` if its residuals refute
    /// the sigmas. `past` is the noise of the last minute.
    pub(super) fn growth(&self, past: f32) -> Option<f32> {
        if self.excluded > 0 && self.rest.excess(REST_QUANTILE) > 0.0 {
            return None;
        }
        let noise = past.max(self.shown());
        let growth = 1.0 + (noise / self.noise - 1.0) * self.share;
        (noise < MOST_NOISE).then(|| sqrt(growth.max(1.0)))
    }
}

/// Returns the residuals of the satellites used, and with them those of the excluded satellites,
/// except for the largest one.
pub(in crate::monitor) fn residuals_of_all<T: Real, const N: usize>(
    judgement: &Judgement<T>,
    snapshot: &Snapshot<'_, T, N>,
    epoch: &EpochView<'_>,
    noise: f32,
) -> EpochResiduals {
    let is_late = judgement.outcome == ExclusionOutcome::NotIsolated(Unidentified::Time);
    if !cfg!(feature = "past") || is_late {
        return EpochResiduals::NONE;
    }
    let (mut sum, mut largest, mut count) = (0.0_f32, 0.0_f32, 0_u32);
    for (row, fit) in judgement.single_exclusions(snapshot, epoch.observations().len()) {
        let normalised = (fit.residual / row.sigma).widen() as f32;
        let square = (normalised * normalised).min(MOST_EXCLUDED);
        (sum, largest, count) = (sum + square, largest.max(square), count + 1);
    }
    let rest = Residuals { sse: snapshot.sse().widen() as f32, dof: snapshot.dof() as u32 };
    let dof = rest.dof + count.saturating_sub(1);
    let ratio = (without_fault(rest, snapshot) + sum - largest) / dof as f32;
    // An infinite or NaN ratio counts as the largest permitted one.
    let ratio = if ratio < MOST_RATIO { ratio } else { MOST_RATIO };
    let agrees = judgement.outcome == ExclusionOutcome::Isolated || judgement.is_covered;
    // Residuals far below their sigmas show less noise than is in use, whatever the share.
    let share = if dof > 1 && ratio < SMALL { 1.0 } else { receivers_share(snapshot, epoch, noise) };
    let worst = snapshot.statistics().worst.index.and_then(|row| epoch.observations().get(row));
    EpochResiduals {
        ratio,
        dof,
        share,
        noise,
        rest,
        excluded: if agrees { count as u8 } else { 0 },
        blamed: worst.map(|seen| seen.satellite),
    }
}

/// Returns the SSE in which the most that one fault explains, of a row or of a constellation, is
/// limited.
fn without_fault<T: Real, const N: usize>(rest: Residuals, snapshot: &Snapshot<'_, T, N>) -> f32 {
    let limited = |left: f32, unknowns: u32, most: f32| match rest.dof.checked_sub(unknowns) {
        Some(dof) if dof > 0 => left.max(0.0) * (1.0 + most / dof as f32),
        _ => rest.sse,
    };
    let one = rest.sse - snapshot.statistics().worst.largest.widen() as f32;
    let sse = rest.sse.min(limited(one, 1, MOST_ONE));
    // Residuals that the sigmas explain need no other explanation, and the search for one is long.
    if !(rest.excess(REST_QUANTILE) > 0.0) {
        return sse;
    }
    let left = constellation_shift::least_sse(snapshot).widen() as f32;
    sse.min(limited(left, constellation_shift::UNKNOWNS as u32, MOST_SHIFT))
}

/// Returns the share of the receiver's part in the variances in use, weighted by redundancy.
fn receivers_share<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    epoch: &EpochView<'_>,
    noise: f32,
) -> f32 {
    let (mut fixed, mut all) = (0.0_f32, 0.0_f32);
    for ((row, fit), part) in snapshot.rows().zip(epoch.receivers_parts()) {
        if row.weight > T::zero() {
            let redundancy = fit.redundancy.widen() as f32;
            fixed += redundancy * (1.0 - part) / (1.0 + (noise - 1.0) * part);
            all += redundancy;
        }
    }
    (1.0 - fixed / all).max(LEAST_SHARE)
}
