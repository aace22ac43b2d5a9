//! Budgets: the committed cost of each stage.
//!
//! The file has one line per figure: value, then name. Instruction counts are exact, so any growth
//! is a change of the program. A growth of 2 % is allowed, because unrelated changes of the
//! compiler's output cause as much.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use super::figure::Figure;

/// Allowed growth: 2 %.
const GROWTH: f64 = 1.02;

/// Returns the path of the committed figures.
pub fn path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../budgets.txt")
}

/// Returns the committed figures by name.
///
/// # Errors
/// If the file cannot be read, or a line is not a figure.
pub fn committed() -> Result<BTreeMap<String, u64>> {
    let path = path();
    let text =
        std::fs::read_to_string(&path).with_context(|| format!("{} cannot be read", path.display()))?;
    parse(&text)
}

fn parse(text: &str) -> Result<BTreeMap<String, u64>> {
    let figure = |line: &str| -> Result<(String, u64)> {
        let (value, name) =
            line.trim_start().split_once(' ').context("the line must be a figure and a name")?;
        Ok((name.trim().to_owned(), value.parse().with_context(|| format!("`{value}` is not a number"))?))
    };
    text.lines().map(|line| figure(line).with_context(|| format!("budget `{line}`"))).collect()
}

/// Formats figures as the file has them.
pub fn render(figures: &[Figure]) -> String {
    figures.iter().fold(String::new(), |mut text, figure| {
        let _ = writeln!(text, "{:>9} {}", figure.value, figure.name);
        text
    })
}

/// Returns the figures that exceed their budget, have none, or are missing.
pub fn findings(figures: &[Figure], committed: &BTreeMap<String, u64>) -> Vec<String> {
    let of_figure = |figure: &Figure| match committed.get(&figure.name) {
        None => Some(format!("{}: no budget is committed", figure.name)),
        Some(&budget) if figure.value as f64 > budget as f64 * GROWTH => {
            let growth = 100.0 * (figure.value as f64 / budget as f64 - 1.0);
            Some(format!("{}: {} is {growth:.1} % above its budget of {budget}", figure.name, figure.value))
        }
        Some(_) => None,
    };
    let is_measured = |name: &String| figures.iter().any(|figure| figure.name == *name);
    let gone = committed.keys().filter(|name| !is_measured(name));
    let gone = gone.map(|name| format!("{name}: has a budget but is not measured"));
    figures.iter().filter_map(of_figure).chain(gone).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(name: &str, value: u64) -> Figure {
        Figure { name: name.into(), value, target: None }
    }

    #[test]
    fn what_is_saved_is_what_is_read() {
        let figures = [figure("orbits, 20 satellites", 123_456), figure("flash", 7)];
        let read = parse(&render(&figures)).expect("figures");
        assert_eq!(findings(&figures, &read), Vec::<String>::new());
    }

    #[test]
    fn growth_beyond_two_percent_and_what_has_no_counterpart_are_findings() {
        let committed = parse("1000 kept\n1000 grown\n5 gone\n").expect("figures");
        let have = findings(&[figure("kept", 1020), figure("grown", 1021), figure("new", 1)], &committed);
        assert_eq!(have.len(), 3, "{have:?}");
        for (finding, word) in
            have.iter().zip(["grown: 1021 is 2.1 % above", "new: no budget", "gone: has a budget"])
        {
            assert!(finding.contains(word), "have {finding}, want {word}");
        }
    }

    #[test]
    fn line_that_is_no_figure_is_named() {
        let error = format!("{:#}", parse("12 a\nmany b\n").expect_err("no number"));
        assert!(error.contains("many b"), "{error}");
    }
}
