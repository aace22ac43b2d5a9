//! Facts that a release depends on: versions that agree, and a forge that tests what a person
//! tests.

use std::fs;
use std::path::Path;

fn text(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Returns the value of a key in a file of settings.
fn value(text: &str, key: &str) -> String {
    let line = text.lines().find_map(|line| line.strip_prefix(&format!("{key} = ")));
    line.unwrap_or_else(|| panic!("no {key}")).trim_matches('"').to_owned()
}

#[test]
fn least_version_of_rust_is_the_one_that_every_test_runs_with() {
    let least = value(&text("Cargo.toml"), "rust-version");
    let pinned = value(&text("rust-toolchain.toml"), "channel");
    assert_eq!(pinned.rsplit_once('.').map(|(version, _)| version), Some(&*least), "pinned is {pinned}");
}

#[test]
fn forge_runs_the_tests_that_the_readme_names() {
    for part in ["test", "check"] {
        let command = &format!("cargo xtask {part}");
        assert!(text(".github/workflows/ci.yml").contains(&format!("- run: .ci/run {part}\n")), "{part}");
        assert!(text(".ci/run").lines().any(|line| line.trim() == command), "{command}");
        assert!(text("README.md").contains(&format!("{command} ")), "{command}");
    }
}

#[test]
fn forge_checks_the_systems_and_processors_that_a_person_rarely_has() {
    let forge = text(".github/workflows/ci.yml");
    for part in ["windows-latest", "macos-latest", "lintian qemu-user", "--only rai --all"] {
        assert!(forge.contains(part), "{part}");
    }
}

#[test]
fn every_manifest_has_the_version_of_the_workspace() {
    let version = value(&text("Cargo.toml"), "version");
    let header = text("rai-firmware/capi/include/rai.h");
    assert!(header.contains(&format!("#define RAI_VERSION \"{version}\"")));
    assert_eq!(value(&text("rai-firmware/python/pyproject.toml"), "version"), version);
    let platformio = text("rai-firmware/capi/library.json");
    assert!(platformio.contains(&format!("\"version\": \"{version}\"")));
}
