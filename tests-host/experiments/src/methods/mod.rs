//! All methods side by side on the same skies and faults: a choice of method by situation, and
//! dominated methods. No paper has it.
//!
//! One, two or three satellites are wrong by a step of seven sizes. Every method receives the very
//! same ranges, through [`Monitor::process`](raim_core::monitor::Monitor::process) in single
//! precision, as on the target.
//!
//! ```text
//! scene(kind of sky, faults, step, run) ──► monitor with each method ──► fate ──► tally
//! ```
//!
//! | module | content |
//! |---|---|
//! | [`skies`] | satellites and errors |
//! | [`fate`] | outcomes of epochs, and their rates |
//! | [`pictures`] | rates against step, by method |
//!
//! Each scene draws from its own stream, so its numbers do not depend on the number of threads, and
//! all are independent.

mod fate;
mod pictures;
mod skies;

use anyhow::Result;
use indicatif::ProgressBar;
use raim::in_order::Together as _;
use raim_core::internals::integrity::raim::isolation::parity;
use raim_core::monitor::Method;
use rig::bench::{budget, stages};

use super::{Effort, Experiment, Finding, Judgement, Outcome, Row, Section};
use fate::{Fate, FateCounts};
use skies::{KINDS, Scene};

/// Entry for the command line.
pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "methods",
    about: "all methods side by side: one to three faults, 8 to 40 satellites, steps of 20 to 150 m",
    run,
};

/// Methods by their words in the command `METHOD`, and the one that only a host can afford.
const CONTENDERS: [Contender; 7] = [
    Contender { name: "BAARDA", method: Some(Method::Baarda) },
    Contender { name: "SIMULTANEOUS", method: Some(Method::Parity(parity::Isolation::Simultaneous)) },
    Contender { name: "SEQUENTIAL", method: Some(Method::Parity(parity::Isolation::Sequential)) },
    Contender { name: "HYBRID", method: Some(Method::Parity(parity::Isolation::Hybrid)) },
    Contender { name: "GROUPING", method: Some(Method::Parity(parity::Isolation::Grouping)) },
    Contender { name: "RANSAC", method: Some(Method::Ransac) },
    Contender { name: "all minimal subsets", method: None },
];

/// A method to identify the faulty satellites.
#[derive(Clone, Copy)]
struct Contender {
    name: &'static str,
    /// Method of the module; `None` for the consensus of all minimal subsets.
    method: Option<Method>,
}

/// Numbers of faulty satellites.
const FAULTS: [usize; 3] = [1, 2, 3];

/// Sizes of the faults, m; each has a random sign.
const STEPS_M: [f64; 7] = [20.0, 30.0, 40.0, 60.0, 80.0, 100.0, 150.0];

/// Tallies by kind of sky, number of faults, step and contender.
struct Tallies(Vec<FateCounts>);

/// Indices of the kind of sky, the number of faults and the step.
#[derive(Clone, Copy)]
struct Place {
    kind: usize,
    faults: usize,
    step: usize,
}

impl Place {
    fn index(self) -> usize {
        (self.kind * FAULTS.len() + self.faults) * STEPS_M.len() + self.step
    }

    fn scene(self, run: u64) -> Scene {
        let number = (self.index() as u64) << 32 | run;
        KINDS[self.kind].scene(number, FAULTS[self.faults], STEPS_M[self.step])
    }
}

impl Tallies {
    fn empty() -> Self {
        Self(vec![FateCounts::default(); KINDS.len() * FAULTS.len() * STEPS_M.len() * CONTENDERS.len()])
    }

    fn of(&mut self, place: Place, contender: usize) -> &mut FateCounts {
        &mut self.0[place.index() * CONTENDERS.len() + contender]
    }

    /// Returns the sum of all matching tallies; `None` stands for every one.
    fn sum(&self, kind: Option<usize>, faults: usize, step: Option<usize>, contender: usize) -> FateCounts {
        let kinds = kind.map_or(0..KINDS.len(), |kind| kind..kind + 1);
        let steps = step.map_or(0..STEPS_M.len(), |step| step..step + 1);
        let places = kinds.flat_map(|kind| steps.clone().map(move |step| Place { kind, faults, step }));
        places.fold(FateCounts::default(), |sum, place| {
            sum + self.0[place.index() * CONTENDERS.len() + contender]
        })
    }
}

