//! The top level of the repository: the folders and files that its layout prescribes, and no others
//! but what tools and readers look for there.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// The prescribed entries.
const PRESCRIBED: [&str; 8] =
    [".cargo", "Cargo.toml", "README.md", "memory.x", "rai-core", "rai-firmware", "tests-host", "xtask"];

/// Entries that a tool looks for at the top level.
///
/// West takes a project for a module of Zephyr only by `zephyr/module.yml` at its root.
const FOR_TOOLS: [&str; 8] = [
    ".ci",
    ".github",
    ".gitignore",
    "Cargo.lock",
    "deny.toml",
    "rust-toolchain.toml",
    "rustfmt.toml",
    "zephyr",
];

/// Documents that a reader looks for at the top level.
const FOR_READERS: [&str; 12] = [
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "CITATION.cff",
    "CONTRIBUTING.md",
    "DESIGN.md",
    "INTERFACES.md",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "LIMITS.md",
    "RESULTS.md",
    "SECURITY.md",
    "results",
];

/// Returns the entries of the top level that git knows; none without git.
fn entries(root: &Path) -> BTreeSet<String> {
    let git = Command::new("git").arg("-C").arg(root).args(["ls-files"]).output();
    let listed = git.ok().filter(|output| output.status.success());
    let text = listed.map(|output| String::from_utf8_lossy(&output.stdout).into_owned()).unwrap_or_default();
    let first = |line: &str| line.split('/').next().map(str::to_owned);
    text.lines().filter_map(first).filter(|entry| root.join(entry).exists()).collect()
}

#[test]
fn top_level_holds_the_prescribed_entries_and_what_tools_and_readers_need() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for entry in PRESCRIBED {
        assert!(root.join(entry).exists(), "{entry} is missing at the top level");
    }
    let known: BTreeSet<&str> = [&PRESCRIBED[..], &FOR_TOOLS, &FOR_READERS].concat().into_iter().collect();
    let have = entries(&root);
    let unknown: Vec<_> = have.iter().filter(|entry| !known.contains(entry.as_str())).collect();
    assert!(
        unknown.is_empty(),
        "{unknown:?} stand at the top level: move them, or name who needs them there"
    );
}
