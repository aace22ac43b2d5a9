//! Curves of a quantity over the latitude of a grid, or over the places of a track.

use anyhow::Result;

use super::picture::{Case, grid_step_deg};
use super::table::Row;
use crate::page::canvas::{Ground, Mark, SERIES};
use crate::page::chart::{Axis, LineChart, Series};

/// Usual width of the picture, pixels.
pub const WIDTH_PX: u32 = 980;

/// Draws a quantity of each case: on a grid the mean of each circle of latitude, otherwise place by
/// place.
///
/// # Errors
/// If plotters cannot draw it.
pub fn svg(
    cases: &[Case<'_>],
    column: &str,
    factor: f64,
    label: &str,
    width_px: u32,
    ground: Ground,
) -> Result<String> {
    let is_grid = cases.first().is_some_and(|case| grid_step_deg(case).is_some());
    let marks = [Mark::Line, Mark::Dashed];
    let styles = marks.into_iter().flat_map(|mark| SERIES.map(|colour| (colour, mark))).cycle();
    let series = cases.iter().zip(styles).map(|(case, (colour, mark))| Series {
        name: case.title.clone(),
        colour,
        mark,
        points: if is_grid { by_latitude(case, column, factor) } else { by_place(case, column, factor) },
    });
    let chart = LineChart {
        title: format!("{label}, {}", if is_grid { "mean over each circle of latitude" } else { "by place" }),
        x: Axis::linear(if is_grid { "latitude / °" } else { "place" }),
        y: Axis::linear(label),
        series: series.collect(),
        spans: Vec::new(),
    };
    chart.svg((width_px, 380), ground)
}

fn by_latitude(case: &Case<'_>, column: &str, factor: f64) -> Vec<(f64, f64)> {
    let is_same = |a: &&Row, b: &&Row| a.text("lat_deg") == b.text("lat_deg");
    let mean = |rows: &[&Row]| {
        let sum: f64 = rows.iter().map(|row| factor * row.number(column)).sum();
        (rows[0].number("lat_deg"), sum / rows.len() as f64)
    };
    case.rows.chunk_by(|a, b| is_same(a, b)).map(mean).collect()
}

fn by_place(case: &Case<'_>, column: &str, factor: f64) -> Vec<(f64, f64)> {
    (1_u32..).zip(&case.rows).map(|(number, row)| (f64::from(number), factor * row.number(column))).collect()
}
