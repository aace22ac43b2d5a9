//! Real recordings that ordinary packages carry, so that a fresh clone tests the path from the
//! bytes of a receiver to the pin.
//!
//! | recording | package | check | known position from |
//! |---|---|---|---|
//! | Kamakura, 2021, a minute at 1 Hz, three systems ([`sample`]) | `cssrlib` of the Python package index | SHA-256, by pip | the package |
//! | station 3040 of Japan's survey, 2005, an hour at 30 s, GPS | sources of RTKLIB at Debian | SHA-256 of the archive | the base station in RTKLIB's own test of `rnx2rtkp` |
//!
//! Both are stored below `target`; nothing of them is part of the repository.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, ensure};
use raim::signal::sample::{self, Sample};
use raim_core::frame::Ecef;

use xtask::cargo::root;
use xtask::setup::agree;

/// Archive of RTKLIB, and its SHA-256.
const RTKLIB: [&str; 2] = [
    "http://deb.debian.org/debian/pool/main/r/rtklib/rtklib_2.4.3.b34+dfsg.orig.tar.xz",
    "81ad284ea51724dd562c5b9b60941bc9dc64733ab9c8f27ee29cfd056c11895a",
];
/// Folder of RTKLIB's recordings, below `target`.
const FOLDER: &str = "target/recordings/rtklib";
/// Observations and ephemerides of the station, in RTKLIB's archive.
const STATION: [&str; 2] = ["test/data/rinex/30400920.05o", "test/data/rinex/30400920.05n"];
/// Position of the station in `app/consapp/rnx2rtkp/gcc/makefile` of the same archive.
const STATION_AT: Ecef = Ecef::new(-3_978_241.958, 3_382_840.234, 3_649_900.853);

/// Returns the recording from Kamakura if it was fetched.
pub fn kamakura() -> Option<Sample> {
    sample::at_hand(&root().join("target"))
}

/// Returns the recording of the station if it was fetched.
pub fn station_3040() -> Option<Sample> {
    let [observations, navigation] = STATION.map(|file| folder().join(file));
    let is_there = observations.is_file() && navigation.is_file();
    is_there.then_some(Sample { observations, navigation, truth: STATION_AT })
}

/// Fetches the missing recordings, after a yes.
///
/// # Errors
/// If the user refuses, a package cannot be fetched, or it differs from the known one.
pub fn fetch() -> anyhow::Result<()> {
    let [has_sample, has_station] = [kamakura().is_some(), station_3040().is_some()];
    let announced = [
        (has_sample, format!("fetch {} from the Python package index (0.4 MB) to target", sample::PACKAGE)),
        (has_station, format!("fetch {} (32 MB) to target", RTKLIB[0])),
    ];
    let missing: Vec<String> =
        announced.into_iter().filter(|(is_there, _)| !is_there).map(|(_, words)| words).collect();
    if missing.is_empty() {
        return Ok(());
    }
    agree(&missing)?;
    if !has_sample {
        sample::fetch(&root().join("target"))?;
    }
    if !has_station {
        fetch_rtklib(&folder(), &STATION)?;
    }
    Ok(())
}

fn folder() -> PathBuf {
    root().join(FOLDER)
}

/// Fetches the archive of RTKLIB unless it is there, checks it, and takes files from it.
fn fetch_rtklib(to: &Path, files: &[&str]) -> anyhow::Result<()> {
    let [address, sha256] = RTKLIB;
    let folder = root().join("target/recordings");
    std::fs::create_dir_all(&folder)?;
    let archive = folder.join("rtklib.tar.xz");
    let status = Command::new("python3")
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/fetch.py"))
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
