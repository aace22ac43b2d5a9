//! The program `rai`: its build for this system or another target, and its archive.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Result, ensure};

use super::VERSION;
use super::files::{Entry, name, tar_gz, time_s};
use xtask::cargo::{command, root, spawn};

/// Builds the program for this system; returns it, and its archive.
///
/// # Errors
/// If it does not build, or does not print its version.
pub(super) fn build(out: &Path) -> Result<(PathBuf, PathBuf)> {
    let program = compile(None)?;
    check_version(&program)?;
    let suffix = format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS);
    let archive = archive(&program, &suffix, out)?;
    Ok((program, archive))
}

/// Builds the program for a target of musl, or for this system with TLS.
///
/// # Errors
/// If it does not build.
pub(super) fn compile(target: Option<&str>) -> Result<PathBuf> {
    let mut cargo = command(&["build", "--release", "--locked", "--package", "raim", "--bin", "rai"]);
    let mut folder = root().join("target");
    if target.is_none() {
        // The cryptography of TLS needs a C compiler, which a system rarely has for another one.
        cargo.args(["--features", "tls"]);
    }
    if let Some(target) = target {
        cargo.args(["--target", target]);
        let variable = target.to_uppercase().replace('-', "_");
        // The compiler's own linker and objects, because a system rarely has those of another one.
        let flags = "-C linker=rust-lld -C link-self-contained=yes";
        cargo.env(format!("CARGO_TARGET_{variable}_RUSTFLAGS"), flags);
        folder = folder.join(target);
    }
    // Without the places of the builder's files, and without symbols, a third of the size.
    cargo.args(["--config", "profile.release.strip=true", "--config", "profile.release.debug=0"]);
    spawn(&mut cargo)?;
    Ok(folder.join("release/rai"))
}

fn check_version(program: &Path) -> Result<()> {
    let output = Command::new(program).arg("--version").output()?;
    let reported = String::from_utf8_lossy(&output.stdout);
    ensure!(reported.trim() == format!("rai {VERSION}"), "{} prints {reported:?}", program.display());
    Ok(())
}

/// Returns the files that go with a program, below a folder.
pub(super) fn with_texts(folder: &str, texts: &[&str]) -> Result<Vec<Entry>> {
    texts
        .iter()
        .map(|text| Entry::of(format!("{folder}{}", name(Path::new(text))?), &root().join(text)))
        .collect()
}

/// Packs a program with its texts.
///
/// # Errors
/// If a file cannot be read or written.
pub(super) fn archive(program: &Path, suffix: &str, out: &Path) -> Result<PathBuf> {
    let folder = format!("rai-{VERSION}-{suffix}/");
    let mut entries = vec![Entry::of(format!("{folder}rai"), program)?.program()];
    let texts = [
        "LICENSE-APACHE",
        "LICENSE-MIT",
        "README.md",
        "rai-firmware/cli/rai.service",
        "rai-firmware/cli/rai.toml",
    ];
    entries.extend(with_texts(&folder, &texts)?);
    let path = out.join(format!("rai-{VERSION}-{suffix}.tar.gz"));
    fs::write(&path, tar_gz(&entries, time_s()?)?)?;
    Ok(path)
}
