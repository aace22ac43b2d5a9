//! The subsets of the last epoch that needed them, kept while the same satellites are visible.

use heapless::Vec;

use super::{MAX_WORK, Selection};
use crate::bounded::gather;
use crate::epoch::EpochView;
use crate::least_squares::equations::{MAX_ROWS, Row};
use crate::numeric::real::Real;
use crate::satellite::SatelliteId;

/// Disjoint subsets of an epoch's satellites, chosen when they are first asked for.
///
/// Kept by whoever judges, so that judging changes nothing else.
#[derive(Clone, Debug, Default)]
pub struct Subsets {
    satellites: Vec<SatelliteId, MAX_ROWS>,
    selection: Selection,
}

impl Subsets {
    /// Of no satellites yet.
    pub const fn new() -> Self {
        Self { satellites: Vec::new(), selection: Selection::none() }
    }

    /// The subsets of an epoch: those known, if they are of the same satellites.
    #[inline(never)]
    pub fn of<T: Real>(&mut self, epoch: &EpochView<'_>, rows: &[Row<T>]) -> &Selection {
        let satellites = || epoch.observations().iter().map(|observation| observation.satellite);
        if !self.satellites.iter().copied().eq(satellites()) {
            self.satellites = gather(satellites());
            // Without the aiding rows behind them, which come and go.
            let of_satellites = rows.get(..self.satellites.len()).unwrap_or(rows);
            self.selection.deal(of_satellites, MAX_WORK);
        }
        &self.selection
    }
}
