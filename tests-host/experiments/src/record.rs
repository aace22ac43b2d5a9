//! Records of what experiments in full found last, in `records/NAME.jsonl`.
//!
//! The first line is the outcome as [`Outcome::json`] has it, without its rows and with the version
//! of the sources; every other line is a row. The documents are compared with it, because the tests
//! run only the reduced form.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use serde_json::Value;

use super::Outcome;

/// Writes the record of an outcome.
///
/// # Errors
/// If the file cannot be written.
pub fn write(outcome: &Outcome, version: &str) -> Result<PathBuf> {
    let mut head = outcome.json();
    let rows = head["rows"].take();
    if let Some(head) = head.as_object_mut() {
        head.remove("rows");
        head.insert("version".into(), version.into());
    }
    let mut text = String::new();
    for line in std::iter::once(&head).chain(rows.as_array().into_iter().flatten()) {
        writeln!(text, "{line}")?;
    }
    let path = path(outcome.name);
    fs::write(&path, text).with_context(|| path.display().to_string())?;
    Ok(path)
}

/// Reads the rows of the committed record of an experiment.
///
/// # Errors
/// If the file cannot be read, or a line is not JSON.
pub fn committed(name: &str) -> Result<Vec<Value>> {
    let path = path(name);
    let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let rows: Result<_, _> = text.lines().skip(1).map(serde_json::from_str).collect();
    rows.with_context(|| path.display().to_string())
}

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("records").join(name).with_extension("jsonl")
}
