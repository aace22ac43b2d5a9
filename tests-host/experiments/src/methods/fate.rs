//! Outcomes of epochs, and their rates.
//!
//! | outcome | verdict | left out |
//! |---|---|---|
//! | correct | protected | exactly the faulty ones |
//! | incomplete | protected | faulty ones only, but not all |
//! | wrong | protected | a healthy one among them |
//! | ambiguous | alert: several exclusions explain the data | |
//! | not isolated | alert: detected, no exclusion found | |
//! | unavailable | nothing is promised: protection level, work | |
//! | missed | protected | none |
//!
//! "Beyond its level" is a protected epoch whose horizontal error exceeds its protection level,
//! which bounds one fault.

use std::ops::Add;

use raim::second_opinion::dense::Range;
use raim::second_opinion::ransac_traditional::{
    Criterion, RATIO, combination_count, combinations, unknowns, vote,
};
use raim::signal::sky::Sight;
use raim_core::epoch::Observation;
use raim_core::frame::{Ecef, Enu, LocalFrame};
use raim_core::internals::integrity::raim::isolation::ransac::ConsensusLimits;
use raim_core::monitor::{Method, Monitor, Strategy};
use raim_core::report::{Alert, Protected, Report, Verdict};
use raim_core::requirements::Requirements;

use super::skies::{CAPACITY, Scene};
use super::{CONTENDERS, Contender};

/// Outcome of an epoch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fate {
    Correct,
    Incomplete,
    Wrong,
    Ambiguous,
    NotIsolated,
    Unavailable,
    Missed,
}

const FATES: [(Fate, &str); 7] = [
    (Fate::Correct, "correct"),
    (Fate::Incomplete, "incomplete"),
    (Fate::Wrong, "wrong"),
    (Fate::Ambiguous, "ambiguous"),
    (Fate::NotIsolated, "not isolated"),
    (Fate::Unavailable, "unavailable"),
    (Fate::Missed, "missed"),
];

/// An outcome; `beyond_level` if a protected position had an error above its level.
#[derive(Clone, Copy, Debug)]
pub(super) struct Judged {
    fate: Fate,
    beyond_level: bool,
}

/// Number of epochs by outcome.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FateCounts {
    fates: [usize; FATES.len()],
    beyond_level: usize,
}

impl FateCounts {
    pub(super) fn add(&mut self, judged: Judged) {
        self.fates[judged.fate as usize] += 1;
        self.beyond_level += usize::from(judged.beyond_level);
    }

    pub(super) fn total(&self) -> usize {
        self.fates.iter().sum()
    }

    pub(super) fn of(&self, fate: Fate) -> usize {
        self.fates[fate as usize]
    }

    /// Returns the share of an outcome, %.
    pub(super) fn percent(&self, fate: Fate) -> f64 {
        100.0 * self.of(fate) as f64 / self.total() as f64
    }

    /// Describes all outcomes that are not correct.
    pub(super) fn rest(&self) -> String {
        let rest = FATES.iter().skip(1).filter(|(fate, _)| self.percent(*fate) >= 0.05);
        let words = rest.map(|(fate, word)| format!("{word} {:.1} %", self.percent(*fate)));
        let beyond = 100.0 * self.beyond_level as f64 / self.total() as f64;
        let beyond = (beyond >= 0.05).then(|| format!("beyond its level {beyond:.1} %"));
        words.chain(beyond).collect::<Vec<_>>().join(", ")
    }
}

impl Add for FateCounts {
    type Output = Self;

    fn add(mut self, other: Self) -> Self {
        for (mine, others) in self.fates.iter_mut().zip(other.fates) {
            *mine += others;
        }
        self.beyond_level += other.beyond_level;
        self
    }
}

/// Judges a scene with every contender; `None` if one is too expensive.
pub(super) fn of_scene(scene: &Scene) -> Vec<Option<Judged>> {
    let mut detected = true;
    let mut of_contender = |contender: &Contender| {
        let judged = match contender.method {
            Some(method) => Some(judge(&monitor(scene, method).process(&scene.epoch), scene)),
            None => traditional(scene, detected),
        };
        // The test is the same for all.
        detected &= judged.is_none_or(|judged| judged.fate != Fate::Missed);
        judged
    };
    CONTENDERS.iter().map(&mut of_contender).collect()
}

fn monitor(scene: &Scene, method: Method) -> Monitor<f32, CAPACITY> {
    let mut monitor = Monitor::new(Requirements::non_precision_approach()).expect("a preset");
    monitor.set_strategy(Strategy::CLASSIC.with_method(method)).expect("every method is built in");
    monitor.disable_continuity();
    monitor.start_from(scene.site);
    monitor
}

fn judge(report: &Report<CAPACITY>, scene: &Scene) -> Judged {
    let observations = scene.epoch.observations();
    let index_of = |satellite| observations.iter().position(|observation| observation.satellite == satellite);
    let left_out = report.excluded.iter().filter_map(|suspect| index_of(suspect.satellite)).collect();
    let fate = match report.verdict {
        Verdict::Protected(Protected::Ok) => Fate::Missed,
        Verdict::Protected(_) => of_exclusion(left_out, &scene.faulty),
        Verdict::Alert(Alert::Ambiguous) => Fate::Ambiguous,
        Verdict::Alert(_) => Fate::NotIsolated,
        Verdict::Unavailable(_) => Fate::Unavailable,
    };
    Judged { fate, beyond_level: is_beyond_level(report, scene.site) }
}

fn of_exclusion(mut left_out: Vec<usize>, faulty: &[usize]) -> Fate {
    left_out.sort_unstable();
    if left_out == faulty {
        Fate::Correct
    } else if left_out.iter().all(|index| faulty.contains(index)) {
        Fate::Incomplete
    } else {
        Fate::Wrong
    }
}

fn is_beyond_level(report: &Report<CAPACITY>, site: Ecef) -> bool {
    let (Verdict::Protected(_), Some(solution), Some(levels)) =
        (report.verdict, &report.solution, report.protection)
    else {
        return false;
    };
    let error = LocalFrame::at(site).rotate(solution.position - site);
    error.horizontal() > levels.hpl_m
}

/// Largest number of minimal subsets that a host can afford.
const MOST_SUBSETS: f64 = 500.0;

/// Applies the consensus of all minimal subsets, which names satellites and tests nothing
/// afterwards; returns `None` if it is too expensive.
fn traditional(scene: &Scene, detected: bool) -> Option<Judged> {
    let range = |((sight, observation), &residual_m): ((&Sight, &Observation), &f64)| {
        let Enu { east, north, up } = sight.line_of_sight;
        let constellation = sight.satellite.constellation();
        Range { line_of_sight: [east, north, up], constellation, residual_m, sigma_m: observation.sigma_m }
    };
    let observed = scene.sights.iter().zip(scene.epoch.observations());
    let ranges: Vec<Range> = observed.zip(&scene.errors_m).map(range).collect();
    let size = unknowns(&ranges);
    if combination_count(ranges.len(), size) > MOST_SUBSETS {
        return None;
    }
    if !detected {
        return Some(Judged { fate: Fate::Missed, beyond_level: false });
    }
    let threshold = ConsensusLimits::published().ok()?.consensus.w_test(ranges.len())?;
    let votes = vote(&ranges, combinations(ranges.len(), size), Criterion::Count { threshold });
    let named = votes.faulty(RATIO);
    let fate = if named.is_empty() { Fate::NotIsolated } else { of_exclusion(named, &scene.faulty) };
    Some(Judged { fate, beyond_level: false })
}
