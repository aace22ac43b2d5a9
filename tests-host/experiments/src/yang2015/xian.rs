//! Figure 6: thresholds above Xi'an, and times without RAIM because `T1 ≥ T2`.
//!
//! With the printed alert limit of 556 m no minute is unavailable. With a share of it of 121.2 m
//! the regional system is unavailable in the paper's two windows, to within minutes. This requires
//! its phases to be 4266 min after `t = 0`, with the planes of the inclined orbits turned by 105°.

use std::ops::RangeInclusive;

use anyhow::Context as _;
use raim::page::canvas::{BLUE, INK, Mark, ORANGE, RED, VIOLET};
use raim::page::chart::{Axis, LineChart, Series, Span};
use raim::signal::sky::{Fleet, Satellite, Site, sights};
use raim_core::frame::Enu;
use raim_core::internals::integrity::raim::detection::threshold::policy::{
    Decision, ThresholdProblem, Weights, range_threshold_m,
};
use raim_core::internals::integrity::raim::levels::largest_slopes;
use raim_core::internals::integrity::raim::levels::noncentrality_at;
use raim_core::internals::numeric::probability::Probability;

use super::grid::pose;
use super::{FALSE_ALARM, LIMIT_M, MASK_DEG, MISSED_DETECTION, SIGMA_M, thresholds};
use crate::{Finding, Judgement, Picture, Row, Section};

/// Number of minutes of a day.
const MINUTES: usize = 1440;
/// Share of the alert limit at which the regional windows appear, m.
const FITTED_M: f64 = 121.2;
/// Start of the regional system's day, min.
const ORIGIN_MIN: usize = 4266;
/// Turn of the planes of its inclined orbits, degrees.
const TURN_DEG: f64 = 105.0;
/// The paper's unavailable minutes.
const PAPER_WINDOWS: [RangeInclusive<usize>; 2] = [106..=125, 1162..=1220];
/// Windows of an independent program with the same phases.
const REFERENCE_WINDOWS: [RangeInclusive<usize>; 2] = [112..=122, 1162..=1228];

/// One minute: number of satellites in view, protection level, and thresholds in metres.
struct Minute {
    visible: usize,
    hpl_m: f64,
    t1_m: f64,
    t2_m: f64,
    /// Optimal threshold, m; `None` if no threshold meets both probabilities.
    t_op_m: Option<f64>,
}

impl Minute {
    fn is_ordered(&self) -> bool {
        self.t_op_m.is_some_and(|t_op_m| self.t1_m < t_op_m && t_op_m < self.t2_m)
    }
}

/// Day of a constellation under one alert limit.
struct Day(Vec<Minute>);

impl Day {
    fn above_xian(satellites: &[Satellite], origin_min: usize, limit_m: f64) -> anyhow::Result<Self> {
        let site = Site::geodetic(34.17, 108.57, 400.0);
        let minute = |minute: usize| {
            let t_s = (origin_min + minute) as f64 * 60.0;
            let seen = sights(satellites, &site, t_s, MASK_DEG.to_radians());
            let directions: Vec<Enu> = seen.iter().map(|sight| sight.line_of_sight).collect();
            judge(&directions, limit_m)
        };
        Ok(Self((0..MINUTES).map(minute).collect::<anyhow::Result<_>>()?))
    }

