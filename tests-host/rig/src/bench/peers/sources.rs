//! Sources of the peers: fetched in one known version each, checked, and unpacked below `target`.
//!
//! | peer | version | source | check |
//! |---|---|---|---|
//! | libswiftnav | as in the crate swiftnav-sys 0.10.0 | crates.io, by cargo | the archive's SHA-256, which cargo checks against its lock |
//! | RTKLIB | 2.4.3 b34 | Debian's mirror, by Python | the archive's SHA-256 |
//!
//! libswiftnav is under the LGPL 3, RTKLIB under a BSD licence of two clauses. Nothing of either is
//! part of the shipped product.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

/// Crate that contains libswiftnav: name, version and SHA-256 of its archive.
const CRATE: [&str; 3] =
    ["swiftnav-sys", "0.10.0", "662d1a118ea189778e8d4be89c00389a8637daed9953d16fa2597adae8b1dce4"];

/// Archive of RTKLIB, its SHA-256, and the files taken from it.
pub(crate) const RTKLIB: [&str; 2] = [
    "http://deb.debian.org/debian/pool/main/r/rtklib/rtklib_2.4.3.b34+dfsg.orig.tar.xz",
    "81ad284ea51724dd562c5b9b60941bc9dc64733ab9c8f27ee29cfd056c11895a",
];
const RTKLIB_FILES: [&str; 3] = ["src/rtklib.h", "src/rtkcmn.c", "src/pntpos.c"];

/// Folders of the sources.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sources {
    /// Folder with `src` and `include`.
    pub libswiftnav: PathBuf,
    /// Folder with [`RTKLIB_FILES`] in their folder.
    pub rtklib: PathBuf,
}

impl Sources {
    fn places() -> Self {
        let folder = folder();
        Self { libswiftnav: folder.join("libswiftnav"), rtklib: folder.join("rtklib") }
    }

    /// Returns the sources if they were fetched before.
    pub fn at_hand() -> Option<Self> {
        let places = Self::places();
        (places.has_libswiftnav() && places.has_rtklib()).then_some(places)
    }

    /// Fetches missing sources, and reports its progress.
    ///
    /// # Errors
    /// If a package index cannot be reached, or an archive differs from the known one.
    pub fn fetch(mut progress: impl FnMut(&str)) -> Result<Self> {
        let places = Self::places();
        std::fs::create_dir_all(folder())?;
        if !places.has_libswiftnav() {
            progress("libswiftnav from crates.io");
            fetch_libswiftnav(&places.libswiftnav)?;
        }
        if !places.has_rtklib() {
            progress("RTKLIB from Debian, 32 MB");
            fetch_rtklib(&places.rtklib, &RTKLIB_FILES)?;
        }
        Self::at_hand().context("files of the peers' sources are missing after fetching")
    }

    fn has_libswiftnav(&self) -> bool {
        self.libswiftnav.join("src/single_epoch_solver.c").is_file()
    }

    fn has_rtklib(&self) -> bool {
        RTKLIB_FILES.iter().all(|file| self.rtklib.join(file).is_file())
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn folder() -> PathBuf {
    root().join("target/peers")
}

/// Lets cargo fetch the crate for an empty package, and copies its part of libswiftnav.
fn fetch_libswiftnav(to: &Path) -> Result<()> {
    let [name, version, sha256] = CRATE;
    let asking = folder().join("asking");
    std::fs::create_dir_all(asking.join("src"))?;
    let manifest = format!(
        "[package]\nname = \"asking\"\nedition = \"2024\"\n\n[dependencies]\n{name} = \"={version}\"\n\n[workspace]\n"
    );
    std::fs::write(asking.join("Cargo.toml"), manifest)?;
    std::fs::write(asking.join("src/lib.rs"), "")?;
    let package = package(&asking)?;
    let lock = std::fs::read_to_string(asking.join("Cargo.lock"))?;
    ensure!(
        lock.contains(&format!("checksum = \"{sha256}\"")),
        "the SHA-256 of {name} {version} on crates.io differs from the known one"
    );
    // The final name marks a complete copy.
    let fresh = to.with_extension("fresh");
    copy(&package.join("src/libswiftnav"), &fresh)?;
    std::fs::rename(fresh, to).context("the copy of libswiftnav cannot be renamed")
}

/// Returns the folder into which cargo has unpacked the crate.
fn package(asking: &Path) -> Result<PathBuf> {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(root()).args(["metadata", "--quiet", "--format-version", "1"]);
    // One target is enough, because nothing is compiled.
    cargo.args(["--filter-platform", crate::setup::TARGETS[0], "--manifest-path"]);
    cargo.arg(asking.join("Cargo.toml"));
    let said = crate::capi::run(&mut cargo).context("cargo cannot fetch libswiftnav")?;
    let metadata: serde_json::Value = serde_json::from_slice(&said)?;
    let packages = metadata["packages"].as_array().context("cargo names no packages")?;
    let package = packages.iter().find(|package| package["name"] == CRATE[0]);
    let manifest = package.and_then(|package| package["manifest_path"].as_str());
    let manifest = Path::new(manifest.context("cargo does not name the crate")?);
    Ok(manifest.parent().context("the manifest has no folder")?.to_owned())
}

/// Copies the two folders to compile.
fn copy(from: &Path, to: &Path) -> Result<()> {
    let _ = std::fs::remove_dir_all(to);
    for folder in ["src", "include/swiftnav"] {
        std::fs::create_dir_all(to.join(folder))?;
        for entry in std::fs::read_dir(from.join(folder))? {
            let path = entry?.path();
            if let Some(name) = path.file_name().filter(|_| path.is_file()) {
                std::fs::copy(&path, to.join(folder).join(name))?;
            }
        }
    }
    Ok(())
}

/// Fetches the archive of RTKLIB unless it is there, checks it, and takes files from it.
pub(crate) fn fetch_rtklib(to: &Path, files: &[&str]) -> Result<()> {
    let [address, sha256] = RTKLIB;
    std::fs::create_dir_all(folder())?;
    let archive = folder().join("rtklib.tar.xz");
    let status = Command::new("python3")
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("../peers/fetch.py"))
        .args([address, sha256])
        .args([&archive, to])
        .args(files)
        .status()
        .context("python3, which fetches RTKLIB, is missing: install it")?;
    ensure!(
        status.success(),
        "RTKLIB could not be fetched: {address}, as any mirror or snapshot.debian.org has it, may also be put at {}",
        archive.display()
    );
    Ok(())
}
