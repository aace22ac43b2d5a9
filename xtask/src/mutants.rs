//! `cargo xtask mutants`: changes the core, one operator or value at a time, and checks that a test
//! fails.
//!
//! Each change is a build, and all of them take hours: `cargo xtask mutants -- --shard 0/20` takes
//! a share, `-- --file '*/snapshot.rs'` a file.

use std::process::Stdio;

use anyhow::{Context as _, Result, ensure};
use pico_args::Arguments;
use xtask::cargo::command;

/// Options of the command.
pub(crate) const OPTIONS: &str = "
  -- OPTION…  Options for cargo-mutants
";

/// Runs the command.
pub(crate) fn run(arguments: &mut Arguments) -> Result<()> {
    let rest = std::mem::replace(arguments, Arguments::from_vec(Vec::new())).finish();
    let mut probe = command(&["mutants", "--version"]);
    ensure!(
        probe.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success()),
        "cargo-mutants is missing: cargo install cargo-mutants"
    );
    let mut command = command(&["mutants", "--package", "raim-core", "--output", "target"]);
    command.args(rest.iter().filter(|word| *word != "--"));
    // A test with a counterexample has detected the change, so the smallest one is not needed.
    command.env("PROPTEST_MAX_SHRINK_ITERS", "0").env("PROPTEST_FAILURE_PERSISTENCE", "off");
    let status = command.status().context("cargo-mutants cannot be run")?;
    ensure!(
        status.success(),
        "some changes were not detected or could not be tried; target/mutants.out lists them"
    );
    Ok(())
}
