//! The core as a module on a microcontroller runs it: in single precision, for 48 satellites.
//!
//! Generic code is compiled where it is used, by the rules of that crate. What is called here instead is compiled with
//! this one: a firmware that is compiled for size, as its bytes to and from the wire may well be, has its integrity
//! compiled for speed nevertheless, and once. Each function is the generic one of its name, and no more.

use crate::clock::{CoastingClock, Forecast, Uptake};
use crate::epoch::{Aided, Epoch};
use crate::equations::LinearEpoch;
use crate::fix::Fix;
use crate::frame::Ecef;
use crate::integrity::residuals::baarda;
use crate::integrity::residuals::exclusion::Exclusion;
use crate::integrity::residuals::levels::{self, Factors, Slopes};
use crate::integrity::residuals::parity::{self, Finding};
use crate::integrity::residuals::ransac::{self, Selection};
use crate::integrity::residuals::threshold::Thresholds;
use crate::integrity::residuals::threshold::policy::{Demand, NoThreshold, Policy, PolicyThreshold};
use crate::integrity::separation::{self, Allocation, Judged, Priors, SeparationError};
use crate::monitor::Search;
use crate::report::Report;
use crate::snapshot::SnapshotError;
use crate::velocity::{RangeRate, Velocity, VelocityError};

/// Most satellites in one epoch: more than three systems show at once anywhere on earth, or fewer where memory is scarce.
pub const CAPACITY: usize = if cfg!(feature = "satellites-16") {
    16
} else if cfg!(feature = "satellites-32") {
    32
} else {
    48
};

/// [`crate::monitor::Monitor`] of this instance.
pub type Monitor = crate::monitor::Monitor<f32, CAPACITY>;

/// [`crate::monitor::Assessment`] of this instance.
pub type Assessment = crate::monitor::Assessment<CAPACITY>;

/// [`crate::integrity::residuals::ransac::Subsets`] of this instance.
pub type Subsets = ransac::Subsets<CAPACITY>;

/// [`crate::snapshot::Snapshot`] of this instance.
pub type Snapshot = crate::snapshot::Snapshot<f32, CAPACITY>;

/// [`Monitor::process`].
#[inline(never)]
pub fn process(monitor: &mut Monitor, epoch: &Epoch<CAPACITY>) -> Report<CAPACITY> {
    monitor.process(epoch)
}

/// [`Monitor::judge`].
#[inline(never)]
pub fn judge(
    monitor: &Monitor,
    epoch: &Epoch<CAPACITY>,
    start: Ecef,
    search: Search<'_>,
    subsets: &mut Subsets,
) -> Assessment {
    monitor.judge(epoch, start, search, subsets)
}

/// The position alone, from a start ([`crate::fix::Workspace::fix`]); `None` where there is none.
#[inline(never)]
pub fn position(epoch: &Epoch<CAPACITY>, start: Ecef) -> Option<Ecef> {
    let mut workspace = Snapshot::unsolved();
    Some(Fix::about(&mut workspace, Aided::alone(epoch), start).ok()?.position())
}

/// [`Snapshot::solve`].
///
/// # Errors
/// As there.
#[inline(never)]
pub fn solve(epoch: LinearEpoch<f32, CAPACITY>) -> Result<Snapshot, SnapshotError> {
    Snapshot::solve(epoch)
}

/// [`Snapshot::leave_out`].
///
/// # Errors
/// As there.
#[inline(never)]
pub fn leave_out(snapshot: &mut Snapshot, index: usize) -> Result<(), SnapshotError> {
    snapshot.leave_out(index)
}

/// [`Snapshot::take_back`].
///
/// # Errors
/// As there.
#[inline(never)]
pub fn take_back(snapshot: &mut Snapshot, index: usize) -> Result<(), SnapshotError> {
    snapshot.take_back(index)
}

/// [`baarda::worst_two`].
#[inline(never)]
pub fn worst_two(snapshot: &Snapshot) -> Option<(usize, f32, f32)> {
    baarda::worst_two(snapshot)
}

/// [`levels::largest_slopes`].
#[inline(never)]
pub fn largest_slopes(snapshot: &Snapshot) -> Slopes<f32> {
    levels::largest_slopes(snapshot)
}

/// [`separation::judge`].
///
/// # Errors
/// As there.
#[inline(never)]
pub fn separate(
    snapshot: &mut Snapshot,
    priors: &Priors<'_, f32>,
    allocation: &Allocation,
) -> Result<Judged<f32>, SeparationError> {
    separation::judge(snapshot, priors, allocation)
}

/// [`parity::grouping`].
#[inline(never)]
pub fn grouping(
    snapshot: &Snapshot,
    thresholds: &Thresholds<'_>,
    limits: &parity::SearchLimits,
) -> Finding<f32> {
    parity::grouping(snapshot, thresholds, limits)
}

/// [`Selection::choose`].
#[inline(never)]
pub fn choose(epoch: &LinearEpoch<f32, CAPACITY>, work: usize) -> Selection<CAPACITY> {
    Selection::choose(epoch, work)
}

/// [`ransac::exclude`].
#[inline(never)]
pub fn exclude_by_consensus(
    snapshot: &mut Snapshot,
    selection: &Selection<CAPACITY>,
    thresholds: &Thresholds<'_>,
    limits: &ransac::ConsensusLimits<'_>,
) -> Exclusion<f32> {
    ransac::exclude(snapshot, selection, thresholds, limits)
}

/// [`CoastingClock::observe`].
#[inline(never)]
pub fn observe(clock: &mut CoastingClock<f32>, time_s: f64, clock_m: f64, clock_sigma_m: f64) -> Uptake {
    clock.observe(time_s, clock_m, clock_sigma_m)
}

/// [`CoastingClock::forecast`].
#[inline(never)]
pub fn forecast(clock: &CoastingClock<f32>, time_s: f64) -> Option<Forecast> {
    clock.forecast(time_s)
}

/// [`Demand::threshold`].
///
/// # Errors
/// As there.
#[inline(never)]
pub fn threshold(demand: &Demand<'_>, policy: Policy) -> Result<PolicyThreshold, NoThreshold> {
    demand.threshold::<f32>(policy)
}

/// [`crate::velocity::estimate`].
///
/// # Errors
/// As there.
#[inline(never)]
pub fn velocity(
    rates: &mut dyn Iterator<Item = RangeRate>,
    thresholds: &Thresholds<'_>,
    factors: &Factors,
) -> Result<Velocity, VelocityError> {
    crate::velocity::estimate::<f32, CAPACITY>(rates, thresholds, factors)
}
