//! Reference values that come with the project: what they are stands in `vectors/README.md`.

use std::path::{Path, PathBuf};

/// Where the reference file or folder `name` lies.
pub fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("vectors").join(name)
}
