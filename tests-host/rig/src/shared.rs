//! Reference folder beside the project, which exists only where the project is developed.
//!
//! Recordings are in that folder and not in the repository. A test that needs one calls
//! [`path_or_skip`], and is counted as skipped without it.

use std::path::{Path, PathBuf};

use crate::skip;

/// Returns the path of the reference folder's entry `relative`, if it exists.
///
/// `RAI_SHARED` names the folder; by default it is `../shared` beside the project's root.
pub fn path(relative: &str) -> Option<PathBuf> {
    let root = std::env::var_os("RAI_SHARED")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"), PathBuf::from);
    let path = root.join(relative);
    path.exists().then_some(path)
}

/// Returns the same as [`path`], and counts the calling test as skipped if the entry is missing.
pub fn path_or_skip(relative: &str) -> Option<PathBuf> {
    let found = path(relative);
    if found.is_none() {
        skip::say(&format!("{relative} of the reference folder (set RAI_SHARED to where it is)"));
    }
    found
}
