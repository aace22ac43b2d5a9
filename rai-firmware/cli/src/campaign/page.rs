//! Report of a whole table: maps, curves and one page.

use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};

use super::curve;
use super::map::{AVAILABILITY, Atlas, Scale, VERTICAL_LEVEL};
use super::picture::{Case, cases, grid_step_deg, mean_over_globe, panel, promises_differ, share_of_globe};
use super::table::{Row, Table};
use crate::page::canvas::Ground;
use crate::page::html::{Page, write_file};

/// Maps of a table: column, classes, title.
const MAPS: [(&str, Scale, &str); 2] = [
    ("availability", AVAILABILITY, "How often the position may be used"),
    ("vpl_99_m", VERTICAL_LEVEL, "The vertical protection level"),
];

/// Curves of a table: column, factor, label.
const CURVES: [(&str, f64, &str); 3] = [
    ("availability", 100.0, "availability / %"),
    ("vpl_median_m", 1.0, "median VPL / m"),
    ("hpl_median_m", 1.0, "median HPL / m"),
];

/// Largest number of rows on the page. The CSV has all of them.
const MOST_LINES: usize = 400;

/// Writes the pictures of a table and their page into a folder; returns the page's path. With
/// `numbers` each box of a map shows its value.
///
/// # Errors
/// If the table is incomplete, or a picture cannot be drawn or written.
pub fn write_report(table: &Table, folder: &Path, numbers: bool) -> Result<PathBuf> {
    ensure!(table.is_whole(), "the table is only a share: merge all shares first");
    let (name, cases) = (&table.identity.name, cases(table));
    let mut page = Page::new(
        &format!("Campaign {name}"),
        "Availability and integrity over places and times, as the module itself judges.",
    );
    settings(&mut page, table);
    summary(&mut page, &cases, table.identity.noise);
    if let Some(step_deg) = cases.first().and_then(grid_step_deg) {
        page.heading("Maps");
        for (column, scale, title) in MAPS {
            let panels: Vec<_> = cases.iter().map(|case| panel(case, column, &scale)).collect();
            let atlas = Atlas {
                title: title.to_owned(),
                panels: &panels,
                columns: 2,
                width_px: 0,
                step_deg,
                scale,
                numbers,
            };
            write_file(&folder.join(format!("{name}-map-{column}.svg")), &atlas.svg(Ground::Sheet)?)?;
            page.drawn(atlas.width_px(), |width_px| {
                let columns = if width_px < atlas.width_px() { 1 } else { atlas.columns };
                Atlas { columns, width_px, ..atlas.clone() }.svg(Ground::Page)
            })?;
        }
    }
    page.heading("Curves");
    for (column, factor, label) in CURVES {
        let draw = |width_px, ground| curve::svg(&cases, column, factor, label, width_px, ground);
        let file = folder.join(format!("{name}-curve-{column}.svg"));
        write_file(&file, &draw(curve::WIDTH_PX, Ground::Sheet)?)?;
        page.drawn(curve::WIDTH_PX, |width_px| draw(width_px, Ground::Page))?;
    }
    if table.rows.len() <= MOST_LINES {
        lines(&mut page, &table.rows, table.identity.noise);
    }
    let path = folder.join(format!("{name}.html"));
    page.write(&path)?;
    Ok(path)
}

