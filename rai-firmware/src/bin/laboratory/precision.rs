//! The core in either precision: single as the shipped image has it ([`rai_core::single`]), double as compiled here.

use rai_core::epoch::Epoch;
use rai_core::integrity::araim::{self, Allocation, AraimError, AraimJudgement, AraimScratch, Priors};
use rai_core::integrity::raim::isolation::baarda;
use rai_core::integrity::raim::levels::{self, Slopes};
use rai_core::least_squares::{Snapshot, SnapshotError};
use rai_core::monitor::Monitor;
use rai_core::numeric::real::Real;
use rai_core::report::Report;
use rai_core::single::{self, CAPACITY, stages};

/// The stages that are measured in both precisions.
pub trait Precision: Real {
    /// [`Snapshot::leave_out`].
    fn leave_out(snapshot: &mut Snapshot<'_, Self>, index: usize) -> Result<(), SnapshotError>;
    /// [`Snapshot::take_back`].
    fn take_back(snapshot: &mut Snapshot<'_, Self>, index: usize) -> Result<(), SnapshotError>;
    /// [`baarda::worst_two`].
    fn worst_two(snapshot: &Snapshot<'_, Self>) -> Option<(usize, Self, Self)>;
    /// [`levels::largest_slopes`].
    fn largest_slopes(snapshot: &Snapshot<'_, Self>) -> Slopes<Self>;
    /// [`araim::judge_in`].
    fn separate(
        snapshot: &mut Snapshot<'_, Self>,
        priors: &Priors<'_, Self>,
        allocation: &Allocation,
        room: &mut AraimScratch<Self>,
    ) -> Result<AraimJudgement<Self>, AraimError>;
    /// [`Monitor::process`].
    fn process(monitor: &mut Monitor<Self, CAPACITY>, epoch: &Epoch<CAPACITY>) -> Report<CAPACITY>;
}

impl Precision for f32 {
    fn separate(
        snapshot: &mut Snapshot<'_, Self>,
        priors: &Priors<'_, Self>,
        allocation: &Allocation,
        room: &mut AraimScratch<Self>,
    ) -> Result<AraimJudgement<Self>, AraimError> {
        stages::separate(snapshot, priors, allocation, room)
    }

    fn leave_out(snapshot: &mut Snapshot<'_, Self>, index: usize) -> Result<(), SnapshotError> {
        stages::leave_out(snapshot, index)
    }

    fn take_back(snapshot: &mut Snapshot<'_, Self>, index: usize) -> Result<(), SnapshotError> {
        stages::take_back(snapshot, index)
    }

    fn worst_two(snapshot: &Snapshot<'_, Self>) -> Option<(usize, Self, Self)> {
        stages::worst_two(snapshot)
    }

    fn largest_slopes(snapshot: &Snapshot<'_, Self>) -> Slopes<Self> {
        stages::largest_slopes(snapshot)
    }

    fn process(monitor: &mut Monitor<Self, CAPACITY>, epoch: &Epoch<CAPACITY>) -> Report<CAPACITY> {
        single::process(monitor, epoch)
    }
}

impl Precision for f64 {
    fn separate(
        snapshot: &mut Snapshot<'_, Self>,
        priors: &Priors<'_, Self>,
        allocation: &Allocation,
        room: &mut AraimScratch<Self>,
    ) -> Result<AraimJudgement<Self>, AraimError> {
        araim::judge_in(snapshot, priors, allocation, room)
    }

    fn leave_out(snapshot: &mut Snapshot<'_, Self>, index: usize) -> Result<(), SnapshotError> {
        snapshot.leave_out(index)
    }

    fn take_back(snapshot: &mut Snapshot<'_, Self>, index: usize) -> Result<(), SnapshotError> {
        snapshot.take_back(index)
    }

    fn worst_two(snapshot: &Snapshot<'_, Self>) -> Option<(usize, Self, Self)> {
        baarda::worst_two(snapshot)
    }

    fn largest_slopes(snapshot: &Snapshot<'_, Self>) -> Slopes<Self> {
        levels::largest_slopes(snapshot)
    }

    fn process(monitor: &mut Monitor<Self, CAPACITY>, epoch: &Epoch<CAPACITY>) -> Report<CAPACITY> {
        monitor.process(epoch)
    }
}
