//! The subsets of the last epoch that needed them, stored as long as the same satellites are
//! visible.

use heapless::Vec;

use super::{MAX_WORK, Selection};
use crate::bounded::gather;
use crate::epoch::EpochView;
use crate::least_squares::equations::{MAX_ROWS, Row};
use crate::numeric::real::Real;
use crate::satellite::SatelliteId;

/// Disjoint subsets of an epoch's satellites, chosen at the first use.
///
/// The caller of [`crate::integrity::judge`] owns them, so that it has no other side effect.
#[derive(Clone, Debug, Default)]
pub struct Subsets<const N: usize = MAX_ROWS> {
    satellites: Vec<SatelliteId, N>,
    selection: Selection<N>,
}

impl<const N: usize> Subsets<N> {
    /// Returns subsets without satellites.
    pub const fn new() -> Self {
        Self { satellites: Vec::new(), selection: Selection::none() }
    }

    /// Returns the subsets of an epoch: the stored ones if the satellites are the same.
    #[inline(never)]
    pub fn of<T: Real>(&mut self, epoch: &EpochView<'_>, rows: &[Row<T>]) -> &Selection<N> {
        let satellites = || epoch.observations().iter().map(|observation| observation.satellite);
        if !self.satellites.iter().copied().eq(satellites()) {
            self.satellites = gather(satellites());
            // Without the aiding rows at the end, which are not in every epoch.
            let of_satellites = rows.get(..self.satellites.len()).unwrap_or(rows);
            self.selection.deal(of_satellites, MAX_WORK);
        }
        &self.selection
    }
}
