//! `SHA256SUMS`, in the form that `sha256sum --check` reads.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use sha2::{Digest as _, Sha256};

use super::files;

/// Writes the sums of files in a folder, and returns the path.
///
/// # Errors
/// If a file cannot be read.
pub(super) fn write(out: &Path, paths: &[PathBuf]) -> Result<PathBuf> {
    let mut lines = Vec::new();
    for path in paths {
        let bytes = fs::read(path).with_context(|| path.display().to_string())?;
        lines.push(format!("{}  {}\n", sum(&bytes), files::name(path)?));
    }
    lines.sort_by(|a, b| a.get(66..).cmp(&b.get(66..)));
    let path = out.join("SHA256SUMS");
    fs::write(&path, lines.concat())?;
    Ok(path)
}

fn sum(bytes: &[u8]) -> String {
    let digits: Vec<_> = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    digits.concat()
}

#[cfg(test)]
mod tests {
    #[test]
    fn sum_is_that_of_the_standard_example() {
        // FIPS 180-4, example of one block.
        let want = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(super::sum(b"abc"), want);
    }
}