fn run(effort: Effort, bar: &ProgressBar) -> Result<Outcome> {
    let runs = effort.pick(30, 1_000);
    let tallies = tally(runs, bar);
    let each = KINDS.iter().enumerate().map(|(index, kind)| section(kind.name, Some(index), &tallies));
    let sections =
        std::iter::once(section("All skies", None, &tallies)).chain(each).chain([costs()?]).collect();
    let steps = STEPS_M.map(|step_m| step_m.to_string()).join(", ");
    Ok(Outcome {
        name: EXPERIMENT.name,
        title: "All methods side by side".into(),
        setup: format!(
            "For each kind of sky, number of faults and step {runs} epochs above Xi'an, each with satellites of its own, \
             drawn from those above 5°; sigmas of the module's own error model for two frequencies; non-precision \
             approach, T1, no clock aid, single precision. The faulty satellites are drawn at random and are wrong by \
             {steps} m, one way or the other; all steps are counted together. Correct: protected, and left out are exactly \
             the faulty satellites. Every method sees the same ranges. Seeds are fixed."
        ),
        sections,
        pictures: pictures::all(&tallies)?,
    })
}

/// Judges every scene, the same number for each place.
fn tally(runs: u64, bar: &ProgressBar) -> Tallies {
    let places: Vec<Place> = (0..KINDS.len())
        .flat_map(|kind| (0..FAULTS.len()).map(move |faults| (kind, faults)))
        .flat_map(|(kind, faults)| (0..STEPS_M.len()).map(move |step| Place { kind, faults, step }))
        .collect();
    bar.set_length(places.len() as u64 * runs);
    let scenes: Vec<(Place, u64)> =
        places.iter().flat_map(|&place| (0..runs).map(move |run| (place, run))).collect();
    let judge = |&(place, run): &(Place, u64)| {
        let fates = fate::of_scene(&place.scene(run));
        bar.inc(1);
        (place, fates)
    };
    let mut tallies = Tallies::empty();
    for (place, fates) in scenes.iter().together(judge).collect::<Vec<_>>() {
        for (contender, judged) in fates.into_iter().enumerate() {
            if let Some(judged) = judged {
                tallies.of(place, contender).add(judged);
            }
        }
    }
    tallies
}

/// Returns the cost of each method on the target, from the committed budgets; a method without a
/// figure is marked.
fn costs() -> Result<Section> {
    let committed = budget::committed()?;
    let mut rows = Vec::new();
    for method in stages::METHODS {
        for faults in 0..=3 {
            let name = stages::of_method(method, faults);
            let ours = committed.get(&name).map_or_else(
                || Finding::Words("not measured".into()),
                |&instructions| Finding::exact(instructions as f64 / 1e6, 2),
            );
            rows.push(Row::new(format!("{method}, faulty {faults} of 20"), "", ours, Judgement::Ours));
        }
    }
    Ok(Section {
        title:
            "Millions of instructions an epoch on the target, in a stream of like ones (cargo xtask bench)"
                .into(),
        rows,
    })
}

/// Returns a line for each number of faults and method: the rate of correct exclusion, and the
/// other outcomes.
fn section(title: &str, kind: Option<usize>, tallies: &Tallies) -> Section {
    let mut rows = Vec::new();
    for (faults, &count) in FAULTS.iter().enumerate() {
        for (index, contender) in CONTENDERS.iter().enumerate() {
            let tally = tallies.sum(kind, faults, None, index);
            if tally.total() > 0 && (kind.is_some() || contender.method.is_some()) {
                let rate = Finding::rate(tally.of(Fate::Correct), tally.total(), 3);
                let plural = if count == 1 { "fault" } else { "faults" };
                let quantity = format!("{count} {plural}, {}", contender.name);
                rows.push(Row::new(quantity, "", rate, Judgement::Ours).because(tally.rest()));
            }
        }
    }
    Section { title: title.into(), rows }
}
