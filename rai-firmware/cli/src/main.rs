//! The command `rai`.

use std::process::ExitCode;

use clap::{Parser, Subcommand};

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
    Configure(raim::configure::Arguments),
    /// Runs the integrity module on a receiver's bytes until it is stopped.
    Run(Box<raim::run::Arguments>),
    /// Replays a recording through the module.
    Replay(Box<raim::replay::command::Arguments>),
    /// Shows the state of a module on a serial port.
    Monitor(raim::monitor::command::Arguments),
    /// Evaluates linearised epochs: JSON lines in, JSON lines out.
    Evaluate(raim::evaluate::command::Arguments),
    /// Computes availability and integrity over places and times: maps, curves, tables.
    Campaign(Box<raim::campaign::command::Arguments>),
}

fn main() -> ExitCode {
    let Arguments { command } = Arguments::parse();
    raim::exit::code_of(|| match command {
        Command::Configure(arguments) => raim::configure::run(&arguments),
        Command::Run(arguments) => raim::run::run(*arguments),
        Command::Replay(arguments) => raim::replay::command::run(&arguments, None),
        Command::Monitor(arguments) => raim::monitor::command::run(&arguments, None),
        Command::Evaluate(arguments) => raim::evaluate::command::run(arguments),
        Command::Campaign(arguments) => raim::campaign::command::run(&arguments),
    })
}
