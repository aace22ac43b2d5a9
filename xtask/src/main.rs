//! Commands of the project: `cargo xtask help` lists them.
//!
//! Each command parses its arguments, calls `tests-host` or a tool, and prints the result.

mod attack;
mod bench;
mod campaign;
mod cargo;
mod coverage;
mod demo;
mod evaluate;
mod flash;
mod fuzz;
mod header;
mod miri;
mod monitor;
mod mutants;
mod nightly;
mod packages;
mod release;
mod replay;
mod reproduce;
mod setup;
mod sink;
mod soak;
mod tables;
mod test;

use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{Parser, Subcommand};

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
    Replay(Box<replay::Arguments>),
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
    Campaign(Box<campaign::Arguments>),
    /// Evaluates linearised epochs: JSON lines in, JSON lines out.
    Evaluate(evaluate::Arguments),
    /// Runs all attacks that try to raise the pin on a wrong position, and prints their results.
    Attack(attack::Arguments),
    /// Runs the emulated board for hours under faults, resets and a bad line.
    Soak(soak::Arguments),
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
    /// Writes the image to a chip, or checks that it fits.
    Flash(flash::Arguments),
    /// Shows the state of a module on a serial port.
    Monitor(monitor::Arguments),
}

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return refuse(&error),
    };
    if arguments.yes {
        tests_host::setup::assume_yes();
    }
    quiet_where_nobody_reads();
    match std::panic::catch_unwind(|| dispatch(arguments.command)) {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(error)) if is_closed_pipe(&error) => ExitCode::SUCCESS,
        Ok(Err(error)) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
        Err(panic) if says_closed_pipe(panic.as_ref()) => ExitCode::SUCCESS,
        Err(panic) => std::panic::resume_unwind(panic),
    }
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
        Command::Evaluate(arguments) => evaluate::run(arguments),
        Command::Attack(arguments) => attack::run(&arguments),
        Command::Soak(arguments) => soak::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Tables(arguments) => tables::run(&arguments),
        Command::Header(arguments) => header::run(&arguments),
        Command::Archives(arguments) => release::build_archives(&arguments),
        Command::Release(arguments) => release::run(&arguments),
        Command::Flash(arguments) => flash::run(&arguments),
        Command::Monitor(arguments) => monitor::run(&arguments),
    }
}

/// Suppresses the panic message if the reader of our output has closed it, as `head` does.
fn quiet_where_nobody_reads() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !says_closed_pipe(panic.payload()) {
            usual(panic);
        }
    }));
}

/// Returns true for the panic of `println!` on a closed pipe, which is its only way to report one.
fn says_closed_pipe(panic: &(dyn std::any::Any + Send)) -> bool {
    panic
        .downcast_ref::<String>()
        .is_some_and(|words| words.starts_with("failed printing to stdout") && words.contains("Broken pipe"))
}

fn is_closed_pipe(error: &anyhow::Error) -> bool {
    let is_pipe = |error: &std::io::Error| error.kind() == std::io::ErrorKind::BrokenPipe;
    error.chain().any(|cause| cause.downcast_ref().is_some_and(is_pipe))
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
