//! The command of developers that reproduces papers and shows the evidence. `cargo xtask` builds
//! and calls this program.

mod page;
mod progress;
mod reproduce;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Reproduces the papers' tables and figures beside ours.
    Reproduce(reproduce::Arguments),
}

fn main() -> ExitCode {
    let Arguments { command: Command::Reproduce(arguments) } = raim::exit::arguments();
    raim::exit::code_of(|| reproduce::run(&arguments))
}
