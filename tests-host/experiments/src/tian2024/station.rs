//! The station's experiment on a real recording: a day of GPS and `BeiDou` at Esbjerg, with 150 m
//! added to the ranges of one, two or three satellites, drawn anew in every epoch.
//!
//! Recording, orbits, corrections and sigmas are the firmware's; position and isolation are the
//! core's. A fault is added to the corrected range before the position is solved. As in the module,
//! a named set counts only if no other explains the ranges nearly as well; otherwise the epoch is
//! unresolved, which the module reports as an alert.

use anyhow::{Context as _, Result};
use indicatif::ProgressBar;
use raim::in_order::Together as _;
use raim::page::bars::BarChart;
use raim::replay::{self, Window};
use raim::signal::encode::{self, Frequency};
use raim::signal::recording::Recording;
use raim_core::epoch::{Epoch, Observation};
use raim_core::frame::Ecef;
use raim_core::internals::integrity::raim::hypotheses::separability::separable;
use raim_core::internals::integrity::raim::isolation::exclusion::ExclusionOutcome;
use raim_core::internals::integrity::raim::isolation::parity;
use raim_core::internals::integrity::raim::isolation::ransac::{MAX_WORK, Selection};
use raim_core::internals::least_squares::Workspace;
use raim_core::internals::least_squares::fix::Fix;
use rand::rngs::ChaCha8Rng;
use rig::shared;

use super::super::draw::{distinct, generator};
use super::super::{Effort, Judgement, Picture, Row, Section};
use super::method::{Answer, Limits, Method, ROWS, Score, Traditional};
use super::{BIAS_M, MASK_RAD, Sky, faults_in_words, most_subsets};

const FOLDER: &str = "data/esbc";
const OBSERVATIONS: &str = "ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz";
const NAVIGATION: &str = "ESBC00DNK_R_20201770000_01D_MN.rnx.gz";
/// Surveyed position of the antenna.
const TRUTH: Ecef = Ecef::new(3_582_104.925_4, 532_590.238_1, 5_232_755.266_9);
const SEED: u64 = 0xE5BC;

const CASES: [(Sky, usize); 8] = [
    (Sky::Both, 0),
    (Sky::Both, 1),
    (Sky::Both, 2),
    (Sky::Both, 3),
    (Sky::Gps, 0),
    (Sky::Gps, 1),
    (Sky::Beidou, 0),
    (Sky::Beidou, 1),
];

/// Methods of the core; the traditional one comes after them.
const METHODS: [(&str, Method); 6] = [
    ("w-test", Method::Baarda),
    ("simultaneous", Method::Parity(parity::Isolation::Simultaneous)),
    ("sequential", Method::Parity(parity::Isolation::Sequential)),
    ("hybrid", Method::Parity(parity::Isolation::Hybrid)),
    ("grouping", Method::Parity(parity::Isolation::Grouping)),
    ("improved consensus", Method::Improved),
];
const COLUMNS: usize = METHODS.len() + 1;

/// Scores by case and method.
type Scores = [[Score; COLUMNS]; CASES.len()];

/// Returns the time between epochs, s; the full form has the recording's.
fn step_s(effort: Effort) -> f64 {
    effort.pick(600.0, 30.0)
}

/// Returns the interval in epochs at which the traditional method runs too.
fn stride(effort: Effort) -> usize {
    effort.pick(8, 40)
}

/// Returns the number of epochs of the recording.
pub(super) fn epochs(effort: Effort) -> u64 {
    (86_400.0 / step_s(effort)) as u64
}

/// Returns the recording's section and picture; only a title without the recording.
pub(super) fn recorded(effort: Effort, bar: &ProgressBar) -> Result<(Section, Option<Picture>)> {
    let Some(folder) = shared::path_or_skip(FOLDER) else {
        let title = format!("The recording of Esbjerg: skipped, {FOLDER} of the reference folder is missing");
        return Ok((Section { title, rows: vec![] }, None));
    };
    let recording = Recording::load(&[folder.join(OBSERVATIONS)], &[folder.join(NAVIGATION)])?;
    let limits = Limits::published()?;
    let selection = encode::Selection::new("GC", Frequency::Dual)?;
    let window = Window { every_s: step_s(effort), ..Window::ALL };
    let lumps = replay::encode(&recording, &selection, &[], &window)?;
    // For a third of the `BeiDou` satellites the receiver tracks one frequency. Without
    // coefficients their sigma is 20 to 40 m (`weighting::ionosphere`), and no method could
    // detect 150 m in them.
    let epochs = replay::corrected(&lumps, TRUTH, MASK_RAD, recording.klobuchar);
    let of = |(index, epoch): (usize, &Epoch<ROWS>)| {
        let scores = judge(effort, &limits, index, epoch);
        bar.inc(1);
        scores
    };
    let each: Vec<Scores> = epochs.iter().enumerate().together(of).collect::<Result<_>>()?;
    let mut sum = Scores::default();
    for scores in &each {
        for (sum, score) in sum.as_flattened_mut().iter_mut().zip(scores.as_flattened()) {
            sum.merge(score);
        }
    }
    Ok((section(&sum), Some(picture(&sum)?)))
}

