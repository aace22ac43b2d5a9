//! `cargo xtask journeys`: types what README tells five people to type, and writes down what they
//! see.
//!
//! Each person starts with a clone of the last commit, an empty home, and no folder beside the
//! clone. The compiler's toolchain is the one of this machine, because rustup brings it. A journey
//! ends at the first line that fails or does not print what it must.

mod people;
mod terminal;
mod transcript;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context as _, Result, ensure};

use crate::cargo::root;
use people::{PEOPLE, Person};
use terminal::{Terminal, Typed};

/// File name of the capture.
const CAPTURE: &str = "capture.rtcm3";

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// People to follow (default: all)
    people: Vec<String>,
    /// Also write a short form of each journey into results/journeys
    #[arg(long)]
    record: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let names = PEOPLE.map(|person| person.name);
    let unknown = arguments.people.iter().find(|name| !names.contains(&name.as_str()));
    ensure!(
        unknown.is_none(),
        "unknown person: {}; known are {}",
        unknown.map_or("", |n| n),
        names.join(", ")
    );
    let is_asked = |person: &&Person| {
        arguments.people.is_empty() || arguments.people.iter().any(|name| name == person.name)
    };
    let folder = root().join("target/journeys");
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let capture = folder.join(CAPTURE);
    receive(&capture)?;
    let mut failures = Vec::new();
    for person in PEOPLE.iter().filter(is_asked) {
        let typed = follow(person, &capture)?;
        let path = folder.join(format!("{}.txt", person.name));
        fs::write(&path, transcript::whole(&typed)).with_context(|| path.display().to_string())?;
        eprintln!("{}: the transcript is {}", person.name, path.display());
        failures.extend(typed.iter().filter_map(|line| line.failure.clone()));
        if arguments.record {
            let path = root().join(format!("results/journeys/{}.md", person.name));
            fs::write(&path, transcript::page(person, &typed)).with_context(|| path.display().to_string())?;
        }
    }
    ensure!(failures.is_empty(), "{}", failures.join("; "));
    Ok(())
}

/// Writes the capture of those who have one: the messages of the sample, as a receiver sends them.
fn receive(capture: &Path) -> Result<()> {
    let mut replay = Command::new(std::env::current_exe()?);
    replay.args(["replay", "--sample", "--rtcm"]).arg(capture).stdout(Stdio::null());
    ensure!(replay.status()?.success(), "the sample cannot be replayed");
    Ok(())
}

/// Types the lines of a person up to the first that fails. The home then stays for a look.
fn follow(person: &Person, capture: &Path) -> Result<Vec<Typed>> {
    let home: PathBuf =
        std::env::temp_dir().join(format!("rai-journey-{}-{}", person.name, std::process::id()));
    let terminal = Terminal::open(&home)?;
    if person.has_capture {
        fs::copy(capture, terminal.clone_folder().join(CAPTURE))?;
    }
    let mut typed = Vec::new();
    for line in person.lines {
        eprintln!("{}: {}", person.name, line.typed);
        let outcome = terminal.enter(line)?;
        eprintln!("{}: {}", person.name, outcome.summary());
        let is_end = outcome.failure.is_some();
        typed.push(outcome);
        if is_end {
            eprintln!("{}: home and clone are left in {}", person.name, home.display());
            return Ok(typed);
        }
    }
    terminal.close()?;
    Ok(typed)
}
