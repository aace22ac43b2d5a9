//! `cargo xtask coverage`: line coverage of the core's tests.

use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context as _, ensure};

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Include the tests of the whole workspace, not only the core's
    #[arg(long)]
    all: bool,
    /// List the lines that no test reaches
    #[arg(long)]
    missing: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let probe = cargo().args(["llvm-cov", "--version"]).stdout(Stdio::null()).stderr(Stdio::null()).status();
    let is_there = probe.is_ok_and(|status| status.success());
    ensure!(
        is_there,
        "cargo-llvm-cov is missing: rustup component add llvm-tools && cargo install cargo-llvm-cov"
    );
    let mut command = cargo();
    let tests: &[&str] = if arguments.all { &["--workspace"] } else { &["--package", "raim-core"] };
    command.args(["llvm-cov", "test"]).args(tests);
    // Only the core is counted, without the tests inside it.
    command.args(["--ignore-filename-regex", "(rai-firmware|tests-host|xtask)/|/tests"]);
    command.arg(if arguments.missing { "--show-missing-lines" } else { "--summary-only" });
    let status = command.status().context("cargo-llvm-cov cannot be run")?;
    ensure!(status.success(), "the tests failed, or their coverage was not measured");
    Ok(())
}

fn cargo() -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."));
    command
}
