//! The report of a judged fix: the position and its satellites in plain numbers.

use heapless::Vec;

use crate::bounded::gather;
use crate::epoch::EpochView;
use crate::frame::LocalFrame;
use crate::integrity::raim::isolation::baarda;
use crate::integrity::{Judgement, Test, WithoutAiding, height_row};
use crate::least_squares::Snapshot;
use crate::least_squares::fix::Fix;
use crate::numeric::real::Real;
use crate::numeric::space::{dot, upper_triangle};
use crate::numeric::sqrt_f64;
use crate::report::{
    AraimReport, HeightReport, MAX_EXCLUDED, Report, Solution, Suspect, TestStatistic, Verdict,
};
use crate::satellite::Constellation;
use crate::weighting::residuals::Residuals;

/// Returns the residuals of the satellites used, weighted by the sigmas of the epoch.
pub(super) fn residuals<T: Real, const N: usize>(
    snapshot: &Snapshot<'_, T, N>,
    epoch: &EpochView<'_>,
) -> Residuals {
    let takes_part = |weight: T| weight > T::zero();
    let used = snapshot.rows().zip(epoch.observations()).filter(|((row, _), _)| takes_part(row.weight));
    let sse = used.fold(0.0, |sum, ((_, fit), observation)| {
        // Single precision is more than accurate enough, and a tenth of the work.
        let residual = fit.residual.widen() as f32 / observation.sigma_m as f32;
        sum + residual * residual
    });
    let aiding = snapshot.rows().skip(epoch.observations().len());
    let aided = aiding.filter(|(row, _)| takes_part(row.weight)).count();
    Residuals { sse, dof: snapshot.dof().saturating_sub(aided) as u32 }
}

/// Returns the excluded satellites with their biases in the final solution.
///
/// The residual of a left-out row is its range minus the prediction from the other rows, which
/// estimates the bias. A left-out aiding row belongs to no satellite and is not listed.
pub(super) fn suspects<T: Real, const N: usize>(
    judgement: &Judgement<T>,
    fix: &Fix<'_, T, N>,
    epoch: &EpochView<'_>,
) -> Vec<Suspect, MAX_EXCLUDED> {
    let listed = judgement.excluded.iter().filter_map(|excluded| {
        let observation = epoch.observations().get(excluded.index)?;
        let (row, fit) = fix.snapshot().row(excluded.index)?;
        let predicted_m2 = dot(&fit.centred, &fit.gain).widen();
        Some(Suspect {
            satellite: observation.satellite,
            w_test: excluded.w_test.widen(),
            bias_m: fit.residual.widen(),
            bias_sigma_m: sqrt_f64(row.sigma.widen() * row.sigma.widen() + predicted_m2.max(0.0)),
        })
    });
    gather(listed)
}

/// Returns the comparison of an epoch's known height with its satellites.
pub(super) fn known_height<T: Real, const N: usize>(
    judgement: &Judgement<T>,
    snapshot: &Snapshot<'_, T, N>,
    epoch: &EpochView<'_>,
) -> Option<HeightReport> {
    let (row, fit) = snapshot.row(height_row(snapshot, epoch)?)?;
    let is_used = row.weight > T::zero();
    // The residual of a left-out row is already its difference to the prediction from the others.
    let share = if is_used { fit.redundancy } else { T::one() };
    let difference = if share >= T::UNTESTABLE { fit.residual / share } else { T::zero() };
    let is_needed = matches!(judgement.without_aiding, WithoutAiding::Untested);
    Some(HeightReport { is_used, is_needed, difference_m: difference.widen() })
}

/// Writes the report on a position. The excluded satellites and the sigma check are already in it.
#[inline(never)]
pub(super) fn describe<T: Real, const N: usize>(
    fix: &Fix<'_, T, N>,
    epoch: &EpochView<'_>,
    verdict: Verdict,
    judgement: &Judgement<T>,
    report: &mut Report<N>,
) {
    let test = judgement.test.as_ref().ok();
    let used = fix.snapshot().rows().zip(epoch.observations()).filter(|((row, _), _)| row.weight > T::zero());
    report.used.clear();
    let mut squares = T::zero();
    for ((_, fit), observation) in used {
        // Never full, because both have the capacity `N`.
        let _ = report.used.push(observation.satellite);
        squares += fit.residual * fit.residual;
    }
    report.verdict = verdict;
    report.solution = Some(solution(fix));
    report.test = test.map(|test| statistic(test, judgement.araim.as_ref()));
    report.protection = judgement.levels();
    report.suspect = test.and_then(|_| suspect(fix.snapshot(), epoch));
    report.residual_rms_m = sqrt_f64(squares.widen() / report.used.len().max(1) as f64);
    report.tracked = epoch.observations().len() as u8;
    report.araim = judgement.araim;
}

/// Returns the global test; under ARAIM the largest of its tests compared with 1, unless the global
/// test alone fails.
fn statistic<T: Real>(test: &Test<T>, araim: Option<&AraimReport>) -> TestStatistic {
    let global = test.detection.statistic();
    match araim.filter(|araim| araim.ratio >= 1.0 || !test.detection.fault()) {
        Some(araim) => TestStatistic { statistic: araim.ratio, threshold: 1.0, ..global },
        None => global,
    }
}

fn suspect<T: Real, const N: usize>(snapshot: &Snapshot<'_, T, N>, epoch: &EpochView<'_>) -> Option<Suspect> {
    let (index, _, _) = baarda::worst_two(snapshot)?;
    let observation = epoch.observations().get(index)?;
    let (row, fit) = snapshot.row(index)?;
    if fit.redundancy < T::UNTESTABLE {
        return None;
    }
    Some(Suspect {
        satellite: observation.satellite,
        w_test: fit.w_test().widen(),
        bias_m: (fit.residual / fit.redundancy).widen(),
        bias_sigma_m: (row.sigma / fit.redundancy.sqrt_approx()).widen(),
    })
}

fn solution<T: Real, const N: usize>(fix: &Fix<'_, T, N>) -> Solution {
    let snapshot = fix.snapshot();
    let position = fix.position();
    let (hdop, vdop) = snapshot.dilutions();
    Solution {
        position,
        geodetic: LocalFrame::at(position).geodetic(),
        covariance_m2: upper_triangle(snapshot.covariance()),
        clocks_m: Constellation::ALL.map(|constellation| snapshot.clock_m(constellation)),
        hdop: hdop.widen(),
        vdop: vdop.widen(),
    }
}
