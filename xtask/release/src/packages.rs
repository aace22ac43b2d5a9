//! The packages as users receive them: packed, unpacked and compiled, with the examples of the two
//! libraries' documentation run.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, ensure};

use xtask::cargo::{command, root, spawn};

/// Packages in their order; each needs those before it.
pub(crate) const PACKAGES: [&str; 5] = ["raim-root", "raim-core", "raim-single", "raim-firmware", "raim"];

/// Separate workspace, so that cargo does not find ours. One package finds the others beside it,
/// not in the registry, because ours are not published.
const WORKSPACE: &str = "[workspace]
resolver = \"3\"
members = [\"raim-root\", \"raim-core\", \"raim-single\", \"raim-firmware\", \"raim\"]

[patch.crates-io]
raim-root = { path = \"raim-root\" }
raim-core = { path = \"raim-core\" }
raim-single = { path = \"raim-single\" }
raim-firmware = { path = \"raim-firmware\" }
";

/// Packs all packages, and tests the result. The command is only checked, because it compiles for
/// minutes and its documentation has no examples.
pub(crate) fn verify() -> Result<()> {
    pack()?;
    let unpacked = unpack()?;
    check_licences(&unpacked)?;
    check_names(&unpacked)?;
    let manifest = unpacked.join("Cargo.toml").display().to_string();
    // The folder of our own results, so that packages of the registry are compiled once.
    let folder = root().join("target").display().to_string();
    let place = ["--manifest-path", manifest.as_str(), "--target-dir", folder.as_str()];
    let [_, core, _, firmware, command_line] = PACKAGES;
    spawn(command(&["test", "--quiet", "--doc", "-p", core]).args(place))?;
    spawn(command(&["check", "--quiet", "--examples", "-p", core]).args(place))?;
    spawn(command(&["test", "--quiet", "--doc", "-p", firmware]).args(place))?;
    spawn(command(&["check", "--quiet", "-p", command_line]).args(place))
}

/// Files of the licence, which every package contains.
const LICENCES: [&str; 2] = ["LICENSE-MIT", "LICENSE-APACHE"];

/// Checks that every package in a folder contains the text of the licence.
fn check_licences(unpacked: &Path) -> Result<()> {
    for (package, name) in PACKAGES.iter().flat_map(|package| LICENCES.map(|name| (package, name))) {
        let file = unpacked.join(package).join(name);
        let have = fs::read_to_string(&file).with_context(|| file.display().to_string())?;
        let want = fs::read_to_string(root().join(name))?;
        ensure!(have == want, "{name} of {package} must be a copy of the file at the top level");
    }
    Ok(())
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
    let which = PACKAGES.map(|package| format!("--package={package}"));
    eprintln!("$ cargo package {}", which.join(" "));
    let how = ["package", "--allow-dirty", "--no-verify", "--exclude-lockfile"];
    let output = command(&how).args(which).output()?;
    ensure!(output.status.success(), "`cargo package` failed:\n{}", String::from_utf8_lossy(&output.stderr));
    Ok(())
}

/// Returns our profiles, without which no result of a package of the registry could be used again.
fn profiles() -> Result<String> {
    let manifest = fs::read_to_string(root().join("Cargo.toml"))?;
    let begin = manifest.find("[profile.dev]").context("the workspace must have a profile `dev`")?;
    let end = manifest.find("[profile.firmware]").context("the workspace must have a profile `firmware`")?;
    Ok(manifest.get(begin..end).unwrap_or_default().to_owned())
}

/// Unpacks the packages side by side, without the version in their names.
fn unpack() -> Result<PathBuf> {
    let (packed, unpacked) = (root().join("target/package"), root().join("target/unpacked"));
    fs::create_dir_all(&unpacked)?;
    fs::write(unpacked.join("Cargo.toml"), format!("{WORKSPACE}\n{}", profiles()?))?;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_package_carries_the_text_of_the_licence() {
        let folders =
            ["rai-core/root", "rai-core", "rai-firmware/single", "rai-firmware", "rai-firmware/cli"]
                .map(|name| root().join(name));
        let together = tempfile::tempdir().expect("a folder");
        for (package, folder) in PACKAGES.iter().zip(&folders) {
            let manifest = fs::read_to_string(folder.join("Cargo.toml")).expect("a manifest");
            assert!(manifest.contains(&format!("name = \"{package}\"")), "{}", folder.display());
            fs::create_dir(together.path().join(package)).expect("a folder");
            for name in LICENCES {
                fs::copy(folder.join(name), together.path().join(package).join(name)).expect("the licence");
            }
        }
        check_licences(together.path()).expect("copies of the files at the top level");

        // A link that git did not follow is a file with a path in it.
        fs::write(together.path().join("raim-core/LICENSE-MIT"), "../LICENSE-MIT").expect("a file");
        let error = check_licences(together.path()).expect_err("no licence").to_string();
        assert!(error.contains("LICENSE-MIT of raim-core"), "{error}");
    }
}
