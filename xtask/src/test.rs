//! `cargo xtask test`: all checks of the project.
//!
//! Each step runs even if earlier ones fail, so that one run shows every failure. The steps form
//! two lanes with separate build folders, because linking a whole image occupies one core and
//! leaves the other to the host.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::time::Instant;

use anyhow::{Context as _, ensure};
use tests_host::image::{self, Chip, Image};
use tests_host::{setup, skip};

use crate::cargo::{command, spawn, step as cargo};

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Accept the current results of the snapshot tests
    #[arg(long)]
    bless: bool,
    /// Fail if a test is skipped because a recording or a program is missing
    #[arg(long)]
    all: bool,
}

type Step = (&'static str, Box<dyn Fn() -> anyhow::Result<()> + Send>);

/// Name of a step, its failure if any, and its duration, s.
type Outcome = (&'static str, Option<anyhow::Error>, f64);

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    setup::ensure()?;
    let (on_host, on_target) = (on_host(arguments.bless, arguments.all), on_target());
    let outcomes: Vec<Outcome> = std::thread::scope(|scope| {
        let target = scope.spawn(|| walk(on_target));
        let host = walk(on_host);
        let target = target.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        host.into_iter().chain(target).collect()
    });
    summarise(&outcomes)
}

/// Takes the steps in order.
fn walk(steps: Vec<Step>) -> Vec<Outcome> {
    let take = |(name, step): Step| {
        let start = Instant::now();
        let failure = step().err();
        if let Some(failure) = &failure {
            eprintln!("{name}: {failure:#}");
        }
        (name, failure, start.elapsed().as_secs_f64())
    };
    steps.into_iter().map(take).collect()
}

fn summarise(outcomes: &[Outcome]) -> anyhow::Result<()> {
    println!();
    for (name, failure, seconds) in outcomes {
        let word = if failure.is_some() { "FAILED" } else { "passed" };
        println!("{word} {name} ({seconds:.1} s)");
    }
    let failed = outcomes.iter().filter(|(_, failure, _)| failure.is_some()).count();
    println!("{} passed, {failed} failed", outcomes.len() - failed);
    ensure!(failed == 0, "{failed} of {} steps failed", outcomes.len());
    Ok(())
}

const FIRMWARE: [&str; 7] = [
    "--profile=firmware",
    "--target=thumbv7em-none-eabihf",
    "--package=rai-firmware",
    "--features=probe",
    "--",
    "-D",
    "warnings",
];

fn on_host(bless: bool, all: bool) -> Vec<Step> {
    vec![
        ("format", cargo(&["fmt", "--all", "--check"])),
        ("lints, host", cargo(&["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"])),
        ("tests", Box::new(move || tests(bless, all))),
        ("documentation's examples", cargo(&["test", "--workspace", "--doc"])),
        ("documentation", Box::new(documentation)),
        ("packages", Box::new(crate::packages::verify)),
        ("licences and advisories of what others wrote", Box::new(dependencies)),
    ]
}

/// Returns the steps for the target, and the fuzzing targets, which build beside both.
fn on_target() -> Vec<Step> {
    let mut clippy_target = vec!["clippy"];
    clippy_target.extend(FIRMWARE);
    let mut libraries =
        vec!["check", "--profile=firmware", "--package=rai-core", "--package=rai-firmware", "--lib"];
    libraries.extend(setup::TARGETS.iter().flat_map(|target| ["--target", target]));
    vec![
        ("lints, target", cargo(&clippy_target)),
        ("libraries on other processors", cargo(&libraries)),
        ("image", Box::new(|| image::build().map(drop))),
        ("memory of the image", Box::new(sizes)),
        ("no panic", Box::new(tests_host::no_panic::prove)),
        ("costs on the target", Box::new(costs)),
        ("threshold tables", Box::new(tables)),
        ("hostile input", Box::new(crate::fuzz::smoke)),
    ]
}

/// Runs the tests with the faster runner if it is installed, and counts those that cannot run here.
fn tests(bless: bool, all: bool) -> anyhow::Result<()> {
    let nextest = command(&["nextest", "--version"]).output().is_ok_and(|output| output.status.success());
    let arguments: &[&str] = if nextest {
        &["nextest", "run", "--workspace", "--no-fail-fast"]
    } else {
        &["test", "--workspace", "--all-targets", "--no-fail-fast"]
    };
    let skips = crate::cargo::root().join("target/skipped-tests");
    match std::fs::remove_file(&skips) {
        Err(error) if error.kind() != ErrorKind::NotFound => {
            return Err(error).with_context(|| skips.display().to_string());
        }
        _ => {}
    }
    let update = if bless { "always" } else { "no" };
    let outcome = spawn(command(arguments).env("INSTA_UPDATE", update).env(skip::VARIABLE, &skips));
    let lines = std::fs::read_to_string(&skips).unwrap_or_default();
    let skipped = skipped(&lines);
    for (test, needs) in &skipped {
        eprintln!("skipped {test}: needs {}", needs.join("; "));
    }
    println!("{} tests skipped", skipped.len());
    outcome?;
    ensure!(!all || skipped.is_empty(), "{} tests were skipped", skipped.len());
    Ok(())
}

/// Returns each skipped test with all its missing requirements.
fn skipped(lines: &str) -> BTreeMap<&str, Vec<&str>> {
    let mut tests = BTreeMap::<&str, Vec<&str>>::new();
    for (test, needs) in lines.lines().filter_map(|line| line.split_once('\t')) {
        let all = tests.entry(test).or_default();
        if !all.contains(&needs) {
            all.push(needs);
        }
    }
    tests
}

/// Checks dependencies against `deny.toml`, if cargo-deny is installed.
fn dependencies() -> anyhow::Result<()> {
    let found = command(&["deny", "--version"]).output().is_ok_and(|output| output.status.success());
    if !found {
        println!("skipped: needs cargo-deny (cargo install cargo-deny)");
        return Ok(());
    }
    spawn(&mut command(&["deny", "check", "bans", "licenses", "sources"]))
}

/// Builds the documentation; every warning is an error.
fn documentation() -> anyhow::Result<()> {
    spawn(command(&["doc", "--quiet", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings"))
}

fn sizes() -> anyhow::Result<()> {
    let image = Image::open(&image::build()?)?;
    println!("{image}");
    let findings = image.check(&Chip::named("STM32F405RGTx")?);
    ensure!(findings.is_empty(), "{}", findings.join("; "));
    Ok(())
}

fn costs() -> anyhow::Result<()> {
    crate::bench::run(&crate::bench::Arguments { check: true, ..Default::default() })
}

fn tables() -> anyhow::Result<()> {
    crate::tables::run(&crate::tables::Arguments { check: true })
}

#[cfg(test)]
mod tests {
    use super::skipped;

    #[test]
    fn a_test_that_lacks_two_things_is_skipped_once() {
        let have = skipped("sky::a\tx\nsky::a\ty\nsky::a\tx\nboard::b\tx\n");
        assert_eq!(have.len(), 2);
        assert_eq!(have["sky::a"], ["x", "y"]);
    }
}
