//! A cursor over the lines of a text that knows where it is, and what stands in their columns.

use anyhow::{Context, Result};

/// Lines with their numbers.
pub(super) struct Lines<'a> {
    lines: std::iter::Peekable<std::str::Lines<'a>>,
    number: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn of(text: &'a str) -> Self {
        Self { lines: text.lines().peekable(), number: 0 }
    }

    /// Number of the line last returned, from 1.
    pub(super) fn number(&self) -> usize {
        self.number
    }

    /// The next line without taking it.
    pub(super) fn peek(&mut self) -> Option<&'a str> {
        self.lines.peek().copied()
    }

    /// The next line of something that has begun.
    pub(super) fn within(&mut self, what: &str) -> Result<&'a str> {
        self.next().with_context(|| format!("the file ends inside {what}"))
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        let line = self.lines.next();
        self.number += usize::from(line.is_some());
        line
    }
}

/// Columns `from..to` without the blanks around; what the line does not reach is empty.
pub(super) fn columns(line: &str, from: usize, to: usize) -> &str {
    line.get(from.min(line.len())..to.min(line.len())).unwrap_or("").trim()
}

/// A number of Fortran, `D` exponents included; nothing when the columns are blank.
pub(super) fn number(text: &str) -> Result<Option<f64>> {
    if text.is_empty() {
        return Ok(None);
    }
    let parsed = text.parse().or_else(|_| text.replace(['D', 'd'], "e").parse::<f64>());
    let value = parsed.ok().filter(|value| value.is_finite());
    value.map(Some).with_context(|| format!("`{text}` is not a number"))
}
