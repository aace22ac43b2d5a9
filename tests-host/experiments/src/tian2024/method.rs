//! The methods that are compared, and what becomes of an epoch in their hands.
//!
//! | fate | of an epoch with a fault | without |
//! |---|---|---|
//! | correct | exactly the faulty satellites are named | nothing is detected |
//! | missed | nothing is detected | – |
//! | wrong | another set is named | any set is named |
//! | unresolved | detected, but no set is named | the same |
//!
//! The paper's "wrong" is wrong or unresolved here.

use anyhow::{Context as _, Result};
use rai_core::integrity::raim::detection::threshold::Thresholds;
use rai_core::integrity::raim::isolation::baarda::exclude_sequentially;
use rai_core::integrity::raim::isolation::exclusion::{Exclusion, ExclusionOutcome};
use rai_core::integrity::raim::isolation::{parity, ransac};
use rai_core::least_squares::Excludable;
use rai_core::least_squares::equations::Row;
use rai_core::numeric::probability::Probability;
use rai_firmware::correction::CAPACITY;
use rand_chacha::ChaCha8Rng;

use super::super::draw::distinct;
use super::super::{Finding, Interval};
use super::Sky;
use tests_host::oracle::Range;
use tests_host::ransac_traditional::{Criterion, RATIO, combination_count, combinations, unknowns, vote};

/// Rows that an epoch may have.
pub(super) const ROWS: usize = CAPACITY;

/// Of the test that decides whether there is a fault.
const FALSE_ALARM: Probability = match Probability::new(1e-4) {
    Some(probability) => probability,
    None => unreachable!(),
};

/// A method of the core.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    /// Sequential exclusion by w-test.
    Baarda,
    /// One of those in parity space.
    Parity(parity::Isolation),
    /// Range consensus over disjoint subsets, with refinement.
    Improved,
}

/// What is asked of the methods.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Of the global test and the w-test.
    pub(super) thresholds: Thresholds<'static>,
    /// Of the searches in parity space: nothing is cut on the host.
    pub(super) parity: parity::SearchLimits,
    /// Of the range consensus.
    pub(super) consensus: ransac::ConsensusLimits<'static>,
}

impl Limits {
    /// `P_fa` 1e-4 and up to three satellites for every method.
    pub(super) fn published() -> Result<Self> {
        Ok(Self {
            // Nothing here asks for the probability of missed detection.
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
        solution: &mut impl Excludable<f32>,
        selection: &ransac::Selection,
        limits: &Limits,
    ) -> Exclusion<f32> {
        match self {
            Self::Baarda => exclude_sequentially(solution, &limits.thresholds),
            Self::Parity(method) => parity::exclude(method, solution, &limits.thresholds, &limits.parity),
            Self::Improved => ransac::exclude(solution, selection, &limits.thresholds, &limits.consensus),
        }
    }
}

/// What a method says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Answer {
    /// There is no fault.
    Nothing,
    /// It is these rows, in ascending order.
    Rows(Vec<usize>),
    /// There is a fault; whose, it cannot say.
    Unresolved,
}

impl Answer {
    /// Of an exclusion by the core.
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

/// Epochs in the hands of one method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Score {
    /// All of them.
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

    /// Share of correct epochs, percent.
    pub(super) fn percent(&self) -> f64 {
        100.0 * self.correct as f64 / self.epochs as f64
    }

    /// The same with its interval.
    pub(super) fn accuracy(&self) -> Finding {
        let Interval { low, high } = Interval::of_rate(self.correct, self.epochs);
        let interval = Some(Interval { low: 100.0 * low, high: 100.0 * high });
        Finding::Number { value: self.percent(), decimals: 2, interval }
    }

    /// The other epochs in words.
    pub(super) fn others(&self) -> String {
        let Self { epochs, missed, wrong, unresolved, .. } = self;
        format!("missed {missed}, wrong {wrong}, unresolved {unresolved} of {epochs}")
    }
}

/// One way to judge by all minimal subsets, or by a sample of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Traditional {
    /// A subset is contradicted when too many others deviate; what the method means.
    Consensus,
    /// When the root mean square of the others' residuals reaches a limit; what is printed.
    Printed {
        /// The limit, m.
        limit_m: f64,
        /// Share of contradicted subsets from which a satellite is faulty.
        ratio: f64,
    },
}

impl Traditional {
    /// The printed criterion with the values that serve it best, found by trial: the paper prints none.
    pub(super) const fn printed(sky: Sky) -> Self {
        match sky {
            Sky::Gps => Self::Printed { limit_m: 80.0, ratio: 0.7 },
            Sky::Beidou | Sky::Both => Self::Printed { limit_m: 60.0, ratio: 0.8 },
        }
    }

    /// What the subsets say; `most` of them are drawn where there are more.
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

/// The rows of an epoch as the plain method takes them.
fn ranges(rows: &[Row<f32>]) -> Vec<Range> {
    let range = |row: &Row<f32>| {
        let line_of_sight = [-row.design.x, -row.design.y, -row.design.z].map(f64::from);
        let (residual_m, sigma_m) = (f64::from(row.residual), f64::from(row.sigma));
        row.clock.map(|constellation| Range { line_of_sight, constellation, residual_m, sigma_m })
    };
    rows.iter().filter_map(range).collect()
}
