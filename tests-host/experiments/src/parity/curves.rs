//! Figures 4 and 5: rates at which a bias of one satellite is detected and isolated, over 12 h.
//!
//! Detection is exact for each geometry, `P_D = 1 − G(τ1; ν, b² S_ii/σ²)`, with `S_ii` from the
//! core; isolation is method C with random noise. An epoch without redundancy detects nothing, and
//! one with a single degree of freedom isolates nothing: the paper's unavailable moments.

use anyhow::Result;
use indicatif::ProgressBar;
use raim::in_order::Together as _;
use raim::page::canvas::{Mark, SERIES};
use raim::page::chart::{Axis, LineChart, Series};
use raim::second_opinion::chi_square::noncentral_lower_tail;
use raim::signal::sky::{Satellite, Sight, Site, linear, sights};
use raim_core::internals::integrity::raim::isolation::parity::hybrid;
use raim_core::internals::least_squares::Workspace;
use raim_core::satellite::Constellation;
use rand_distr::{Distribution as _, StandardNormal};

use super::super::draw::generator;
use super::super::{Effort, Finding, Interval, Judgement, Picture, Row, Section};
use super::{MASK_RAD, MOST_ROWS, Sky, limits, thresholds};

const HOURS: f64 = 12.0;
const STEP_M: f64 = 20.0;
/// Number of biases: 0, 20, … 500 m.
const BIASES: usize = 26;
const SKIES: [Sky; 3] = [Sky::Gps, Sky::Early, Sky::Both];
const SIGMAS_M: [f64; 2] = [6.0, 20.0];
/// Number of the faulty satellite, of `BeiDou` if both systems are in view.
const FAULTY: u8 = 3;
const SEED: u64 = 0x9A84;

/// Returns the time between epochs, s; the full form has the paper's.
pub(super) fn step_s(effort: Effort) -> f64 {
    effort.pick(120.0, 30.0)
}

/// Returns the number of steps of the progress bar: epochs.
pub(super) fn steps(effort: Effort) -> u64 {
    (HOURS * 3600.0 / step_s(effort)) as u64
}

/// Sums over the epochs of one sky and sigma, by bias.
#[derive(Clone, Copy, Debug, Default)]
struct Curve {
    /// Number of epochs in which the faulty satellite is in view.
    epochs: usize,
    detected: [f64; BIASES],
    isolated: [usize; BIASES],
}

impl Curve {
    fn and(&self, other: &Self) -> Self {
        Self {
            epochs: self.epochs + other.epochs,
            detected: std::array::from_fn(|bias| self.detected[bias] + other.detected[bias]),
            isolated: std::array::from_fn(|bias| self.isolated[bias] + other.isolated[bias]),
        }
    }

    fn detection(&self, bias: usize) -> f64 {
        self.detected[bias] / self.epochs as f64
    }

    fn isolation(&self, bias: usize) -> f64 {
        self.isolated[bias] as f64 / self.epochs as f64
    }
}

/// Curves by sky and sigma.
type Curves = [[Curve; SIGMAS_M.len()]; SKIES.len()];

fn is_faulty(sky: Sky, sight: &Sight) -> bool {
    let constellation = if sky == Sky::Gps { Constellation::Gps } else { Constellation::Beidou };
    sight.satellite.constellation() == constellation && sight.satellite.number() == FAULTY
}

