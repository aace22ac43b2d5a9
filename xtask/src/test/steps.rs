//! The steps of `cargo xtask test`, in the order in which each lane takes them.

use std::collections::BTreeMap;
use std::io::ErrorKind;

use anyhow::{Context as _, Result, ensure};
use rig::bench::Scope;
use rig::image::{self, Chip, NAMED, Named};
use rig::setup;
use rig::skip;

use super::counts::SKIPPED_TESTS;
use crate::cargo::{command, root, spawn};

/// One check.
pub(super) struct Step {
    pub(super) name: &'static str,
    pub(super) lane: Lane,
    when: When,
    /// Runs it with `--bless` and `--all`.
    pub(super) run: fn(bool, bool) -> Result<Done>,
}

/// The runs that include a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum When {
    /// Only the whole.
    Whole,
    /// Only `--quick`: a step of the whole includes it.
    Quick,
    /// Both.
    Both,
}

impl Step {
    /// Returns true if the run includes this step.
    pub(super) fn is_part_of(&self, quick: bool) -> bool {
        self.when == When::Both || (self.when == When::Quick) == quick
    }
}

/// Steps of one lane run one after another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lane {
    /// Builds for this machine.
    Host,
    /// Builds for the chip, and the fuzzing targets.
    Target,
}

/// The end of a step that found nothing wrong.
pub(super) enum Done {
    Passed,
    /// It did not run, for lack of this.
    Skipped(String),
}

const fn step(name: &'static str, lane: Lane, when: When, run: fn(bool, bool) -> Result<Done>) -> Step {
    Step { name, lane, when, run }
}

/// Targets of the operating systems on which `rai` must compile besides Linux.
const SYSTEMS: [&str; 2] = ["x86_64-pc-windows-gnu", "aarch64-apple-darwin"];

/// All of them.
pub(super) const STEPS: &[Step] = &[
    step("format", Lane::Host, When::Both, |_, _| cargo(&["fmt", "--all", "--check"])),
    step("lints", Lane::Host, When::Both, |_, _| {
        cargo(&["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"])
    }),
    step("unit tests", Lane::Host, When::Quick, |_, _| {
        cargo(&["test", "--package=raim-core", "--package=raim-firmware", "--lib"])
    }),
    step("tests", Lane::Host, When::Whole, tests),
    step("examples in the documentation", Lane::Host, When::Whole, |_, _| {
        cargo(&["test", "--workspace", "--doc"])
    }),
    step("documentation", Lane::Host, When::Whole, |_, _| documentation()),
    step("packages", Lane::Host, When::Whole, |_, _| done(crate::packages::verify())),
    step("licences and sources of dependencies", Lane::Host, When::Whole, |_, _| dependencies()),
    step("lints of the image", Lane::Target, When::Whole, |_, _| lints_of_the_image()),
    step("libraries on other processors", Lane::Target, When::Whole, |_, _| libraries()),
    step("other operating systems", Lane::Target, When::Whole, |_, _| other_systems()),
    step("features of the core", Lane::Target, When::Whole, |_, _| features_of_the_core()),
    step("image", Lane::Target, When::Both, |_, _| done(image::build())),
    step("memory of the image", Lane::Target, When::Both, |_, _| sizes(&NAMED[..1])),
    step("memory of the other named images", Lane::Target, When::Whole, |_, _| sizes(&NAMED[1..])),
    step("no panic", Lane::Target, When::Whole, |_, _| done(rig::no_panic::prove())),
    step("costs on the target", Lane::Target, When::Whole, |_, _| done(crate::bench::check(Scope::Tested))),
    step("threshold tables", Lane::Target, When::Whole, |_, _| {
        done(crate::tables::run(&crate::tables::Arguments { check: true, geoid: None }))
    }),
    step("hostile input", Lane::Target, When::Whole, |_, _| done(crate::fuzz::smoke())),
];

fn done<T>(result: Result<T>) -> Result<Done> {
    result.map(|_| Done::Passed)
}

fn cargo(arguments: &[&str]) -> Result<Done> {
    done(spawn(&mut command(arguments)))
}

fn lints_of_the_image() -> Result<Done> {
    let target = format!("--target={}", setup::TARGETS[0]);
    let what = ["--profile=firmware", &target, "--package=raim-firmware", "--features=stm32f405,instruments"];
    cargo(&[&["clippy"], &what[..], &["--", "-D", "warnings"]].concat())
}

fn libraries() -> Result<Done> {
    let mut arguments =
        vec!["check", "--profile=firmware", "--package=raim-core", "--package=raim-firmware", "--lib"];
    arguments.extend(setup::TARGETS.iter().flat_map(|target| ["--target", target]));
    cargo(&arguments)
}

