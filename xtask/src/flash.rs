//! `cargo xtask flash`.

use anyhow::bail;

/// Arguments of the command.
#[derive(clap::Args)]
pub struct Arguments {}

/// Runs the command.
pub fn run(_arguments: Arguments) -> anyhow::Result<()> {
    bail!("not built yet")
}