/// Adds one epoch to a curve. `seen` has the noise of each range in units of its sigma.
fn add(curve: &mut Curve, seen: &[(&Sight, f64)], faulty: usize, sigma_m: f64) -> Result<()> {
    curve.epochs += 1;
    let thresholds = thresholds()?;
    for bias in 0..BIASES {
        let bias_m = bias as f64 * STEP_M;
        let row = |(index, (sight, noise)): (usize, &(&Sight, f64))| {
            let y_m = sigma_m * noise + if index == faulty { bias_m } else { 0.0 };
            linear::Row { satellite: sight.satellite, line_of_sight: sight.line_of_sight, sigma_m, y_m }
        };
        let rows: Vec<linear::Row> = seen.iter().enumerate().map(row).collect();
        let mut workspace = Workspace::of(linear::equations::<f32, MOST_ROWS>(&rows)?);
        let Ok(snapshot) = workspace.solve() else {
            return Ok(());
        };
        let (dof, Some(threshold)) = (snapshot.dof(), thresholds.tau1(snapshot.dof())) else { return Ok(()) };
        let redundancy = snapshot.row(faulty).map_or(0.0, |(_, fit)| f64::from(fit.redundancy.max(0.0)));
        let noncentrality = (bias_m / sigma_m).powi(2) * redundancy;
        curve.detected[bias] += 1.0 - noncentral_lower_tail(threshold, dof, noncentrality).0;
        let found = hybrid(&snapshot, &thresholds, &limits());
        let correct = found.set.is_ok_and(|set| {
            let mut named = set.rows().iter().map(|row| row.index);
            named.next() == Some(faulty) && named.next().is_none()
        });
        curve.isolated[bias] += usize::from(correct);
    }
    Ok(())
}

fn epoch(satellites: &[Satellite], site: &Site, index: u64, t_s: f64) -> Result<Curves> {
    let all = sights(satellites, site, t_s, MASK_RAD);
    let mut draw = generator(SEED, index);
    let mut curves = Curves::default();
    for (sky, by_sigma) in SKIES.into_iter().zip(&mut curves) {
        // Every bias and sigma has the same noise, so that the curves are smooth and differ only by
        // their subject.
        let mut with_noise = |sight| (sight, StandardNormal.sample(&mut draw));
        let seen: Vec<(&Sight, f64)> =
            all.iter().filter(|sight| sky.has(sight)).map(&mut with_noise).collect();
        let Some(faulty) = seen.iter().position(|(sight, _)| is_faulty(sky, sight)) else { continue };
        for (sigma_m, curve) in SIGMAS_M.into_iter().zip(by_sigma) {
            add(curve, &seen, faulty, sigma_m)?;
        }
    }
    Ok(curves)
}

fn curves(effort: Effort, bar: &ProgressBar) -> Result<Curves> {
    let (satellites, site) = (Sky::satellites(), Site::geodetic(25.1, 121.6, 0.0));
    let of = |index: u64| {
        let curves = epoch(&satellites, &site, index, index as f64 * step_s(effort));
        bar.inc(1);
        curves
    };
    // The results are collected first, because sums of floating-point numbers depend on their
    // order.
    let each: Vec<Curves> = (0..steps(effort)).together(of).collect::<Result<_>>()?;
    Ok(each.iter().fold(Curves::default(), |sum, curves| {
        std::array::from_fn(|sky| std::array::from_fn(|sigma| sum[sky][sigma].and(&curves[sky][sigma])))
    }))
}

/// Returns both figures, and the values read off them.
pub(super) fn figures(effort: Effort, bar: &ProgressBar) -> Result<(Vec<Section>, Vec<Picture>)> {
    let curves = curves(effort, bar)?;
    let detection = picture(
        "parity-figure-4",
        "Detection of a bias of satellite 3 over 12 h",
        "detected / %",
        "Figure 4: with both systems every larger bias is detected; early BeiDou alone has moments in which it is not.",
        &curves,
        Curve::detection,
    )?;
    let isolation = picture(
        "parity-figure-5",
        "Isolation of a bias of satellite 3 over 12 h",
        "isolated correctly / %",
        "Figure 5: isolation needs a degree of freedom more than detection, and early BeiDou alone seldom has it.",
        &curves,
        Curve::isolation,
    )?;
    Ok((vec![detection_section(&curves), isolation_section(&curves)], vec![detection, isolation]))
}

/// Returns the smallest bias from which on a rate stays at least at `least`, as words.
fn reached(curve: &Curve, rate: impl Fn(&Curve, usize) -> f64, least: f64) -> Finding {
    let first = (0..BIASES).rev().take_while(|&bias| rate(curve, bias) >= least).last();
    match first {
        Some(bias) => Finding::exact(bias as f64 * STEP_M, 0),
        None => Finding::Words("never".to_owned()),
    }
}

