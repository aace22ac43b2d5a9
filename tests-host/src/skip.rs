//! Tests that cannot run here say so, and are counted.
//!
//! A skipped test passes, since the test runner knows no third outcome. So that nobody takes it for more, each
//! appends a line to the file that `RAI_SKIPS` names: `cargo xtask test` sets it, counts and prints, and fails on any
//! when all tests are asked for.

use std::fs::OpenOptions;
use std::io::Write as _;

/// Names the file that skipped tests are written to.
pub const VARIABLE: &str = "RAI_SKIPS";

/// Says aloud that the calling test is skipped, and what it needs.
pub fn say(needs: &str) {
    eprintln!("skipped: needs {needs}");
    let Some(path) = std::env::var_os(VARIABLE) else { return };
    let line = format!("{}\t{needs}\n", test());
    // One write of one line: tests of several processes append to the file at a time.
    let written = OpenOptions::new()
        .create(true)
        .append(true)
        .open(path)
        .and_then(|mut file| file.write_all(line.as_bytes()));
    if let Err(error) = written {
        panic!("a skipped test cannot be counted: {error}");
    }
}

/// The program and the test in it. A runner that gives each test a process names it in the arguments, the
/// compiler's own names the thread.
fn test() -> String {
    let mut arguments = std::env::args();
    let program = arguments.next().unwrap_or_default();
    let program = program.rsplit('/').next().unwrap_or("");
    // Behind the last hyphen stands what cargo tells builds apart by.
    let program = program.rsplit_once('-').map_or(program, |(name, _)| name);
    let named = arguments.find(|word| word == "--exact").and_then(|_| arguments.next());
    let thread = std::thread::current();
    let name = named.or_else(|| thread.name().map(str::to_owned)).unwrap_or_default();
    format!("{program}::{name}")
}
