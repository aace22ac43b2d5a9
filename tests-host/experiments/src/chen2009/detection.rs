//! Figure 6: size of a bias that the test detects, with and without a forecast clock.
//!
//! ```text
//! P_D(b) = 1 − G(τ1; ν, λ)      λ = b² S_ii / σ²      averaged over instants and satellites
//! σ_b² = (σ TDOP)² + σ_predict²
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `b` | bias of one satellite | m |
//! | `σ` | standard deviation of a range | m |
//! | `S_ii` | redundancy number of the faulty satellite, the clock's row included | – |
//! | `TDOP` | time dilution of precision of the same satellites | – |
//! | `σ_predict` | of table 1: 0.34, 1.13, 1.16 m | m |
//!
//! The result is exact. With fewer satellites than are in view, the highest ones count. References:
//! [Chen2009] eq. 3–12 and figure 6.
//!
//! [Chen2009]: raim#references

use anyhow::Result;
use indicatif::ProgressBar;
use nalgebra::Vector3;
use raim::in_order::Together as _;
use raim::page::canvas::{BLUE, GREY, Mark, ORANGE, VIOLET};
use raim::page::chart::{Axis, LineChart, Series};
use raim::second_opinion::chi_square::noncentral_lower_tail;
use raim::signal::sky::{Fleet, Sight, Site, sights};
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::least_squares::Workspace;
use raim_core::internals::least_squares::equations::LinearEpoch;
use raim_core::internals::numeric::probability::Probability;
use raim_core::satellite::Constellation::Gps;

use super::super::{Finding, Judgement, Picture, Row, Section};

/// Standard deviations of a range, m: the paper's, and two of present receivers.
pub(super) const SIGMAS_M: [f64; 3] = [6.0, 2.0, 1.0];

const FALSE_ALARM: f64 = 1e-3;

/// Probability needed only for the tables, which come in pairs. The test does not use missed
/// detection.
const MISSED_DETECTION: f64 = 1e-3;

/// Largest bias, m.
const BIAS_LIMIT_M: f64 = 200.0;

/// An aid beside the satellites.
#[derive(Clone, Copy)]
struct Aid {
    name: &'static str,
    /// Value in figure 6, m.
    paper: &'static str,
    /// Reason for a difference from ours.
    why: &'static str,
    clock: Clock,
}

#[derive(Clone, Copy)]
enum Clock {
    Unknown,
    /// Solved with `σ TDOP`, then forecast with this standard deviation, m.
    Forecast(f64),
    /// Known with this total standard deviation, m.
    Known(f64),
}

const AIDS: [Aid; 5] = [
    Aid { name: "no aid", paper: "", why: "", clock: Clock::Unknown },
    Aid {
        name: "polynomial",
        paper: "50",
        why: "By eq. 3 σ_b is at least σ TDOP, whatever forecasts: with these σ_predict the three aids differ by less than 1 %.",
        clock: Clock::Forecast(1.16),
    },
    Aid { name: "ref. [2]", paper: "40", why: "As for the polynomial.", clock: Clock::Forecast(1.13) },
    Aid {
        name: "CWUC",
        paper: "16",
        why: "With 6 m of noise no test sees 16 m; it would take a noise of 1.5 to 2 m.",
        clock: Clock::Forecast(0.34),
    },
    Aid { name: "clock known to 0.4 m", paper: "", why: "", clock: Clock::Known(0.4) },
];

/// A fault on one satellite at one instant.
#[derive(Clone, Copy)]
struct Case {
    dof: usize,
    redundancy: f64,
}

/// Returns the satellites of one instant, the highest first.
fn sky(instant: usize, instants: usize) -> Vec<Sight> {
    const DAY_S: f64 = 86_164.1;
    let chengdu = Site::geodetic(30.67, 104.06, 500.0);
    let t_s = DAY_S * instant as f64 / instants as f64;
    let mut seen = sights(&Fleet::Gps24.satellites(), &chengdu, t_s, 10.0_f64.to_radians());
    seen.sort_by(|a, b| b.line_of_sight.up.total_cmp(&a.line_of_sight.up));
    seen
}