const SIGMA_FREE: &str =
    "sigma and BeiDou's satellites are not printed: 140 m lies between sigma 6 m and 20 m";
const MOMENTS: &str =
    "the mechanism agrees: moments with little redundancy, whose share the unknown constellation decides";

fn detection_section(curves: &Curves) -> Section {
    let [_, beidou, both] = curves;
    let mut rows = Vec::new();
    for (sigma, sigma_m) in SIGMAS_M.iter().enumerate() {
        for (percent, paper) in [("99.99", "140"), ("99", "")] {
            let least = if paper.is_empty() { 0.99 } else { 0.9999 };
            let judgement = if paper.is_empty() { Judgement::Ours } else { Judgement::InTrend };
            let quantity = format!("both systems, sigma {sigma_m} m: bias detected in {percent} %, m");
            let ours = reached(&both[sigma], Curve::detection, least);
            let row = Row::new(quantity, paper, ours, judgement);
            rows.push(if paper.is_empty() { row } else { row.because(SIGMA_FREE) });
        }
    }
    for (sigma, sigma_m) in SIGMAS_M.iter().enumerate() {
        let ours = Finding::exact(100.0 * beidou[sigma].detection(BIASES - 1), 1);
        let quantity = format!("BeiDou alone, sigma {sigma_m} m: detected of 500 m, %");
        rows.push(Row::new(quantity, "below 100", ours, Judgement::InTrend).because(MOMENTS));
    }
    Section { title: "Figure 4, detection".to_owned(), rows }
}

fn isolation_section(curves: &Curves) -> Section {
    let [_, beidou, both] = curves;
    let mut rows = Vec::new();
    for (sigma, sigma_m) in SIGMAS_M.iter().enumerate() {
        let quantity = format!("both systems, sigma {sigma_m} m: bias isolated in 99 %, m");
        rows.push(Row::new(quantity, "", reached(&both[sigma], Curve::isolation, 0.99), Judgement::Ours));
        let curve = &beidou[sigma];
        let Interval { low, high } = Interval::of_rate(curve.isolated[BIASES - 1], curve.epochs);
        let interval = Some(Interval { low: 100.0 * low, high: 100.0 * high });
        let ours = Finding::Number { value: 100.0 * curve.isolation(BIASES - 1), decimals: 1, interval };
        let quantity = format!("BeiDou alone, sigma {sigma_m} m: isolated of 500 m, %");
        rows.push(Row::new(quantity, "below 100", ours, Judgement::InTrend).because(MOMENTS));
    }
    Section { title: "Figure 5, isolation".to_owned(), rows }
}

fn picture(
    name: &str,
    title: &str,
    y: &str,
    caption: &str,
    curves: &Curves,
    rate: fn(&Curve, usize) -> f64,
) -> Result<Picture> {
    let mut series = Vec::new();
    for ((sky, by_sigma), colour) in SKIES.iter().zip(curves).zip(SERIES) {
        for ((sigma_m, curve), mark) in SIGMAS_M.iter().zip(by_sigma).zip([Mark::Line, Mark::Dashed]) {
            let points = (0..BIASES).map(|bias| (bias as f64 * STEP_M, 100.0 * rate(curve, bias)));
            let name = sky.name().replace(", 24 satellites", "").replace(", 3 GEO + 3 IGSO + 4 MEO", "");
            series.push(Series {
                name: format!("{name}, {sigma_m} m"),
                colour,
                mark,
                points: points.collect(),
            });
        }
    }
    if name == "parity-figure-4" {
        let (name, mark) = ("paper, both: 100 %".to_owned(), Mark::Dots);
        series.push(Series { name, colour: SERIES[SKIES.len() - 1], mark, points: vec![(140.0, 100.0)] });
    }
    let chart = LineChart {
        title: title.to_owned(),
        x: Axis::linear("bias / m").over(0.0..300.0),
        y: Axis::linear(y).over(0.0..104.0),
        series,
        spans: vec![],
    };
    Picture::draw(name, caption, |ground| chart.svg((860, 420), ground))
}
