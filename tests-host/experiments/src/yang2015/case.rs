//! Under which requirements table 1 is computed, and what is counted.

use anyhow::Context as _;
use rai_core::integrity::raim::detection::threshold::Thresholds;
use rai_core::integrity::raim::detection::threshold::policy::{Policy, ThresholdProblem};
use rai_core::integrity::raim::levels::{LevelInputs, largest_slopes};
use rai_core::least_squares::Snapshot;
use rai_core::numeric::real::Real;
use rai_core::requirements::Requirements;

use super::grid::LATITUDES;
use super::{FALSE_ALARM, LIMIT_M, thresholds};

/// The fault, m.
pub(super) const FAULT_M: f64 = 100.0;

/// While the fault lasts, s.
pub(super) const FAULT_S: std::ops::Range<f64> = 7200.0..10_800.0;

/// The non-centrality at the alert limit that is divided by this gives the published false alarms of `T_OP`.
const FITTED: f64 = 275.0;

/// The two thresholds of table 1.
pub(super) const POLICIES: [Policy; 2] = [Policy::T1, Policy::TOp];

/// Number of [`Case`]s.
pub(super) const CASES: usize = 3;

/// Requirements, and the thresholds that follow from them.
pub(super) struct Case {
    /// In words.
    pub(super) name: String,
    thresholds: Thresholds<'static>,
    requirements: Requirements,
}

impl Case {
    fn new(false_alarm: f64, limit_m: f64) -> anyhow::Result<Self> {
        let printed = Requirements::non_precision_approach();
        Ok(Self {
            name: format!("P_fa {false_alarm:e}, f HAL {limit_m:.1} m"),
            thresholds: thresholds(false_alarm)?,
            requirements: Requirements { hal_m: limit_m / printed.guard_fraction, ..printed },
        })
    }

    /// As printed; with the probability that gives the false alarms of `T1`; with the limit that gives those of `T_OP`.
    pub(super) fn all() -> anyhow::Result<[Self; CASES]> {
        let fitted_m = LIMIT_M / FITTED.sqrt();
        Ok([Self::new(FALSE_ALARM, LIMIT_M)?, Self::new(1e-5, LIMIT_M)?, Self::new(1e-5, fitted_m)?])
    }

    /// What SSE must reach to mean a fault. Where no `T_OP` meets the requirements, it is `T1`: the lower of the two always.
    pub(super) fn threshold<T: Real>(
        &self,
        policy: Policy,
        snapshot: &Snapshot<'_, T>,
    ) -> anyhow::Result<f64> {
        let classic = self.thresholds.tau1(snapshot.dof()).context("beyond the tables")?;
        if policy == Policy::T1 {
            return Ok(classic);
        }
        // Where T2 holds T_OP down to T1, single precision may round it below.
        Ok(self
            .demand(snapshot)
            .threshold::<T>(policy)
            .map_or(classic, |threshold| threshold.tau.max(classic)))
    }

    /// Whether any threshold meets both probabilities.
    pub(super) fn is_available(&self, snapshot: &Snapshot<'_, f64>) -> bool {
        self.demand(snapshot).threshold::<f64>(Policy::TOp).is_ok()
    }

    fn demand<T: Real>(&self, snapshot: &Snapshot<'_, T>) -> ThresholdProblem<'static> {
        ThresholdProblem::new(
            snapshot.dof(),
            &LevelInputs::to_faults(largest_slopes(snapshot)),
            &self.requirements,
            self.thresholds,
        )
    }
}

/// False alarms and missed detections, counted or expected.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Errors {
    /// Fault-free samples in which a fault is detected.
    pub(super) false_alarms: f64,
    /// Faulty samples in which none is.
    pub(super) missed: f64,
}

impl Errors {
    fn plus(self, other: Self) -> Self {
        Self { false_alarms: self.false_alarms + other.false_alarms, missed: self.missed + other.missed }
    }
}

/// Errors of each case, threshold and row of cells.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally([[[Errors; LATITUDES]; POLICIES.len()]; CASES]);

impl Tally {
    /// Adds errors of one cell.
    pub(super) fn add(&mut self, case: usize, policy: usize, row: usize, errors: Errors) {
        let entry = &mut self.0[case][policy][row];
        *entry = entry.plus(errors);
    }

    /// Both tallies together.
    pub(super) fn plus(&self, other: &Self) -> Self {
        let mut sum = *self;
        for (case, policies) in other.0.iter().enumerate() {
            for (policy, rows) in policies.iter().enumerate() {
                rows.iter().enumerate().for_each(|(row, &errors)| sum.add(case, policy, row, errors));
            }
        }
        sum
    }

    /// Errors of one row of cells.
    pub(super) fn of_row(&self, case: usize, policy: usize, row: usize) -> Errors {
        self.0[case][policy][row]
    }

    /// Errors of all cells.
    pub(super) fn total(&self, case: usize, policy: usize) -> Errors {
        self.0[case][policy].iter().fold(Errors::default(), |sum, &errors| sum.plus(errors))
    }
}
