//! The reference folder that stands beside the project where the project is developed.
//!
//! Recordings, gold tables and vectors live there and not in the repository. A test that needs one asks
//! [`path`] and says aloud that it is skipped where there is none.

use std::path::{Path, PathBuf};

/// The reference folder's entry `relative`, if it is there.
///
/// The folder is named by `RAI_SHARED`, or is `../shared` beside the project's root.
pub fn path(relative: &str) -> Option<PathBuf> {
    let root = std::env::var_os("RAI_SHARED")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared"), PathBuf::from);
    let path = root.join(relative);
    path.exists().then_some(path)
}

/// As [`path`], and says that the calling test is skipped where the entry is missing.
pub fn path_or_skip(relative: &str) -> Option<PathBuf> {
    let found = path(relative);
    if found.is_none() {
        eprintln!("skipped: needs {relative} of the reference folder (set RAI_SHARED to where it is)");
    }
    found
}
