//! Tables of the flight: rates of correct answers, errors of the position, and cost.

use std::time::Instant;

use anyhow::Result;
use raim::page::canvas::{BLUE, GREEN, GREY, Mark, ORANGE, RED, VIOLET};
use raim::page::chart::{Axis, LineChart, Series, Span};
use raim::signal::sky::linear::{Sigma, equations, rows};
use raim::signal::sky::sights;
use raim_core::internals::integrity::raim::isolation::parity;
use raim_core::internals::integrity::raim::isolation::ransac::{MAX_WORK, Selection};
use raim_core::internals::least_squares::Workspace;

use super::super::super::draw::generator;
use super::super::super::{Finding, Interval, Judgement, Picture, Row, Section};
use super::super::method::{Limits, Method, ROWS, Score, Traditional};
use super::super::{CLOCKS_M, MASK_RAD, faults_in_words};
use super::{
    Flight, IMPROVED, JUDGES, Opinion, PRINTED_CRITERION, SEGMENTS, SIGMA_M, Sample, View, segment, site,
};

/// Printed values of one stretch.
struct Printed {
    /// Missed, wrong, accuracy in percent: parity, traditional, improved.
    isolated: [(u32, u32, f64); 3],
    /// Horizontal and vertical error, m: all in view, parity, traditional, improved.
    horizontal_m: [f64; 4],
    vertical_m: [f64; 4],
}

const PRINTED: [Printed; SEGMENTS.len()] = [
    Printed {
        isolated: [(0, 181, 90.95), (263, 250, 74.35), (41, 35, 96.2)],
        horizontal_m: [66.47, 24.99, 55.94, 14.92],
        vertical_m: [15.78, 17.56, 37.43, 9.66],
    },
    Printed {
        isolated: [(23, 26, 97.55), (108, 207, 84.25), (17, 21, 98.1)],
        horizontal_m: [45.09, 9.74, 13.63, 9.40],
        vertical_m: [12.30, 6.71, 11.78, 6.11],
    },
    Printed {
        isolated: [(2, 1, 99.85), (4, 211, 89.25), (0, 1, 99.95)],
        horizontal_m: [32.55, 5.988, 10.42, 5.992],
        vertical_m: [11.30, 1.824, 6.56, 1.816],
    },
    Printed {
        isolated: [(0, 0, 100.0), (0, 2, 99.8), (0, 1, 99.9)],
        horizontal_m: [7.39; 4],
        vertical_m: [1.85; 4],
    },
];

/// Returns the printed column of a judge.
const fn column(judge: usize) -> usize {
    match judge {
        0 | 1 => judge,
        4 => 3,
        _ => 2,
    }
}

/// Returns the opinions of one judge over one stretch of one view.
fn opinions(
    samples: &[[Sample; 2]],
    view: usize,
    stretch: usize,
    judge: usize,
) -> impl Iterator<Item = (&Opinion, &[usize])> {
    let of_view = samples.iter().map(move |pair| &pair[view]);
    let within = of_view.filter(move |sample| segment(sample.second) == stretch);
    within.filter_map(move |sample| Some((sample.opinions[judge].as_ref()?, sample.faulty.as_slice())))
}

/// Returns all sections.
pub(super) fn sections(samples: &[[Sample; 2]]) -> Vec<Section> {
    let mut sections = Vec::new();
    for (view, name) in ["all satellites in view", "22 satellites"].into_iter().enumerate() {
        sections.push(isolation(samples, view, name));
        let title = format!("Table 7, horizontal error in m rms, {name}");
        sections.push(Section { title, rows: errors(samples, view, Judgement::InTrend, horizontal) });
    }
    let title = "Table 8, standard deviation of the height in m, all satellites in view: the printed 1.85 m, from \
                 ranges of 10.5 m, would need a vertical dilution of 0.18";
    let rows = errors(samples, 0, Judgement::NotReproducible, vertical);
    sections.push(Section { title: title.to_owned(), rows });
    sections.push(work(samples));
    sections
}

const LIMIT: &str = "turns on a limit that is not printed";
const WEAKER: &str =
    "the paper's parity method is not described: sequential isolation is right nearly always";

