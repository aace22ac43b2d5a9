//! Replay of the committed corpus and seeded mutations of it, without cargo-fuzz.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};

use super::Target;
use super::mutation::Mutator;

/// Largest number of inputs of a target in the repository.
pub const MOST_INPUTS: usize = 150;

/// Largest size of all inputs in the repository, bytes.
pub const CORPUS_BYTES: usize = 500_000;

/// Returns the folder of a target's corpus.
pub fn folder(target: &Target) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus").join(target.name)
}

/// Returns the corpus of a target, in the order of its names.
///
/// # Errors
/// If a folder or file cannot be read, or the folder is empty.
pub fn corpus(target: &Target) -> anyhow::Result<Vec<Vec<u8>>> {
    let folder = folder(target);
    let listing = std::fs::read_dir(&folder).with_context(|| format!("no corpus in {}", folder.display()))?;
    let mut paths = listing.map(|entry| Ok(entry?.path())).collect::<std::io::Result<Vec<_>>>()?;
    paths.sort();
    let inputs = paths.iter().map(std::fs::read).collect::<std::io::Result<Vec<_>>>()?;
    ensure!(!inputs.is_empty(), "no corpus in {}", folder.display());
    Ok(inputs)
}

/// Runs `many` seeded mutations of a target's corpus. If one panics, its number is printed.
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

/// Printer of the input that panics: it is dropped only while a panic unwinds.
struct Report<'r> {
    target: &'r Target,
    input: &'r [u8],
    index: usize,
}

impl Drop for Report<'_> {
    fn drop(&mut self) {
        eprintln!("{}: mutation {} panicked: {:02x?}", self.target.name, self.index, self.input);
    }
}
