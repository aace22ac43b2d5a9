//! The header of the C interface, which cbindgen makes from the sources.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Error, Result, ensure};
use rig::capi::{folder, header_path};

use crate::{Built, VERSION, files};

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Write nothing; fail if the committed header differs from the sources
    #[arg(long)]
    check: bool,
}

/// Runs `cargo xtask header`.
///
/// # Errors
/// The sources make no header, or another one than the committed one that is checked.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let path = header_path();
    if arguments.check {
        check()?;
        println!("committed header: identical to that of the sources");
    } else {
        fs::write(&path, generated()?).with_context(|| path.display().to_string())?;
        println!("wrote {}", path.display());
    }
    Ok(())
}

/// Checks the header, and copies it.
pub(crate) fn copy(out: &Path) -> Result<Built> {
    check()?;
    Ok(Built::of(vec![files::copy(&header_path(), &out.join("rai.h"))?]))
}

/// Compares the committed header with that of the sources.
fn check() -> Result<()> {
    let path = header_path();
    let committed = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    ensure!(
        committed == generated()?,
        "the C interface has changed and its header has not: run `cargo xtask header`, and raise RAI_ABI_VERSION if a \
         program compiled against the old header would misunderstand the new library"
    );
    Ok(())
}

/// Generates the header from the sources.
fn generated() -> Result<String> {
    let config = cbindgen::Config::from_file(folder().join("cbindgen.toml")).map_err(Error::msg)?;
    // The root comes first, because it lists the modules in the reader's order.
    let builder = cbindgen::Builder::new().with_config(config).with_src(folder().join("src/lib.rs"));
    let mut header = Vec::new();
    builder
        .generate()
        .context("the header cannot be generated from the sources of the C interface")?
        .write(&mut header);
    Ok(String::from_utf8(header)?.replace("@VERSION@", VERSION))
}

#[cfg(test)]
mod tests {
    #[test]
    fn committed_header_is_what_the_sources_say() {
        super::check().unwrap();
    }
}
