//! `cargo xtask journeys`: types what README tells five people to type, and writes what they see
//! below `target/journeys`.
//!
//! Each person starts with a clone of the last commit, an empty home, and no folder beside the
//! clone. The compiler's toolchain is the one of this machine, because rustup brings it. A journey
//! ends at the first line that fails or does not print what it must.

mod people;
mod terminal;
mod transcript;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use anyhow::{Context as _, Result, ensure};
use pico_args::Arguments;
use xtask::cargo::{program, root};

use people::{PEOPLE, Person};
use terminal::{Terminal, Typed};

/// File name of the capture.
const CAPTURE: &str = "capture.rtcm3";

/// Options of the command.
pub(crate) const OPTIONS: &str = "
  NAME…  People to follow (default: all)
";

/// Runs the command.
pub(crate) fn run(arguments: &mut Arguments) -> Result<()> {
    let mut asked = Vec::new();
    while let Some(name) = arguments.opt_free_from_str::<String>()? {
        asked.push(name);
    }
    let names = PEOPLE.map(|person| person.name);
    let unknown = asked.iter().find(|name| !names.contains(&name.as_str()));
    ensure!(
        unknown.is_none(),
        "unknown person: {}; known are {}",
        unknown.map_or("", |n| n),
        names.join(", ")
    );
    let is_asked = |person: &&Person| asked.is_empty() || asked.iter().any(|name| name == person.name);
    let folder = root().join("target/journeys");
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let capture = folder.join(CAPTURE);
    receive(&capture)?;
    let mut failures = Vec::new();
    for person in PEOPLE.iter().filter(is_asked) {
        eprintln!("{}: {}", person.title, person.aim);
        let typed = follow(person, &capture)?;
        let path = folder.join(format!("{}.txt", person.name));
        fs::write(&path, transcript::whole(&typed)).with_context(|| path.display().to_string())?;
        eprintln!("{}: the transcript is {}", person.name, path.display());
        failures.extend(typed.iter().filter_map(|line| line.failure.clone()));
    }
    ensure!(failures.is_empty(), "{}", failures.join("; "));
    Ok(())
}

/// Writes the capture of those who have one: the messages of the sample, as a receiver sends them.
fn receive(capture: &Path) -> Result<()> {
    let mut replay = program("rig", "rig", "");
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
