//! The two libraries as users receive them: packed, unpacked, compiled, with the examples of their
//! documentation run.

use std::fs;
use std::path::PathBuf;

use anyhow::{Context as _, Result, ensure};

use crate::cargo::{command, root, spawn};

/// Packages in their order; the second needs the first.
const PACKAGES: [&str; 2] = ["rai-core", "rai-firmware"];

/// Separate workspace, so that cargo does not find ours. One library finds the other beside it, not
/// in the registry, because ours are not published and the name may belong to somebody else.
const WORKSPACE: &str = "[workspace]
resolver = \"3\"
members = [\"rai-core\", \"rai-firmware\"]

[patch.crates-io]
rai-core = { path = \"rai-core\" }
";

/// Packs both libraries, and tests the result.
pub(crate) fn verify() -> Result<()> {
    pack()?;
    let unpacked = unpack()?;
    let manifest = unpacked.join("Cargo.toml").display().to_string();
    let folder = unpacked.join("target").display().to_string();
    let doc = ["test", "--quiet", "--doc", "--workspace", "--manifest-path"];
    spawn(command(&doc).args([manifest.as_str(), "--target-dir", folder.as_str()]))
}

/// Packs without compiling, because the examples compile later, and without a lock file, which a
/// library does not need.
fn pack() -> Result<()> {
    eprintln!("$ cargo package --package {} --package {}", PACKAGES[0], PACKAGES[1]);
    let how = ["package", "--allow-dirty", "--no-verify", "--exclude-lockfile"];
    let output = command(&how).args(["--package", PACKAGES[0], "--package", PACKAGES[1]]).output()?;
    ensure!(output.status.success(), "`cargo package` failed:\n{}", String::from_utf8_lossy(&output.stderr));
    Ok(())
}

/// Unpacks the packages side by side, without the version in their names.
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
        // Packed files all have the same time, so cargo would take the results of earlier files for
        // current ones.
        archive.set_preserve_mtime(false);
        archive.unpack(&unpacked)?;
        fs::rename(unpacked.join(versioned), folder)?;
    }
    Ok(unpacked)
}
