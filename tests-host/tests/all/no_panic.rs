//! Completeness of the proof that nothing panics.

use std::path::Path;

use rig::no_panic::coverage;

/// Returns the sources of a crate of this repository.
fn sources(of: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(of).join("src")
}

/// Returns the public functions of a library that a folder of the proof does not list.
fn missing_from_the_proof(library: &str, folder: &str) -> Vec<String> {
    let folder = sources("rai-firmware").join("bin/no_panic").join(folder);
    let lists = std::fs::read_dir(&folder).expect("the lists").map(|entry| entry.expect("a list").path());
    let list: String = lists.map(|path| std::fs::read_to_string(path).expect("the list")).collect();
    // What stands at the root of a library is called by the name of its crate.
    let list = list.replace("raim_single::", "crate::");
    coverage::missing(&sources(library).join("lib.rs"), &list).expect("the sources")
}

#[test]
fn every_public_function_of_the_core_is_in_the_proof() {
    assert_eq!(missing_from_the_proof("rai-core", "integrity"), Vec::<String>::new());
}

#[test]
fn every_public_function_of_the_firmware_s_library_is_in_the_proof() {
    assert_eq!(missing_from_the_proof("rai-firmware", "receiver"), Vec::<String>::new());
}

#[test]
fn every_public_function_of_the_instance_of_the_core_is_in_the_proof() {
    assert_eq!(missing_from_the_proof("rai-firmware/single", "integrity"), Vec::<String>::new());
}
