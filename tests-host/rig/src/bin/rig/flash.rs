//! `cargo xtask flash`: writes the image to a chip, or checks it against the chip's memory.

use std::path::{Path, PathBuf};

use anyhow::ensure;
use rig::image::{Chip, Image, Named};

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Name of the chip in probe-rs
    #[arg(long, default_value = "STM32F405RGTx")]
    chip: String,
    /// Only check that the image fits the chip and would start; needs no probe
    #[arg(long)]
    dry_run: bool,
    /// Name of the image to build and write; `cargo xtask image` lists them
    #[arg(long, default_value = "fast", conflicts_with = "image")]
    named: String,
    /// File of an image to write instead
    #[arg(long)]
    image: Option<PathBuf>,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let chip = Chip::named(&arguments.chip)?;
    let path = arguments.image.clone().map_or_else(|| fresh(&arguments.named), Ok)?;
    check(&path, &chip)?;
    if arguments.dry_run { Ok(()) } else { write(&path, &chip) }
}

/// Builds a named image, which prints the chips that carry it.
fn fresh(name: &str) -> anyhow::Result<PathBuf> {
    let named = Named::of(name)?;
    crate::image::build(named).map(|(path, _)| path)
}

fn check(path: &Path, chip: &Chip) -> anyhow::Result<()> {
    let image = Image::open(path)?;
    println!("{image}");
    let findings = image.check(chip);
    ensure!(findings.is_empty(), "the image does not fit:\n  {}", findings.join("\n  "));
    println!("fits {}", chip.name);
    Ok(())
}

#[cfg(feature = "probe")]
fn write(path: &Path, chip: &Chip) -> anyhow::Result<()> {
    use anyhow::Context as _;
    use probe_rs::flashing::{ElfLoader, ElfOptions, download_file};
    use probe_rs::{Session, SessionConfig};

    let mut session = Session::auto_attach(chip.name, SessionConfig::default())
        .context("no debug probe reaches the chip")?;
    println!("writing …");
    download_file(&mut session, path, ElfLoader(ElfOptions::default()))
        .context("the image could not be written to flash")?;
    session.core(0)?.reset()?;
    println!("written; the module runs");
    Ok(())
}

#[cfg(not(feature = "probe"))]
fn write(_path: &Path, chip: &Chip) -> anyhow::Result<()> {
    anyhow::bail!(
        "this build has no probe support, which takes minutes to compile:\n\n    \
         cargo run --package rig --features probe -- flash --chip {}\n",
        chip.name
    )
}
