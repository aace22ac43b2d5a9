//! Rows of a campaign as text: CSV below one line that identifies the campaign.
//!
//! ```text
//! # rai campaign 2,lpv200,seed 1,noise 0,specification 0123456789abcdef,cells 648,rows 4,masks: elevation 5°; …
//! cell,sky,mask_deg,errors,fault,method,policy,levels,place,lat_deg,lon_deg,height_m,epochs,…
//! 0,GPS and Galileo,5,airborne,none,SEPARATION,-,-,-85 -175,-85,-175,0,144,…
//! ```
//!
//! Rows are in the order of their cells. A share of a campaign has the same first lines and the
//! rows of its own cells. All shares merged are the bytes of a single run.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail, ensure};

use super::statistics;

/// Columns before those of the statistics.
const KEYS: [&str; 12] = [
    "cell", "sky", "mask_deg", "errors", "fault", "method", "policy", "levels", "place", "lat_deg",
    "lon_deg", "height_m",
];

/// Identity of a table: its first line.
#[derive(Clone, Debug, PartialEq)]
pub struct Identity {
    /// Name of the campaign.
    pub name: String,
    /// Seed of the campaign.
    pub seed: u64,
    /// Ratio of the drawn noise to the expected sigma.
    pub noise: f64,
    /// Hash of the specification and the files that it names.
    pub hash: u64,
    /// Number of cells of the whole campaign.
    pub cells: usize,
    /// Number of rows per cell.
    pub rows: usize,
    /// Settings in words, which may contain commas.
    pub settings: String,
}

impl Identity {
    /// Formats the line, without its end.
    pub fn line(&self) -> String {
        let Self { name, seed, noise, hash, cells, rows, settings } = self;
        format!(
            "# rai campaign 2,{name},seed {seed},noise {noise},specification {hash:016x},cells {cells},rows {rows},\
             {settings}"
        )
    }

    /// Parses the line.
    fn read(line: &str) -> Option<Self> {
        let mut fields = line.strip_prefix("# rai campaign 2,")?.splitn(7, ',');
        let name = fields.next()?.to_owned();
        let mut number = |prefix: &str| fields.next()?.strip_prefix(prefix).map(str::to_owned);
        let identity = Self {
            name,
            seed: number("seed ")?.parse().ok()?,
            noise: number("noise ")?.parse().ok()?,
            hash: u64::from_str_radix(&number("specification ")?, 16).ok()?,
            cells: number("cells ")?.parse().ok()?,
            rows: number("rows ")?.parse().ok()?,
            settings: number("")?,
        };
        (identity.rows > 0 && identity.line() == line).then_some(identity)
    }

    /// Returns the first two lines with their ends.
    pub fn heading(&self) -> String {
        format!("{}\n{}\n", self.line(), columns().join(","))
    }
}

fn columns() -> Vec<&'static str> {
    KEYS.into_iter().chain(statistics::COLUMNS).collect()
}

/// A row that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Number of its cell.
    pub cell: usize,
    fields: Vec<String>,
    line: String,
}

impl Row {
    fn read(line: &str) -> Option<Self> {
        let fields: Vec<String> = line.split(',').map(str::to_owned).collect();
        let cell = fields.first()?.parse().ok()?;
        (fields.len() == columns().len()).then(|| Self { cell, fields, line: line.to_owned() })
    }

    /// Returns the field of a column, or an empty string if there is no such column.
    pub fn text(&self, column: &str) -> &str {
        let place = columns().iter().position(|name| *name == column);
        place.and_then(|place| self.fields.get(place)).map_or("", String::as_str)
    }

    /// Returns the field as a number, or NaN if it is not one.
    pub fn number(&self, column: &str) -> f64 {
        self.text(column).parse().unwrap_or(f64::NAN)
    }
}

