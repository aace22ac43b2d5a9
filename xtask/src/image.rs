//! `cargo xtask image`: builds named images and compares them with their limits.

use anyhow::ensure;
use rig::image::{Image, NAMED, Named};

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Names of the images (default: print the images and their chips, and build none)
    names: Vec<String>,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if arguments.names.is_empty() {
        for named in &NAMED {
            println!("{named}");
        }
        return Ok(());
    }
    rig::setup::ensure()?;
    let images = arguments.names.iter().map(|name| Named::of(name)).collect::<anyhow::Result<Vec<_>>>()?;
    images.into_iter().try_for_each(|named| build(named).map(|_| ()))
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
