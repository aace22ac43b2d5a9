//! The proof that nothing panics is complete, and can fail.

use std::path::Path;

use tests_host::no_panic::{self, coverage};

/// The sources of a crate of this repository.
fn sources(of: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(of).join("src")
}

fn missing_from_the_proof(library: &str, list: &str) -> Vec<String> {
    let list = sources("rai-firmware").join("bin/no_panic").join(list);
    let list = std::fs::read_to_string(list).expect("the list");
    coverage::missing(&sources(library).join("lib.rs"), &list).expect("the sources")
}

#[test]
fn every_public_function_of_the_core_is_in_the_proof() {
    assert_eq!(missing_from_the_proof("rai-core", "integrity.rs"), Vec::<String>::new());
}

#[test]
fn every_public_function_of_the_firmware_s_library_is_in_the_proof() {
    assert_eq!(missing_from_the_proof("rai-firmware", "receiver.rs"), Vec::<String>::new());
}

#[test]
fn reachable_panic_is_found_and_named() {
    let error =
        no_panic::prove_library("reachable-panic").expect_err("the panic that was put there").to_string();
    println!("{error}");
    let want = "rai-firmware/src/bin/no_panic/main.rs:";
    assert!(error.starts_with("a panic is reachable from\n") && error.contains(want), "have {error}");
    assert_eq!(error.lines().count(), 2, "one place: have {error}");
}
