//! Programs `rai` that need no library of their system, and the proof that they compute what the
//! program of this system computes.
//!
//! The C library is musl, whose objects and linker come with the compiler, so that one machine
//! builds for both processors.

use std::ffi::OsStr;
use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, Result, ensure};
use object::elf::{EM_AARCH64, EM_X86_64};
use raim::replay::{Window, encode};
use raim::signal::encode::{Frequency, Selection};
use raim::signal::sky::raw::Simulation;

use super::{Built, binary, elf};
use xtask::cargo::root;

/// Processor of a program: its name in targets, and its number in ELF.
pub(super) struct Processor {
    name: &'static str,
    machine: u16,
}

/// Epochs of the replay, one a second.
const EPOCHS: u32 = 120;

pub(super) const X86_64: Processor = Processor { name: "x86_64", machine: EM_X86_64 };
pub(super) const AARCH64: Processor = Processor { name: "aarch64", machine: EM_AARCH64 };

/// Builds and checks a static program.
///
/// # Errors
/// If it does not build, is not static, or prints anything else than the program of this system.
pub(super) fn build(processor: &Processor, out: &Path) -> Result<Built> {
    let target = format!("{}-unknown-linux-musl", processor.name);
    if rig::setup::add_target(&target).is_err() {
        return Ok(Built::Missing(format!("needs the target: rustup target add {target}, or --yes")));
    }
    let program = binary::compile(Some(&target))?;
    let bytes = fs::read(&program)?;
    let needs = elf::needs(&bytes).context("the program is no ELF file of 64 bits")?;
    ensure!(needs.machine == processor.machine, "{} is for another processor", program.display());
    ensure!(needs.parts.is_empty(), "{} needs {}", program.display(), needs.parts.join(", "));
    let mut skipped = Vec::new();
    match runner(processor.name) {
        Some(runner) => compare(&runner, &program)?,
        None => skipped.push(format!("its replay by qemu-{} (apt-get install qemu-user)", processor.name)),
    }
    let paths = vec![binary::archive(&program, &format!("{}-linux-static", processor.name), out)?];
    Ok(Built::Files { paths, skipped })
}

/// Returns the command before a program of a processor: empty on the processor itself, otherwise an
/// emulator; `None` without one.
fn runner(processor: &str) -> Option<Vec<String>> {
    if cfg!(target_os = "linux") && processor == std::env::consts::ARCH {
        return Some(Vec::new());
    }
    let is_there = |name: &String| Command::new(name).arg("--version").output().is_ok();
    let names = ["-static", ""].map(|ending| format!("qemu-{processor}{ending}"));
    names.into_iter().find(is_there).map(|name| vec![name])
}

/// Compares the version, the output and the tables of a program with those of the program of this
/// system.
fn compare(runner: &[String], program: &Path) -> Result<()> {
    let own = binary::compile(None)?;
    let folder = root().join("target/release-replay");
    fs::create_dir_all(&folder)?;
    fs::write(folder.join("capture.rtcm3"), simulated()?)?;
    let (have, want) = (Outcome::of(runner, program, &folder)?, Outcome::of(&[], &own, &folder)?);
    let lines = want.satellites.lines().count();
    ensure!(lines > EPOCHS as usize, "the replay has only {lines} rows of satellites");
    ensure!(have == want, "{} prints other bytes than {}", program.display(), own.display());
    Ok(())
}

/// Everything that a program prints about the capture.
#[derive(PartialEq, Eq)]
struct Outcome {
    version: String,
    summary: String,
    epochs: String,
    satellites: String,
}

impl Outcome {
    fn of(runner: &[String], program: &Path, folder: &Path) -> Result<Self> {
        let run = |arguments: &[&str]| {
            let mut command = Command::new(runner.first().map_or(program.as_os_str(), OsStr::new));
            command.args(runner.first().map(|_| program)).args(arguments).current_dir(folder);
            let output = command.output().with_context(|| format!("{command:?}"))?;
            let why = String::from_utf8_lossy(&output.stderr);
            ensure!(output.status.success(), "{command:?}: {}: {why}", output.status);
            Ok(String::from_utf8(output.stdout)?)
        };
        let tables = ["--csv", "epochs.csv", "--satellites", "satellites.csv"];
        Ok(Self {
            version: run(&["--version"])?,
            summary: run(&[&["replay", "capture.rtcm3"], &tables[..]].concat())?,
            epochs: fs::read_to_string(folder.join("epochs.csv"))?,
            satellites: fs::read_to_string(folder.join("satellites.csv"))?,
        })
    }
}

/// Returns two minutes of a simulated receiver, as RTCM 3.
fn simulated() -> Result<Vec<u8>> {
    let recording = Simulation::above_xian(3600.0, EPOCHS, 5).record();
    let selection = Selection::new("GC", Frequency::Dual)?;
    let lumps = encode(&recording, &selection, &[], &Window::ALL)?;
    Ok(lumps.into_iter().flat_map(|lump| lump.bytes).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `true` prints another version than `rai` and writes no tables.
    #[test]
    fn a_program_that_replays_nothing_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        assert!(Outcome::of(&[], Path::new("/bin/true"), folder.path()).is_err());
        assert!(Outcome::of(&[], Path::new("/bin/false"), folder.path()).is_err());
    }

    #[test]
    fn capture_is_that_of_a_receiver() {
        assert!(raim::signal::capture::has_frames(&simulated().unwrap()));
    }
}