/// Returns the possible faults; none if fewer than `most` satellites are in view, or no test is
/// possible.
fn cases(seen: &[Sight], most: Option<usize>, sigma_m: f64, clock: Clock) -> Vec<Case> {
    let Some(chosen) = seen.get(..most.unwrap_or(seen.len())) else { return Vec::new() };
    let mut epoch = LinearEpoch::<f64, 24>::new();
    for sight in chosen {
        let raim_core::frame::Enu { east, north, up } = sight.line_of_sight;
        epoch.satellite(Gps, Vector3::new(east, north, up), 0.0, sigma_m).expect("a sight is a sound row");
    }
    let mut workspace = Workspace::of(epoch.clone());
    let Ok(alone) = workspace.solve() else { return Vec::new() };
    let solved_m2 = alone.clock_variance(Gps).unwrap_or(f64::INFINITY);
    let sigma_b_m = match clock {
        Clock::Unknown => None,
        Clock::Forecast(sigma_predict_m) => Some(libm::sqrt(solved_m2 + sigma_predict_m * sigma_predict_m)),
        Clock::Known(sigma_b_m) => Some(sigma_b_m),
    };
    if let Some(sigma_b_m) = sigma_b_m {
        epoch.clock(Gps, 0.0, sigma_b_m).expect("a sound row");
    }
    let mut workspace = Workspace::of(epoch);
    let Some(snapshot) = workspace.solve().ok().filter(|snapshot| snapshot.dof() > 0) else {
        return Vec::new();
    };
    let of_satellites = snapshot.rows().take(chosen.len());
    of_satellites.map(|(_, fit)| Case { dof: snapshot.dof(), redundancy: fit.redundancy }).collect()
}

/// Returns all cases of a day under one aid.
fn day(skies: &[Vec<Sight>], most: Option<usize>, sigma_m: f64, clock: Clock) -> Vec<Case> {
    skies.iter().flat_map(|seen| cases(seen, most, sigma_m, clock)).collect()
}

/// Probabilities of detection by degrees of freedom and `√λ`: exact at the nodes, within 2e-5
/// between them.
struct Power(Vec<Vec<f64>>);

impl Power {
    /// Nodes for one unit of `√λ`.
    const NODES: f64 = 50.0;

    /// Value of `√λ` at which detection is certain: `√τ1` is below 6 for the degrees of freedom
    /// here.
    const CERTAIN: f64 = 16.0;

    fn tabulate() -> Self {
        let most = Fleet::Gps24.satellites().len() - 3;
        let probability = |tail| Probability::new(tail).expect("a probability");
        let thresholds = Thresholds::from_tables(probability(FALSE_ALARM), probability(MISSED_DETECTION));
        let thresholds = thresholds.expect("rows of the tables");
        let of_dof = |dof: usize| {
            let tau1 = thresholds.tau1(dof).expect("fewer satellites than the tables have");
            let node = |node: usize| {
                let root = node as f64 / Self::NODES;
                1.0 - noncentral_lower_tail(tau1, dof, root * root).0
            };
            (0..=(Self::CERTAIN * Self::NODES) as usize).map(node).collect()
        };
        Self((1..=most).together(of_dof).collect())
    }

    fn at(&self, dof: usize, root: f64) -> f64 {
        let place = root * Self::NODES;
        match self.0[dof - 1].get(place as usize..) {
            Some([low, high, ..]) => low + place.fract() * (high - low),
            _ => 1.0,
        }
    }

    /// Returns the mean over all cases under one bias.
    fn over(&self, cases: &[Case], bias_m: f64, sigma_m: f64) -> f64 {
        let of_case = |case: &Case| self.at(case.dof, bias_m / sigma_m * libm::sqrt(case.redundancy));
        cases.iter().map(of_case).sum::<f64>() / cases.len() as f64
    }

    /// Returns the smallest bias that is detected at this rate, m.
    fn bias(&self, cases: &[Case], wanted: f64, sigma_m: f64) -> Finding {
        let enough = |bias_m: f64| self.over(cases, bias_m, sigma_m) >= wanted;
        if cases.is_empty() {
            return Finding::Words("no test".into());
        }
        if !enough(BIAS_LIMIT_M) {
            return Finding::Words(format!("beyond {BIAS_LIMIT_M}"));
        }
        let (mut low_m, mut high_m) = (0.0, BIAS_LIMIT_M);
        while high_m - low_m > 0.01 {
            let middle_m = f64::midpoint(low_m, high_m);
            if enough(middle_m) { high_m = middle_m } else { low_m = middle_m }
        }
        Finding::exact(high_m, 1)
    }
}

/// A line of the table: number of satellites, aid, share of the faults.
struct Line {
    most: Option<usize>,
    aid: usize,
    wanted: f64,
}

