//! Tools that need the nightly toolchain, which the product itself never does.

use std::process::{Command, Stdio};

use anyhow::ensure;

use crate::cargo::root;

/// Returns the nightly toolchain's cargo, at the root of the repository.
pub fn cargo(arguments: &[&str]) -> Command {
    let mut command = Command::new("rustup");
    command.args(["run", "nightly", "cargo"]).args(arguments);
    // These variables belong to the toolchain that runs this command, not to nightly.
    command.env_remove("RUSTUP_TOOLCHAIN").env_remove("CARGO").env_remove("RUSTC");
    command.current_dir(root());
    command
}

/// Checks that nightly and one of its tools are installed.
///
/// # Errors
/// If one is missing; the error is the command that installs it.
pub fn ensure(probe: &[&str], install: &str) -> anyhow::Result<()> {
    ensure!(
        answers(&["--version"]),
        "nightly is missing: rustup toolchain install nightly --profile minimal"
    );
    ensure!(answers(probe), "`cargo {}` is missing: {install}", probe[0]);
    Ok(())
}

fn answers(arguments: &[&str]) -> bool {
    let silent = cargo(arguments).stdout(Stdio::null()).stderr(Stdio::null()).status();
    silent.is_ok_and(|status| status.success())
}
