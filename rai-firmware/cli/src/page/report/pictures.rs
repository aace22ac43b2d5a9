//! Pictures of a report without script: sky, track, C/N0, residuals, clock.

use anyhow::Result;
use raim_core::frame::SPEED_OF_LIGHT_M_S;
use raim_core::satellite::Constellation;

use super::code::{UNKNOWN, value};
use super::facts::Facts;
use super::journal::Journal;
use super::satellites::Spot;
use crate::page::canvas::{BLUE, Ground, Mark, RED};
use crate::page::chart::{Axis, LineChart, Series};
use crate::page::skyplot::{self, Body, skyplot};
use crate::satellites::Fate;

/// Height of a chart, pixels.
pub(super) const HEIGHT_PX: u32 = 280;

/// Largest number of points of a chart's lines together. A day has more satellites than an hour,
/// each in sight for a shorter part, and its charts are no larger.
const POINTS: usize = 6000;

/// Draws the satellites in the sky, each at its last place.
pub(super) fn sky(journal: &Journal, facts: &Facts, width_px: u32) -> Result<String> {
    let body = |(satellite, known): (_, &super::satellites::Satellite)| {
        let spot = known.track.iter().rev().find(|spot| spot.direction[0] != UNKNOWN)?;
        let [azimuth_rad, elevation_rad] = spot.direction.map(|code| (f64::from(code) / 100.0).to_radians());
        let is_excluded =
            Fate::ALL.iter().zip(known.fates).any(|(fate, epochs)| fate.is_excluded() && epochs > 0);
        (elevation_rad > 0.0).then_some(Body { satellite, elevation_rad, azimuth_rad, is_excluded })
    };
    let all = journal.satellites.all.iter().map(|(satellite, known)| (*satellite, known));
    let bodies: Vec<Body> = all.filter_map(body).collect();
    skyplot(&bodies, facts.mask_deg.to_radians(), width_px, Ground::Page)
}

/// Draws the positions over the ground.
pub(super) fn track(journal: &Journal, width_px: u32) -> Result<String> {
    let points: Vec<(f64, f64)> = journal.track.iter().map(|(_, at)| (at.east, at.north)).collect();
    // Both axes have the same scale.
    let [east, north] = [|point: &(f64, f64)| point.0, |point: &(f64, f64)| point.1].map(|pick| {
        let range =
            points.iter().map(pick).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), metres| {
                (low.min(metres), high.max(metres))
            });
        if range.0 <= range.1 { range } else { (0.0, 0.0) }
    });
    let half = (0.55 * (east.1 - east.0).max(north.1 - north.0)).max(0.5);
    let around = |(low, high): (f64, f64)| f64::midpoint(low, high) - half..f64::midpoint(low, high) + half;
    let chart = LineChart {
        title: "Positions over the ground".to_owned(),
        x: Axis::linear("east / m").over(around(east)),
        y: Axis::linear("north / m").over(around(north)),
        series: vec![Series { name: String::new(), colour: BLUE, mark: Mark::Dots, points }],
        spans: Vec::new(),
    };
    chart.svg((width_px, width_px + 40), Ground::Page)
}

/// Returns the charts of C/N0, of the residuals and of the clock.
pub(super) fn of_satellites(journal: &Journal) -> Vec<LineChart> {
    let mut charts = Vec::new();
    if !journal.satellites.all.is_empty() {
        charts.push(chart(
            journal,
            "Is the signal strong?  C/N0 by system",
            "C/N0 / dB-Hz",
            |spot| (spot.cn0[0] > 0).then(|| f64::from(spot.cn0[0]) / 4.0),
            false,
        ));
        charts.push(chart(
            journal,
            "Which range is off?  Residuals by system",
            "residual / m",
            |spot| value(largest(spot.residual)),
            true,
        ));
    }
    let clock = journal.epochs.buckets.iter().step_by(journal.epochs.buckets.len() / 1000 + 1);
    let points: Vec<(f64, f64)> = clock
        .map(|bucket| {
            let micros = f64::from(bucket.values[0]) / SPEED_OF_LIGHT_M_S * 1e6;
            (f64::from(bucket.first_ms) * 1e-3, micros)
        })
        .collect();
    if points.iter().any(|(_, micros)| micros.is_finite()) {
        charts.push(LineChart {
            title: "Receiver clock against the time of the system".to_owned(),
            x: axis(journal),
            y: Axis::linear("clock / µs"),
            series: vec![Series { name: String::new(), colour: BLUE, mark: Mark::Line, points }],
            spans: Vec::new(),
        });
    }
    charts
}

fn axis(journal: &Journal) -> Axis {
    Axis::linear("time / s").over(0.0..journal.last_s.max(1.0))
}

/// Returns the code of the larger magnitude.
fn largest([low, high]: [i16; 2]) -> i16 {
    if low != UNKNOWN && i32::from(low).abs() > i32::from(high).abs() { low } else { high }
}

/// Returns the lines of all satellites in the colours of their systems, and the exclusions above.
fn chart(
    journal: &Journal,
    title: &str,
    label: &str,
    of: impl Fn(&Spot) -> Option<f64>,
    marks_exclusions: bool,
) -> LineChart {
    let time_s = |spot: &Spot| {
        let time_ms = journal.satellites.times_ms.get(spot.bucket as usize);
        time_ms.map_or(f64::NAN, |time_ms| f64::from(*time_ms) * 1e-3)
    };
    let spots: usize = journal.satellites.all.values().map(|known| known.track.len()).sum();
    let every = spots / POINTS + 1;
    let mut series = Vec::new();
    for system in Constellation::ALL {
        let of_system = journal.satellites.all.iter().filter(|(one, _)| one.constellation() == system);
        for (index, (_, known)) in of_system.enumerate() {
            let mut points: Vec<(f64, f64)> = Vec::new();
            let mut before = None;
            for spot in known.track.iter().step_by(every) {
                // A satellite that was out of sight has a gap.
                if before.is_some_and(|bucket: u32| spot.bucket - bucket > every as u32) {
                    points.push((f64::NAN, f64::NAN));
                }
                before = Some(spot.bucket);
                points.push((time_s(spot), of(spot).unwrap_or(f64::NAN)));
            }
            let name = if index == 0 { skyplot::name(system).to_owned() } else { String::new() };
            series.push(Series {
                name,
                colour: skyplot::colour(system),
                mark: skyplot::mark_of(system),
                points,
            });
        }
    }
    let is_excluded =
        |spot: &&Spot| Fate::ALL.get(usize::from(spot.fate)).is_some_and(|fate| fate.is_excluded());
    let excluded = journal.satellites.all.values().flat_map(|known| known.track.iter().filter(is_excluded));
    let excluded: Vec<(f64, f64)> = excluded.filter_map(|spot| Some((time_s(spot), of(spot)?))).collect();
    if marks_exclusions && !excluded.is_empty() {
        let every = excluded.len() / 400 + 1;
        let points = excluded.into_iter().step_by(every).collect();
        series.push(Series { name: "excluded".to_owned(), colour: RED, mark: Mark::Crosses, points });
    }
    LineChart { title: title.to_owned(), x: axis(journal), y: Axis::linear(label), series, spans: Vec::new() }
}
