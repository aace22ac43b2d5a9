//! Figures: rates at which each method leaves out exactly the faulty satellites.

use anyhow::Result;
use raim::page::bars::BarChart;
use raim::page::canvas::{Mark, SERIES};
use raim::page::chart::{Axis, LineChart, Series};

use super::super::Picture;
use super::fate::Fate;
use super::skies::KINDS;
use super::{CONTENDERS, FAULTS, STEPS_M, Tallies};

const SIZE: (u32, u32) = (920, 400);

/// Returns the methods of the module. The host's method has too few skies for a line.
fn methods() -> impl Iterator<Item = (usize, &'static str)> {
    let each = CONTENDERS.iter().enumerate().filter(|(_, contender)| contender.method.is_some());
    each.map(|(index, contender)| (index, contender.name))
}

pub(super) fn all(tallies: &Tallies) -> Result<Vec<Picture>> {
    let mut pictures = Vec::new();
    for (faults, count) in FAULTS.into_iter().enumerate() {
        pictures.push(against_step(tallies, faults, count)?);
    }
    pictures.push(by_sky(tallies, FAULTS.len() - 1)?);
    pictures.push(wrong(tallies)?);
    Ok(pictures)
}

/// Draws correct exclusions against the step, all skies together.
fn against_step(tallies: &Tallies, faults: usize, count: usize) -> Result<Picture> {
    let line = |(contender, name): (usize, &str)| {
        let point = |(step, &step_m): (usize, &f64)| {
            (step_m, tallies.sum(None, faults, Some(step), contender).percent(Fate::Correct))
        };
        Series {
            name: name.into(),
            colour: SERIES[contender % SERIES.len()],
            // The gaps distinguish lines that coincide.
            mark: if contender % 2 == 0 { Mark::Line } else { Mark::Dashed },
            points: STEPS_M.iter().enumerate().map(point).collect(),
        }
    };
    let plural = if count == 1 { "fault" } else { "faults" };
    let chart = LineChart {
        title: format!("{count} {plural}: exactly the faulty satellites left out"),
        x: Axis::linear("step / m").over(0.0..STEPS_M[STEPS_M.len() - 1]),
        y: Axis::linear("epochs / %").over(0.0..104.0),
        series: methods().map(line).collect(),
        spans: Vec::new(),
    };
    let caption =
        format!("Correct exclusion against the size of {count} simultaneous {plural}, all skies together.");
    Picture::draw(&format!("methods-{count}-{plural}"), &caption, |ground| chart.svg(SIZE, ground))
}

/// Draws correct exclusions by kind of sky, all steps together.
fn by_sky(tallies: &Tallies, faults: usize) -> Result<Picture> {
    let bars = methods().map(|(contender, name)| {
        let heights = (0..KINDS.len())
            .map(|kind| tallies.sum(Some(kind), faults, None, contender).percent(Fate::Correct));
        (name.to_owned(), heights.collect())
    });
    let chart = BarChart {
        title: format!("{} faults: exactly the faulty satellites left out", FAULTS[faults]),
        y_label: "epochs / %".into(),
        x_label: "satellites of GPS (G) and BeiDou (C)".into(),
        groups: KINDS.iter().map(|kind| kind.label.to_owned()).collect(),
        bars: bars.collect(),
    };
    let caption =
        "Correct exclusion of three simultaneous faults by number of satellites, all steps together.";
    Picture::draw("methods-by-sky", caption, |ground| chart.svg(SIZE, ground))
}

/// Draws healthy satellites left out of protected positions, by number of faults.
fn wrong(tallies: &Tallies) -> Result<Picture> {
    let bars = methods().map(|(contender, name)| {
        let heights =
            (0..FAULTS.len()).map(|faults| tallies.sum(None, faults, None, contender).percent(Fate::Wrong));
        (name.to_owned(), heights.collect())
    });
    let chart = BarChart {
        title: "Protected, and a healthy satellite left out".into(),
        y_label: "epochs / %".into(),
        x_label: "faulty satellites".into(),
        groups: FAULTS.iter().map(ToString::to_string).collect(),
        bars: bars.collect(),
    };
    let caption = "Wrong exclusions that the module did not recognise as such, all skies and steps together.";
    Picture::draw("methods-wrong", caption, |ground| chart.svg(SIZE, ground))
}
