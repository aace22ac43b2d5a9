//! The subsets of the last epoch that needed them, kept while the same satellites are visible.

use heapless::Vec;

use super::{MAX_WORK, Selection};
use crate::bounded::gather;
use crate::epoch::Epoch;
use crate::equations::LinearEpoch;
use crate::numeric::real::Real;
use crate::satellite::SatelliteId;

/// Disjoint subsets of an epoch's satellites, chosen when they are first asked for.
///
/// Kept by whoever judges, so that judging changes nothing else.
#[derive(Clone, Debug, Default)]
pub struct Subsets<const N: usize> {
    satellites: Vec<SatelliteId, N>,
    selection: Selection<N>,
}

impl<const N: usize> Subsets<N> {
    /// Of no satellites yet.
    pub const fn new() -> Self {
        Self { satellites: Vec::new(), selection: Selection::none() }
    }

    /// The subsets of an epoch: those known, if they are of the same satellites.
    #[inline(never)]
    pub fn of<T: Real>(&mut self, epoch: &Epoch<N>, equations: &LinearEpoch<T, N>) -> &Selection<N> {
        let satellites = || epoch.observations().iter().map(|observation| observation.satellite);
        let known = self.selection.rows() == equations.rows().len()
            && self.satellites.iter().copied().eq(satellites());
        if !known {
            self.satellites = gather(satellites());
            self.selection = Selection::choose(equations, MAX_WORK);
        }
        &self.selection
    }
}
