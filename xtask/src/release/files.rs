//! Files of a release: copies, and compressed archives whose bytes depend on their contents alone.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use flate2::Compression;
use flate2::write::GzEncoder;

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

/// Returns a tar archive, compressed. Every folder stands before its files.
pub(super) fn tar_gz(entries: &[Entry]) -> Result<Vec<u8>> {
    let mut archive = tar::Builder::new(GzEncoder::new(Vec::new(), Compression::best()));
    let mut folders = std::collections::BTreeSet::new();
    for entry in entries {
        for folder in folders_of(&entry.path) {
            if folders.insert(folder.clone()) {
                archive.append(&header(&folder, 0, 0o755, tar::EntryType::Directory)?, std::io::empty())?;
            }
        }
        let mode = if entry.is_program { 0o755 } else { 0o644 };
        let header = header(&entry.path, entry.bytes.len() as u64, mode, tar::EntryType::Regular)?;
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

/// Returns the header of an entry that belongs to root and has no time.
fn header(path: &str, bytes: u64, mode: u32, kind: tar::EntryType) -> Result<tar::Header> {
    let mut header = tar::Header::new_gnu();
    header.set_path(path)?;
    header.set_size(bytes);
    header.set_mode(mode);
    header.set_mtime(0);
    header.set_uid(0);
    header.set_gid(0);
    header.set_username("root")?;
    header.set_groupname("root")?;
    header.set_entry_type(kind);
    header.set_cksum();
    Ok(header)
}