/// Returns a line per case. Values over the globe are weighted by area.
///
/// Without noise and without a fault nothing was drawn that could alarm or mislead, and a dash says
/// so.
pub fn summary_lines(cases: &[Case<'_>], noise: f64) -> (Vec<&'static str>, Vec<Vec<String>>) {
    let is_grid = cases.first().is_some_and(|case| grid_step_deg(case).is_some());
    let sum = |case: &Case<'_>, column: &str| case.rows.iter().map(|row| row.number(column)).sum::<f64>();
    let percent = |share: f64| format!("{:.2}", 100.0 * share);
    let line = |case: &Case<'_>| {
        let mean = if is_grid {
            mean_over_globe(case, |row| row.number("availability"))
        } else {
            sum(case, "protected") / sum(case, "epochs")
        };
        let above = |least: f64| {
            if is_grid {
                percent(share_of_globe(case, |row| row.number("availability") >= least))
            } else {
                String::new()
            }
        };
        let is_drawn = noise > 0.0 || case.rows.iter().any(|row| row.text("fault") != "none");
        let drawn = |column: &str| if is_drawn { sum(case, column).to_string() } else { "–".to_owned() };
        vec![
            case.title.clone(),
            case.promise.words().to_owned(),
            percent(mean),
            above(0.99),
            above(0.995),
            median(case, "hpl_median_m"),
            median(case, "vpl_median_m"),
            format!("{}", sum(case, "epochs")),
            drawn("alerts"),
            drawn("excluded"),
            drawn("misleading"),
            drawn("hazardous"),
        ]
    };
    let columns = vec![
        "case",
        "levels bound",
        "availability / %",
        "of the globe with 99 % / %",
        "with 99.5 % / %",
        "median HPL / m",
        "median VPL / m",
        "epochs",
        "alerts",
        "exclusions",
        "misleading",
        "hazardous",
    ];
    (columns, cases.iter().map(line).collect())
}

/// Adds the settings of the campaign.
fn settings(page: &mut Page, table: &Table) {
    let identity = &table.identity;
    page.heading("Settings");
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    let mut rows = vec![
        row("random numbers", format!("seed {}", identity.seed)),
        row(
            "noise",
            match identity.noise {
                0.0 => "none: the geometry alone".to_owned(),
                noise => format!("drawn with {noise} times the expected sigma"),
            },
        ),
    ];
    let words = identity.settings.split("; ").map(|part| part.split_once(": ").unwrap_or(("", part)));
    rows.extend(words.map(|(name, value)| row(name, value.to_owned())));
    rows.push(row("specification", format!("hash {:016x}", identity.hash)));
    rows.push(row("size", format!("cells {}, rows of each {}", identity.cells, identity.rows)));
    rows.push(row("version", format!("raim {}", env!("CARGO_PKG_VERSION"))));
    page.table(&["setting", "value"], &rows);
}

fn summary(page: &mut Page, cases: &[Case<'_>], noise: f64) {
    let (columns, lines) = summary_lines(cases, noise);
    page.heading("Summary");
    if promises_differ(cases) {
        page.paragraph(
            "The cases below make different promises. The levels of ARAIM bound several faulty satellites and the loss \
             of a whole system; those of the other methods bound one faulty satellite. A level that bounds less is \
             smaller: this does not make its method the better one.",
        );
    }
    page.table(&columns, &lines);
    if noise == 0.0 {
        page.paragraph(
            "A dash stands where nothing was drawn: without noise and without a fault, no range is wrong, and no count \
             of alerts or of misleading epochs would mean anything.",
        );
    }
    page.paragraph(
        "Misleading: the error exceeds the protection level while the position may be used. Hazardous: it exceeds the \
         alert limit. Medians are over places of the medians over time.",
    );
}

/// Returns the median over the places.
fn median(case: &Case<'_>, column: &str) -> String {
    let mut values: Vec<f64> = case.rows.iter().map(|row| row.number(column)).collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).map_or_else(String::new, |value| format!("{value:.2}"))
}

/// Adds the rows, if a page can hold them.
fn lines(page: &mut Page, rows: &[Row], noise: f64) {
    const SHOWN: [&str; 12] = [
        "sky",
        "mask_deg",
        "errors",
        "fault",
        "method",
        "policy",
        "levels",
        "place",
        "availability",
        "hpl_median_m",
        "vpl_median_m",
        "misleading",
    ];
    page.heading("Rows");
    let cells = |row: &Row| {
        let cell = |column: &str| match column {
            "misleading" if noise == 0.0 && row.text("fault") == "none" => "–".to_owned(),
            _ => row.text(column).to_owned(),
        };
        SHOWN.map(cell).to_vec()
    };
    page.table(&SHOWN, &rows.iter().map(cells).collect::<Vec<_>>());
}
