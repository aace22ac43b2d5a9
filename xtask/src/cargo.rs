//! Calls of cargo at the project's root.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, ensure};

use crate::setup::{VARIABLE, is_yes_assumed};

/// Variable by which a program learns the name under which a person called it, for its help and
/// its reports.
pub const CALLED_AS: &str = "RAI_CALLED_AS";

/// Name of these commands for a person.
pub const NAME: &str = "cargo xtask";

/// Returns cargo's command.
pub fn command(arguments: &[impl AsRef<OsStr>]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root()).args(arguments);
    command
}

/// Returns the command that builds a program of a package and runs it in the caller's folder, to
/// which paths on the command line are relative.
pub fn program(package: &str, name: &str, features: &str) -> Command {
    let mut command = command(&["run", "--package", package, "--bin", name, "--features", features]);
    command.arg("--manifest-path").arg(root().join("Cargo.toml")).arg("--").env(CALLED_AS, NAME);
    if is_yes_assumed() {
        command.env(VARIABLE, "1");
    }
    if let Ok(folder) = std::env::current_dir() {
        command.current_dir(folder);
    }
    command
}

/// Returns the project's root.
pub fn root() -> PathBuf {
    // Without `..`, because users read paths below it.
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().map_or_else(PathBuf::new, Path::to_owned)
}

/// Prints and runs the command.
///
/// # Errors
/// If it cannot be run or fails.
pub fn spawn(command: &mut Command) -> anyhow::Result<()> {
    let words: Vec<_> = command.get_args().map(|argument| argument.to_string_lossy().into_owned()).collect();
    eprintln!("$ cargo {}", words.join(" "));
    let status = command.status().context("cargo cannot be run")?;
    ensure!(status.success(), "`cargo {}` failed", words.join(" "));
    Ok(())
}
