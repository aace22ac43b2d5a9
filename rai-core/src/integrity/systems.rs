//! Systems that are left out as a whole: one that is found broken in this epoch, and those that are
//! kept out because of earlier epochs.
//!
//! The levels are those of the remaining satellites. They bound the effect of one more faulty
//! satellite among these, as after any other exclusion.

use heapless::Vec;

use super::by_residuals::without_aids;
use super::raim::detection::Detection;
use super::raim::detection::threshold::Thresholds;
use super::raim::hypotheses::broken_system::{self, BrokenSystem};
use super::raim::hypotheses::constellation_shift;
use super::raim::hypotheses::time_tag::{EpochRates, RangeRates};
use super::raim::isolation::exclusion::{Excluded, ExclusionOutcome};
use super::{Criteria, Judgement, WithoutAiding};
use crate::bit_set::{bit, count_of, members};
use crate::bounded::gather;
use crate::epoch::EpochView;
use crate::least_squares::equations::Row;
use crate::least_squares::{Excludable, RowFit, Snapshot};
use crate::numeric::real::Real;
use crate::report::MAX_EXCLUDED;

/// Leaves out the one system without which all others agree. Called if no exclusion of single
/// satellites explains a fault.
///
/// If there is no such system, judgement and solution do not change.
#[cold]
#[inline(never)]
pub(super) fn leave_out_broken<T: Real, const N: usize>(
    solution: &mut impl Excludable<T, N>,
    epoch: &EpochView<'_>,
    aids: &[usize],
    criteria: &Criteria<'_, T>,
    rates: Option<&RangeRates<'_>>,
    judgement: &mut Judgement<T>,
) {
    let before: Vec<usize, MAX_EXCLUDED> = gather(judgement.excluded.iter().map(|excluded| excluded.index));
    if !before.is_empty() && solution.take_back(&before).is_err() {
        return;
    }
    let found = broken_system::find(solution, epoch.observations().len(), &criteria.thresholds);
    let found = found.filter(|found| !is_of_time(solution, epoch, found, criteria, rates));
    let Some(found) = found.filter(|found| solution.leave_out_all(found.rows).is_ok()) else {
        // This cannot fail, because these rows were left out before.
        let _ = solution.set_aside(&before);
        return;
    };
    let test = criteria.test(solution.snapshot(), epoch.shared());
    let without_aiding = without_aids(solution, aids, epoch, criteria);
    let is_contradicted = test.is_err()
        || matches!(&without_aiding, WithoutAiding::Tested(test) if test.detection.fault())
        || constellation_shift::shows(solution.snapshot(), &criteria.thresholds);
    if is_contradicted {
        solution.take_back_all(found.rows);
        let _ = solution.set_aside(&before);
        return;
    }
    judgement.excluded.clear();
    judgement.outcome = ExclusionOutcome::Isolated;
    judgement.is_covered = false;
    (judgement.test, judgement.without_aiding) = (test, without_aiding);
    judgement.name_system(bit(found.constellation as usize) as u8, found.rows);
}

/// Returns true if a wrong time of all ranges explains the data as well.
fn is_of_time<T: Real, const N: usize>(
    solution: &impl Excludable<T, N>,
    epoch: &EpochView<'_>,
    found: &BrokenSystem<T>,
    criteria: &Criteria<'_, T>,
    rates: Option<&RangeRates<'_>>,
) -> bool {
    let rates = rates.and_then(|rates| EpochRates::of(epoch, rates));
    let gone = count_of(found.rows) as u32;
    rates.is_some_and(|rates| rates.rival(solution.snapshot(), gone, found.left, &criteria.thresholds))
}

/// Systems that are kept out of an epoch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct KeptOut {
    /// The systems, a bit for each id.
    systems: u8,
    /// Bit set of their rows.
    rows: u64,
    /// True if all satellites agree, those of these systems included.
    pub(crate) agrees: bool,
}

impl KeptOut {
    /// No system is kept out.
    pub(crate) const NONE: Self = Self { systems: 0, rows: 0, agrees: false };

    /// Leaves out the satellites of `systems`, a bit for each id.
    ///
    /// If the others determine no position, no satellite is left out.
    #[cold]
    #[inline(never)]
    pub(crate) fn of<T: Real, const N: usize>(
        solution: &mut impl Excludable<T, N>,
        epoch: &EpochView<'_>,
        systems: u8,
        thresholds: &Thresholds<'_>,
    ) -> Self {
        let satellites = epoch.observations().iter().enumerate();
        let mine = satellites.filter(|(_, seen)| systems >> (seen.satellite.constellation() as u8) & 1 != 0);
        let rows = mine.fold(0, |set, (index, _)| set | bit(index));
        if rows == 0 {
            return Self::NONE;
        }
        let agrees = Detection::passes(solution.snapshot(), thresholds);
        match solution.leave_out_all(rows) {
            Ok(()) => Self { systems, rows, agrees },
            Err(_) => Self::NONE,
        }
    }

    /// Lists the systems in a judgement of the others.
    pub(crate) fn describe<T: Real>(self, judgement: &mut Judgement<T>) {
        if self.rows != 0 {
            judgement.name_system(self.systems, self.rows);
        }
    }
}

impl<T: Real> Judgement<T> {
    /// Iterates over the satellites that were left out one by one, not with their system.
    ///
    /// `satellites` is the number of rows that are satellites.
    pub(crate) fn single_exclusions<'j, const N: usize>(
        &'j self,
        snapshot: &'j Snapshot<'_, T, N>,
        satellites: usize,
    ) -> impl Iterator<Item = (&'j Row<T>, &'j RowFit<T>)> {
        let excluded = self.excluded.iter().filter(move |excluded| excluded.index < satellites);
        let rows = excluded.filter_map(|excluded| snapshot.row(excluded.index));
        rows.filter(|(row, _)| row.clock.is_none_or(|system| self.lost_systems >> (system as u8) & 1 == 0))
    }

    /// Adds systems, a bit for each id, and as many of their rows as there is capacity for.
    fn name_system(&mut self, systems: u8, rows: u64) {
        self.lost_systems |= systems;
        for index in members(rows) {
            // A row that is left out has no w-test.
            let _ = self.excluded.push(Excluded { index, w_test: T::zero() });
        }
    }
}
