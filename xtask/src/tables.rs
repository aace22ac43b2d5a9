//! `cargo xtask tables`: regenerates the threshold tables, or checks the committed ones.

use anyhow::{Context as _, ensure};
use oracle::tables;
use oracle::vectors;

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Write nothing; fail if the committed table differs from its generator, or either from the
    /// gold values
    #[arg(long)]
    pub(crate) check: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let path = tables::committed_path();
    if arguments.check {
        let committed = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        tables::check_committed(&committed)?;
        println!("committed table: identical to its generator, byte for byte");
    } else {
        std::fs::write(&path, tables::render()).with_context(|| path.display().to_string())?;
        println!("wrote {}", path.display());
    }
    compare_with_gold()
}

fn compare_with_gold() -> anyhow::Result<()> {
    let comparison = tables::compare_with_gold(&vectors::path("gold"), &tables::computed())?;
    let worst = comparison.worst_relative;
    println!("gold values: {} compared, worst relative error {worst:.1e}", comparison.values);
    ensure!(worst <= tables::TOLERANCE, "worst relative error {worst:.1e} exceeds {:.0e}", tables::TOLERANCE);
    Ok(())
}
