//! The core as a module on a microcontroller runs it: in single precision, for 48 satellites.
//!
//! Generic code is compiled where it is used, by the rules of that crate. What is called here instead is compiled with
//! this one: a firmware that is compiled for size, as its bytes to and from the wire may well be, has its integrity
//! compiled for speed nevertheless, and once. Each function is the generic one of its name, and no more.

#[cfg(feature = "stages")]
pub mod stages;

pub use crate::epoch::CAPACITY;

use crate::epoch::Epoch;
use crate::frame::Ecef;
use crate::integrity::raim::detection::threshold::Thresholds;
use crate::integrity::raim::hypotheses::time_tag::RangeRates;
use crate::integrity::raim::levels::Factors;
use crate::least_squares::{Snapshot, SnapshotError};
use crate::monitor::Search;
use crate::report::Report;
use crate::velocity::{RangeRate, Velocity, VelocityError};

/// [`crate::monitor::Monitor`] of this instance.
pub type Monitor = crate::monitor::Monitor<f32, CAPACITY>;

/// [`crate::monitor::Accepted`] of this instance.
pub type Accepted = crate::monitor::Accepted<f32>;

/// [`crate::monitor::Assessment`] of this instance.
pub type Assessment = crate::monitor::Assessment<CAPACITY>;

/// [`crate::monitor::Memory`] of this instance.
pub type Memory = crate::monitor::Memory<f32, CAPACITY>;

/// [`crate::least_squares::Workspace`] of this instance.
pub type Workspace = crate::least_squares::Workspace<f32, CAPACITY>;

/// [`Monitor::process`].
#[inline(never)]
pub fn process(monitor: &mut Monitor, epoch: &Epoch<CAPACITY>) -> Report<CAPACITY> {
    monitor.process(epoch)
}

/// [`Monitor::judge`].
#[inline(never)]
pub fn judge<'m>(
    monitor: &Monitor,
    epoch: &Epoch<CAPACITY>,
    start: Ecef,
    search: Search<'_>,
    rates: Option<&RangeRates<'_>>,
    memory: &'m mut Memory,
) -> &'m mut Assessment {
    monitor.judge(epoch, start, search, rates, memory)
}

/// [`Workspace::solve`].
///
/// # Errors
/// As there.
#[inline(never)]
pub fn solve(workspace: &mut Workspace) -> Result<Snapshot<'_, f32>, SnapshotError> {
    workspace.solve()
}

/// The position alone, from a start ([`Workspace::fix`]); `None` where there is none.
#[inline(never)]
pub fn position(workspace: &mut Workspace, epoch: &Epoch<CAPACITY>, start: Ecef) -> Option<Ecef> {
    Some(workspace.fix(epoch, start).ok()?.position())
}

/// [`crate::velocity::estimate`].
///
/// # Errors
/// As there.
#[inline(never)]
pub fn velocity(
    workspace: &mut Workspace,
    rates: &mut dyn Iterator<Item = RangeRate>,
    thresholds: &Thresholds<'_>,
    factors: &Factors<f32>,
) -> Result<Velocity, VelocityError> {
    crate::velocity::estimate(workspace, rates, thresholds, factors)
}
