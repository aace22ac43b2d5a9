//! Stanford diagram: each epoch's error against its protection level.
//!
//! | region | meaning |
//! |---|---|
//! | above the diagonal, below the alert limit | the error is bounded |
//! | below the diagonal | misleading: the error exceeds the level |
//! | below the diagonal, error beyond the alert limit | hazardous |
//! | level above the alert limit | unavailable |
//!
//! Protected epochs are drawn over the others, and misleading ones over all, so that none hides
//! them.

use anyhow::Result;

use super::canvas::{GREEN, GREY, Ground, INK, Mark, RED, VIOLET};
use super::chart::{Axis, EDGE, LineChart, Series};
use super::{Moment, Verdict};

/// Returns the horizontal diagram.
///
/// # Errors
/// Plotters fails to draw.
pub fn horizontal(moments: &[Moment], width_px: u32, ground: Ground) -> Result<String> {
    let pairs =
        moments.iter().filter_map(|moment| Some((moment.verdict, moment.horizontal_error_m?, moment.hpl_m?)));
    let limit_m = moments.iter().find_map(|moment| moment.hal_m);
    diagram("Horizontal error and protection level, epoch by epoch", pairs, limit_m, width_px, ground)
}

/// Returns the vertical diagram.
///
/// # Errors
/// Plotters fails to draw.
pub fn vertical(moments: &[Moment], width_px: u32, ground: Ground) -> Result<String> {
    let pairs = moments
        .iter()
        .filter_map(|moment| Some((moment.verdict, moment.vertical_error_m?.abs(), moment.vpl_m?)));
    let limit_m = moments.iter().find_map(|moment| moment.val_m);
    diagram("Vertical error and protection level, epoch by epoch", pairs, limit_m, width_px, ground)
}

/// Width of a diagram beside another, pixels.
pub const WIDTH_PX: u32 = 560;

/// Largest height of a diagram, pixels.
const HEIGHT_PX: u32 = 516;

/// Smallest error on the axis, m; smaller ones are drawn there.
const LEAST_M: f64 = 0.01;

fn diagram(
    title: &str,
    pairs: impl Iterator<Item = (Verdict, f64, f64)>,
    limit_m: Option<f64>,
    width_px: u32,
    ground: Ground,
) -> Result<String> {
    let pairs: Vec<(Verdict, f64, f64)> = pairs.collect();
    let largest_m = pairs.iter().map(|&(_, error_m, bound_m)| error_m.max(bound_m));
    let largest_m = largest_m.filter(|metres| metres.is_finite()).chain(limit_m).fold(1.0, f64::max);
    let end_m = libm::exp10(libm::log10(largest_m * 1.2).ceil());
    let line = |name: &str, colour, mark, points| Series { name: name.to_owned(), colour, mark, points };
    let diagonal = vec![(LEAST_M, LEAST_M), (end_m, end_m)];
    let mut series = vec![line("error = level", INK, Mark::Line, diagonal)];
    if let Some(limit_m) = limit_m {
        let corner = vec![(LEAST_M, limit_m), (limit_m, limit_m), (limit_m, LEAST_M)];
        series.push(line("alert limit", RED, Mark::Dashed, corner));
    }
    let holds = |&&(_, error_m, bound_m): &&(Verdict, f64, f64)| error_m <= bound_m;
    let of = |verdict: Verdict| pairs.iter().filter(move |pair| pair.0 == verdict);
    let points = |pairs: &mut dyn Iterator<Item = &(Verdict, f64, f64)>| -> Vec<(f64, f64)> {
        pairs.map(|&(_, error_m, bound_m)| (error_m.max(LEAST_M), bound_m)).collect()
    };
    for (name, colour, mark, points) in [
        ("unavailable", GREY, Mark::Dots, points(&mut of(Verdict::Unavailable))),
        ("alert", RED, Mark::Crosses, points(&mut of(Verdict::Alert))),
        ("protected", GREEN, Mark::Dots, points(&mut of(Verdict::Protected).filter(holds))),
        ("misleading", VIOLET, Mark::Dots, points(&mut of(Verdict::Protected).filter(|pair| !holds(pair)))),
    ] {
        if !points.is_empty() {
            series.push(line(name, colour, mark, points));
        }
    }
    let chart = LineChart {
        title: title.to_owned(),
        x: Axis::logarithmic("position error / m").over(LEAST_M * EDGE..end_m),
        y: Axis::logarithmic("protection level / m").over(LEAST_M * EDGE..end_m),
        series,
        spans: Vec::new(),
    };
    chart.svg((width_px, HEIGHT_PX.min(width_px + 60)), ground)
}