fn isolation(samples: &[[Sample; 2]], view: usize, name: &str) -> Section {
    let mut rows = Vec::new();
    for (stretch, printed) in PRINTED.iter().enumerate() {
        for (judge, judge_name) in JUDGES.iter().enumerate().skip(1) {
            let mut score = Score::default();
            opinions(samples, view, stretch, judge)
                .for_each(|(opinion, faulty)| score.add(&opinion.answer, faulty));
            let (missed, wrong, accuracy) = printed.isolated[column(judge) - 1];
            let (judgement, why) = match (stretch, judge) {
                (0, 1) => (Judgement::NotReproducible, WEAKER),
                (0 | 1, PRINTED_CRITERION) => (Judgement::NotReproducible, LIMIT),
                (3, _) => (Judgement::Reproduced, ""),
                _ => (Judgement::InTrend, ""),
            };
            let reason = [score.others().as_str(), why].join("; ");
            let quantity = format!("{}, {judge_name}", faults_in_words(SEGMENTS[stretch].faults));
            let paper = format!("{accuracy} ({missed} missed, {wrong} wrong)");
            let row = Row::new(quantity, paper, score.accuracy(), judgement);
            rows.push(row.because(reason.trim_end_matches("; ")));
        }
    }
    Section { title: format!("Table 6, accuracy in %, {name}"), rows }
}

/// Function that returns the printed and the found value of an error.
type Quantity = fn(&Printed, usize, &[&Opinion]) -> (f64, Finding);

fn horizontal(printed: &Printed, column: usize, opinions: &[&Opinion]) -> (f64, Finding) {
    let errors = opinions.iter().map(|opinion| opinion.horizontal_m);
    (printed.horizontal_m[column], deviation(errors, 0.0))
}

fn vertical(printed: &Printed, column: usize, opinions: &[&Opinion]) -> (f64, Finding) {
    let errors = || opinions.iter().map(|opinion| opinion.up_m);
    let mean = errors().sum::<f64>() / opinions.len() as f64;
    (printed.vertical_m[column], deviation(errors(), mean))
}

fn errors(samples: &[[Sample; 2]], view: usize, judgement: Judgement, quantity: Quantity) -> Vec<Row> {
    let mut rows = Vec::new();
    for (stretch, printed) in PRINTED.iter().enumerate() {
        for (judge, name) in JUDGES.iter().enumerate() {
            let of_judge: Vec<&Opinion> =
                opinions(samples, view, stretch, judge).map(|(opinion, _)| opinion).collect();
            let (paper, ours) = quantity(printed, column(judge), &of_judge);
            let case = faults_in_words(SEGMENTS[stretch].faults);
            let turns = judge == PRINTED_CRITERION && judgement == Judgement::InTrend;
            let judgement = if turns { Judgement::NotReproducible } else { judgement };
            let row = Row::new(format!("{case}, {name}"), format!("{paper}"), ours, judgement);
            rows.push(row.because(if turns { LIMIT } else { "" }));
        }
    }
    rows
}

/// Returns the root mean square about a value.
fn deviation(values: impl Iterator<Item = f64>, about: f64) -> Finding {
    let squares: Vec<f64> = values.map(|value| (value - about).powi(2)).collect();
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    let Interval { low, high } = Interval::of_mean(&squares);
    let interval = Some(Interval { low: low.max(0.0).sqrt(), high: high.sqrt() });
    Finding::Number { value: mean.sqrt(), decimals: 2, interval }
}

/// Returns table 9 in units independent of the machine.
fn work(samples: &[[Sample; 2]]) -> Section {
    let works = || samples.iter().map(|[all, _]| all.work);
    let mean = |value: fn(&super::Work) -> f64| {
        works().map(|work| value(&work)).sum::<f64>() / works().count() as f64
    };
    let (minimal, chosen) = (mean(|work| work.minimal), mean(|work| work.chosen as f64));
    let seen = |work: super::Work| work.satellites;
    let satellites =
        format!("{} … {}", works().map(seen).min().unwrap_or(0), works().map(seen).max().unwrap_or(0));
    let ours = |what: &str, value: f64| Row::new(what, "", Finding::exact(value, 0), Judgement::Ours);
    let rows = vec![
        Row::new("satellites in view", "", Finding::Words(satellites), Judgement::Ours),
        ours("parity: sets looked at, mean", mean(|work| work.sets as f64)),
        ours("traditional: minimal subsets, mean", minimal),
        ours("improved: subsets, mean", chosen),
        ours("improved: triangles and tetrahedra, mean", mean(|work| work.tetrahedra as f64)),
        Row::new(
            "subsets, traditional / improved",
            "545 (times)",
            Finding::exact(minimal / chosen, 0),
            Judgement::InTrend,
        )
        .because("the paper's is a ratio of times, in which the choice of the subsets weighs too"),
    ];
    Section { title: "Table 9, work per epoch, all satellites in view".to_owned(), rows }
}

/// Number of timed epochs, and of minimal subsets from which the traditional method's time is
/// extrapolated.
const TIMED: u64 = 20;
const TIMED_SUBSETS: usize = 500;

