//! `cargo xtask image`: builds named images and compares them with their limits.

use anyhow::ensure;
use rig::image::{Chip, Image, NAMED, Named};

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Names of the images (default: print the images and their chips, and build none)
    names: Vec<String>,
    /// Fail if an image does not fit the chip of the first board
    #[arg(long)]
    board: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if arguments.names.is_empty() {
        for named in &NAMED {
            println!("{named}");
        }
        return Ok(());
    }
    let images = arguments.names.iter().map(|name| Named::of(name)).collect::<anyhow::Result<Vec<_>>>()?;
    let chip = arguments.board.then(|| Chip::named("STM32F405RGTx")).transpose()?;
    for named in images {
        let (_, image) = build(named)?;
        let findings = chip.as_ref().map(|chip| image.check(chip)).unwrap_or_default();
        ensure!(findings.is_empty(), "{}: {}", named.name, findings.join("; "));
    }
    Ok(())
}

/// Builds an image, prints its path and memory, and fails if it exceeds its limits.
pub(crate) fn build(named: &Named) -> anyhow::Result<(std::path::PathBuf, Image)> {
    let path = named.build()?;
    let image = Image::open(&path)?;
    println!("{named}  built: {}", path.display());
    println!(
        "  {} bytes of flash, {} of statics and {} for the stack\n",
        image.flash_bytes, image.static_ram_bytes, named.stack_bytes
    );
    let findings = named.findings(&image);
    ensure!(findings.is_empty(), "{}", findings.join("; "));
    Ok((path, image))
}
