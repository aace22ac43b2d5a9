//! `cargo xtask endure`: `rai run` for an hour between cuts, kills and dead clients.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use adversary::endurance::{self, Program};
use anyhow::ensure;

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Duration, min, from 1 to 1440
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=1440))]
    minutes: u32,
    /// Send ten epochs a second to every kind of reader at once, without cuts and kills
    #[arg(long)]
    all_readers: bool,
    /// Program to run instead of a fresh optimised build
    #[arg(long, value_name = "RAI")]
    program: Option<PathBuf>,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let program = arguments.program.clone().map_or_else(rig::image::build_rai, Ok)?;
    let program = Program { command: vec![program.into_os_string()], variables: Vec::new() };
    let folder = std::env::temp_dir().join(format!("rai-endure-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    if arguments.all_readers {
        return with_all_readers(&program, 60 * arguments.minutes, &folder);
    }
    let outcome = endurance::run(&program, 60 * arguments.minutes, &folder, |so_far| {
        eprintln!("{} epochs sent, {} kills", so_far.sent, so_far.kills[0]);
    });
    std::fs::remove_dir_all(&folder)?;
    let outcome = outcome?;
    conclude(&outcome, &outcome.broken())
}

fn with_all_readers(program: &Program, seconds: u32, folder: &Path) -> anyhow::Result<()> {
    let outcome = endurance::readers::run(program, seconds, folder, |sent| eprintln!("{sent} epochs sent"));
    std::fs::remove_dir_all(folder)?;
    let outcome = outcome?;
    conclude(&outcome, &outcome.broken())
}

/// Prints an outcome, and fails if it broke a promise.
fn conclude(outcome: &impl Display, broken: &[String]) -> anyhow::Result<()> {
    println!("{outcome}");
    ensure!(broken.is_empty(), "{}", broken.join("; "));
    Ok(())
}
