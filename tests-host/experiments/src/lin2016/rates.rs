//! Figures 4 and 5: rates at which a bias is detected, and at which its satellite is identified.
//!
//! ```text
//! P_D(b) = 1 − G(τ1; ν, (b/σ)² S_ii)            exact, for a bias of satellite i
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `b` | bias | m |
//! | `S_ii` | redundancy number, from the core's snapshot | – |
//! | `G` | lower tail of the non-central χ² distribution | – |
//!
//! In every epoch one satellite in view is drawn. The exact rate is the mean over all that could
//! have been drawn, epoch by epoch. Evaluating `P_D` for one drawn satellite per epoch gives a
//! sample of it, whose deviation is computed beside it.
//!
//! The rates of identification include all trials: the w-test runs even if the global test has not
//! detected. The paper must have done the same, because in its figures identification leads
//! detection.

use anyhow::Context as _;
use raim::in_order::Together as _;
use raim_core::internals::integrity::raim::detection::detect;
use raim_core::internals::integrity::raim::isolation::baarda::identify;
use rand::RngExt as _;

use super::{Day, EPOCHS, Finding, Judgement, Picture, Row, SEED, SIGMA_M, Section, faulty, pose};
use crate::draw::generator;

use raim::page::canvas::{BLUE, INK, Mark, ORANGE, RGBColor, VIOLET};
use raim::page::chart::{Axis, LineChart, Series};
use raim::second_opinion::chi_square;

/// Number of biases: steps of ten metres, from no bias to 100 m.
const BIASES: usize = 11;

fn bias_m(step: usize) -> f64 {
    10.0 * step as f64
}

/// Exact rates of detection of an independent program, with one satellite drawn for each epoch.
const REFERENCE: [(usize, f64); 7] =
    [(2, 0.024), (3, 0.212), (4, 0.599), (5, 0.838), (6, 0.932), (7, 0.975), (8, 0.992)];
/// Rounding of these rates.
const ROUNDING: f64 = 5e-4;
/// Two-sided 95 % point of the normal distribution.
const NORMAL_95: f64 = 1.96;

/// An exact rate of detection.
#[derive(Clone, Copy)]
struct Exact {
    /// Mean over the satellites in view, then over the epochs.
    rate: f64,
    /// Standard deviation of the mean with one satellite drawn for each epoch.
    deviation: f64,
}

fn exact(day: &Day) -> anyhow::Result<Vec<Exact>> {
    let epochs: Vec<[(f64, f64); BIASES]> =
        (0..EPOCHS).together(|epoch| moments(day, epoch)).collect::<anyhow::Result<_>>()?;
    let of_bias = |step: usize| {
        let sum =
            |pick: fn(&(f64, f64)) -> f64| epochs.iter().map(|moments| pick(&moments[step])).sum::<f64>();
        let count = EPOCHS as f64;
        Exact {
            rate: sum(|&(mean, _)| mean) / count,
            deviation: sum(|&(_, variance)| variance).sqrt() / count,
        }
    };
    Ok((0..BIASES).map(of_bias).collect())
}

/// Returns mean and variance of `P_D` over the satellites of one epoch, for every bias.
fn moments(day: &Day, epoch: usize) -> anyhow::Result<[(f64, f64); BIASES]> {
    let mut workspace = pose::<f64>(&day.rows(epoch, 0))?;
    let snapshot = workspace.solve()?;
    let tau = day.thresholds.tau1(snapshot.dof()).context("beyond the tables")?;
    Ok(std::array::from_fn(|step| {
        let detection = |redundancy: f64| {
            let noncentrality = (bias_m(step) / SIGMA_M).powi(2) * redundancy;
            1.0 - chi_square::noncentral_lower_tail(tau, snapshot.dof(), noncentrality).0
        };
        let rates: Vec<f64> = snapshot.rows().map(|(_, fit)| detection(fit.redundancy)).collect();
        let mean = rates.iter().sum::<f64>() / rates.len() as f64;
        let squares = rates.iter().map(|rate| (rate - mean).powi(2)).sum::<f64>();
        (mean, squares / rates.len() as f64)
    }))
}

