//! The instance of the core for a microcontroller: in single precision, for up to 48 satellites.
//!
//! Generic code is compiled in the crate that uses it, with that crate's optimisation. These
//! functions are compiled with this crate instead. The integrity part of a firmware that is
//! compiled for size is thus compiled for speed, and only once. Each function calls the generic one
//! of its name.

#[cfg(feature = "stages")]
pub mod stages;

pub use crate::bounded::CAPACITY;

use crate::epoch::Epoch;
use crate::frame::Ecef;
use crate::integrity::raim::detection::threshold::Thresholds;
use crate::integrity::raim::hypotheses::time_tag::RangeRates;
use crate::integrity::raim::levels::KFactors;
use crate::least_squares::{Snapshot, SnapshotError};
use crate::monitor::Search;
use crate::report::Report;
use crate::velocity::{RangeRate, Velocity, VelocityError};

/// [`crate::monitor::Monitor`] of this instance.
pub type Monitor = crate::monitor::Monitor<f32, CAPACITY>;

/// [`crate::monitor::ValidatedRequirements`] of this instance.
pub type ValidatedRequirements = crate::monitor::ValidatedRequirements<f32>;

/// [`crate::monitor::EpochOutcome`] of this instance.
pub type EpochOutcome = crate::monitor::EpochOutcome<CAPACITY>;

/// [`crate::monitor::MonitorWorkspace`] of this instance.
pub type MonitorWorkspace = crate::monitor::MonitorWorkspace<f32, CAPACITY>;

/// [`crate::least_squares::Workspace`] of this instance.
pub type Workspace = crate::least_squares::Workspace<f32, CAPACITY>;

/// Calls [`Monitor::process`].
#[inline(never)]
pub fn process(monitor: &mut Monitor, epoch: &Epoch<CAPACITY>) -> Report<CAPACITY> {
    monitor.process(epoch)
}

/// Calls [`Monitor::judge`].
#[inline(never)]
pub fn judge<'m>(
    monitor: &Monitor,
    epoch: &Epoch<CAPACITY>,
    start: Ecef,
    search: Search<'_>,
    rates: Option<&RangeRates<'_>>,
    memory: &'m mut MonitorWorkspace,
) -> &'m mut EpochOutcome {
    monitor.judge_about(epoch, start, search, rates, memory)
}

/// Calls [`Workspace::solve`].
///
/// # Errors
/// As [`Workspace::solve`].
#[inline(never)]
pub fn solve(workspace: &mut Workspace) -> Result<Snapshot<'_, f32>, SnapshotError> {
    workspace.solve()
}

/// Returns the position of [`Workspace::fix`], or `None` if there is none.
#[inline(never)]
pub fn position(workspace: &mut Workspace, epoch: &Epoch<CAPACITY>, start: Ecef) -> Option<Ecef> {
    Some(workspace.fix(epoch, start).ok()?.position())
}

/// Calls [`crate::velocity::estimate`].
///
/// # Errors
/// As [`crate::velocity::estimate`].
#[inline(never)]
pub fn velocity(
    workspace: &mut Workspace,
    rates: &mut dyn Iterator<Item = RangeRate<f32>>,
    thresholds: &Thresholds<'_>,
    factors: &KFactors<f32>,
) -> Result<Velocity, VelocityError> {
    crate::velocity::estimate(workspace, rates, thresholds, factors)
}
