//! Commands of the project: `cargo xtask help` lists them.
//!
//! A command runs here, or builds a package of the workspace and runs its program. Nothing here
//! depends on these packages, so that a command compiles what it needs and nothing else.

mod coverage;
mod journeys;
mod miri;
mod mutants;
mod set_up;
mod test;
mod verb;

use std::ffi::OsString;
use std::process::ExitCode;

use verb::{Outcome, VERBS, Verb};

fn main() -> ExitCode {
    let mut words: Vec<OsString> = std::env::args_os().skip(1).collect();
    let is_yes = |word: &OsString| word == "--yes" || word == "-y";
    if words.iter().any(is_yes) {
        xtask::setup::assume_yes();
        words.retain(|word| !is_yes(word));
    }
    let name = words.first().map(|word| word.to_string_lossy().into_owned()).unwrap_or_default();
    match VERBS.iter().find(|verb| verb.name == name) {
        Some(verb) => end(verb, words.split_off(1)),
        None if ["help", "--help", "-h"].contains(&&*name) => {
            print!("{}", verb::help());
            ExitCode::SUCCESS
        }
        None if name.is_empty() => {
            eprint!("{}", verb::help());
            ExitCode::FAILURE
        }
        None => {
            eprintln!("error: `{name}` is not a command; `{} help` lists them", xtask::cargo::NAME);
            ExitCode::FAILURE
        }
    }
}

/// Runs a command, and returns its exit code.
fn end(verb: &Verb, words: Vec<OsString>) -> ExitCode {
    match verb.run(words) {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        // The program has printed the reason.
        Ok(Outcome::Ended(code)) => ExitCode::from(code),
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
