//! `cargo xtask mutants`: changes the core, one operator or value at a time, and checks that a test
//! fails.
//!
//! Each change is a build, and all of them take hours: `cargo xtask mutants -- --shard 0/20` takes
//! a share, `-- --file '*/snapshot.rs'` a file. `rai-core/mutants.md` lists the changes that no
//! test detects, with reasons.

use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context as _, ensure};

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Arguments for cargo-mutants
    #[arg(last = true)]
    rest: Vec<String>,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let probe = cargo().args(["mutants", "--version"]).stdout(Stdio::null()).stderr(Stdio::null()).status();
    ensure!(
        probe.is_ok_and(|status| status.success()),
        "cargo-mutants is missing: cargo install cargo-mutants"
    );
    let mut command = cargo();
    command.args(["mutants", "--package", "raim-core", "--output", "target"]).args(&arguments.rest);
    // A test with a counterexample has detected the change, so the smallest one is not needed.
    command.env("PROPTEST_MAX_SHRINK_ITERS", "0").env("PROPTEST_FAILURE_PERSISTENCE", "off");
    let status = command.status().context("cargo-mutants cannot be run")?;
    ensure!(
        status.success(),
        "some changes were not detected or could not be tried; target/mutants.out lists them"
    );
    Ok(())
}

fn cargo() -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."));
    command
}
