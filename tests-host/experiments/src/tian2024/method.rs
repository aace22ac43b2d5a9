//! The compared methods, and the outcomes of an epoch.
//!
//! | outcome | of an epoch with a fault | without |
//! |---|---|---|
//! | correct | exactly the faulty satellites are named | nothing is detected |
//! | missed | nothing is detected | – |
//! | wrong | another set is named | any set is named |
//! | unresolved | detected, but no set is named | the same |
//!
//! The paper's "wrong" is wrong or unresolved here.

use anyhow::{Context as _, Result};
use raim::second_opinion::dense::Range;
use raim::second_opinion::ransac_traditional::{
    Criterion, RATIO, combination_count, combinations, unknowns, vote,
};
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::isolation::baarda::exclude_sequentially;
use raim_core::internals::integrity::raim::isolation::exclusion::{Exclusion, ExclusionOutcome};
use raim_core::internals::integrity::raim::isolation::{parity, ransac};
use raim_core::internals::least_squares::Excludable;
use raim_core::internals::least_squares::equations::Row;
use raim_core::internals::numeric::probability::Probability;
use raim_firmware::correction::CAPACITY;
use rand::rngs::ChaCha8Rng;

use super::super::draw::distinct;
use super::super::{Finding, Interval};
use super::Sky;

/// Capacity of an epoch, rows.
pub(super) const ROWS: usize = CAPACITY;

/// Probability of false alarm of the global test.
const FALSE_ALARM: Probability = match Probability::new(1e-4) {
    Some(probability) => probability,
    None => unreachable!(),
};

/// A method of the core.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    /// Sequential exclusion by w-test.
    Baarda,
    /// One of the methods in parity space.
    Parity(parity::Isolation),
    /// Range consensus over disjoint subsets, with refinement.
    Improved,
}

/// Requirements on the methods.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Thresholds of the global test and the w-test.
    pub(super) thresholds: Thresholds<'static>,
    /// Limits of the searches in parity space; nothing is cut on the host.
    pub(super) parity: parity::SearchLimits,
    /// Limits of the range consensus.
    pub(super) consensus: ransac::ConsensusLimits<'static>,
}

impl Limits {
    /// Returns `P_fa` 1e-4 and up to three satellites for every method.
    pub(super) fn published() -> Result<Self> {
        Ok(Self {
            // The probability of missed detection is not used here.
            thresholds: Thresholds::from_tables(FALSE_ALARM, FALSE_ALARM)?,
            parity: parity::SearchLimits { sets: usize::MAX, ..parity::SearchLimits::published() },
            consensus: ransac::ConsensusLimits::published()?,
        })
    }
}

impl Method {
    /// Isolates, and leaves the rows found out of `solution`.
    pub(super) fn exclude(
        self,
        solution: &mut impl Excludable<f32, ROWS>,
        selection: &ransac::Selection<ROWS>,
        limits: &Limits,
    ) -> Exclusion<f32> {
        match self {
            Self::Baarda => exclude_sequentially(solution, &limits.thresholds),
            Self::Parity(method) => parity::exclude(method, solution, &limits.thresholds, &limits.parity),
            Self::Improved => ransac::exclude(solution, selection, &limits.thresholds, &limits.consensus),
        }
    }
}

/// Answer of a method.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Answer {
    /// No fault.
    Nothing,
    /// These rows are faulty, in ascending order.
    Rows(Vec<usize>),
    /// There is a fault that cannot be attributed.
    Unresolved,
}

impl Answer {
    /// Returns the answer of an exclusion by the core.
    pub(super) fn of(exclusion: &Exclusion<f32>) -> Self {
        match exclusion.outcome {
            ExclusionOutcome::Passed => Self::Nothing,
            ExclusionOutcome::Isolated => Self::named(exclusion.rows.iter().map(|excluded| excluded.index)),
            ExclusionOutcome::NotIsolated(_) => Self::Unresolved,
        }
    }

    fn named(rows: impl Iterator<Item = usize>) -> Self {
        let mut rows: Vec<usize> = rows.collect();
        rows.sort_unstable();
        if rows.is_empty() { Self::Nothing } else { Self::Rows(rows) }
    }
}

