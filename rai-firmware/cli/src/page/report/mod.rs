//! The report of `replay`, `run` and `demo`: what happened when, to which satellites, and why.
//!
//! ```text
//! epochs, silences ──► Journal ──► Report ──► one page: tables, pictures, values, script
//! ```
//!
//! | module | content |
//! |---|---|
//! | [`Journal`] | what happened, in bounded memory: epochs, satellites, events |
//! | [`Facts`] | what the caller knows: source, command, settings |
//! | `reasons`, `plain` | reasons of verdicts in words; the result in plain words |
//! | `tables`, `pictures` | the page without its script |
//! | `data`, `code` | the values, in few bytes, for the script |
//!
//! With its script the page replaces the pictures over time by ones that zoom together. Without, it
//! has the same content as SVG. The page refers to no other address.

mod code;
mod data;
mod epochs;
mod facts;
mod journal;
mod pictures;
mod plain;
mod reasons;
mod satellites;
mod tables;

use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::Result;

use super::canvas::Ground;
use super::html::Page;
use super::{stanford, timeline};

pub use code::base64_text;
pub use facts::{Facts, command_line, settings_of};
pub use journal::{Happened, Journal};
pub use reasons::explanation;

/// Script of the page, behind its values.
const AFTER_THE_VALUES: &str =
    concat!("</script>\n<script>\n", include_str!("report.js"), include_str!("start.js"), "</script>\n");

/// The function that makes the script's parts of a report, for a page of another maker.
pub const SCRIPT: &str = include_str!("report.js");

/// Style of the parts that the script makes.
pub const STYLE: &str = include_str!("report.css");

/// Width of the pictures over time, pixels.
const WIDTH_PX: u32 = 960;

/// Returns the page.
///
/// # Errors
/// A picture cannot be drawn.
pub fn page(journal: &Journal, facts: &Facts) -> Result<Page> {
    let mut page = before_the_values(journal, facts)?;
    let mut values = Vec::new();
    data::json(journal, facts, &mut values)?;
    page.raw(&String::from_utf8(values)?);
    page.raw(AFTER_THE_VALUES);
    Ok(page)
}

/// Writes the page to a file whose name ends in `.html`, or as `report.html` into a folder; returns
/// its path. The values, which are most of a long page, are never in memory as text.
///
/// # Errors
/// The page cannot be drawn or written.
pub fn write(journal: &Journal, facts: &Facts, place: &Path) -> Result<PathBuf> {
    let is_file = place.extension().is_some_and(|ending| ending == "html");
    let path = if is_file { place.to_owned() } else { place.join("report.html") };
    let page = before_the_values(journal, facts)?;
    page.write_with(&path, |file| {
        data::json(journal, facts, file)?;
        file.write_all(AFTER_THE_VALUES.as_bytes())
    })?;
    Ok(path)
}

/// Returns the page up to the values for its script.
fn before_the_values(journal: &Journal, facts: &Facts) -> Result<Page> {
    let mut page = Page::new(&facts.title, &facts.summary);
    page.raw(&format!("<p class=\"plain\">{}</p>\n", super::html::escaped(&plain::words(journal))));
    page.figures(&facts.figures);
    tables::facts(&mut page, journal, facts);
    tables::reasons(&mut page, journal);
    page.heading("What happened when");
    page.raw("<div id=\"live\"></div>\n<div class=\"still\">\n");
    over_time(&mut page, journal, facts)?;
    page.raw("</div>\n");
    tables::events(&mut page, journal);
    page.heading("Satellites");
    page.raw("<div id=\"sky\"></div>\n<div class=\"still\">\n");
    let (sky, track) =
        (|width_px| pictures::sky(journal, facts, width_px), |width_px| pictures::track(journal, width_px));
    page.drawn_beside(super::skyplot::SIDE_PX, &[&sky, &track])?;
    page.raw("</div>\n");
    tables::satellites(&mut page, journal);
    against_truth(&mut page, journal)?;
    page.raw(&format!("<style>\n{STYLE}</style>\n<script type=\"application/json\" id=\"data\">"));
    Ok(page)
}

/// Adds the pictures over time, for a page without script.
fn over_time(page: &mut Page, journal: &Journal, facts: &Facts) -> Result<()> {
    let moments = journal.thinned.moments();
    page.drawn(WIDTH_PX, |width_px| {
        timeline::picture(&journal.thinned, &facts.incidents, &facts.beside, width_px, Ground::Page)
    })?;
    for chart in pictures::of_satellites(journal) {
        page.drawn(WIDTH_PX, |width_px| chart.svg((width_px, pictures::HEIGHT_PX), Ground::Page))?;
    }
    if (moments.len() as u64) < journal.len() {
        page.paragraph(&format!(
            "The pictures show {} of {} epochs: the extremes of each stretch of time, and the first epoch of each \
             verdict in it.",
            moments.len(),
            journal.len()
        ));
    }
    Ok(())
}

/// Adds the diagrams of errors against levels, if the truth is known.
fn against_truth(page: &mut Page, journal: &Journal) -> Result<()> {
    let moments = journal.thinned.moments();
    if moments.iter().all(|moment| moment.horizontal_error_m.is_none()) {
        return Ok(());
    }
    page.heading("Error against protection level");
    page.paragraph(
        "Above the diagonal the protection level is larger than the error and bounds it, as it must. A violet dot below \
         it is misleading: a position that was promised to be better than it was.",
    );
    let (horizontal, vertical) = (
        |width_px| stanford::horizontal(&moments, width_px, Ground::Page),
        |width_px| stanford::vertical(&moments, width_px, Ground::Page),
    );
    page.drawn_beside(stanford::WIDTH_PX, &[&horizontal, &vertical])
}