/// Returns table 9 as times of this machine, which no test checks.
pub(super) fn times(flight: &Flight) -> Result<[Section; 1]> {
    let mut each_s = [const { Vec::new() }; 3];
    for index in 1..=TIMED {
        let second = index * 90;
        let seen = sights(&flight.satellites, &site(second), second as f64, MASK_RAD);
        let mut rows = rows(&seen, Sigma::Constant(SIGMA_M), CLOCKS_M, &flight.noise, second);
        rows[index as usize % seen.len()].y_m += super::BIAS_M;
        let epoch = equations::<f32, ROWS>(&rows)?;
        let taken_s = taken_s(&epoch, &flight.limits, second)?;
        each_s.iter_mut().zip(taken_s).for_each(|(times, taken)| times.push(taken));
    }
    // The median is used, because a mean would include the machine's other work.
    let [parity_s, traditional_s, improved_s] = each_s.map(|mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    });
    let row = |name: &str, printed: &str, ours: String| {
        Row::new(name, printed, Finding::Words(ours), Judgement::Ours)
            .because("other machine, other language")
    };
    let rows = vec![
        row("parity", "0.00214 s", format!("{:.0} µs", parity_s * 1e6)),
        row("traditional, extrapolated", "3.871 s", format!("{traditional_s:.2} s")),
        row("improved, with the choice of subsets", "0.0071 s", format!("{:.0} µs", improved_s * 1e6)),
        row("traditional / improved", "545", format!("{:.0}", traditional_s / improved_s)),
    ];
    Ok([Section {
        title: "Table 9, median time per epoch with one fault on one core, this machine".to_owned(),
        rows,
    }])
}

/// Returns the times that parity, traditional and improved method take for one epoch, solution
/// included, s.
fn taken_s(
    epoch: &raim_core::internals::least_squares::equations::LinearEpoch<f32, ROWS>,
    limits: &Limits,
    second: u64,
) -> Result<[f64; 3]> {
    let start = Instant::now();
    let mut workspace = Workspace::of(epoch.clone());
    let mut snapshot = workspace.solve()?;
    parity::exclude(parity::Isolation::Sequential, &mut snapshot, &limits.thresholds, &limits.parity);
    let parity_s = start.elapsed().as_secs_f64();

    let start = Instant::now();
    Traditional::Consensus.judge(epoch.rows(), limits, TIMED_SUBSETS, &mut generator(0, second))?;
    let (count, size) = (epoch.rows().len(), 5);
    let share =
        raim::second_opinion::ransac_traditional::combination_count(count, size) / TIMED_SUBSETS as f64;
    let traditional_s = start.elapsed().as_secs_f64() * share;

    let start = Instant::now();
    let mut workspace = Workspace::of(epoch.clone());
    let mut snapshot = workspace.solve()?;
    let selection = Selection::choose(snapshot.equations(), 2 * MAX_WORK);
    Method::Improved.exclude(&mut snapshot, &selection, limits);
    Ok([parity_s, traditional_s, start.elapsed().as_secs_f64()])
}

/// Time between the points of the picture, s.
const PICTURE_STEP_S: u64 = 20;

pub(super) fn figure_6(samples: &[[Sample; 2]]) -> Result<Picture> {
    let shown = || samples.iter().map(|pair| &pair[View::All as usize]);
    let shown = || shown().filter(|sample| sample.second.is_multiple_of(PICTURE_STEP_S));
    let line = |judge: usize, colour, mark| Series {
        name: JUDGES[judge].to_owned(),
        colour,
        mark,
        points: shown()
            .filter_map(|sample| Some((sample.second as f64, sample.opinions[judge].as_ref()?.horizontal_m)))
            .collect(),
    };
    let spans = [(0, RED), (1, ORANGE), (2, VIOLET)].map(|(stretch, colour)| {
        let start = if stretch == 0 { 0 } else { SEGMENTS[stretch - 1].end_s };
        let range = start as f64..SEGMENTS[stretch].end_s as f64;
        Span { name: faults_in_words(SEGMENTS[stretch].faults).to_owned(), range, colour }
    });
    let chart = LineChart {
        title: "Horizontal error of a flight with faults of 150 m".to_owned(),
        x: Axis::linear("time / s").over(0.0..7080.0),
        y: Axis::linear("horizontal error / m"),
        series: vec![
            line(0, GREY, Mark::Line),
            line(PRINTED_CRITERION, ORANGE, Mark::Dots),
            line(1, BLUE, Mark::Line),
            line(IMPROVED, GREEN, Mark::Dashed),
        ],
        spans: spans.to_vec(),
    };
    let caption =
        "Figure 6: who believes every satellite goes astray; who leaves the faulty ones out does not.";
    Picture::draw("tian2024-figure-6", caption, |ground| chart.svg((940, 420), ground))
}
