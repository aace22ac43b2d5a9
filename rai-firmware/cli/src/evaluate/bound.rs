//! Protection levels `BOUND`, beside those of the papers in the least-squares part, and exclusion
//! levels.

use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::exclusion_levels::exclusion_levels;
use raim_core::internals::integrity::raim::levels::{KFactors, LevelInputs, Levels};
use raim_core::internals::least_squares::Snapshot;
use raim_core::internals::numeric::probability::Probability;
use raim_core::internals::numeric::real::Real;
use serde::Serialize;

use super::line::{self, Line};
use super::number::Number;

/// Fault-free risk of the published vectors.
const FAULT_FREE: f64 = 1e-7;

/// Levels under the classic threshold, with all rows.
#[derive(Serialize)]
pub(super) struct Bound {
    hpl: Number,
    vpl: Number,
    /// Exclusion levels; `null` if a row could not be excluded.
    hel: Option<Number>,
    vel: Option<Number>,
}

impl Bound {
    /// Returns the core's levels of a snapshot with redundancy.
    ///
    /// The error names the value that the tables do not cover.
    pub(super) fn of<T: Real>(
        line: &Line,
        snapshot: &mut Snapshot<'_, T>,
        thresholds: &Thresholds<'_>,
    ) -> Result<Self, String> {
        let dof = snapshot.dof();
        let lambda =
            thresholds.lambda(dof).ok_or_else(|| format!("{dof} degrees of freedom: beyond the tables"))?;
        let (_, missed_detection) = line.probabilities()?;
        let fault_free: Probability = line::probability("pff", FAULT_FREE)?;
        let factors = KFactors::new(missed_detection, fault_free);
        let levels = LevelInputs::of(snapshot, Levels::Bound, &factors).protect(lambda);
        let excluding = exclusion_levels(snapshot, thresholds, Levels::Bound, &factors);
        Ok(Self {
            hpl: levels.hpl_m.into(),
            vpl: levels.vpl_m.into(),
            hel: excluding.map(|levels| levels.hpl_m.into()),
            vel: excluding.map(|levels| levels.vpl_m.into()),
        })
    }
}
