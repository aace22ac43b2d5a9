//! The commands of the page: `rai replay`, and those by which the page asks for what it shows.
//!
//! | command | prints |
//! |---|---|
//! | `rai replay …` | as on a computer |
//! | `page arrange FILE…` | arguments of `rai replay` for these files, and notes, as JSON |
//! | `page settings` | every setting with its text, as JSON |
//! | `page sample` | nothing: it writes the sample |
//! | `page steps RECEIVER WIRE` | commands for the receiver, as JSON |
//! | `page live NAME RATE SETTING…` | the state, as JSON: it starts the live module |

use std::path::Path;

use anyhow::{Result, bail};
use clap::{Parser, Subcommand};
use raim::exit;
use raim::replay::command;

use super::live::Live;
use super::{arrange, sample, settings};

/// Receiver integrity on a computer: is this GNSS position to be trusted?
#[derive(Parser)]
#[command(name = "rai", version)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Replays a recording through the module.
    Replay(Box<command::Arguments>),
}

/// Runs the command of this process; returns the live module if it starts one.
///
/// # Errors
/// As the command.
pub(crate) fn dispatch() -> Result<Option<Live>> {
    let words: Vec<String> = std::env::args().collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["page", "arrange", files @ ..] => println!("{}", arrange::arguments(files)?),
        ["page", "settings"] => println!("{}", settings::all()),
        ["page", "sample"] => std::fs::write(Path::new(sample::NAME), sample::bytes()?)?,
        ["page", "steps", receiver, wire] => println!("{}", settings::steps(receiver, wire)?),
        ["page", "live", name, rate, settings @ ..] => return Live::start(name, rate, settings).map(Some),
        ["page", ..] => bail!("the page has no such command"),
        _ => {
            let CommandLine { command: Command::Replay(arguments) } = exit::arguments();
            command::run(&arguments, None)?;
        }
    }
    Ok(None)
}
