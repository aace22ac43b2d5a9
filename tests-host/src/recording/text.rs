//! A file's text, whatever it is wrapped in, and a cursor over its lines that knows where it is.
//!
//! Wrapping is told by content, not by name: gzip by its magic bytes, compact RINEX by the label of its first line.

use std::io::Read as _;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use flate2::read::MultiGzDecoder;

use super::hatanaka;

/// RINEX text of a file: plain, gzip, compact, or compact in gzip.
///
/// Bytes outside ASCII (names in comments) become `?`, so that every column stays where it was.
pub(super) fn open(path: &Path) -> Result<String> {
    let bytes = std::fs::read(path).context("cannot be read")?;
    let text: String =
        unpack(bytes)?.into_iter().map(|byte| if byte.is_ascii() { byte.into() } else { '?' }).collect();
    ensure!(!text.trim().is_empty(), "is empty");
    let first = text.lines().next().unwrap_or("");
    if first.get(60..).is_some_and(|label| label.trim_end() == hatanaka::MARK) {
        return hatanaka::decompress(&text);
    }
    Ok(text)
}

fn unpack(bytes: Vec<u8>) -> Result<Vec<u8>> {
    match bytes.as_slice() {
        [0x1f, 0x8b, ..] => {
            let mut unpacked = Vec::with_capacity(bytes.len() * 6);
            MultiGzDecoder::new(bytes.as_slice()).read_to_end(&mut unpacked).context("is damaged gzip")?;
            Ok(unpacked)
        }
        [0x1f, 0x9d, ..] => bail!("is packed by `compress`: unpack it with `gzip -d`"),
        [b'P', b'K', 3, 4, ..] => bail!("is a zip archive: unpack it first"),
        _ => Ok(bytes),
    }
}

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
