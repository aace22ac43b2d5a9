//! The commands: name, help, where each runs, and what it needs before anything compiles.

use std::ffi::OsString;
use std::fmt::Write as _;
use std::process::{Child, Stdio};

use anyhow::{Context as _, Result};
use pico_args::Arguments;
use xtask::cargo::{self, NAME};
use xtask::setup::{self, Need};

use Place::{Here, Program};

/// A command.
pub(crate) struct Verb {
    pub(crate) name: &'static str,
    /// Line in the list of commands.
    about: &'static str,
    place: Place,
    /// Parts that the machine must have.
    needs: &'static [Need],
}

/// Place where a command runs.
#[derive(Clone, Copy)]
enum Place {
    /// In this program, which prints these options as help.
    Here { run: fn(&mut Arguments) -> Result<()>, options: &'static str },
    /// In the program of this name, of this package, which gets the name of the command.
    Program { package: &'static str, name: &'static str },
}

/// End of a command.
pub(crate) enum Outcome {
    /// It ran here, as it should.
    Done,
    /// Its program ended with this code.
    Ended(u8),
}

const fn verb(name: &'static str, about: &'static str, place: Place, needs: &'static [Need]) -> Verb {
    Verb { name, about, place, needs }
}

/// The parts of the emulated board.
const BOARD: &[Need] = &[Need::Chip, Need::Emulator];

/// The programs.
const RAI: Place = Program { package: "raim", name: "rai" };
const DEMO: Place = Program { package: "emulated", name: "demo" };
const RIG: Place = Program { package: "rig", name: "rig" };
const ORACLE: Place = Program { package: "oracle", name: "oracle" };
const ADVERSARY: Place = Program { package: "adversary", name: "adversary" };
const EVIDENCE: Place = Program { package: "evidence", name: "evidence" };
const RELEASE: Place = Program { package: "release", name: "release" };

/// All commands.
pub(crate) const VERBS: &[Verb] = &[
    verb(
        "demo",
        "Shows the module at work: a simulated sky, a drifting satellite, the emulated board",
        DEMO,
        BOARD,
    ),
    verb(
        "test",
        "Tests host, image and board: behaviour, no panic, costs",
        Here { run: crate::test::test, options: crate::test::OPTIONS },
        BOARD,
    ),
    verb(
        "check",
        "Checks the rest: format, lints, documentation, packages, long tests, other processors",
        Here { run: crate::test::check, options: crate::test::OPTIONS },
        &[Need::Chip, Need::Emulator, Need::Components, Need::Processors, Need::Page],
    ),
    verb(
        "setup",
        "Installs missing requirements, or prints the command that does",
        Here { run: crate::set_up::run, options: crate::set_up::OPTIONS },
        &[],
    ),
    verb("replay", "Replays a recording through the module, on the host or on the emulated board", RIG, &[]),
    verb("monitor", "Shows the state of a module on a serial port", RIG, &[]),
    verb(
        "campaign",
        "Computes availability and integrity over places and times: maps, curves, tables",
        RAI,
        &[],
    ),
    verb("evaluate", "Evaluates linearised epochs: JSON lines in, JSON lines out", RAI, &[]),
    verb(
        "attack",
        "Runs all attacks that try to raise the pin on a wrong position, and prints their results",
        ADVERSARY,
        &[],
    ),
    verb("soak", "Runs the emulated board for hours under faults, resets and a bad line", ADVERSARY, BOARD),
    verb("endure", "Runs `rai run` for an hour between cuts, kills and dead clients", ADVERSARY, &[]),
    verb("fuzz", "Fuzzes the module, guided by coverage. Needs nightly and cargo-fuzz", ADVERSARY, &[]),
    verb("reproduce", "Reproduces the papers' tables and figures beside ours", EVIDENCE, &[]),
    verb("bench", "Measures the cost of the module on the chip: instructions, flash, RAM, stack", RIG, BOARD),
    verb("image", "Builds named images, and compares their memory with their limits", RIG, &[Need::Chip]),
    verb("flash", "Writes an image to a chip, or checks that it fits", RIG, &[Need::Chip]),
    verb("header", "Generates the header of the C interface", RELEASE, &[]),
    verb(
        "archives",
        "Builds the library for C for every processor: Cortex-M0+, M4F, M7, M33 and RV32",
        RELEASE,
        &[Need::Chip, Need::Processors],
    ),
    verb(
        "release",
        "Builds and checks every artefact of a release, with checksums and a bill of materials",
        RELEASE,
        &[Need::Chip, Need::Emulator, Need::Processors],
    ),
    verb("tables", "Regenerates the threshold tables", ORACLE, &[]),
    verb(
        "journeys",
        "Types what README says to five people, each in a fresh clone and an empty home",
        Here { run: crate::journeys::run, options: crate::journeys::OPTIONS },
        &[],
    ),
    verb(
        "miri",
        "Runs the library tests under Miri. Needs nightly and miri",
        Here { run: crate::miri::run, options: "" },
        &[],
    ),
    verb(
        "coverage",
        "Measures the line coverage of the core's tests. Needs cargo-llvm-cov",
        Here { run: crate::coverage::run, options: crate::coverage::OPTIONS },
        &[],
    ),
    verb(
        "mutants",
        "Mutation-tests the core. Needs cargo-mutants, and hours",
        Here { run: crate::mutants::run, options: crate::mutants::OPTIONS },
        &[],
    ),
];

/// Returns the list of commands.
pub(crate) fn help() -> String {
    let mut text = format!("Usage: {NAME} COMMAND [OPTIONS]\n\nCommands:\n");
    for Verb { name, about, .. } in VERBS {
        let _ = writeln!(text, "  {name:10} {about}");
    }
    text + "\nOptions:\n  -y, --yes   Answer every question of the set-up with yes\n  -h, --help  Print help, after \
            the name of a command too\n"
}

impl Verb {
    /// Runs the command with its arguments.
    pub(crate) fn run(&self, words: Vec<OsString>) -> Result<Outcome> {
        let is_help = words.iter().any(|word| word == "--help" || word == "-h");
        if !is_help {
            setup::ensure(self.needs)?;
        }
        match self.place {
            Here { options, .. } if is_help => {
                print!("{}.\n\nUsage: {NAME} {} [OPTIONS]\n{options}", self.about, self.name);
                Ok(Outcome::Done)
            }
            Here { run, .. } => {
                run(&mut Arguments::from_vec(words))?;
                Ok(Outcome::Done)
            }
            Program { package, name } => {
                let mut all = vec![OsString::from(self.name)];
                all.extend(words);
                self.hand_over(package, name, all)
            }
        }
    }