    /// Returns the smallest and the largest value, as words.
    fn range(&self, decimals: usize, value: impl Fn(&Minute) -> f64) -> String {
        let values = || self.0.iter().map(&value).filter(|value| !value.is_nan());
        let (low, high) =
            (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        format!("{low:.decimals$} to {high:.decimals$}")
    }

    fn unavailable(&self) -> Vec<RangeInclusive<usize>> {
        windows((0..MINUTES).filter(|&minute| self.0[minute].t_op_m.is_none()))
    }

    fn count(&self, holds: fn(&Minute) -> bool) -> Finding {
        let count = self.0.iter().filter(|&minute| holds(minute)).count();
        Finding::Words(format!("{count} of {MINUTES} min"))
    }
}

fn judge(directions: &[Enu], limit_m: f64) -> anyhow::Result<Minute> {
    let mut workspace = pose::<f64>(directions, |_| 0.0)?;
    let snapshot = workspace.solve()?;
    let (dof, slopes, thresholds) = (snapshot.dof(), largest_slopes(&snapshot), thresholds(FALSE_ALARM)?);
    let demand = ThresholdProblem {
        dof,
        noncentrality: noncentrality_at(limit_m, slopes.horizontal),
        thresholds,
        missed_detection: Probability::new(MISSED_DETECTION).context("a probability")?,
        weights: Weights::EQUAL,
    };
    let Decision { tau1, tau2, tau_op, .. } = demand.decide::<f64>().context("beyond the tables")?;
    let metres = |tau: f64| range_threshold_m(tau, dof, SIGMA_M);
    Ok(Minute {
        visible: directions.len(),
        hpl_m: slopes.protect(thresholds.lambda(dof).context("beyond the tables")?).hpl_m,
        t1_m: metres(tau1),
        t2_m: metres(tau2),
        t_op_m: tau_op.map(metres),
    })
}

/// Groups minutes that follow each other into ranges.
fn windows(minutes: impl Iterator<Item = usize>) -> Vec<RangeInclusive<usize>> {
    let mut windows: Vec<RangeInclusive<usize>> = Vec::new();
    for minute in minutes {
        match windows.last_mut() {
            Some(window) if window.end() + 1 == minute => *window = *window.start()..=minute,
            _ => windows.push(minute..=minute),
        }
    }
    windows
}

fn words(windows: &[RangeInclusive<usize>]) -> String {
    if windows.is_empty() {
        return "never".into();
    }
    let words: Vec<_> = windows.iter().map(|window| format!("{}-{}", window.start(), window.end())).collect();
    words.join(", ")
}

/// Returns the regional system with the planes of its inclined orbits turned and its ground tracks
/// unchanged.
fn regional() -> Vec<Satellite> {
    let turn_rad = TURN_DEG.to_radians();
    let turned = |mut satellite: Satellite| {
        let orbit = &mut satellite.orbit;
        let geosynchronous = orbit.semi_major_axis_m > 4e7;
        if geosynchronous && orbit.inclination_rad > 0.0 {
            orbit.node_rad += turn_rad;
            orbit.mean_anomaly_rad -= turn_rad;
        }
        satellite
    };
    Fleet::BeidouRegional.satellites().into_iter().map(turned).collect()
}

/// Returns the figure's tables and pictures.
pub(super) fn figure_6() -> anyhow::Result<(Vec<Section>, Vec<Picture>)> {
    let (regional, global) = (regional(), Fleet::BeidouGlobal.satellites());
    let printed = Day::above_xian(&regional, ORIGIN_MIN, LIMIT_M)?;
    let fitted = Day::above_xian(&regional, ORIGIN_MIN, FITTED_M)?;
    let all = Day::above_xian(&global, 0, LIMIT_M)?;
    let all_fitted = Day::above_xian(&global, 0, FITTED_M)?;
    let sections = vec![
        regional_section(&printed, &fitted),
        windows_section(&fitted.unavailable()),
        global_section(&all, &all_fitted),
    ];
    Ok((sections, vec![regional_picture(&fitted)?, global_picture(&all)?]))
}

fn regional_section(printed: &Day, fitted: &Day) -> Section {
    let differing = fitted.0.iter().enumerate().filter(|(minute, judged)| {
        judged.t_op_m.is_none() != PAPER_WINDOWS.iter().any(|window| window.contains(minute))
    });
    let differing = Finding::Words(format!("{} of {MINUTES}", differing.count()));
    let text = Finding::Words;
    let rows = vec![
        Row::new(
            "satellites in view",
            "8 to 12",
            text(printed.range(0, |minute| minute.visible as f64)),
            Judgement::Reproduced,
        ),
        Row::new("T1, m", "figure only", text(printed.range(2, |minute| minute.t1_m)), Judgement::Ours),
        Row::new("HPL, m", "", text(printed.range(0, |minute| minute.hpl_m)), Judgement::Ours),
        Row::new(
            "unavailable as printed, min",
            words(&PAPER_WINDOWS),
            text(words(&printed.unavailable())),
            Judgement::NotReproducible,
        )
        .because("HPL never comes near 0.95 · 556 m: sigma = 6 m is too small for that"),
        Row::new(
            format!("unavailable with {FITTED_M} m, min"),
            words(&PAPER_WINDOWS),
            text(words(&fitted.unavailable())),
            Judgement::InTrend,
        )
        .because("limit and phases are fitted to the paper's windows"),
        Row::new("minutes that differ from the paper's windows", "", differing, Judgement::Ours),
        Row::new(
            format!("T1 < T_OP < T2 with {FITTED_M} m"),
            "where available",
            fitted.count(Minute::is_ordered),
            Judgement::InTrend,
        )
        .because("close to the windows T_OP is held at T1, as the paper's own rule asks"),
    ];
    Section { title: "Figure 6a, 6b: regional system above Xi'an".into(), rows }
}

fn windows_section(have: &[RangeInclusive<usize>]) -> Section {
    let row = |(index, want): (usize, &RangeInclusive<usize>)| {
        let (start, end) =
            have.get(index).map_or((f64::NAN, f64::NAN), |have| (*have.start() as f64, *have.end() as f64));
        let end_row = |what: &str, have: f64, want: usize| {
            Row::new(
                format!("window {}: {what} minute", index + 1),
                "",
                Finding::exact(have, 0),
                Judgement::Ours,
            )
            .held_to(6, want as f64, 1.0)
        };
        [end_row("first", start, *want.start()), end_row("last", end, *want.end())]
    };
    let mut rows: Vec<Row> = REFERENCE_WINDOWS.iter().enumerate().flat_map(row).collect();
    let windows = Finding::exact(have.len() as f64, 0);
    rows.push(Row::new("windows", "2", windows, Judgement::Reproduced).held_to(6, 2.0, 0.0));
    Section { title: format!("Figure 6b with {FITTED_M} m, beside an independent program"), rows }
}

fn global_section(printed: &Day, fitted: &Day) -> Section {
    let text = Finding::Words;
    let optimal = |minute: &Minute| minute.t_op_m.unwrap_or(f64::NAN);
    let rows = vec![
        Row::new(
            "satellites in view",
            "13 to 19",
            text(printed.range(0, |minute| minute.visible as f64)),
            Judgement::Reproduced,
        )
        .because("to within one, the phases being unpublished"),
        Row::new("unavailable, min", "never", text(words(&printed.unavailable())), Judgement::Reproduced),
        Row::new("T1 < T_OP < T2", "always", printed.count(Minute::is_ordered), Judgement::Reproduced),
        Row::new("T1, m", "figure only", text(printed.range(1, |minute| minute.t1_m)), Judgement::Ours),
        Row::new("T_OP, m", "figure only", text(printed.range(0, optimal)), Judgement::Ours),
        Row::new("T2, m", "figure only", text(printed.range(0, |minute| minute.t2_m)), Judgement::Ours),
        Row::new(
            format!("unavailable with {FITTED_M} m, min"),
            "never",
            text(words(&fitted.unavailable())),
            Judgement::Reproduced,
        ),
        Row::new(format!("T_OP with {FITTED_M} m, m"), "", text(fitted.range(0, optimal)), Judgement::Ours),
        Row::new(
            format!("T2 with {FITTED_M} m, m"),
            "",
            text(fitted.range(0, |minute| minute.t2_m)),
            Judgement::Ours,
        ),
    ];
    Section { title: "Figure 6c: global system above Xi'an".into(), rows }
}

fn chart(title: &str, day: &Day, spans: Vec<Span>) -> LineChart {
    let series = |name: &str, colour, value: fn(&Minute) -> f64| Series {
        name: name.to_owned(),
        colour,
        mark: Mark::Line,
        points: (0..).zip(&day.0).map(|(minute, judged)| (f64::from(minute), value(judged))).collect(),
    };
    LineChart {
        title: title.to_owned(),
        x: Axis::linear("time / min").over(0.0..1440.0),
        y: Axis::logarithmic("threshold / m"),
        series: vec![
            series("T2", ORANGE, |minute| minute.t2_m),
            series("T_OP", VIOLET, |minute| minute.t_op_m.unwrap_or(f64::NAN)),
            series("T1", BLUE, |minute| minute.t1_m),
        ],
        spans,
    }
}

fn regional_picture(fitted: &Day) -> anyhow::Result<Picture> {
    let span = |window: &RangeInclusive<usize>| Span {
        name: "unavailable".to_owned(),
        range: *window.start() as f64..*window.end() as f64 + 1.0,
        colour: RED,
    };
    let title = format!("Figure 6b: regional system above Xi'an, f HAL = {FITTED_M} m");
    let mut chart = chart(&title, fitted, fitted.unavailable().iter().map(span).collect());
    chart.y = chart.y.over(8.9..100.0);
    chart.series.push(printed_windows(9.2));
    let caption = "Where the lower bound T1 meets the upper bound T2 no threshold meets both probabilities: RAIM is \
                   unavailable. The alert limit is a fitted one; with the printed one it never is.";
    Picture::draw("yang2015-figure-6-regional", caption, |ground| chart.svg((900, 420), ground))
}

/// Returns the paper's windows as bars at a height.
fn printed_windows(height_m: f64) -> Series {
    let bar = |window: &RangeInclusive<usize>| {
        let at = |minute: usize| (minute as f64, height_m);
        [at(*window.start()), at(window.end() + 1), (f64::NAN, f64::NAN)]
    };
    let points = PAPER_WINDOWS.iter().flat_map(bar).collect();
    Series { name: "unavailable in the paper".into(), colour: INK, mark: Mark::Line, points }
}

fn global_picture(printed: &Day) -> anyhow::Result<Picture> {
    let title = "Figure 6c: global system above Xi'an, as printed";
    let caption =
        "With 35 satellites the bounds stay far apart, and the threshold of least risk lies between them.";
    Picture::draw("yang2015-figure-6-global", caption, |ground| {
        chart(title, printed, Vec::new()).svg((900, 420), ground)
    })
}