/// Epochs of one method, by outcome.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Score {
    /// Number of all epochs.
    pub(super) epochs: usize,
    correct: usize,
    missed: usize,
    wrong: usize,
    unresolved: usize,
}

impl Score {
    /// Adds an epoch in which the rows `faulty`, in ascending order, are faulty.
    pub(super) fn add(&mut self, answer: &Answer, faulty: &[usize]) {
        self.epochs += 1;
        let count = match answer {
            Answer::Nothing if faulty.is_empty() => &mut self.correct,
            Answer::Nothing => &mut self.missed,
            Answer::Rows(rows) if rows == faulty => &mut self.correct,
            Answer::Rows(_) => &mut self.wrong,
            Answer::Unresolved => &mut self.unresolved,
        };
        *count += 1;
    }

    /// Adds other epochs.
    pub(super) fn merge(&mut self, other: &Self) {
        self.epochs += other.epochs;
        self.correct += other.correct;
        self.missed += other.missed;
        self.wrong += other.wrong;
        self.unresolved += other.unresolved;
    }

    /// Returns the share of correct epochs, %.
    pub(super) fn percent(&self) -> f64 {
        100.0 * self.correct as f64 / self.epochs as f64
    }

    /// Returns the same with its interval.
    pub(super) fn accuracy(&self) -> Finding {
        let Interval { low, high } = Interval::of_rate(self.correct, self.epochs);
        let interval = Some(Interval { low: 100.0 * low, high: 100.0 * high });
        Finding::Number { value: self.percent(), decimals: 2, interval }
    }

    /// Describes the other epochs.
    pub(super) fn others(&self) -> String {
        let Self { epochs, missed, wrong, unresolved, .. } = self;
        format!("missed {missed}, wrong {wrong}, unresolved {unresolved} of {epochs}")
    }
}

/// A criterion on all minimal subsets, or on a sample of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Traditional {
    /// A subset is contradicted if too many others deviate, as the method intends.
    Consensus,
    /// A subset is contradicted if the root mean square of the others' residuals reaches a limit,
    /// as printed.
    Printed {
        /// Limit, m.
        limit_m: f64,
        /// Smallest share of contradicted subsets at which a satellite counts as faulty.
        ratio: f64,
    },
}

impl Traditional {
    /// Returns the printed criterion with the values that suit it best, found by trial, because the
    /// paper prints none.
    pub(super) const fn printed(sky: Sky) -> Self {
        match sky {
            Sky::Gps => Self::Printed { limit_m: 80.0, ratio: 0.7 },
            Sky::Beidou | Sky::Both => Self::Printed { limit_m: 60.0, ratio: 0.8 },
        }
    }

    /// Lets the subsets vote; if there are more than `most`, that many are drawn.
    pub(super) fn judge(
        self,
        rows: &[Row<f32>],
        limits: &Limits,
        most: usize,
        generator: &mut ChaCha8Rng,
    ) -> Result<Answer> {
        let ranges = ranges(rows);
        let (count, size) = (ranges.len(), unknowns(&ranges));
        let threshold = limits.consensus.consensus.w_test(count).context("more rows than the tables have")?;
        let (criterion, ratio) = match self {
            Self::Consensus => (Criterion::Count { threshold }, RATIO),
            Self::Printed { limit_m, ratio } => (Criterion::RootMeanSquare { limit_m }, ratio),
        };
        let votes = if combination_count(count, size) <= most as f64 {
            vote(&ranges, combinations(count, size), criterion)
        } else {
            vote(&ranges, (0..most).map(|_| distinct(generator, size, count)), criterion)
        };
        Ok(Answer::named(votes.faulty(ratio).into_iter()))
    }
}

/// Returns the rows of an epoch for the traditional method.
fn ranges(rows: &[Row<f32>]) -> Vec<Range> {
    let range = |row: &Row<f32>| {
        let line_of_sight = [-row.design.x, -row.design.y, -row.design.z].map(f64::from);
        let (residual_m, sigma_m) = (f64::from(row.residual), f64::from(row.sigma));
        row.clock.map(|constellation| Range { line_of_sight, constellation, residual_m, sigma_m })
    };
    rows.iter().filter_map(range).collect()
}
