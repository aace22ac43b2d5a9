//! The two libraries as users receive them: packed, unpacked, compiled, with the examples of their
//! documentation run.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, ensure};

use crate::cargo::{command, root, spawn};

/// Packages in their order; the second needs the first.
pub(crate) const PACKAGES: [&str; 2] = ["raim-core", "raim-firmware"];

/// Separate workspace, so that cargo does not find ours. One library finds the other beside it, not
/// in the registry, because ours are not published.
const WORKSPACE: &str = "[workspace]
resolver = \"3\"
members = [\"raim-core\", \"raim-firmware\"]

[patch.crates-io]
raim-core = { path = \"raim-core\" }
";

/// Packs both libraries, and tests the result.
pub(crate) fn verify() -> Result<()> {
    pack()?;
    let unpacked = unpack()?;
    check_names(&unpacked)?;
    let manifest = unpacked.join("Cargo.toml").display().to_string();
    let folder = unpacked.join("target").display().to_string();
    let doc = ["test", "--quiet", "--doc", "--workspace", "--manifest-path"];
    spawn(command(&doc).args([manifest.as_str(), "--target-dir", folder.as_str()]))
}

/// Checks that every name of ours resolves to our own package. A registry may give a name to
/// another project, whose code cargo would then compile in place of ours.
fn check_names(unpacked: &Path) -> Result<()> {
    let output = command(&["metadata", "--format-version", "1"]).current_dir(unpacked).output()?;
    ensure!(output.status.success(), "`cargo metadata` failed:\n{}", String::from_utf8_lossy(&output.stderr));
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout)?;
    let packages = metadata["packages"].as_array().context("cargo names no package")?;
    for name in PACKAGES {
        let found: Vec<_> = packages.iter().filter(|package| package["name"] == name).collect();
        ensure!(found.len() == 1, "{} packages have the name {name}, must be one", found.len());
        ensure!(found[0]["source"].is_null(), "{name} is the package of {}, not ours", found[0]["source"]);
    }
    let foreign = packages.iter().filter(|package| package["source"].is_string());
    let like_ours =
        foreign.filter_map(|package| package["name"].as_str()).find(|name| name.starts_with("rai"));
    ensure!(like_ours.is_none(), "{like_ours:?} comes from a registry and has a name like ours");
    Ok(())
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
