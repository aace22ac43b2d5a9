//! Two minutes of what `cargo xtask endure` does for an hour.

use std::ffi::OsString;

use adversary::endurance::{self, Program};
use raim::run::{Arguments, run};

/// Variable with the arguments of the service, one on each line, in the process of
/// [`service_of_its_own`].
const ARGUMENTS: &str = "RAI_ARGUMENTS";

/// The command line of the program.
#[derive(clap::Parser)]
struct Line {
    #[command(flatten)]
    arguments: Arguments,
}

/// Becomes the service in a process that
/// [`two_minutes_of_cuts_kills_and_dead_clients_lose_nothing`] starts. It saves the tests a second
/// build of the program.
#[test]
fn service_of_its_own() {
    let Ok(arguments) = std::env::var(ARGUMENTS) else { return };
    let line = ["rai"].into_iter().chain(arguments.lines());
    let Line { arguments } = clap::Parser::parse_from(line);
    run(arguments).unwrap();
}

#[test]
fn two_minutes_of_cuts_kills_and_dead_clients_lose_nothing() {
    let words = ["service::endurance::service_of_its_own", "--exact", "--nocapture"].map(OsString::from);
    let own = std::env::current_exe().unwrap().into_os_string();
    let program = Program {
        command: [own].into_iter().chain(words).collect(),
        variables: vec![("RUST_TEST_THREADS".into(), "1".into())],
    };
    let folder = tempfile::tempdir().unwrap();
    let mut outcome = endurance::run(&program, 120, folder.path(), |_| ()).unwrap();
    println!("{outcome}");
    // The load is that of a program that was not compiled for speed; the command measures the
    // other.
    outcome.load = 0.0;
    assert_eq!(outcome.broken(), [""; 0]);
}
