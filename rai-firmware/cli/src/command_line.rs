//! The command line of `rai`: its commands, and their dispatch.

use clap::{CommandFactory as _, Parser, Subcommand};

use crate::{campaign, configure, evaluate, monitor, replay, run};

/// Receiver integrity on a computer: is this GNSS position to be trusted?
#[derive(Parser)]
#[command(name = "rai", version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Makes a receiver send what the module reads, or prints the commands that do.
    Configure(configure::Arguments),
    /// Runs the integrity module on a receiver's bytes until it is stopped.
    Run(Box<run::Arguments>),
    /// Replays a recording through the module.
    Replay(Box<replay::command::Arguments>),
    /// Shows the state of a module on a serial port.
    Monitor(monitor::command::Arguments),
    /// Evaluates linearised epochs: JSON lines in, JSON lines out.
    Evaluate(evaluate::command::Arguments),
    /// Computes availability and integrity over places and times: maps, curves, tables.
    Campaign(Box<campaign::command::Arguments>),
}

/// Runs the command that this process was started with. Wrong arguments end the process.
///
/// # Errors
/// As the command.
pub fn dispatch() -> anyhow::Result<()> {
    match Arguments::parse().command {
        Command::Configure(arguments) => configure::run(&arguments),
        Command::Run(arguments) => run::run(*arguments),
        Command::Replay(arguments) => replay::command::run(&arguments, None),
        Command::Monitor(arguments) => monitor::command::run(&arguments, None),
        Command::Evaluate(arguments) => evaluate::command::run(arguments),
        Command::Campaign(arguments) => campaign::command::run(&arguments),
    }
}

/// Returns the description of the command line, from which its manual is generated.
pub fn description() -> clap::Command {
    Arguments::command()
}