/// Counts of the trials with one bias.
#[derive(Clone, Copy, Default)]
struct Counts {
    detected: usize,
    named: usize,
    detected_and_named: usize,
}

impl Counts {
    fn add(self, other: Self) -> Self {
        Self {
            detected: self.detected + other.detected,
            named: self.named + other.named,
            detected_and_named: self.detected_and_named + other.detected_and_named,
        }
    }
}

fn simulate(day: &Day, trials: usize) -> anyhow::Result<[Counts; BIASES]> {
    let sum = |a: [Counts; BIASES], b: [Counts; BIASES]| std::array::from_fn(|step| a[step].add(b[step]));
    (0..trials * EPOCHS).together_sum(|number| try_all_biases(day, number), Default::default(), sum)
}

/// Tries all biases with one noise and one satellite, in the scalar type of the target.
fn try_all_biases(day: &Day, number: usize) -> anyhow::Result<[Counts; BIASES]> {
    let (trial, epoch) = (number / EPOCHS, number % EPOCHS);
    let rows = day.rows(epoch, trial);
    let chosen = generator(SEED, number as u64).random_range(0..rows.len());
    let mut counts = [Counts::default(); BIASES];
    for (step, counts) in counts.iter_mut().enumerate() {
        let mut workspace = pose::<f32>(&faulty(&rows, chosen, bias_m(step)))?;
        let snapshot = workspace.solve()?;
        let detected = detect(&snapshot, &day.thresholds).context("beyond the tables")?.fault();
        let named = identify(&snapshot, &day.thresholds) == Ok(chosen);
        let one = usize::from;
        *counts =
            Counts { detected: one(detected), named: one(named), detected_and_named: one(detected && named) };
    }
    Ok(counts)
}

/// Returns both figures with their tables.
pub(super) fn figures_4_and_5(day: &Day, trials: usize) -> anyhow::Result<(Vec<Section>, Vec<Picture>)> {
    let exact = exact(day)?;
    let counts = simulate(day, trials)?;
    let rate =
        |pick: fn(&Counts) -> usize, step: usize| Finding::rate(pick(&counts[step]), trials * EPOCHS, 3);
    let rows = |what: &str, whole_at_m: f64, pick: fn(&Counts) -> usize| -> Vec<Row> {
        (0..BIASES).map(|step| simulated_row(what, step, whole_at_m, rate(pick, step))).collect()
    };
    let detected = held_to_reference(rows("detected", 70.0, |counts| counts.detected));
    let sections = vec![
        Section { title: "Figure 4: detection by theory, mean over all satellites in view; held to a mean over drawn ones"
                .into(), rows: exact_rows(&exact) },
        Section { title: "Figure 4: detection, simulated".into(), rows: detected },
        Section {
            title: "Figure 5: identification, the w-test alone".into(),
            rows: rows("named", 60.0, |counts| counts.named),
        },
        Section {
            title: "Figure 5: identification after detection".into(),
            rows: rows("detected and named", 60.0, |counts| counts.detected_and_named),
        },
    ];
    Ok((sections, vec![figure_4(&exact, &counts, trials)?, figure_5(&counts, trials)?]))
}

/// Returns the paper's words about its curves: they rise from 10 m on and reach 1 at 70 m and at
/// about 60 m.
fn printed(step: usize, whole_at_m: f64) -> (&'static str, Judgement) {
    if step == 1 {
        ("begins to rise", Judgement::InTrend)
    } else if (bias_m(step) - whole_at_m).abs() < 1.0 {
        ("1", Judgement::InTrend)
    } else {
        ("", Judgement::Ours)
    }
}

