//! `cargo xtask setup`: installs the requirements beyond the Rust toolchain.

use anyhow::ensure;
use rig::recordings;
use rig::setup::{Machine, Step, consumers, ensure_all, plan};

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Install nothing; print missing requirements, and fail if there are any
    #[arg(long)]
    check: bool,
    /// Also install the programs that tests compare the module with or build it by: gpsd, chrony,
    /// socat, RTKLIB, cmake, newlib, and packages of Python in their own folder; and those that
    /// check a release: lintian, man, qemu-user
    #[arg(long, conflicts_with = "check")]
    consumers: bool,
    /// Also fetch real recordings that packages carry, with checksums, for tests of the path from
    /// the bytes to the pin
    #[arg(long, conflicts_with = "check")]
    recordings: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if !arguments.check {
        ensure_all()?;
        if arguments.consumers {
            consumers()?;
        }
        if arguments.recordings {
            recordings::fetch()?;
        }
        println!("nothing is missing");
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
    ensure!(steps.is_empty(), "{} steps are missing (`cargo xtask setup` takes them)", steps.len());
    println!("nothing is missing");
    Ok(())
}
