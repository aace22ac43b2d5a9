//! The committed corpus and seeded mutations of it, without cargo-fuzz.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};

use super::Target;
use super::mutation::Mutator;

/// How many inputs of a target the repository has room for.
pub const MOST_INPUTS: usize = 150;

/// What the repository has room for in all, bytes.
pub const CORPUS_BYTES: usize = 500_000;

/// Where the corpus of a target is.
pub fn folder(target: &Target) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target.name)
}

/// The corpus of a target, in the order of its names.
///
/// # Errors
/// A folder or file that cannot be read, or an empty folder.
pub fn corpus(target: &Target) -> anyhow::Result<Vec<Vec<u8>>> {
    let folder = folder(target);
    let listing = std::fs::read_dir(&folder).with_context(|| format!("no corpus in {}", folder.display()))?;
    let mut paths = listing.map(|entry| Ok(entry?.path())).collect::<std::io::Result<Vec<_>>>()?;
    paths.sort();
    let inputs = paths.iter().map(std::fs::read).collect::<std::io::Result<Vec<_>>>()?;
    ensure!(!inputs.is_empty(), "no corpus in {}", folder.display());
    Ok(inputs)
}

/// Runs some seeded mutations of a target's corpus; the number of the one that panics is printed on the way out.
///
/// # Errors
/// As [`corpus`].
pub fn mutate(target: &Target, many: usize, seed: u64) -> anyhow::Result<()> {
    let corpus = corpus(target)?;
    let mut mutator = Mutator::new(&corpus, seed);
    (0..many).for_each(|index| run(target, &mutator.input(), index));
    Ok(())
}

fn run(target: &Target, input: &[u8], index: usize) {
    let report = Report { target, input, index };
    (target.run)(input);
    std::mem::forget(report);
}

/// Says on the way out which input it was: dropped only while a panic passes by.
struct Report<'r> {
    target: &'r Target,
    input: &'r [u8],
    index: usize,
}

impl Drop for Report<'_> {
    fn drop(&mut self) {
        eprintln!("{}: mutation {} panics: {:02x?}", self.target.name, self.index, self.input);
    }
}
