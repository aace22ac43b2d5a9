//! Outcome of an experiment, in three forms: text, JSON, pages.

use std::fmt;

use anyhow::Result;
use raim::page::html::Page;
use serde_json::{Value, json};

use super::{Finding, Row};

/// A table with a title, or part of one.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Table or figure of the paper, with its set-up.
    pub title: String,
    /// Rows of the table.
    pub rows: Vec<Row>,
}

/// A figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Name of its file, without extension: `lin2016-figure-4`.
    pub name: String,
    /// Description of the picture, one sentence.
    pub caption: String,
    /// The picture as a file.
    pub sheet: String,
    /// The picture on a page.
    pub inline: String,
}

impl Picture {
    /// Draws a picture in both forms.
    ///
    /// # Errors
    /// If it cannot be drawn.
    pub fn draw(
        name: &str,
        caption: &str,
        draw: impl Fn(raim::page::canvas::Ground) -> Result<String>,
    ) -> Result<Self> {
        use raim::page::canvas::Ground;
        let (sheet, inline) = (draw(Ground::Sheet)?, draw(Ground::Page)?);
        Ok(Self { name: name.to_owned(), caption: caption.to_owned(), sheet, inline })
    }
}

/// Result of one paper's experiments.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Name on the command line.
    pub name: &'static str,
    /// Title with author and year.
    pub title: String,
    /// Set-up in a few sentences: sky, place, sigma, seeds, sample counts.
    pub setup: String,
    /// Tables.
    pub sections: Vec<Section>,
    /// Figures.
    pub pictures: Vec<Picture>,
}

impl Outcome {
    /// Returns every row of every section.
    pub fn rows(&self) -> impl Iterator<Item = &Row> {
        self.sections.iter().flat_map(|section| &section.rows)
    }

    /// Returns the rows that miss their acceptance value.
    pub fn failures(&self) -> impl Iterator<Item = &Row> {
        self.rows().filter(|row| row.acceptance.as_ref().is_some_and(|acceptance| !acceptance.holds))
    }

    /// Returns a JSON object with a field for each column.
    pub fn json(&self) -> Value {
        let row = |section: &Section, row: &Row| {
            let (low, high) = match row.ours {
                Finding::Number { interval: Some(interval), .. } => (Some(interval.low), Some(interval.high)),
                _ => (None, None),
            };
            json!({
                "section": section.title, "quantity": row.quantity, "paper": row.paper,
                "ours": row.ours.value().map_or_else(|| json!(row.ours.text()), |value| json!(value)),
                "low": low, "high": high, "verdict": row.judgement, "reason": row.reason,
                "acceptance": row.acceptance,
            })
        };
        let rows: Vec<Value> = self
            .sections
            .iter()
            .flat_map(|section| section.rows.iter().map(move |line| row(section, line)))
            .collect();
        json!({ "experiment": self.name, "title": self.title, "setup": self.setup, "rows": rows })
    }
}

const COLUMNS: [&str; 6] = ["quantity", "paper", "ours", "95 % confidence", "verdict", "held to"];

fn cells(row: &Row) -> [String; 6] {
    let held = row.acceptance.as_ref().map_or(String::new(), |acceptance| {
        let word = if acceptance.holds { "holds" } else { "FAILS" };
        format!("{} ({word})", acceptance.want)
    });
    [
        row.quantity.clone(),
        row.paper.clone(),
        row.ours.text(),
        row.ours.interval_text(),
        row.judgement.words().to_owned(),
        held,
    ]
}

impl fmt::Display for Outcome {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(formatter, "{}\n{}", self.title, self.setup)?;
        for section in &self.sections {
            writeln!(formatter, "\n  {}", section.title)?;
            let lines: Vec<_> = section.rows.iter().map(cells).collect();
            let width = |column: usize| {
                let cells = lines.iter().filter_map(|line| line.get(column));
                cells.map(|cell| cell.chars().count()).chain([COLUMNS[column].len()]).max().unwrap_or(0)
            };
            let widths: [usize; 6] = std::array::from_fn(width);
            let line = |cells: &[String; 6]| {
                let padded: Vec<_> =
                    cells.iter().zip(widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
                padded.join("  ").trim_end().to_owned()
            };
            writeln!(formatter, "    {}", line(&COLUMNS.map(str::to_owned)))?;
            for (row, cells) in section.rows.iter().zip(&lines) {
                writeln!(formatter, "    {}", line(cells))?;
                if !row.reason.is_empty() {
                    writeln!(formatter, "        {}", row.reason)?;
                }
            }
        }
        Ok(())
    }
}

/// Returns one page with all outcomes.
pub fn page(outcomes: &[Outcome]) -> Page {
    let mut page = Page::new(
        "RAI beside its sources",
        "Each printed value beside ours, computed by the module's own code.",
    );
    let rows = || outcomes.iter().flat_map(Outcome::rows);
    let count = |words: &str| rows().filter(|row| row.judgement.words() == words).count().to_string();
    let held: Vec<_> = rows().filter_map(|row| row.acceptance.as_ref()).map(|bound| bound.holds).collect();
    page.figures(&[
        ("values reproduced".into(), count("reproduced")),
        ("in trend".into(), count("in trend")),
        ("not reproducible".into(), count("not reproducible")),
        ("bounds held".into(), format!("{} of {}", held.iter().filter(|&&holds| holds).count(), held.len())),
    ]);
    for outcome in outcomes {
        page.heading(&outcome.title);
        page.paragraph(&outcome.setup);
        for section in &outcome.sections {
            page.subheading(&section.title);
            let rows: Vec<_> =
                section.rows.iter().map(|row| (cells(row).to_vec(), row.reason.clone())).collect();
            page.table_with_notes(&COLUMNS, &rows);
        }
        for picture in &outcome.pictures {
            page.picture(&picture.inline);
            page.paragraph(&picture.caption);
        }
    }
    page
}
