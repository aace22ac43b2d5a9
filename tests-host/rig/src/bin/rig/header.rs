//! `cargo xtask header`: generates the header of the C interface, or compares the committed one
//! with the sources.

use anyhow::{Context as _, ensure};
use rig::capi;

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Write nothing; fail if the committed header differs from the sources
    #[arg(long)]
    check: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let (path, header) = (capi::header_path(), capi::header()?);
    if arguments.check {
        let committed = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        ensure!(committed == header, "{}", capi::STALE_HEADER);
        println!("committed header: identical to that of the sources");
    } else {
        std::fs::write(&path, header).with_context(|| path.display().to_string())?;
        println!("wrote {}", path.display());
    }
    Ok(())
}
