//! The core as an image runs it: in single precision, for as many satellites as its memory holds.
//!
//! Generic code is compiled in the crate that uses it, with that crate's optimisation. These
//! functions are compiled with this crate instead, so that a firmware that is compiled for size has
//! its integrity compiled for speed, and once. Each function calls the generic one of its name.
//!
//! | feature | default | effect |
//! |---|---|---|
//! | `satellites-32`, `satellites-48` | no | at most 32 or 48 satellites in an epoch; without both 16, in less memory |
//! | `stages` | no | the stages one by one, for measurements |
#![no_std]
#![forbid(unsafe_code)]
#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[cfg(feature = "stages")]
pub mod stages;

use raim_core::epoch::Epoch;
use raim_core::frame::Ecef;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::hypotheses::time_tag::RangeRates;
use raim_core::internals::integrity::raim::levels::KFactors;
use raim_core::internals::least_squares::SnapshotError;
use raim_core::internals::velocity::{self, RangeRate, VelocityError};
use raim_core::internals::weighting::adaptation::Residuals;
use raim_core::monitor::Search;
use raim_core::report::{ProtectionLevels, Report};

/// Most satellites in one epoch: 48, more than three systems show at once anywhere on earth, or
/// fewer without the feature `satellites-48`.
pub const CAPACITY: usize = if cfg!(feature = "satellites-48") {
    48
} else if cfg!(feature = "satellites-32") {
    32
} else {
    16
};

/// [`raim_core::monitor::Monitor`] of this instance.
pub type Monitor = raim_core::monitor::Monitor<f32, CAPACITY>;

/// [`raim_core::monitor::ValidatedRequirements`] of this instance.
pub type ValidatedRequirements = raim_core::monitor::ValidatedRequirements<f32, CAPACITY>;

/// [`raim_core::monitor::EpochOutcome`] of this instance.
pub type EpochOutcome = raim_core::monitor::EpochOutcome<CAPACITY>;

/// [`raim_core::monitor::MonitorMemory`] of this instance.
pub type MonitorMemory = raim_core::monitor::MonitorMemory<f32, CAPACITY>;

/// [`raim_core::internals::least_squares::Snapshot`] of this instance.
pub type Snapshot<'w> = raim_core::internals::least_squares::Snapshot<'w, f32, CAPACITY>;

/// [`raim_core::internals::least_squares::Workspace`] of this instance.
pub type Workspace = raim_core::internals::least_squares::Workspace<f32, CAPACITY>;

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
    memory: &'m mut MonitorMemory,
) -> &'m mut EpochOutcome {
    monitor.judge(epoch, start, search, rates, memory)
}

/// Calls [`Monitor::levels`].
#[inline(never)]
pub fn levels(
    monitor: &Monitor,
    epoch: &Epoch<CAPACITY>,
    start: Ecef,
    noise: f32,
    memory: &mut MonitorMemory,
) -> Option<ProtectionLevels> {
    monitor.levels(epoch, start, noise, memory)
}

/// Calls [`Monitor::fault_free`].
#[inline(never)]
pub fn fault_free(
    monitor: &Monitor,
    epoch: &Epoch<CAPACITY>,
    start: Ecef,
    noise: f32,
    memory: &mut MonitorMemory,
) -> Option<(ProtectionLevels, Option<Residuals>)> {
    monitor.fault_free(epoch, start, noise, memory)
}

/// Calls [`Workspace::solve`].
///
/// # Errors
/// As [`Workspace::solve`].
#[inline(never)]
pub fn solve(workspace: &mut Workspace) -> Result<Snapshot<'_>, SnapshotError> {
    workspace.solve()
}

/// Returns the position alone, from a start ([`Workspace::fix`]), or `None`.
#[inline(never)]
pub fn position(workspace: &mut Workspace, epoch: &Epoch<CAPACITY>, start: Ecef) -> Option<Ecef> {
    Some(workspace.fix(epoch, start).ok()?.position())
}

/// Calls [`raim_core::internals::velocity::estimate`].
///
/// # Errors
/// As [`raim_core::internals::velocity::estimate`].
#[inline(never)]
pub fn velocity(
    workspace: &mut Workspace,
    rates: &mut dyn Iterator<Item = RangeRate<f32>>,
    thresholds: &Thresholds<'_>,
    factors: &KFactors<f32>,
    shown_m_s: &mut f32,
) -> Result<velocity::Velocity, VelocityError> {
    velocity::estimate(workspace, rates, thresholds, factors, shown_m_s)
}

/// The example of the readme.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
