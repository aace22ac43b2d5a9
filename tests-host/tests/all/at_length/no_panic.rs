//! Proof that the proof of no panic can fail, and the proof for the library for C.

use std::collections::BTreeSet;

use rig::capi;
use rig::image::CompiledFor;
use rig::no_panic;
use rig::no_panic::static_library::{HANDLER, StaticLibrary};

#[test]
fn reachable_panic_is_found_and_named() {
    for compiled_for in CompiledFor::ALL {
        let proof = no_panic::prove_library(no_panic::ONE_PANIC, compiled_for);
        let error = proof.expect_err("the panic that was put there").to_string();
        println!("{error}");
        let want = "rai-firmware/instruments/src/reachable_panic.rs:";
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
