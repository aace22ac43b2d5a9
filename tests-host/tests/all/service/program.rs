//! The service in a process of its own.

use std::process::Command;

use raim::run::{Arguments, run};

/// Variable with the arguments, one on each line.
const ARGUMENTS: &str = "RAI_ARGUMENTS";

/// The command line of the program.
#[derive(clap::Parser)]
struct Line {
    #[command(flatten)]
    arguments: Arguments,
}

/// Returns the command that starts the service with these arguments, one on each line. It is this
/// test program, which saves the tests a second build.
pub(super) fn service(arguments: &str) -> Command {
    started_by(Command::new(std::env::current_exe().unwrap()), arguments)
}

/// Works like [`service`], by a command that another program starts.
pub(super) fn started_by(mut launcher: Command, arguments: &str) -> Command {
    launcher.args(["service::program::service_of_its_own", "--exact", "--nocapture"]);
    launcher.env(ARGUMENTS, arguments).env("RUST_TEST_THREADS", "1");
    launcher
}

/// Becomes the service in the process that [`service`] starts.
#[test]
fn service_of_its_own() {
    let Ok(arguments) = std::env::var(ARGUMENTS) else { return };
    let line = ["rai"].into_iter().chain(arguments.lines());
    let Line { arguments } = clap::Parser::parse_from(line);
    // The test program would print its own lines, and wait for a reader that has stopped.
    std::process::exit(run(arguments).inspect_err(|error| eprintln!("error: {error:#}")).is_err().into());
}
