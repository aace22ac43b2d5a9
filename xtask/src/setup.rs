//! `cargo xtask setup`: what the Rust toolchain does not bring.

use anyhow::ensure;
use tests_host::setup::{Machine, Step, consumers, ensure_all, plan};

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Install nothing; say what is missing, and fail if anything is.
    #[arg(long)]
    check: bool,
    /// Also what tests hold the module against: gpsd, RTKLIB, and pynmea2 and pymavlink in a folder of their own.
    #[arg(long, conflicts_with = "check")]
    consumers: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if !arguments.check {
        ensure_all()?;
        if arguments.consumers {
            consumers()?;
        }
        println!("everything is there");
        return Ok(());
    }
    let steps = plan(&Machine::look_for_all());
    for step in &steps {
        match step {
            Step::Run(command) => println!("missing: {}", command.join(" ")),
            Step::Unpack => println!("missing: the emulator (to be unpacked below target)"),
            Step::Ask(words) => println!("missing, for you to do: {words}"),
        }
    }
    ensure!(steps.is_empty(), "{} steps are left (`cargo xtask setup` takes them)", steps.len());
    println!("everything is there");
    Ok(())
}
