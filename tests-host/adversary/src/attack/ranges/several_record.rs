//! Record of the rates at which several faults pass undetected, in `records/several.tsv`.
//!
//! The first line has the version of the sources. Every other line is a cell of the table:
//! method, number of faults, number of satellites, epochs, promised, misleading, hazardous.

use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::{Context as _, Result, ensure};

use super::several_faults::{METHODS, Passing};
use crate::attack::record;

const FILE: &str = "several.tsv";

/// First word of the first line.
const VERSION: &str = "version";

/// Writes the record.
///
/// # Errors
/// If the file cannot be written.
pub fn write(cells: &[Passing], version: &str) -> Result<PathBuf> {
    let mut text = format!("{VERSION}\t{version}\n");
    for Passing { method, satellites, faults, epochs, promised, misleading, hazardous } in cells {
        let _ = writeln!(
            text,
            "{method}\t{faults}\t{satellites}\t{epochs}\t{promised}\t{misleading}\t{hazardous}"
        );
    }
    record::write(FILE, &text)
}

/// Reads the committed record.
///
/// # Errors
/// If the file cannot be read, or a line is not a cell.
pub fn committed() -> Result<Vec<Passing>> {
    let text = record::read(FILE)?;
    let mut lines = text.lines();
    ensure!(lines.next().is_some_and(|line| line.starts_with(VERSION)), "the first line must be the version");
    lines.map(|line| cell(line).with_context(|| format!("`{line}` must be a cell"))).collect()
}

fn cell(line: &str) -> Result<Passing> {
    let (method, counts) = line.split_once('\t').context("several columns")?;
    let method = METHODS.into_iter().find(|known| *known == method).context("a method")?;
    let counts = counts.split('\t').map(str::parse).collect::<Result<Vec<usize>, _>>()?;
    let &[faults, satellites, epochs, promised, misleading, hazardous] = &counts[..] else {
        anyhow::bail!("there must be six counts");
    };
    Ok(Passing { method, satellites, faults, epochs, promised, misleading, hazardous })
}

/// Returns a Markdown table: a row per method and number of faults, a column per number of
/// satellites.
pub fn markdown(cells: &[Passing]) -> String {
    let mut numbers: Vec<usize> = cells.iter().map(|cell| cell.satellites).collect();
    numbers.sort_unstable();
    numbers.dedup();
    let heads: Vec<String> = numbers.iter().map(|number| format!("{number} satellites")).collect();
    let mut table =
        format!("| method | faults | {} |\n|---|---|{}\n", heads.join(" | "), "---|".repeat(numbers.len()));
    let mut rows: Vec<(&str, usize)> = cells.iter().map(|cell| (cell.method, cell.faults)).collect();
    rows.dedup();
    for (method, faults) in rows {
        let of_row = cells.iter().filter(|cell| (cell.method, cell.faults) == (method, faults));
        let row: Vec<String> = of_row.map(percents).collect();
        let _ = writeln!(table, "| `{method}` | {faults} | {} |", row.join(" | "));
    }
    table
}

fn percents(cell: &Passing) -> String {
    let percent = |count: usize| 100.0 * count as f64 / cell.epochs.max(1) as f64;
    let [beyond, hazardous] = [cell.misleading, cell.hazardous].map(percent);
    format!("{beyond:.1} ({hazardous:.1}) of {:.0}", percent(cell.promised))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELL: Passing = Passing {
        method: "AUTO",
        satellites: 8,
        faults: 2,
        epochs: 1000,
        promised: 64,
        misleading: 2,
        hazardous: 1,
    };

    /// `cargo xtask attack --several 1000 --record` renews the record, `RAI_BLESS=1` the table.
    #[test]
    fn document_has_the_rates_of_the_record() {
        let cells = committed().expect("a record");
        rig::document::must_have("results/integrity.md", "several", &markdown(&cells));
    }

    #[test]
    fn line_is_read_as_a_cell() {
        assert_eq!(cell("AUTO\t2\t8\t1000\t64\t2\t1").expect("a cell"), CELL);
        for line in ["AUTO\t2\t8\t1000\t64\t2", "MAGIC\t2\t8\t1000\t64\t2\t1", "AUTO"] {
            assert!(cell(line).is_err(), "{line}");
        }
    }

    #[test]
    fn cell_has_percents_of_all_epochs() {
        let want = "| method | faults | 8 satellites |\n|---|---|---|\n| `AUTO` | 2 | 0.2 (0.1) of 6 |\n";
        assert_eq!(markdown(&[CELL]), want);
    }
}
