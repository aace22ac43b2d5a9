//! `cargo xtask flash`: the image onto a chip, or held against its memory.

use std::path::{Path, PathBuf};

use anyhow::ensure;
use tests_host::image::{self, Chip, Image};

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The chip, as probe-rs names it.
    #[arg(long, default_value = "STM32F405RGTx")]
    chip: String,
    /// Write nothing and need no probe: check that the image fits the chip and would start.
    #[arg(long)]
    dry_run: bool,
    /// This image instead of a fresh one.
    #[arg(long)]
    image: Option<PathBuf>,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let chip = Chip::named(&arguments.chip)?;
    let path = arguments.image.clone().map_or_else(fresh, Ok)?;
    check(&path, &chip)?;
    if arguments.dry_run { Ok(()) } else { write(&path, &chip) }
}

fn fresh() -> anyhow::Result<PathBuf> {
    tests_host::setup::ensure()?;
    image::build()
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

    let mut session =
        Session::auto_attach(chip.name, SessionConfig::default()).context("no probe reaches the chip")?;
    println!("writing …");
    download_file(&mut session, path, ElfLoader(ElfOptions::default()))
        .context("the flash was not written")?;
    session.core(0)?.reset()?;
    println!("written; the module runs");
    Ok(())
}

#[cfg(not(feature = "probe"))]
fn write(_path: &Path, chip: &Chip) -> anyhow::Result<()> {
    anyhow::bail!(
        "this build cannot drive a probe, which takes minutes to compile:\n\n    \
         cargo run --package xtask --features probe -- flash --chip {}\n",
        chip.name
    )
}