    /// Builds and runs the program of a package.
    fn hand_over(&self, package: &str, name: &str, words: Vec<OsString>) -> Result<Outcome> {
        let mut image = self.image_beside();
        let features = if self.writes_a_chip(&words) { "probe" } else { "" };
        let status = cargo::program(package, name, features).args(words).status();
        if let Some(build) = &mut image {
            // The program has built the image too, and printed what is wrong with it.
            let _ = build.wait();
        }
        let code = status.context("cargo cannot be run")?.code();
        Ok(Outcome::Ended(code.and_then(|code| u8::try_from(code).ok()).unwrap_or(1)))
    }

    /// Begins to build the image beside the program that will ask for it: the link of the image
    /// keeps one core busy.
    fn image_beside(&self) -> Option<Child> {
        let is_asked = self.needs.contains(&Need::Chip) && self.needs.contains(&Need::Emulator);
        let mut build = cargo::command(&["image", "--quiet"]);
        is_asked.then(|| build.stdout(Stdio::null()).stderr(Stdio::null()).spawn().ok()).flatten()
    }

    /// Returns true if the program needs probe-rs, which takes minutes to compile.
    fn writes_a_chip(&self, words: &[OsString]) -> bool {
        self.name == "flash" && !words.iter().any(|word| word == "--dry-run" || word == "--help")
    }
}