fn judge(effort: Effort, limits: &Limits, index: usize, epoch: &Epoch<ROWS>) -> Result<Scores> {
    let mut scores = Scores::default();
    for (case, (&(sky, faults), scores)) in CASES.iter().zip(&mut scores).enumerate() {
        let mut draw = generator(SEED + case as u64, index as u64);
        let (epoch, faulty) = with_faults(epoch, sky, faults, &mut draw)?;
        let mut workspace = Workspace::<f32, ROWS>::new();
        // Without a position no method can isolate anything.
        let Ok(fix) = workspace.fix(&epoch, TRUTH) else { continue };
        let rows = &fix.snapshot().equations().to_vec();
        let selection = Selection::choose(rows, 2 * MAX_WORK);
        for ((_, method), score) in METHODS.iter().zip(&mut *scores) {
            // Each method has its own copy of the position, because leaving out rows changes it.
            let fix = workspace.fix(&epoch, TRUTH)?;
            score.add(&answer(*method, fix, &selection, limits), &faulty);
        }
        if index.is_multiple_of(stride(effort)) {
            let reported = Traditional::Consensus.judge(rows, limits, most_subsets(effort), &mut draw)?;
            scores[METHODS.len()].add(&reported, &faulty);
        }
    }
    Ok(scores)
}

/// Returns the ranges of some systems with faults on some of them, and the faulty ones.
fn with_faults(
    epoch: &Epoch<ROWS>,
    sky: Sky,
    faults: usize,
    draw: &mut ChaCha8Rng,
) -> Result<(Epoch<ROWS>, Vec<usize>)> {
    let of_sky = |observation: &&Observation| sky.has(observation.satellite);
    let mut observations: Vec<Observation> = epoch.observations().iter().filter(of_sky).copied().collect();
    let faulty = distinct(draw, faults, observations.len());
    for &row in &faulty {
        observations[row].range_m += BIAS_M;
    }
    let mut epoch = Epoch::new(epoch.time_s());
    for observation in observations {
        epoch.push(observation).context("an observation that the firmware let pass")?;
    }
    Ok((epoch, faulty))
}

/// Returns a method's answer about a position, as the module reports it.
fn answer(
    method: Method,
    mut fix: Fix<'_, f32, ROWS>,
    selection: &Selection<ROWS>,
    limits: &Limits,
) -> Answer {
    let exclusion = method.exclude(&mut fix, selection, limits);
    let accepted = exclusion.outcome != ExclusionOutcome::Isolated
        || separable(&mut fix, &exclusion, &limits.thresholds);
    if accepted { Answer::of(&exclusion) } else { Answer::Unresolved }
}

fn section(scores: &Scores) -> Section {
    let mut rows = Vec::new();
    for ((sky, faults), scores) in CASES.iter().zip(scores) {
        let names = METHODS.iter().map(|(name, _)| *name).chain(["traditional consensus"]);
        // Without a fault all methods are the same: the global test.
        let shown = if *faults == 0 { 1 } else { COLUMNS };
        for (name, score) in names.zip(scores).take(shown).filter(|(_, score)| score.epochs > 0) {
            let name = if *faults == 0 { "any method" } else { name };
            let quantity = format!("{}, {}, {name}", sky.name(), faults_in_words(*faults));
            rows.push(Row::new(quantity, "", score.accuracy(), Judgement::Ours).because(score.others()));
        }
    }
    let title = "The recording of Esbjerg (2020-06-25), accuracy in % by method".to_owned();
    Section { title, rows }
}

fn picture(scores: &Scores) -> Result<Picture> {
    let named = METHODS.iter().enumerate();
    let chart = BarChart {
        title: "Faults of 150 m in a real recording, isolated correctly".to_owned(),
        y_label: "accuracy / %".to_owned(),
        x_label: "GPS + BeiDou; GPS alone; BeiDou alone".to_owned(),
        groups: ["one", "two", "three", "one, GPS", "one, BeiDou"].map(str::to_owned).to_vec(),
        bars: named
            .map(|(column, (name, _))| {
                let of = |case: usize| scores[case][column].percent();
                ((*name).to_owned(), [1, 2, 3, 5, 7].map(of).to_vec())
            })
            .collect(),
    };
    let caption = "A day at Esbjerg: any search isolates one fault, grouping isolates two and three.";
    Picture::draw("tian2024-esbjerg", caption, |ground| chart.svg((860, 400), ground))
}
