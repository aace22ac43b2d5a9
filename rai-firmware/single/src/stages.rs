//! The stages of this instance one by one, for measurements. They are compiled for speed, as in the
//! shipped image.
//!
//! Each function calls the generic one of its name.

use raim_core::epoch::Epoch;
use raim_core::internals::clock::{CoastingClock, Forecast, Observed};
use raim_core::internals::integrity::araim::{
    self, Allocation, AraimError, AraimJudgement, AraimScratch, Priors,
};
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::detection::threshold::policy::{
    NoThreshold, Policy, PolicyThreshold, ThresholdProblem,
};
use raim_core::internals::integrity::raim::isolation::baarda;
use raim_core::internals::integrity::raim::isolation::exclusion::Exclusion;
use raim_core::internals::integrity::raim::isolation::parity::{self, ParityFinding};
use raim_core::internals::integrity::raim::isolation::ransac::{self, Selection};
use raim_core::internals::integrity::raim::levels::{self, Slopes};
use raim_core::internals::least_squares::SnapshotError;
use raim_core::internals::least_squares::equations::Row;
use raim_core::monitor;
use raim_core::report::Report;

use crate::{CAPACITY, Snapshot};

/// Calls [`Snapshot::leave_out`].
///
/// # Errors
/// As [`Snapshot::leave_out`].
#[inline(never)]
pub fn leave_out(snapshot: &mut Snapshot<'_>, index: usize) -> Result<(), SnapshotError> {
    snapshot.leave_out(index)
}

/// Calls [`Snapshot::take_back`].
///
/// # Errors
/// As [`Snapshot::take_back`].
#[inline(never)]
pub fn take_back(snapshot: &mut Snapshot<'_>, index: usize) -> Result<(), SnapshotError> {
    snapshot.take_back(index)
}

/// Calls [`baarda::worst_two`].
#[inline(never)]
pub fn worst_two(snapshot: &Snapshot<'_>) -> Option<(usize, f32, f32)> {
    baarda::worst_two(snapshot)
}

/// Calls [`levels::largest_slopes`].
#[inline(never)]
pub fn largest_slopes(snapshot: &Snapshot<'_>) -> Slopes<f32> {
    levels::largest_slopes(snapshot)
}

/// Calls [`araim::judge_in`].
///
/// # Errors
/// As [`araim::judge_in`].
#[inline(never)]
pub fn separate(
    snapshot: &mut Snapshot<'_>,
    priors: &Priors<'_, f32>,
    allocation: &Allocation,
    room: &mut AraimScratch<f32, CAPACITY>,
) -> Result<AraimJudgement<f32>, AraimError> {
    araim::judge_in(snapshot, priors, allocation, room)
}

/// Calls [`parity::grouping`].
#[inline(never)]
pub fn grouping(
    snapshot: &Snapshot<'_>,
    thresholds: &Thresholds<'_>,
    limits: &parity::SearchLimits,
) -> ParityFinding<f32> {
    parity::grouping(snapshot, thresholds, limits)
}

/// Calls [`Selection::choose`].
#[inline(never)]
pub fn choose(rows: &[Row<f32>], work: usize) -> Selection<CAPACITY> {
    Selection::choose(rows, work)
}

/// Calls [`ransac::exclude`].
#[inline(never)]
pub fn exclude_by_consensus(
    snapshot: &mut Snapshot<'_>,
    selection: &Selection<CAPACITY>,
    thresholds: &Thresholds<'_>,
    limits: &ransac::ConsensusLimits<'_>,
) -> Exclusion<f32> {
    ransac::exclude(snapshot, selection, thresholds, limits)
}

/// Calls [`CoastingClock::observe`].
#[inline(never)]
pub fn observe(clock: &mut CoastingClock<f32>, time_s: f64, clock_m: f64, clock_sigma_m: f64) -> Observed {
    clock.observe(time_s, clock_m, clock_sigma_m)
}

/// Calls [`CoastingClock::forecast`].
#[inline(never)]
pub fn forecast(clock: &CoastingClock<f32>, time_s: f64) -> Option<Forecast> {
    clock.forecast(time_s)
}

/// Calls [`ThresholdProblem::threshold`].
///
/// # Errors
/// As [`ThresholdProblem::threshold`].
#[inline(never)]
pub fn threshold(demand: &ThresholdProblem<'_>, policy: Policy) -> Result<PolicyThreshold, NoThreshold> {
    demand.threshold::<f32>(policy)
}

/// Calls [`Monitor::process_in`](monitor::Monitor::process_in).
#[inline(never)]
pub fn process_in<'m>(
    monitor: &mut crate::Monitor,
    memory: &'m mut crate::MonitorMemory,
    epoch: &Epoch<CAPACITY>,
) -> &'m Report<CAPACITY> {
    monitor.process_in(memory, epoch)
}

/// Calls [`Monitor::process_in`](monitor::Monitor::process_in) for 16 satellites.
#[inline(never)]
pub fn process_sixteen_in<'m>(
    monitor: &mut monitor::Monitor<f32, 16>,
    memory: &'m mut monitor::MonitorMemory<f32, 16>,
    epoch: &Epoch<16>,
) -> &'m Report<16> {
    monitor.process_in(memory, epoch)
}
