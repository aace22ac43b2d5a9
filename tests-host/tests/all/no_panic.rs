//! Completeness of the proof that nothing panics.

use std::path::Path;

use rig::no_panic::coverage;

/// Returns the sources of a crate of this repository.
fn sources(of: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(of).join("src")
}

/// Returns the functions of a documented interface that a list of the proof lacks.
fn missing_from_the_proof(library: &str, list: &str) -> Vec<String> {
    let list = sources("rai-firmware/instruments").join("no_panic").join(list);
    let list = std::fs::read_to_string(list).expect("the list");
    coverage::missing(&sources(library).join("lib.rs"), &list).expect("the sources")
}

#[test]
fn documented_interface_of_the_core_is_in_the_proof() {
    assert_eq!(missing_from_the_proof("rai-core", "core.rs"), Vec::<String>::new());
}

#[test]
fn documented_interface_of_the_module_is_in_the_proof() {
    assert_eq!(missing_from_the_proof("rai-firmware", "receiver/mod.rs"), Vec::<String>::new());
}
