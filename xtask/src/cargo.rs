//! Calls of cargo.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, ensure};

/// Returns a call of cargo, to be made later.
pub(crate) fn step(arguments: &[&str]) -> Box<dyn Fn() -> anyhow::Result<()> + Send> {
    let arguments: Vec<String> = arguments.iter().map(ToString::to_string).collect();
    Box::new(move || spawn(&mut command(&arguments)))
}

/// Returns cargo's command at the project's root.
pub(crate) fn command(arguments: &[impl AsRef<std::ffi::OsStr>]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root()).args(arguments);
    command
}

/// Returns the project's root.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().map_or_else(PathBuf::new, Path::to_owned)
}

/// Prints and runs the command.
pub(crate) fn spawn(command: &mut Command) -> anyhow::Result<()> {
    let words: Vec<_> = command.get_args().map(|argument| argument.to_string_lossy().into_owned()).collect();
    eprintln!("$ cargo {}", words.join(" "));
    let status = command.status().context("cargo cannot be run")?;
    ensure!(status.success(), "`cargo {}` failed", words.join(" "));
    Ok(())
}
