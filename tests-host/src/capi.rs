//! The C interface: its header, and C programs that use it.
//!
//! | step | with |
//! |---|---|
//! | header from the sources | cbindgen |
//! | static and shared library of the host, static library of the chip | cargo |
//! | program, for the host and for the chip | gcc, arm-none-eabi-gcc |

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, ensure};

/// What to do where the committed header is not that of the sources.
pub const STALE_HEADER: &str = "the C interface has changed and its header has not: run `cargo xtask header`, and raise \
                                RAI_ABI_VERSION if a program compiled against the old header would misunderstand the new library";

/// Where the package of the C interface lies.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../rai-firmware/capi")
}

/// Where the committed header lies.
pub fn header_path() -> PathBuf {
    folder().join("include/rai.h")
}

/// The header as the sources say it is.
///
/// # Errors
/// Where a source cannot be read as Rust.
pub fn header() -> anyhow::Result<String> {
    let config = cbindgen::Config::from_file(folder().join("cbindgen.toml")).map_err(anyhow::Error::msg)?;
    // From the root on, since the modules are in the order of a reader there.
    let builder = cbindgen::Builder::new().with_config(config).with_src(folder().join("src/lib.rs"));
    let mut header = Vec::new();
    builder.generate().context("the sources of the C interface make no header")?.write(&mut header);
    Ok(String::from_utf8(header)?)
}

/// Builds the library of the C interface and gives its path.
///
/// `kind` is `staticlib` or `cdylib`, `target` a Rust target, or none for the host.
///
/// # Errors
/// Where it does not build; the message is cargo's.
pub fn library(kind: &str, target: Option<&str>, features: &str) -> anyhow::Result<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = root.join("target/capi").join(features.replace(',', "-"));
    let profile = if target.is_some() { "firmware" } else { "dev" };
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo
        .current_dir(&root)
        .args([
            "rustc",
            "--quiet",
            "--package=rai-capi",
            "--lib",
            "--crate-type",
            kind,
            "--no-default-features",
        ])
        .args(["--features", features, "--profile", profile, "--target-dir"])
        .arg(&folder);
    if let Some(target) = target {
        cargo.args(["--target", target]);
    }
    run(&mut cargo)?;
    let name = if kind == "cdylib" { "librai.so" } else { "librai.a" };
    let profile_folder = if profile == "dev" { "debug" } else { profile };
    Ok(folder.join(target.unwrap_or("")).join(profile_folder).join(name))
}

/// Runs a command and gives what it wrote to standard output.
///
/// # Errors
/// With what it wrote to standard error, where it fails.
pub fn run(command: &mut Command) -> anyhow::Result<Vec<u8>> {
    let output =
        command.output().with_context(|| format!("{} cannot be run", command.get_program().display()))?;
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{} failed:\n{said}", command.get_program().display());
    Ok(output.stdout)
}
