//! `cargo xtask setup`: installs the requirements beyond the Rust toolchain.

use anyhow::{Result, ensure};
use pico_args::Arguments;
use xtask::cargo::{program, spawn};
use xtask::setup::{Machine, Need, Step, consumers, plan};

/// Options of the command.
pub(crate) const OPTIONS: &str = "
  --check       Install nothing; print missing requirements, and fail if there are any
  --consumers   Also install the programs that tests compare the module with or build it by: gpsd,
                chrony, socat, RTKLIB, cmake, newlib, and packages of Python in their own folder; and
                those that check a release: lintian, man, qemu-user
  --recordings  Also fetch real recordings that packages carry, with checksums, for tests of the path
                from the bytes to the pin
";

/// All parts.
const ALL: [Need; 6] =
    [Need::Chip, Need::Processors, Need::Page, Need::Components, Need::Emulator, Need::CCompiler];

/// Runs the command.
pub(crate) fn run(arguments: &mut Arguments) -> Result<()> {
    let [is_check, has_consumers, has_recordings] =
        ["--check", "--consumers", "--recordings"].map(|option| arguments.contains(option));
    crate::test::ensure_none_is_left(arguments)?;
    ensure!(!is_check || !(has_consumers || has_recordings), "--check installs nothing");
    if is_check {
        return check();
    }
    xtask::setup::ensure(&ALL)?;
    if has_consumers {
        consumers()?;
    }
    if has_recordings {
        spawn(program("rig", "rig", "").arg("recordings"))?;
    }
    println!("nothing is missing");
    Ok(())
}

/// Prints the missing parts.
fn check() -> Result<()> {
    let steps = plan(&Machine::look(&ALL));
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
