//! `cargo xtask bench`: the cost of the module on the chip.

use anyhow::{Context as _, ensure};
use rig::bench::{self, Measurement, Scope, budget};
use rig::board;

/// Arguments of the command.
#[derive(clap::Args)]
#[allow(clippy::struct_excessive_bools, reason = "each is another thing to do")]
pub(crate) struct Arguments {
    /// Fail if a figure exceeds its budget by more than 2 %
    #[arg(long, conflicts_with = "save")]
    check: bool,
    /// As --check, for the instructions of each stage alone: the part that `test` measures
    #[arg(long, conflicts_with_all = ["check", "save", "tested"])]
    stages: bool,
    /// As --check, without the libraries for C that no test links
    #[arg(long, conflicts_with_all = ["check", "save"])]
    tested: bool,
    /// Accept the current figures as budgets
    #[arg(long)]
    save: bool,
    /// Measure epochs per second and instructions on this machine instead; not compared with a
    /// budget
    #[arg(long, conflicts_with_all = ["check", "save"])]
    host: bool,
    /// Profile the first stage whose name contains this text, by function
    #[arg(long, value_name = "STAGE", conflicts_with_all = ["check", "save", "host"])]
    profile: Option<String>,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    match &arguments.profile {
        Some(stage) => profile(stage),
        None if arguments.host => host(),
        None => target(arguments),
    }
}

fn profile(stage: &str) -> anyhow::Result<()> {
    ensure!(board::is_installed(), "the emulator is needed: `cargo xtask setup` installs it");
    let (name, profile) = bench::profile(stage)?;
    println!("{name}\n\n{profile}");
    Ok(())
}

fn host() -> anyhow::Result<()> {
    cargo(&["bench", "--package", "experiments", "--bench", "throughput"])?;
    cargo(&["run", "--release", "--package", "rig", "--example", "judged"])
}

fn cargo(arguments: &[&str]) -> anyhow::Result<()> {
    xtask::cargo::spawn(&mut xtask::cargo::command(arguments))
}

fn target(arguments: &Arguments) -> anyhow::Result<()> {
    if arguments.stages {
        return compare(&measure(Scope::Stages)?);
    }
    if arguments.tested {
        return compare(&measure(Scope::Tested)?);
    }
    let measurement = measure(Scope::All)?;
    if arguments.save {
        let path = budget::path();
        std::fs::write(&path, budget::render(&measurement.figures))
            .with_context(|| path.display().to_string())?;
        println!("wrote {}", path.display());
    }
    if arguments.check { compare(&measurement) } else { Ok(()) }
}

fn measure(scope: Scope) -> anyhow::Result<Measurement> {
    ensure!(board::is_installed(), "the emulator is needed: `cargo xtask setup` installs it");
    let measurement = Measurement::take(scope, |at| eprintln!("measuring {at}"))?;
    println!("{measurement}");
    Ok(measurement)
}

fn compare(measurement: &Measurement) -> anyhow::Result<()> {
    let findings = measurement.check()?;
    ensure!(
        findings.is_empty(),
        "{}\nif the growth is intended, `cargo xtask bench --save` accepts the new figures",
        findings.join("\n")
    );
    Ok(())
}
