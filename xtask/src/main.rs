//! Commands of the project: `cargo xtask help` lists them.
//!
//! Each command parses its arguments, calls a package or a tool, and prints the result. Commands of
//! `rai` are those of the package `raim`.

mod attack;
mod attack_small;
mod bench;
mod campaign;
mod cargo;
mod coverage;
mod demo;
#[cfg(target_os = "linux")]
mod endure;
mod evidence;
mod flash;
mod fuzz;
mod header;
mod image;
#[cfg(target_os = "linux")]
mod journeys;
mod miri;
mod mutants;
mod nightly;
mod optimise;
mod packages;
mod progress;
mod release;
mod replay;
mod reproduce;
mod setup;
mod soak;
mod tables;
mod test;

use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{Parser, Subcommand};
use raim::exit;

/// RAI: receiver autonomous integrity monitoring for microcontrollers.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    /// Answer every question of the set-up with yes.
    #[arg(long, short, global = true)]
    yes: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Shows the module at work: a simulated sky, a drifting satellite, the emulated board.
    Demo(demo::Arguments),
    /// Runs all checks: format, lints, tests, images, budgets, tables, packages, documentation.
    Test(test::Arguments),
    /// Installs missing requirements, or prints the command that does.
    Setup(setup::Arguments),
    /// Replays a recording through the module, on the host or on the emulated board.
    Replay(Box<raim::replay::command::Arguments>),
    /// Fuzzes the module, guided by coverage. Needs nightly and cargo-fuzz.
    Fuzz(fuzz::Arguments),
    /// Runs the library tests under Miri, which detects undefined behaviour. Needs nightly and
    /// miri.
    Miri,
    /// Measures the line coverage of the core's tests. Needs cargo-llvm-cov.
    Coverage(coverage::Arguments),
    /// Mutation-tests the core. Needs cargo-mutants, and hours.
    Mutants(mutants::Arguments),
    /// Reproduces the papers' tables and figures beside ours.
    Reproduce(reproduce::Arguments),
    /// Computes availability and integrity over places and times: maps, curves, tables.
    Campaign(Box<raim::campaign::command::Arguments>),
    /// Evaluates linearised epochs: JSON lines in, JSON lines out.
    Evaluate(raim::evaluate::command::Arguments),
    /// Runs all attacks that try to raise the pin on a wrong position, and prints their results.
    Attack(attack::Arguments),
    /// Runs the emulated board for hours under faults, resets and a bad line.
    Soak(soak::Arguments),
    /// Runs `rai run` for an hour between cuts, kills and dead clients.
    #[cfg(target_os = "linux")]
    Endure(endure::Arguments),
    /// Types what README says to five people, each in a fresh clone and an empty home.
    #[cfg(target_os = "linux")]
    Journeys(journeys::Arguments),
    /// Measures the cost of the module on the chip: instructions by stage, flash, RAM, stack.
    Bench(bench::Arguments),
    /// Regenerates the threshold tables.
    Tables(tables::Arguments),
    /// Generates the header of the C interface.
    Header(header::Arguments),
    /// Builds the library for C for every processor: Cortex-M0+, M4F, M7, M33 and RV32.
    Archives(release::ArchiveArguments),
    /// Builds and checks every artefact of a release, with checksums and a bill of materials.
    Release(release::Arguments),
    /// Builds named images, and compares their memory with their limits.
    Image(image::Arguments),
    /// Writes an image to a chip, or checks that it fits.
    Flash(flash::Arguments),
    /// Shows the state of a module on a serial port.
    Monitor(raim::monitor::command::Arguments),
}

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return refuse(&error),
    };
    if arguments.yes {
        rig::setup::assume_yes();
    }
    exit::code_of(|| dispatch(arguments.command))
}

fn dispatch(command: Command) -> anyhow::Result<()> {
    match command {
        Command::Demo(arguments) => demo::run(&arguments),
        Command::Test(arguments) => test::run(&arguments),
        Command::Setup(arguments) => setup::run(&arguments),
        Command::Replay(arguments) => replay::run(&arguments),
        Command::Fuzz(arguments) => fuzz::run(&arguments),
        Command::Miri => miri::run(),
        Command::Coverage(arguments) => coverage::run(&arguments),
        Command::Mutants(arguments) => mutants::run(&arguments),
        Command::Reproduce(arguments) => reproduce::run(&arguments),
        Command::Campaign(arguments) => campaign::run(&arguments),
        Command::Evaluate(arguments) => raim::evaluate::command::run(arguments),
        Command::Attack(arguments) => attack::run(&arguments),
        Command::Soak(arguments) => soak::run(&arguments),
        #[cfg(target_os = "linux")]
        Command::Endure(arguments) => endure::run(&arguments),
        #[cfg(target_os = "linux")]
        Command::Journeys(arguments) => journeys::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Tables(arguments) => tables::run(&arguments),
        Command::Header(arguments) => header::run(&arguments),
        Command::Archives(arguments) => release::build_archives(&arguments),
        Command::Release(arguments) => release::run(&arguments),
        Command::Image(arguments) => image::run(&arguments),
        Command::Flash(arguments) => flash::run(&arguments),
        Command::Monitor(arguments) => raim::monitor::command::run(&arguments, Some(&rig::demo::watched)),
    }
}

/// Prints the help if it was requested; otherwise prints one line about the wrong arguments.
fn refuse(error: &clap::Error) -> ExitCode {
    let is_help = error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;
    if is_help || !error.use_stderr() {
        // If standard output is closed, there is nobody left to inform.
        let _ = error.print();
        return if is_help { ExitCode::FAILURE } else { ExitCode::SUCCESS };
    }
    // The error stands before the first blank line; usage and hints follow.
    let text = error.to_string();
    let lines = text.lines().map(str::trim).take_while(|line| !line.is_empty());
    eprintln!("{}", lines.collect::<Vec<_>>().join(" "));
    ExitCode::FAILURE
}
