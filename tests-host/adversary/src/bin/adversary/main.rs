//! The commands of developers that attack the module. `cargo xtask` builds and calls this program.

mod attack;
mod attack_small;
#[cfg(target_os = "linux")]
mod endure;
mod fuzz;
mod soak;

use std::process::ExitCode;

use anyhow::Result;
use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Runs all attacks that try to raise the pin on a wrong position, and prints their results.
    Attack(attack::Arguments),
    /// Runs the emulated board for hours under faults, resets and a bad line.
    Soak(soak::Arguments),
    /// Runs `rai run` for an hour between cuts, kills and dead clients.
    #[cfg(target_os = "linux")]
    Endure(endure::Arguments),
    /// Fuzzes the module, guided by coverage. Needs nightly and cargo-fuzz.
    Fuzz(fuzz::Arguments),
}

fn main() -> ExitCode {
    let Arguments { command } = raim::exit::arguments();
    raim::exit::code_of(|| dispatch(command))
}

fn dispatch(command: Command) -> Result<()> {
    match command {
        Command::Attack(arguments) => attack::run(&arguments),
        Command::Soak(arguments) => soak::run(&arguments),
        #[cfg(target_os = "linux")]
        Command::Endure(arguments) => endure::run(&arguments),
        Command::Fuzz(arguments) => fuzz::run(&arguments),
    }
}
