//! The reference folder that stands beside the project where the project is developed.
//!
//! Recordings live there and not in the repository. A test that needs one asks [`path_or_skip`],
//! and is counted as skipped where there is none.

use std::path::{Path, PathBuf};

use crate::skip;

/// The reference folder's entry `relative`, if it is there.
///
/// The folder is named by `RAI_SHARED`, or is `../shared` beside the project's root.
pub fn path(relative: &str) -> Option<PathBuf> {
    let root = std::env::var_os("RAI_SHARED")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared"), PathBuf::from);
    let path = root.join(relative);
    path.exists().then_some(path)
}

/// As [`path`], and counts the calling test as skipped where the entry is missing.
pub fn path_or_skip(relative: &str) -> Option<PathBuf> {
    let found = path(relative);
    if found.is_none() {
        skip::say(&format!("{relative} of the reference folder (set RAI_SHARED to where it is)"));
    }
    found
}
