//! The command of developers that generates tables. `cargo xtask` builds and calls this program.

mod tables;

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
    /// Regenerates the threshold tables.
    Tables(tables::Arguments),
}

fn main() -> ExitCode {
    let Arguments { command: Command::Tables(arguments) } = raim::exit::arguments();
    raim::exit::code_of(|| tables::run(&arguments))
}
