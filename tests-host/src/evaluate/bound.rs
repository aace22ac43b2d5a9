//! The protection levels that bound, beside the papers' of the least-squares part.

use rai_core::integrity::raim::detection::threshold::Thresholds;
use rai_core::integrity::raim::levels::{KFactors, LevelInputs, Levels};
use rai_core::least_squares::Snapshot;
use rai_core::numeric::probability::Probability;
use rai_core::numeric::real::Real;
use serde::Serialize;

use super::line::{self, Line};
use super::number::Number;

/// Risk without any fault of the published vectors.
const FAULT_FREE: f64 = 1e-7;

/// Levels under the classic threshold, all rows in.
#[derive(Serialize)]
pub(super) struct Bound {
    hpl: Number,
    vpl: Number,
}

impl Bound {
    /// The core's levels of a snapshot with redundancy.
    ///
    /// The error names what the tables do not reach.
    pub(super) fn of<T: Real>(
        line: &Line,
        snapshot: &Snapshot<'_, T>,
        thresholds: &Thresholds<'_>,
    ) -> Result<Self, String> {
        let dof = snapshot.dof();
        let lambda =
            thresholds.lambda(dof).ok_or_else(|| format!("{dof} degrees of freedom: beyond the tables"))?;
        let (_, missed_detection) = line.probabilities()?;
        let fault_free: Probability = line::probability("pff", FAULT_FREE)?;
        let factors = KFactors::new(missed_detection, fault_free);
        let levels = LevelInputs::of(snapshot, Levels::Bound, &factors).protect(lambda);
        Ok(Self { hpl: levels.hpl_m.into(), vpl: levels.vpl_m.into() })
    }
}
