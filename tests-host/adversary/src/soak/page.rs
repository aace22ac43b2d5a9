//! The page of a soak.

use anyhow::Result;
use raim::page::bars::BarChart;
use raim::page::canvas::Ground;
use raim::page::html::Page;
use raim::page::{Moment, stanford};

use super::Outcome;
use super::table::{TO_PIN_MS, ms};

/// Width of a bar, ms.
const BAR_MS: f64 = 0.2;

/// Points of a diagram at most. More would only overlap.
const MOMENTS: usize = 4000;

/// Returns the page of several outcomes.
///
/// # Errors
/// If a picture cannot be drawn.
pub fn page(outcomes: &[Outcome]) -> Result<Page> {
    let broken: Vec<String> = outcomes.iter().flat_map(Outcome::broken).collect();
    let verdict = if broken.is_empty() {
        "Every count that must be zero is zero."
    } else {
        "Not every count that must be zero is zero."
    };
    let mut page = Page::new("RAI: a soak on the emulated board", verdict);
    for words in &broken {
        page.paragraph(words);
    }
    tables(&mut page, outcomes);
    for outcome in outcomes {
        page.heading(outcome.name);
        page.pictures(&[to_pin(outcome).svg((560, 516), Ground::Page)?, errors(outcome)?]);
    }
    Ok(page)
}

/// Adds a table for each section, with a column for each outcome.
fn tables(page: &mut Page, outcomes: &[Outcome]) {
    let sections: Vec<_> = outcomes.iter().map(Outcome::sections).collect();
    let names = outcomes.iter().map(|outcome| outcome.name);
    for (index, (heading, rows)) in sections.first().into_iter().flatten().enumerate() {
        let columns: Vec<&str> = std::iter::once(*heading).chain(names.clone()).collect();
        let row = |at: usize, name: &str| {
            let values = sections.iter().map(|section| section[index].1[at].1.clone());
            std::iter::once(name.to_owned()).chain(values).collect()
        };
        let rows: Vec<Vec<String>> = rows.iter().enumerate().map(|(at, (name, _))| row(at, name)).collect();
        page.table(&columns, &rows);
    }
}

/// Returns the histogram of the time to the pin.
fn to_pin(outcome: &Outcome) -> BarChart {
    let bars = (TO_PIN_MS / BAR_MS) as usize;
    let mut heights = vec![0.0; bars + 1];
    for &ticks in &outcome.watch.to_pin_ticks {
        heights[((ms(ticks) / BAR_MS) as usize).min(bars)] += 1.0;
    }
    let last = heights.iter().rposition(|height| *height > 0.0).unwrap_or(0);
    heights.truncate(last + 1);
    BarChart {
        title: "From the last byte of an epoch to the pin".to_owned(),
        y_label: "epochs".to_owned(),
        x_label: "board time up to / ms".to_owned(),
        groups: (1..=heights.len()).map(|bar| format!("{:.1}", bar as f64 * BAR_MS)).collect(),
        bars: vec![("epochs".to_owned(), heights)],
    }
}

/// Draws error against protection level. The alert limit is not drawn because it changes.
fn errors(outcome: &Outcome) -> Result<String> {
    let moments = &outcome.tally.moments;
    let every = moments.len().div_ceil(MOMENTS).max(1);
    let shown = moments.iter().step_by(every).cloned().map(|moment| Moment { hal_m: None, ..moment });
    let shown: Vec<Moment> = shown.collect();
    stanford::horizontal(&shown, stanford::WIDTH_PX, Ground::Page)
}
