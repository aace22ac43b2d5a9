//! The two libraries as others would get them: packed, unpacked, compiled, their documentation's examples run.

use std::fs;
use std::path::PathBuf;

use anyhow::{Context as _, Result, ensure};

use crate::cargo::{command, root, spawn};

/// What is packed; the second needs the first.
const PACKAGES: [&str; 2] = ["rai-core", "rai-firmware"];

/// A workspace of its own, so that ours is not found. The one library finds the other beside it and not where crates are
/// published: ours are not, and somebody else's may have the name.
const WORKSPACE: &str = "[workspace]
resolver = \"3\"
members = [\"rai-core\", \"rai-firmware\"]

[patch.crates-io]
rai-core = { path = \"rai-core\" }
";

/// Packs both, and tests what came out of it.
pub(crate) fn verify() -> Result<()> {
    pack()?;
    let unpacked = unpack()?;
    let manifest = unpacked.join("Cargo.toml").display().to_string();
    let folder = unpacked.join("target").display().to_string();
    let doc = ["test", "--quiet", "--doc", "--workspace", "--manifest-path"];
    spawn(command(&doc).args([manifest.as_str(), "--target-dir", folder.as_str()]))
}

/// Compiled once, when the examples run; a library has no use for a lock file.
fn pack() -> Result<()> {
    eprintln!("$ cargo package --package {} --package {}", PACKAGES[0], PACKAGES[1]);
    let how = ["package", "--allow-dirty", "--no-verify", "--exclude-lockfile"];
    let output = command(&how).args(["--package", PACKAGES[0], "--package", PACKAGES[1]]).output()?;
    ensure!(output.status.success(), "`cargo package` failed:\n{}", String::from_utf8_lossy(&output.stderr));
    Ok(())
}

/// The packages side by side, without the version in their names.
fn unpack() -> Result<PathBuf> {
    let (packed, unpacked) = (root().join("target/package"), root().join("target/unpacked"));
    fs::create_dir_all(&unpacked)?;
    fs::write(unpacked.join("Cargo.toml"), WORKSPACE)?;
    fs::copy(root().join("Cargo.lock"), unpacked.join("Cargo.lock"))?;
    for package in PACKAGES {
        let versioned = format!("{package}-{}", env!("CARGO_PKG_VERSION"));
        let file = packed.join(format!("{versioned}.crate"));
        let reader = fs::File::open(&file).with_context(|| file.display().to_string())?;
        let folder = unpacked.join(package);
        if folder.exists() {
            fs::remove_dir_all(&folder)?;
        }
        let mut archive = tar::Archive::new(flate2::read::GzDecoder::new(reader));
        // Packed files all have one time, by which what was compiled of them before would seem to be of these.
        archive.set_preserve_mtime(false);
        archive.unpack(&unpacked)?;
        fs::rename(unpacked.join(versioned), folder)?;
    }
    Ok(unpacked)
}