pub(super) fn sections(instants: usize, bar: &ProgressBar) -> Vec<Section> {
    let (skies, power) = (skies(instants), Power::tabulate());
    let each = SIGMAS_M.into_iter().enumerate();
    each.map(|(index, sigma_m)| {
        let as_published = index == 0;
        let lines = if as_published {
            few_satellites().chain(all_satellites(&[0, 1, 2, 3, 4])).collect()
        } else {
            all_satellites(&[0, 3, 4]).collect::<Vec<_>>()
        };
        let rows = lines.iter().map(|line| row(line, &skies, &power, sigma_m, as_published)).collect();
        bar.inc(instants as u64);
        Section { title: format!("Figure 6: bias detected at a given rate, σ {sigma_m} m, exact"), rows }
    })
    .collect()
}

/// Returns the lines with few satellites. Four detect hardly more than half of the faults, five
/// most of them.
fn few_satellites() -> impl Iterator<Item = Line> {
    [(4, 0.5), (4, 0.95), (5, 0.5), (5, 0.95), (6, 0.95), (6, 0.99)]
        .into_iter()
        .flat_map(|(most, wanted)| [0, 3, 4].map(|aid| Line { most: Some(most), aid, wanted }))
}

fn all_satellites(aids: &[usize]) -> impl Iterator<Item = Line> {
    [0.95, 0.99].into_iter().flat_map(|wanted| aids.iter().map(move |&aid| Line { most: None, aid, wanted }))
}

fn skies(instants: usize) -> Vec<Vec<Sight>> {
    (0..instants).map(|instant| sky(instant, instants)).collect()
}

fn row(line: &Line, skies: &[Vec<Sight>], power: &Power, sigma_m: f64, as_published: bool) -> Row {
    let aid = &AIDS[line.aid];
    let found = power.bias(&day(skies, line.most, sigma_m, aid.clock), line.wanted, sigma_m);
    let satellites = line.most.map_or("all".into(), |most| most.to_string());
    let quantity =
        format!("{satellites} satellites, {}: {:.0} % detected / m", aid.name, 100.0 * line.wanted);
    // The paper's biases are those from which on every fault was detected.
    if as_published && line.most.is_none() && line.wanted > 0.98 && !aid.paper.is_empty() {
        Row::new(quantity, aid.paper, found, Judgement::NotReproducible).because(aid.why)
    } else {
        Row::new(quantity, "", found, Judgement::Ours)
    }
}

/// Draws figure 6 with all satellites in view and `σ = 6 m`; the paper's three biases are dots at
/// full rate.
pub(super) fn picture(instants: usize) -> Result<Picture> {
    let (skies, power, sigma_m) = (skies(instants), Power::tabulate(), SIGMAS_M[0]);
    let curve = |name: &str, most: Option<usize>, aid: usize, colour, mark| {
        let cases = day(&skies, most, sigma_m, AIDS[aid].clock);
        let point = |bias: u32| (f64::from(bias), 100.0 * power.over(&cases, f64::from(bias), sigma_m));
        Series { name: name.into(), colour, mark, points: (0..=100).map(point).collect() }
    };
    let paper = Series {
        name: "paper: 16, 40, 50 m".into(),
        colour: ORANGE,
        mark: Mark::Dots,
        points: vec![(16.0, 100.0), (40.0, 100.0), (50.0, 100.0)],
    };
    let chart = LineChart {
        title: "Figure 6: faults detected by number of satellites, σ 6 m".into(),
        x: Axis::linear("bias of one satellite / m").over(0.0..100.0),
        y: Axis::linear("detected / %").over(0.0..104.0),
        series: vec![
            curve("all, no aid", None, 0, GREY, Mark::Line),
            curve("all, CWUC", None, 3, BLUE, Mark::Line),
            curve("5, no aid", Some(5), 0, GREY, Mark::Dashed),
            curve("5, CWUC", Some(5), 3, BLUE, Mark::Dashed),
            curve("4, CWUC", Some(4), 3, VIOLET, Mark::Dashed),
            paper,
        ],
        spans: Vec::new(),
    };
    let caption = "Detection rate against bias, by number of satellites, with a forecast clock and without. Polynomial and \
                   AR(3) with fixed parameters would lie on the line of CWUC.";
    Picture::draw("chen2009-figure-6", caption, |ground| chart.svg((920, 420), ground))
}
