//! Two minutes of what `cargo xtask endure` does for an hour, and ten seconds of its other mode.

use std::ffi::OsString;
use std::io::{BufRead as _, BufReader, Write as _};
use std::net::TcpStream;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use adversary::endurance::{self, Program};
use raim::run::clock::Clock;
use raim::run::{Arguments, Plan, run, serve_by};

/// The command line of the program.
#[derive(clap::Parser)]
struct Line {
    #[command(flatten)]
    arguments: Arguments,
}

/// Becomes the service in a process that the other tests start, which saves them a build of the
/// program. Its clock is that of the computer or the one at an address.
#[test]
fn service_of_its_own() {
    let Ok(arguments) = std::env::var("RAI_ARGUMENTS") else { return };
    let line = ["rai"].into_iter().chain(arguments.lines());
    let Line { arguments } = clap::Parser::parse_from(line);
    let Ok(address) = std::env::var("RAI_CLOCK") else {
        // The test program would print its own lines, and wait for a reader that has stopped.
        std::process::exit(run(arguments).inspect_err(|error| eprintln!("error: {error:#}")).is_err().into());
    };
    let (plan, stop, clock) = (Plan::read(arguments).unwrap(), Arc::default(), Clock::led());
    let own = Arc::clone(&clock);
    thread::spawn(move || obey(TcpStream::connect(address).unwrap(), &own));
    serve_by(&plan, &stop, &clock).unwrap();
}

/// Moves the clock as the other side asks.
fn obey(stream: TcpStream, clock: &Clock) {
    stream.set_nodelay(true).unwrap();
    let mut answers = stream.try_clone().unwrap();
    for line in BufReader::new(stream).lines().map_while(Result::ok) {
        match line.split_once(' ').map(|(what, count)| (what, count.parse().unwrap())) {
            Some(("pass", ms)) => clock.advance(Duration::from_millis(ms)),
            Some(("bytes", count)) => clock.await_bytes(count),
            _ => panic!("{line}"),
        }
        answers.write_all(b"ok\n").unwrap();
    }
}

/// Returns this test program as the service.
fn program() -> Program {
    let words = ["endurance::service_of_its_own", "--exact", "--nocapture"].map(OsString::from);
    let own = std::env::current_exe().unwrap().into_os_string();
    Program {
        command: [own].into_iter().chain(words).collect(),
        variables: vec![("RUST_TEST_THREADS".into(), "1".into())],
    }
}

#[test]
fn ten_seconds_of_every_reader_at_once_lose_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut outcome = endurance::readers::run(&program(), 10, folder.path(), |_| ()).unwrap();
    println!("{outcome}");
    // The costs are those of a test program; the command measures the others.
    (outcome.load, outcome.memory_kib) = (0.0, 0);
    assert_eq!(outcome.broken(), [""; 0]);
}

#[test]
fn two_minutes_of_cuts_kills_and_dead_clients_lose_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut outcome = endurance::run(&program(), 120, folder.path(), |_| ()).unwrap();
    println!("{outcome}");
    // The load is that of a program that was not compiled for speed; the command measures the
    // other.
    outcome.load = 0.0;
    assert_eq!(outcome.broken(), [""; 0]);
}
