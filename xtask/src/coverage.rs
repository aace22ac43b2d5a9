//! `cargo xtask coverage`: line coverage of the core's tests.

use std::process::Stdio;

use anyhow::{Context as _, Result, ensure};
use pico_args::Arguments;
use xtask::cargo::command;

/// Options of the command.
pub(crate) const OPTIONS: &str = "
  --all      Include the tests of the whole workspace, not only the core's
  --missing  List the lines that no test reaches
";

/// Runs the command.
pub(crate) fn run(arguments: &mut Arguments) -> Result<()> {
    let [is_all, is_missing] = ["--all", "--missing"].map(|option| arguments.contains(option));
    crate::test::ensure_none_is_left(arguments)?;
    let mut probe = command(&["llvm-cov", "--version"]);
    ensure!(
        probe.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success()),
        "cargo-llvm-cov is missing: rustup component add llvm-tools && cargo install cargo-llvm-cov"
    );
    let tests: &[&str] =
        if is_all { &["--workspace", "--lib", "--bins", "--test=*"] } else { &["--package", "raim-core"] };
    let mut command = command(&[&["llvm-cov", "test"], tests].concat());
    // Only the core is counted, without the tests inside it.
    command.args(["--ignore-filename-regex", "(rai-firmware|tests-host|xtask)/|/tests"]);
    command.arg(if is_missing { "--show-missing-lines" } else { "--summary-only" });
    let status = command.status().context("cargo-llvm-cov cannot be run")?;
    ensure!(status.success(), "the tests failed, or their coverage was not measured");
    Ok(())
}