/// Checks that the command `rai` compiles for Windows and macOS, as far as their targets are
/// installed.
fn other_systems() -> Result<Done> {
    let output = std::process::Command::new("rustup").args(["target", "list", "--installed"]).output();
    let installed = output.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
    let installed = installed.unwrap_or_default();
    let (here, missing): (Vec<&str>, Vec<&str>) =
        SYSTEMS.iter().partition(|target| installed.lines().any(|line| line == **target));
    for target in here {
        cargo(&["check", "--package=raim", "--target", target])?;
    }
    if missing.is_empty() {
        return Ok(Done::Passed);
    }
    Ok(Done::Skipped(format!("targets of other systems (rustup target add {})", missing.join(" "))))
}

/// Checks the core without features, with each alone and with all. `cargo test -p xtask --test
/// public_items` compares what they add.
fn features_of_the_core() -> Result<Done> {
    let check = |features: &[&str]| {
        let what = ["clippy", "--quiet", "--package=raim-core", "--lib"];
        spawn(command(&what).args(features).args(["--", "-D", "warnings"]))
    };
    let features = "araim searches tables double-tables policies past hypotheses aiding";
    for feature in std::iter::once("").chain(features.split(' ')) {
        check(&["--no-default-features", "--features", feature])?;
    }
    check(&["--all-features"])?;
    let lacking = ["test", "--quiet", "--package=raim-core", "--lib", "--no-default-features"];
    cargo(&[&lacking[..], &["method_that_this_build_lacks"]].concat())
}

/// Runs all tests, by nextest if it is installed because it is faster, and counts those that cannot
/// run here.
fn tests(bless: bool, all: bool) -> Result<Done> {
    let nextest = command(&["nextest", "--version"]).output().is_ok_and(|output| output.status.success());
    // One more than there are processors, because the tests of a group mostly wait.
    let threads = std::thread::available_parallelism().map_or(2, |count| count.get() + 1).to_string();
    let config = root().join("xtask/nextest.toml");
    let of_nextest = [
        "nextest",
        "run",
        "--workspace",
        "--no-fail-fast",
        "--config-file",
        &config.to_string_lossy(),
        "--test-threads",
        &threads,
    ];
    let of_cargo = ["test", "--workspace", "--all-targets", "--no-fail-fast"];
    let arguments: &[&str] = if nextest { &of_nextest } else { &of_cargo };
    let skips = root().join("target/skipped-tests");
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
        println!("skipped {test}: needs {}", needs.join("; "));
    }
    println!("{SKIPPED_TESTS}{}", skipped.len());
    outcome?;
    ensure!(!all || skipped.is_empty(), "{} tests were skipped", skipped.len());
    Ok(Done::Passed)
}

/// Returns each skipped test with all that it needs.
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

/// Checks what `deny.toml` allows. Known vulnerabilities are not among it: their list has to be
/// fetched, which a test must not need.
fn dependencies() -> Result<Done> {
    let found = command(&["deny", "--version"]).output().is_ok_and(|output| output.status.success());
    if !found {
        return Ok(Done::Skipped("cargo-deny (cargo install cargo-deny)".into()));
    }
    cargo(&["deny", "check", "bans", "licenses", "sources"])
}

/// Every warning counts.
fn documentation() -> Result<Done> {
    let arguments = ["doc", "--quiet", "--workspace", "--no-deps"];
    done(spawn(command(&arguments).env("RUSTDOCFLAGS", "-D warnings")))
}

/// Compares images with their limits and with the chip of the board.
fn sizes(images: &[Named]) -> Result<Done> {
    let chip = Chip::named("STM32F405RGTx")?;
    for named in images {
        let (_, image) = crate::image::build(named)?;
        let findings = image.check(&chip);
        ensure!(findings.is_empty(), "{}: {}", named.name, findings.join("; "));
    }
    Ok(Done::Passed)
}

#[cfg(test)]
mod tests {
    use super::{STEPS, skipped};

    #[test]
    fn test_that_lacks_two_things_is_skipped_once() {
        let have = skipped("sky::a\tx\nsky::a\ty\nsky::a\tx\nboard::b\tx\n");
        assert_eq!(have.len(), 2);
        assert_eq!(have["sky::a"], ["x", "y"]);
    }

    #[test]
    fn steps_have_names_of_their_own() {
        let names: std::collections::BTreeSet<_> = STEPS.iter().map(|step| step.name).collect();
        assert_eq!(names.len(), STEPS.len());
    }
}
