//! A small real recording for users without one: a minute of a receiver in Kamakura, Japan.
//!
//! GPS, Galileo and QZSS at 1 Hz, 2021-03-19 12:00, RINEX 3. It is part of the Python package
//! `cssrlib` (MIT licence). pip, the package client that a machine is likely to have, fetches it
//! once into a cache folder. The package is only unpacked; nothing of it is run.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use raim_core::frame::Ecef;

/// Package, and its only version whose content is known.
pub const PACKAGE: &str = "cssrlib==1.2.1";

/// Hash of that version's wheel, which pip compares.
const HASH: &str = "sha256:4a8a7c283097e197e34fde44344fa7fe0f7ae319d07837acbad362d259cbb6cb";

/// File names of observations and ephemerides, anywhere in the package.
const NAMES: [&str; 2] = ["SEPT078M1.21O", "SEPT078M.21P"];

/// Folder of the sample in a cache.
const FOLDER: &str = "sample";

/// A recording, and the place of its antenna.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// RINEX observations.
    pub observations: PathBuf,
    /// RINEX ephemerides.
    pub navigation: PathBuf,
    /// Position of the antenna.
    pub truth: Ecef,
}

/// Returns the sample from a folder of the cache, and fetches it if it is missing.
///
/// # Errors
/// If Python with pip is missing, the package index cannot be reached, or the package lacks the
/// files or differs from the known one; the message says which.
pub fn fetch(cache: &Path) -> Result<Sample> {
    if let Some(sample) = at_hand(cache) {
        return Ok(sample);
    }
    let folder = cache.join(FOLDER);
    install(&folder)?;
    let missing = || format!("{PACKAGE} in {} lacks {}", folder.display(), NAMES.join(" and "));
    at_hand(cache).with_context(missing)
}

/// Returns the sample if a folder of the cache has it.
pub fn at_hand(cache: &Path) -> Option<Sample> {
    let folder = cache.join(FOLDER);
    let [observations, navigation] = NAMES.map(|name| find(&folder, name));
    let truth = Ecef::new(-3_962_108.673, 3_381_309.574, 3_668_678.638);
    Some(Sample { observations: observations?, navigation: navigation?, truth })
}

/// Unpacks the package without its dependencies.
fn install(folder: &Path) -> Result<()> {
    let list = folder.join("requirements.txt");
    std::fs::create_dir_all(folder)
        .and_then(|()| std::fs::write(&list, format!("{PACKAGE} --hash={HASH}\n")))
        .with_context(|| format!("{} cannot be written", list.display()))?;
    let mut pip = Command::new("python3");
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps"]);
    pip.args(["--only-binary", ":all:", "--require-hashes", "--target"]).arg(folder).arg("-r").arg(&list);
    let output = pip.output();
    let output =
        output.context("pip, which fetches the sample, is missing: install python3 and python3-pip")?;
    let complaint = String::from_utf8_lossy(&output.stderr);
    let complaint = complaint.lines().last().unwrap_or("no reason given");
    ensure!(output.status.success(), "pip could not fetch the sample ({PACKAGE}): {complaint}");
    Ok(())
}

/// Finds a file of that name in a folder or below it.
fn find(folder: &Path, name: &str) -> Option<PathBuf> {
    let entries = std::fs::read_dir(folder).ok()?;
    let paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    let here = paths.iter().find(|path| path.file_name().is_some_and(|of| of == name)).cloned();
    here.or_else(|| paths.iter().filter(|path| path.is_dir()).find_map(|path| find(path, name)))
}