fn simulated_row(what: &str, step: usize, whole_at_m: f64, ours: Finding) -> Row {
    let (paper, judgement) = printed(step, whole_at_m);
    let row = Row::new(format!("{what} at {} m", bias_m(step)), paper, ours, judgement);
    if paper == "1" {
        row.because("read off a curve: satellites low in redundancy stay hidden longer")
    } else {
        row
    }
}

/// Requires the simulation to agree within 0.03, as 2,882 trials allow.
fn held_to_reference(rows: Vec<Row>) -> Vec<Row> {
    let held = |(step, row): (usize, Row)| match REFERENCE.iter().find(|(known, _)| *known == step) {
        Some(&(_, want)) => row.held_to(7, want, 0.03),
        None => row,
    };
    rows.into_iter().enumerate().map(held).collect()
}

/// Requires the exact rates to agree with the reference within the effect of drawing one satellite
/// per epoch: more than 0.01 at 40 and 50 m, less elsewhere.
fn exact_rows(exact: &[Exact]) -> Vec<Row> {
    let row = |(step, &Exact { rate, deviation }): (usize, &Exact)| {
        let (paper, judgement) = printed(step, 70.0);
        let row =
            Row::new(format!("detected at {} m", bias_m(step)), paper, Finding::exact(rate, 4), judgement);
        match REFERENCE.iter().find(|(known, _)| *known == step) {
            Some(&(_, want)) => row
                .because(format!(
                    "drawing one satellite an epoch moves the mean by {deviation:.4} (one sigma)"
                ))
                .held_to(7, want, ten_thousandths(NORMAL_95 * deviation + ROUNDING)),
            None => row,
        }
    };
    exact.iter().enumerate().map(row).collect()
}

fn ten_thousandths(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}

fn line(name: &str, colour: RGBColor, mark: Mark, rate: impl Fn(usize) -> f64) -> Series {
    let points = (0..BIASES).map(|step| (bias_m(step), rate(step))).collect();
    Series { name: name.to_owned(), colour, mark, points }
}

/// Returns the points that the paper's words give for its curve.
fn printed_points(whole_at_m: f64) -> Series {
    let points = vec![(10.0, 0.0), (whole_at_m, 1.0)];
    Series { name: "paper: rises, is whole".into(), colour: INK, mark: Mark::Dots, points }
}

fn chart(title: &str, series: Vec<Series>) -> LineChart {
    LineChart {
        title: title.to_owned(),
        x: Axis::linear("bias / m").over(0.0..100.0),
        y: Axis::linear("rate").over(0.0..1.05),
        series,
        spans: Vec::new(),
    }
}

fn share(count: usize, trials: usize) -> f64 {
    count as f64 / (trials * EPOCHS) as f64
}

fn figure_4(exact: &[Exact], counts: &[Counts; BIASES], trials: usize) -> anyhow::Result<Picture> {
    let simulated = |step: usize| share(counts[step].detected, trials);
    let series = vec![
        line("exact", BLUE, Mark::Line, |step| exact[step].rate),
        line("simulated", ORANGE, Mark::Dots, simulated),
        printed_points(70.0),
    ];
    let chart = chart("Figure 4: rate of detection", series);
    let caption = "The larger the bias of one satellite, the surer it is detected: by theory, and counted.";
    Picture::draw("lin2016-figure-4", caption, |ground| chart.svg((720, 400), ground))
}

fn figure_5(counts: &[Counts; BIASES], trials: usize) -> anyhow::Result<Picture> {
    let series = vec![
        line("w-test alone", VIOLET, Mark::Line, |step| share(counts[step].named, trials)),
        line("after detection", BLUE, Mark::Dashed, |step| share(counts[step].detected_and_named, trials)),
        printed_points(60.0),
    ];
    let chart = chart("Figure 5: rate of identification", series);
    let caption =
        "The w-test alone names the satellite some metres earlier than the global test detects the fault.";
    Picture::draw("lin2016-figure-5", caption, |ground| chart.svg((720, 400), ground))
}
