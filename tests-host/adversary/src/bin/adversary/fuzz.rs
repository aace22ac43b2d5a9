//! `cargo xtask fuzz`: hostile input, extended by the code that it reaches.
//!
//! The command works in `target/fuzz`. It reads the committed corpus, and writes it only with
//! `--keep`.

use std::path::{Path, PathBuf};
use std::process::Command;

use adversary::fuzzing::{TARGETS, Target, replay, seeds};
use anyhow::{Context as _, ensure};
use xtask::cargo::root;
use xtask::nightly;

/// Longest input, bytes: an epoch of many satellites with their ephemerides.
const LONGEST: usize = 4096;

/// Command that installs the tool.
const INSTALL: &str = "cargo install cargo-fuzz";

/// Arguments to which the tool answers if it is installed.
const PROBE: [&str; 2] = ["fuzz", "--version"];

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Names of the targets to fuzz (default: all)
    targets: Vec<String>,
    /// Time for each target, s
    #[arg(long, value_name = "S", default_value_t = 600)]
    seconds: u64,
    /// Run every target for seconds, if the tools are there
    #[arg(long, conflicts_with = "keep")]
    smoke: bool,
    /// Minimise the inputs found so far into the committed corpus instead of fuzzing
    #[arg(long)]
    keep: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if arguments.smoke {
        return smoke();
    }
    let targets = chosen(&arguments.targets)?;
    nightly::ensure(&PROBE, INSTALL)?;
    for target in targets {
        if arguments.keep { keep(target)? } else { fuzz(target, arguments.seconds)? }
    }
    Ok(())
}

/// Runs every target briefly, or prints why not, because the other tests suffice on a machine
/// without the tools.
fn smoke() -> anyhow::Result<()> {
    const SECONDS: u64 = 20;
    if let Err(missing) = nightly::ensure(&PROBE, INSTALL) {
        println!("skipped, because {missing}");
        return Ok(());
    }
    TARGETS.iter().try_for_each(|target| fuzz(target, SECONDS / TARGETS.len() as u64))
}

fn chosen(names: &[String]) -> anyhow::Result<Vec<&'static Target>> {
    let all = || TARGETS.iter().map(|target| target.name).collect::<Vec<_>>().join(", ");
    let named = |name: &String| {
        let target = TARGETS.iter().find(|target| target.name == name);
        target.with_context(|| format!("`{name}` is not a target; the targets are {}", all()))
    };
    if names.is_empty() { Ok(TARGETS.iter().collect()) } else { names.iter().map(named).collect() }
}

fn fuzz(target: &Target, seconds: u64) -> anyhow::Result<()> {
    let found = found(target)?;
    std::fs::create_dir_all(replay::folder(target))?;
    let mut command = tool("run", target);
    command.args([&found, &replay::folder(target)]).arg("--");
    command.args([
        format!("-max_total_time={seconds}"),
        format!("-max_len={LONGEST}"),
        "-timeout=10".to_owned(),
    ]);
    spawn(&mut command, target)
}

/// Minimises the inputs found so far together with the corpus, and writes a spread of them as the
/// new corpus.
fn keep(target: &Target) -> anyhow::Result<()> {
    let found = found(target)?;
    for (index, input) in replay::corpus(target).unwrap_or_default().iter().enumerate() {
        std::fs::write(found.join(format!("kept-{index}")), input)?;
    }
    spawn(tool("cmin", target).arg(&found), target)?;
    let reaching = sorted_by_length(&found)?;
    let kept = spread(&reaching, replay::MOST_INPUTS);
    let folder = replay::folder(target);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder)?;
    for (index, input) in kept.iter().enumerate() {
        std::fs::write(folder.join(format!("{index:03}")), input)?;
    }
    println!("{}: {} of {} inputs kept", target.name, kept.len(), reaching.len());
    Ok(())
}

fn sorted_by_length(folder: &Path) -> anyhow::Result<Vec<Vec<u8>>> {
    let inputs = std::fs::read_dir(folder)?.map(|entry| std::fs::read(entry?.path()));
    let mut inputs = inputs.collect::<Result<Vec<_>, _>>()?;
    inputs.sort_by(|a, b| a.len().cmp(&b.len()).then_with(|| a.cmp(b)));
    Ok(inputs)
}

/// Returns at most `most` inputs, from the shortest to the longest, because short ones are refused
/// early and long ones go deep.
fn spread(inputs: &[Vec<u8>], most: usize) -> Vec<&Vec<u8>> {
    let many = inputs.len().min(most);
    (0..many).map(|index| &inputs[index * inputs.len() / many]).collect()
}

/// Returns the folder in which a target's inputs grow, with the seeds in it.
fn found(target: &Target) -> anyhow::Result<PathBuf> {
    let folder = root().join("target/fuzz/found").join(target.name);
    std::fs::create_dir_all(&folder)?;
    for (index, seed) in seeds::of(target.name).iter().enumerate() {
        std::fs::write(folder.join(format!("seed-{index}")), seed)?;
    }
    Ok(folder)
}

/// Returns the command of cargo-fuzz without a sanitizer: it would find nothing in safe Rust, and
/// doubles the build time.
fn tool(action: &str, target: &Target) -> Command {
    let mut command =
        nightly::cargo(&["fuzz", action, "--fuzz-dir", "tests-host/fuzz", "--sanitizer", "none"]);
    command.args(["--target-dir", "target/fuzz"]).arg(target.name);
    command
}

fn spawn(command: &mut Command, target: &Target) -> anyhow::Result<()> {
    let status = command.status().context("cargo-fuzz cannot be run")?;
    ensure!(
        status.success(),
        "{}: not finished; a failing input is in tests-host/fuzz/artifacts/{0}",
        target.name
    );
    Ok(())
}
