//! Files of a release: copies, and compressed archives whose bytes depend on their contents alone.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result};
use flate2::Compression;
use flate2::write::GzEncoder;

use xtask::cargo::root;

/// A file of an archive: path, contents, and the right to run it.
pub(super) struct Entry {
    pub(super) path: String,
    pub(super) bytes: Vec<u8>,
    pub(super) is_program: bool,
}

impl Entry {
    /// Returns an entry with the contents of a file.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub(super) fn of(path: impl Into<String>, file: &Path) -> Result<Self> {
        let bytes = fs::read(file).with_context(|| file.display().to_string())?;
        Ok(Self { path: path.into(), bytes, is_program: false })
    }

    /// Returns an entry with a text.
    pub(super) fn text(path: impl Into<String>, text: impl Into<String>) -> Self {
        Self { path: path.into(), bytes: text.into().into_bytes(), is_program: false }
    }

    /// Marks the entry as a program.
    pub(super) fn program(mut self) -> Self {
        self.is_program = true;
        self
    }
}

/// Copies a file and returns the copy's path.
pub(super) fn copy(from: &Path, to: &Path) -> Result<PathBuf> {
    fs::copy(from, to).with_context(|| format!("{} to {}", from.display(), to.display()))?;
    Ok(to.to_owned())
}

/// Returns the name of a file.
pub(super) fn name(path: &Path) -> Result<String> {
    let name = path.file_name().with_context(|| format!("{} has no name", path.display()))?;
    Ok(name.to_string_lossy().into_owned())
}

/// Returns the time of every file of a release, in seconds since 1970: `SOURCE_DATE_EPOCH`, as
/// builds of the same sources elsewhere take it, otherwise that of the last commit. Sources without
/// commits have no time, which is 0.
///
/// # Errors
/// If `SOURCE_DATE_EPOCH` is no number.
pub(super) fn time_s() -> Result<u64> {
    if let Ok(text) = std::env::var("SOURCE_DATE_EPOCH") {
        return text.parse().with_context(|| format!("SOURCE_DATE_EPOCH must be seconds, not {text:?}"));
    }
    let git = Command::new("git").args(["log", "-1", "--format=%ct"]).current_dir(root()).output();
    let reported = git.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned());
    Ok(reported.ok().and_then(|text| text.parse().ok()).unwrap_or(0))
}

/// Returns bytes, compressed without name and time.
pub(super) fn gz(bytes: &[u8]) -> Result<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes)?;
    Ok(encoder.finish()?)
}

/// Returns a tar archive of files of this time, compressed. Every folder stands before its files.
pub(super) fn tar_gz(entries: &[Entry], time_s: u64) -> Result<Vec<u8>> {
    let mut archive = tar::Builder::new(GzEncoder::new(Vec::new(), Compression::best()));
    let mut folders = std::collections::BTreeSet::new();
    for entry in entries {
        for folder in folders_of(&entry.path) {
            if folders.insert(folder.clone()) {
                let header = header(&folder, 0, 0o755, tar::EntryType::Directory, time_s)?;
                archive.append(&header, std::io::empty())?;
            }
        }
        let mode = if entry.is_program { 0o755 } else { 0o644 };
        let bytes = entry.bytes.len() as u64;
        let header = header(&entry.path, bytes, mode, tar::EntryType::Regular, time_s)?;
        archive.append(&header, &*entry.bytes)?;
    }
    let mut encoder = archive.into_inner()?;
    encoder.flush()?;
    Ok(encoder.finish()?)
}

/// Returns the folders of a path, outermost first, each with a slash at its end.
fn folders_of(path: &str) -> Vec<String> {
    let ends = path.match_indices('/').map(|(index, _)| path.get(..=index).unwrap_or_default());
    ends.map(str::to_owned).collect()
}

/// Returns the header of an entry that belongs to root.
fn header(path: &str, bytes: u64, mode: u32, kind: tar::EntryType, time_s: u64) -> Result<tar::Header> {
    let mut header = tar::Header::new_gnu();
    header.set_path(path)?;
    header.set_size(bytes);
    header.set_mode(mode);
    header.set_mtime(time_s);
    header.set_uid(0);
    header.set_gid(0);
    header.set_username("root")?;
    header.set_groupname("root")?;
    header.set_entry_type(kind);
    header.set_cksum();
    Ok(header)
}
