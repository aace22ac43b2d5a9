//! A file in place of standard input.
//!
//! `rai run --input FILE` is `rai run < FILE`: what is done with a file on standard input is then
//! done with a named one.

use std::path::Path;

use anyhow::{Context as _, Result};

/// Returns the name of an input. A file takes the place of standard input, `-`.
///
/// # Errors
/// The file cannot be read.
pub(crate) fn named(input: &str) -> Result<String> {
    if !Path::new(input).is_file() {
        return Ok(input.to_owned());
    }
    replace(Path::new(input)).with_context(|| input.to_owned())?;
    Ok("-".to_owned())
}

#[cfg(unix)]
fn replace(path: &Path) -> Result<()> {
    nix::unistd::dup2_stdin(std::fs::File::open(path)?)?;
    Ok(())
}

#[cfg(not(unix))]
fn replace(_: &Path) -> Result<()> {
    anyhow::bail!("on this system give a file as standard input: rai run < FILE")
}
