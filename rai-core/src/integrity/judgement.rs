//! The result of a method for one epoch.

use heapless::Vec;

use super::raim::detection::Detection;
use super::raim::detection::threshold::policy::NoThreshold;
use super::raim::isolation::exclusion::{Excluded, ExclusionOutcome};
use crate::numeric::real::Real;
use crate::report::{AraimReport, MAX_EXCLUDED, ProtectionLevels};

/// The global test of a snapshot, and the protection levels under its threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Test<T> {
    /// The test.
    pub detection: Detection<T>,
    /// Protection levels.
    pub levels: ProtectionLevels,
}

/// The test without the clock forecast and the known height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WithoutAiding<T> {
    /// Neither of them takes part in the solution.
    Always,
    /// Without them the satellites cannot be tested.
    Untested,
    /// The test of the satellites alone.
    Tested(Test<T>),
}

/// Result of a method for one epoch.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement<T> {
    /// Result of the exclusion.
    pub outcome: ExclusionOutcome,
    /// Rows left out, in the order of exclusion.
    pub excluded: Vec<Excluded<T>, MAX_EXCLUDED>,
    /// Test of the remaining rows, or the reason why there is none.
    pub test: Result<Test<T>, NoThreshold>,
    /// Test without the clock forecast and the known height.
    pub without_aiding: WithoutAiding<T>,
    /// True if the levels hold for every explanation of an ambiguous fault.
    pub is_covered: bool,
    /// Constellations left out as a whole, a bit for each id.
    pub lost_systems: u8,
    /// True if faulty satellites were searched for.
    pub searched: bool,
    /// Additional results of [`Method::Araim`](super::Method::Araim).
    pub araim: Option<AraimReport>,
}

impl<T: Real> Judgement<T> {
    /// Returns the protection levels: the larger of those with and without the aiding rows.
    pub fn levels(&self) -> Option<ProtectionLevels> {
        let levels = self.test.ok()?.levels;
        Some(match &self.without_aiding {
            WithoutAiding::Tested(alone) => levels.or_larger(&alone.levels),
            WithoutAiding::Always | WithoutAiding::Untested => levels,
        })
    }

    /// Multiplies every protection level by a factor.
    pub(crate) fn scale_levels(&mut self, factor: f64) {
        if let Ok(test) = &mut self.test {
            test.levels = test.levels.times(factor);
        }
        if let WithoutAiding::Tested(alone) = &mut self.without_aiding {
            alone.levels = alone.levels.times(factor);
        }
    }
}
