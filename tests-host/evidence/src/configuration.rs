//! Configuration index: everything that a verdict depends on, with a hash of each part.
//!
//! Two modules whose indices are equal return the same verdicts for the same bytes, because all
//! transcendental functions and all tables are part of them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result};
use raim_firmware::settings::{Configuration, Setting};
use sha2::{Digest as _, Sha256};

/// One part of the configuration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Name of the part.
    pub name: String,
    /// Its version or its hash.
    pub value: String,
    /// Command that prints it.
    pub command: String,
}

/// Files whose contents are part of the configuration, from the top of the project.
const FILES: &[(&str, &str)] = &[
    ("toolchain", "rust-toolchain.toml"),
    ("versions of all libraries", "Cargo.lock"),
    ("thresholds", "rai-core/src/integrity/raim/detection/threshold/table.rs"),
    ("settings", "rai-firmware/src/settings/table.rs"),
    ("interfaces", "INTERFACES.md"),
    ("memory map of the chip", "memory.x"),
    ("budgets of instructions, flash and stack", "tests-host/budgets.txt"),
];

/// Returns all parts. An image is a part of its own if its path is given.
///
/// # Errors
/// If a file of the project cannot be read.
pub fn index(image: Option<&Path>) -> Result<Vec<Part>> {
    let mut parts = vec![
        part("version", env!("CARGO_PKG_VERSION"), "cargo pkgid -p raim-firmware"),
        part("commit", &commit(), "git rev-parse HEAD"),
        part("settings at start, all", &format!("{:08x}", Configuration::at_start().hash()), "PRAIC,CONFIG"),
        part("number of settings", &Setting::ALL.len().to_string(), "PRAIC,CONFIG"),
        part(
            "settings at start that affect a promise",
            &format!("{:08x}", Configuration::at_start().promise_hash()),
            "PRAIC,CONFIG",
        ),
    ];
    for (name, file) in FILES {
        let sum = sum(&top().join(file))?;
        parts.push(part(&format!("{name} ({file})"), &sum, &format!("sha256sum {file}")));
    }
    if let Some(image) = image {
        let name = image.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        parts.push(part(&format!("image ({name})"), &sum(image)?, "cargo image"));
    }
    Ok(parts)
}

fn part(name: &str, value: &str, command: &str) -> Part {
    Part { name: name.to_owned(), value: value.to_owned(), command: command.to_owned() }
}

/// Returns the folder of the project.
pub(crate) fn top() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Returns the SHA-256 of a file, hexadecimal.
fn sum(path: &Path) -> Result<String> {
    let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let digits: Vec<_> = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    Ok(digits.concat())
}

/// Returns the commit, with a mark if files differ from it.
fn commit() -> String {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").arg("-C").arg(top()).args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let Some(commit) = git(&["rev-parse", "HEAD"]) else { return "unknown: not a clone".into() };
    let is_clean = git(&["status", "--porcelain"]).is_some_and(|changes| changes.is_empty());
    if is_clean { commit } else { format!("{commit}, with changes") }
}

#[cfg(test)]
mod tests {
    use super::{index, sum, top};

    #[test]
    fn index_names_every_file() {
        let parts = index(None).expect("an index");
        for (_, file) in super::FILES {
            let part = parts.iter().find(|part| part.name.contains(file)).expect("the file");
            assert_eq!(part.value.len(), 64, "{part:?}");
        }
    }

    #[test]
    fn sum_is_that_of_another_program() {
        let path = top().join("memory.x");
        let Ok(output) = std::process::Command::new("sha256sum").arg(&path).output() else {
            rig::skip::say("the program sha256sum");
            return;
        };
        let want = String::from_utf8_lossy(&output.stdout);
        assert_eq!(sum(&path).expect("a file"), want.split(' ').next().unwrap_or_default());
    }
}
