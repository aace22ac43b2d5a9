//! Records of what experiments in full found last, in `records/NAME.json`.
//!
//! A record is the outcome as [`Outcome::json`] has it, with the version of the sources. The
//! documents are compared with it, because the tests run only the reduced form.

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
    let mut value = outcome.json();
    value["version"] = version.into();
    let path = path(outcome.name);
    fs::write(&path, format!("{value:#}\n")).with_context(|| path.display().to_string())?;
    Ok(path)
}

/// Reads the committed record of an experiment.
///
/// # Errors
/// If the file cannot be read, or is not JSON.
pub fn committed(name: &str) -> Result<Value> {
    let path = path(name);
    let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    serde_json::from_str(&text).with_context(|| path.display().to_string())
}

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("records").join(name).with_extension("json")
}
