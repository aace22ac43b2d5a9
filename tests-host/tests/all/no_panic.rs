//! Completeness of the proof that nothing panics, and proof that it can fail.

use std::collections::BTreeSet;
use std::path::Path;

use rig::capi;
use rig::image::CompiledFor;
use rig::no_panic::static_library::{HANDLER, StaticLibrary};
use rig::no_panic::{self, coverage};

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

#[test]
fn reachable_panic_is_found_and_named() {
    for compiled_for in CompiledFor::ALL {
        let proof = no_panic::prove_library(no_panic::ONE_PANIC, compiled_for);
        let error = proof.expect_err("the panic that was put there").to_string();
        println!("{error}");
        let want = "rai-firmware/src/bin/reachable_panic.rs:";
        assert!(error.starts_with("a panic is reachable from\n") && error.contains(want), "have {error}");
        assert_eq!(error.lines().count(), 2, "one place: have {error}");
    }
}

#[test]
fn every_function_of_the_header_is_in_the_proof_of_the_library_for_c() {
    let library = StaticLibrary::build().expect("the library");
    let header = std::fs::read_to_string(capi::header_path()).expect("the header is committed");
    let declared: BTreeSet<String> = header.lines().filter_map(function_declared).collect();
    assert_eq!(*library.exports(), declared);
    assert_eq!(library.offences(&[]).expect("the library links"), []);
    let error = library.offences(&[HANDLER]).expect_err("where a panic would end is called");
    println!("{error:#}");
}

/// Returns the name of the function that a line of the header declares.
fn function_declared(line: &str) -> Option<String> {
    let is_code = line.starts_with(|first: char| first.is_ascii_lowercase()) && !line.starts_with("typedef");
    let (declared, _) = line.split_once('(').filter(|_| is_code)?;
    declared.rsplit([' ', '*']).next().map(str::to_owned)
}
