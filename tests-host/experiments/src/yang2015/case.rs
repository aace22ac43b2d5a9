//! Requirements of table 1, and its counts.

use anyhow::Context as _;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::detection::threshold::policy::{Policy, ThresholdProblem};
use raim_core::internals::integrity::raim::levels::{LevelInputs, largest_slopes};
use raim_core::internals::least_squares::Snapshot;
use raim_core::internals::numeric::real::Real;
use raim_core::requirements::Requirements;

use super::grid::LATITUDES;
use super::{FALSE_ALARM, LIMIT_M, ROWS, thresholds};

/// Size of the fault, m.
pub(super) const FAULT_M: f64 = 100.0;

/// Time of the fault, s.
pub(super) const FAULT_S: std::ops::Range<f64> = 7200.0..10_800.0;

/// Divisor of the non-centrality at the alert limit that gives the published false alarms of
/// `T_OP`.
const FITTED: f64 = 275.0;

/// The two thresholds of table 1.
pub(super) const POLICIES: [Policy; 2] = [Policy::T1, Policy::TOp];

/// Number of [`Case`]s.
pub(super) const CASES: usize = 3;

/// Requirements, and their thresholds.
pub(super) struct Case {
    /// Name in words.
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
            requirements: printed.with_hal_m(limit_m / printed.guard_fraction),
        })
    }

    /// Returns three cases: as printed; with the probability that gives the false alarms of `T1`;
    /// with the limit that gives those of `T_OP`.
    pub(super) fn all() -> anyhow::Result<[Self; CASES]> {
        let fitted_m = LIMIT_M / FITTED.sqrt();
        Ok([Self::new(FALSE_ALARM, LIMIT_M)?, Self::new(1e-5, LIMIT_M)?, Self::new(1e-5, fitted_m)?])
    }

    /// Returns the SSE at which a fault is detected. If no `T_OP` meets the requirements, it is
    /// `T1`: always the lower of the two.
    pub(super) fn threshold<T: Real>(
        &self,
        policy: Policy,
        snapshot: &Snapshot<'_, T, ROWS>,
    ) -> anyhow::Result<f64> {
        let classic = self.thresholds.tau1(snapshot.dof()).context("beyond the tables")?;
        if policy == Policy::T1 {
            return Ok(classic);
        }
        // If T2 limits T_OP to T1, single precision may round it below.
        Ok(self
            .demand(snapshot)
            .threshold::<T>(policy)
            .map_or(classic, |threshold| threshold.tau.max(classic)))
    }

    /// Returns true if any threshold meets both probabilities.
    pub(super) fn is_available(&self, snapshot: &Snapshot<'_, f64, ROWS>) -> bool {
        self.demand(snapshot).threshold::<f64>(Policy::TOp).is_ok()
    }

    fn demand<T: Real>(&self, snapshot: &Snapshot<'_, T, ROWS>) -> ThresholdProblem<'static> {
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
    /// Number of fault-free samples with a detection.
    pub(super) false_alarms: f64,
    /// Number of faulty samples without a detection.
    pub(super) missed: f64,
}

impl Errors {
    fn plus(self, other: Self) -> Self {
        Self { false_alarms: self.false_alarms + other.false_alarms, missed: self.missed + other.missed }
    }
}

/// Errors by case, threshold and row of cells.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ErrorsByCase([[[Errors; LATITUDES]; POLICIES.len()]; CASES]);

impl ErrorsByCase {
    /// Adds errors of one cell.
    pub(super) fn add(&mut self, case: usize, policy: usize, row: usize, errors: Errors) {
        let entry = &mut self.0[case][policy][row];
        *entry = entry.plus(errors);
    }

    /// Returns the sum of both tallies.
    pub(super) fn plus(&self, other: &Self) -> Self {
        let mut sum = *self;
        for (case, policies) in other.0.iter().enumerate() {
            for (policy, rows) in policies.iter().enumerate() {
                rows.iter().enumerate().for_each(|(row, &errors)| sum.add(case, policy, row, errors));
            }
        }
        sum
    }

    /// Returns the errors of one row of cells.
    pub(super) fn of_row(&self, case: usize, policy: usize, row: usize) -> Errors {
        self.0[case][policy][row]
    }

    /// Returns the errors of all cells.
    pub(super) fn total(&self, case: usize, policy: usize) -> Errors {
        self.0[case][policy].iter().fold(Errors::default(), |sum, &errors| sum.plus(errors))
    }
}
