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
}

fn main() -> ExitCode {
    let Arguments { command } = Arguments::parse();
    let result = match command {
        Command::Configure(arguments) => raim::configure::run(&arguments),
        Command::Run(arguments) => raim::run::run(*arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
