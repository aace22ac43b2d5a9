//! Reference values of the project; `vectors/README.md` describes them.

use std::path::{Path, PathBuf};

/// Returns the path of the reference file or folder `name`.
pub fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../vectors").join(name)
}
