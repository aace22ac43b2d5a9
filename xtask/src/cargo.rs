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
    command.arg("--manifest-path").arg(root().join("Cargo.toml")).arg("--");
    if let Ok(folder) = std::env::current_dir() {
        command.current_dir(folder);
    }
    for_a_person(&mut command);
    command
}

/// Builds a program of the workspace, and returns where it is.
///
/// A package with other features is another package, and so is all that needs it. A test beside the program makes cargo
/// choose the features with which `cargo xtask test` builds everything: nothing is compiled twice.
///
/// # Errors
/// If it does not compile.
pub fn build(name: &str) -> anyhow::Result<PathBuf> {
    spawn(&mut command(&["build", "--workspace", "--bin", name, "--test", "top_level"]))?;
    let folder = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    Ok(folder.join("debug").join(name))
}

/// Lets a program answer as this one was asked.
pub fn for_a_person(command: &mut Command) -> &mut Command {
    if is_yes_assumed() {
        command.env(VARIABLE, "1");
    }
    command.env(CALLED_AS, NAME)
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
    let name = Path::new(command.get_program()).file_name().unwrap_or_default();
    let words: Vec<_> = std::iter::once(name).chain(command.get_args()).map(OsStr::to_string_lossy).collect();
    let words = words.join(" ");
    eprintln!("$ {words}");
    let status = command.status().with_context(|| format!("`{words}` cannot be run"))?;
    ensure!(status.success(), "`{words}` failed");
    Ok(())
}