/// A table, or a share of one.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Identity of the campaign.
    pub identity: Identity,
    /// Rows in the order of the file.
    pub rows: Vec<Row>,
    /// Number of bytes up to the end of the last complete cell.
    pub whole_bytes: usize,
}

impl Table {
    /// Reads a text as far as its cells are complete, because an interrupted run leaves only a
    /// beginning.
    ///
    /// # Errors
    /// If the heading is invalid, or a line before the last is not a row.
    pub fn read(text: &str) -> Result<Self> {
        let mut lines = text.split_inclusive('\n');
        let heading = lines.next().unwrap_or("");
        let identity =
            Identity::read(heading.trim_end()).context("the first line must be that of a campaign")?;
        let names = lines.next().unwrap_or("");
        ensure!(names.trim_end() == columns().join(","), "the columns are not those of this version");
        let mut table = Self { whole_bytes: heading.len() + names.len(), identity, rows: Vec::new() };
        let mut pending: Vec<Row> = Vec::new();
        let mut pending_bytes = 0;
        for (index, line) in lines.enumerate() {
            let row = line.strip_suffix('\n').and_then(Row::read);
            let Some(row) = row else {
                // Only the last line may be incomplete.
                ensure!(!line.ends_with('\n'), "line {} is not a row of this table", index + 3);
                break;
            };
            if pending.first().is_some_and(|first| first.cell != row.cell) {
                bail!("line {}: cell {} lacks rows", index + 3, pending[0].cell);
            }
            pending.push(row);
            pending_bytes += line.len();
            if pending.len() == table.identity.rows {
                table.rows.append(&mut pending);
                table.whole_bytes += pending_bytes;
                pending_bytes = 0;
            }
        }
        Ok(table)
    }

    /// Returns the numbers of the cells in the table.
    pub fn cells(&self) -> impl Iterator<Item = usize> + '_ {
        self.rows.chunks(self.identity.rows).filter_map(|rows| rows.first().map(|row| row.cell))
    }

    /// Returns true if the table has every cell.
    pub fn is_whole(&self) -> bool {
        self.cells().eq(0..self.identity.cells)
    }
}

/// Merges all shares into the table of a single run.
///
/// # Errors
/// If a file is not a table, the shares belong to different campaigns, or a cell is missing or
/// occurs twice; the error names it and the remedy.
pub fn merge(files: &[PathBuf]) -> Result<String> {
    let mut cells: BTreeMap<usize, (String, &Path)> = BTreeMap::new();
    let mut identity: Option<(Identity, &Path)> = None;
    for file in files {
        let text =
            std::fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()))?;
        let table = Table::read(&text).with_context(|| file.display().to_string())?;
        let (first, of) = identity.get_or_insert_with(|| (table.identity.clone(), file));
        ensure!(
            *first == table.identity,
            "{} and {} are of different campaigns:\n  {}\n  {}",
            of.display(),
            file.display(),
            first.line(),
            table.identity.line()
        );
        for rows in table.rows.chunks(table.identity.rows) {
            let text: String = rows.iter().flat_map(|row| [row.line.as_str(), "\n"]).collect();
            let cell = rows.first().map_or(0, |row| row.cell);
            if let Some((_, before)) = cells.insert(cell, (text, file)) {
                bail!(
                    "cell {cell} is in {} and in {}: give each share once",
                    before.display(),
                    file.display()
                );
            }
        }
    }
    let (identity, _) = identity.context("nothing to merge: give the CSV files of all shares")?;
    let missing: Vec<usize> = (0..identity.cells).filter(|cell| !cells.contains_key(cell)).collect();
    if let Some(first) = missing.first() {
        bail!(
            "{} of {} cells are missing, the first is {first}: finish the shares with --resume, and give all of them",
            missing.len(),
            identity.cells
        );
    }
    ensure!(cells.len() == identity.cells, "the tables have cells that the campaign does not have");
    Ok(identity.heading() + &cells.into_values().map(|(text, _)| text).collect::<String>())
}
