//! Reports of tests that cannot run here, so that they are counted.
//!
//! A skipped test passes, because the test runner has no third outcome. To make it visible, each
//! appends a line to the file that `RAI_SKIPS` names. `cargo xtask test` sets the variable, counts
//! and prints the lines, and fails on any if all tests are requested.

use std::fs::OpenOptions;
use std::io::Write as _;

/// Environment variable with the path of the file for skipped tests.
pub const VARIABLE: &str = "RAI_SKIPS";

/// Reports that the calling test is skipped, and its missing requirement.
pub fn say(needs: &str) {
    eprintln!("skipped: needs {needs}");
    let Some(path) = std::env::var_os(VARIABLE) else { return };
    let line = format!("{}\t{needs}\n", test());
    // One write per line, because tests of several processes append to the file at the same time.
    let written = OpenOptions::new()
        .create(true)
        .append(true)
        .open(path)
        .and_then(|mut file| file.write_all(line.as_bytes()));
    if let Err(error) = written {
        panic!("a skipped test cannot be counted: {error}");
    }
}

/// Returns the program and the test in it. A runner with one process per test names it in the
/// arguments; the compiler's own runner names the thread.
fn test() -> String {
    let mut arguments = std::env::args();
    let program = arguments.next().unwrap_or_default();
    let program = program.rsplit('/').next().unwrap_or("");
    // The suffix after the last hyphen is cargo's hash of the build.
    let program = program.rsplit_once('-').map_or(program, |(name, _)| name);
    let named = arguments.find(|word| word == "--exact").and_then(|_| arguments.next());
    let thread = std::thread::current();
    let name = named.or_else(|| thread.name().map(str::to_owned)).unwrap_or_default();
    format!("{program}::{name}")
}
