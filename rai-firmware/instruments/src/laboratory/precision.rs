//! The core in either precision: single as in the shipped image ([`raim_single`]), double as
//! compiled here.

use raim_core::epoch::Epoch;
use raim_core::internals::integrity::araim::{
    self, Allocation, AraimError, AraimJudgement, AraimScratch, Priors,
};
use raim_core::internals::integrity::raim::isolation::baarda;
use raim_core::internals::integrity::raim::levels::{self, Slopes};
use raim_core::internals::least_squares::{Snapshot, SnapshotError};
use raim_core::internals::numeric::real::Real;
use raim_core::monitor::Monitor;
use raim_core::report::Report;
use raim_single::{CAPACITY, stages};

/// Stages that are measured in both precisions.
pub trait Precision: Real {
    /// Calls [`Snapshot::leave_out`].
    fn leave_out(snapshot: &mut Snapshot<'_, Self, CAPACITY>, index: usize) -> Result<(), SnapshotError>;
    /// Calls [`Snapshot::take_back`].
    fn take_back(snapshot: &mut Snapshot<'_, Self, CAPACITY>, index: usize) -> Result<(), SnapshotError>;
    /// Calls [`baarda::worst_two`].
    fn worst_two(snapshot: &Snapshot<'_, Self, CAPACITY>) -> Option<(usize, Self, Self)>;
    /// Calls [`levels::largest_slopes`].
    fn largest_slopes(snapshot: &Snapshot<'_, Self, CAPACITY>) -> Slopes<Self>;
    /// Calls [`araim::judge_in`].
    fn separate(
        snapshot: &mut Snapshot<'_, Self, CAPACITY>,
        priors: &Priors<'_, Self>,
        allocation: &Allocation,
        room: &mut AraimScratch<Self, CAPACITY>,
    ) -> Result<AraimJudgement<Self>, AraimError>;
    /// Calls [`Monitor::process`].
    fn process(monitor: &mut Monitor<Self, CAPACITY>, epoch: &Epoch<CAPACITY>) -> Report<CAPACITY>;
}

impl Precision for f32 {
    fn separate(
        snapshot: &mut Snapshot<'_, Self, CAPACITY>,
        priors: &Priors<'_, Self>,
        allocation: &Allocation,
        room: &mut AraimScratch<Self, CAPACITY>,
    ) -> Result<AraimJudgement<Self>, AraimError> {
        stages::separate(snapshot, priors, allocation, room)
    }

    fn leave_out(snapshot: &mut Snapshot<'_, Self, CAPACITY>, index: usize) -> Result<(), SnapshotError> {
        stages::leave_out(snapshot, index)
    }

    fn take_back(snapshot: &mut Snapshot<'_, Self, CAPACITY>, index: usize) -> Result<(), SnapshotError> {
        stages::take_back(snapshot, index)
    }

    fn worst_two(snapshot: &Snapshot<'_, Self, CAPACITY>) -> Option<(usize, Self, Self)> {
        stages::worst_two(snapshot)
    }

    fn largest_slopes(snapshot: &Snapshot<'_, Self, CAPACITY>) -> Slopes<Self> {
        stages::largest_slopes(snapshot)
    }

    fn process(monitor: &mut Monitor<Self, CAPACITY>, epoch: &Epoch<CAPACITY>) -> Report<CAPACITY> {
        raim_single::process(monitor, epoch)
    }
}

impl Precision for f64 {
    fn separate(
        snapshot: &mut Snapshot<'_, Self, CAPACITY>,
        priors: &Priors<'_, Self>,
        allocation: &Allocation,
        room: &mut AraimScratch<Self, CAPACITY>,
    ) -> Result<AraimJudgement<Self>, AraimError> {
        araim::judge_in(snapshot, priors, allocation, room)
    }

    fn leave_out(snapshot: &mut Snapshot<'_, Self, CAPACITY>, index: usize) -> Result<(), SnapshotError> {
        snapshot.leave_out(index)
    }

    fn take_back(snapshot: &mut Snapshot<'_, Self, CAPACITY>, index: usize) -> Result<(), SnapshotError> {
        snapshot.take_back(index)
    }

    fn worst_two(snapshot: &Snapshot<'_, Self, CAPACITY>) -> Option<(usize, Self, Self)> {
        baarda::worst_two(snapshot)
    }

    fn largest_slopes(snapshot: &Snapshot<'_, Self, CAPACITY>) -> Slopes<Self> {
        levels::largest_slopes(snapshot)
    }

    fn process(monitor: &mut Monitor<Self, CAPACITY>, epoch: &Epoch<CAPACITY>) -> Report<CAPACITY> {
        monitor.process(epoch)
    }
}
