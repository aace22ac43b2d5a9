//! The file that holds the level of the pin.

use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// Writes a level. The low one also reaches a disk that takes no new file: it is written over the file,
/// or the file is removed.
///
/// # Errors
/// As the system reports them, with the name of the file.
pub(super) fn drive(path: &Path, high: bool) -> io::Result<()> {
    match replace(path, high) {
        // A level that stays low is safe, one that stays high is not.
        Err(error) if !high => overwrite(path).or_else(|_| fs::remove_file(path)).map_err(|_| error),
        replaced => replaced,
    }
    .map_err(|error| io::Error::new(error.kind(), format!("{}: {error}", path.display())))
}

/// Replaces a file as a whole, so that no reader sees half of it.
fn replace(path: &Path, high: bool) -> io::Result<()> {
    let next = next_of(path);
    fs::write(&next, if high { "1\n" } else { "0\n" })?;
    fs::rename(&next, path)
}

/// Returns the name under which a file is written. Another service may keep its pin in the same folder,
/// under a name that begins alike.
pub(super) fn next_of(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".next");
    path.with_file_name(name)
}

/// Overwrites the level in a file with low, which needs no room on the disk.
fn overwrite(path: &Path) -> io::Result<()> {
    fs::OpenOptions::new().write(true).open(path)?.write_all(b"0\n")
}
