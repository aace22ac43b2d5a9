//! The steps of `cargo xtask test` and `cargo xtask check`, in the order in which each lane takes
//! them.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::Path;
use std::process::Stdio;

use anyhow::{Context as _, Result, ensure};
use xtask::cargo::{build, command, for_a_person, root, spawn};
use xtask::setup::TARGETS;

use super::counts::SKIPPED_TESTS;

/// One check.
pub(super) struct Step {
    pub(super) name: &'static str,
    pub(super) lane: Lane,
    /// Runs it.
    pub(super) run: fn(Options) -> Result<Done>,
}

/// Wishes of the person who runs the steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Options {
    /// A skipped test is a failure.
    pub(super) all: bool,
}

/// Steps of one lane run one after another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lane {
    /// Tests on this machine.
    Host,
    /// Builds for the chip, and all that needs few seconds here: the last tests wait with nothing beside them in their
    /// own lane.
    Target,
}

/// The end of a step that found nothing wrong.
pub(super) enum Done {
    Passed,
    /// It did not run, for lack of this.
    Skipped(String),
}

const fn host(name: &'static str, run: fn(Options) -> Result<Done>) -> Step {
    Step { name, lane: Lane::Host, run }
}

const fn target(name: &'static str, run: fn(Options) -> Result<Done>) -> Step {
    Step { name, lane: Lane::Target, run }
}

const FORMAT: Step = host("format", |_| cargo(&["fmt", "--all", "--check"]));
const LINTS: Step =
    host("lints", |_| cargo(&["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]));
const UNIT_TESTS: Step =
    host("unit tests", |_| cargo(&["test", "--package=raim-core", "--package=raim-firmware", "--lib"]));
const IMAGE: Step = target("image and its memory", |_| rig(&["image", "--board", "fast"]));

/// The short ones.
pub(super) const QUICK: &[Step] = &[FORMAT, LINTS, UNIT_TESTS, IMAGE];

/// Those of `test`.
pub(super) const TEST: &[Step] = &[
    host("tests", |options| tests(Share::Short, options)),
    IMAGE,
    target("no panic", |_| rig(&["prove", "--image", "fast"])),
    target("costs on the target", |_| rig(&["bench", "--stages"])),
];

/// Those of `check`.
pub(super) const CHECK: &[Step] = &[
    FORMAT,
    LINTS,
    host("features of the core", |_| features_of_the_core()),
    host("tests at length", |options| tests(Share::AtLength, options)),
    target("lints of the image", |_| lints_of_the_image()),
    target("libraries on other processors", |_| libraries()),
    target("other operating systems", |_| other_systems()),
    target("no panic in what ships", |_| rig(&["prove"])),
    target("worst costs, memory of the images and library for C", |_| rig(&["bench", "--tested"])),
    target("threshold tables", |_| run("oracle", &["tables", "--check"])),
    target("hostile input", |_| run("adversary", &["fuzz", "--smoke"])),
    target("examples in the documentation", |_| cargo(&["test", "--workspace", "--doc"])),
    target("documentation", |_| documentation()),
    target("packages", |_| run("release", &["packages"])),
    target("licences and sources of dependencies", |_| dependencies()),
    target("interface against the last release", |_| interface()),
];

/// Targets of the operating systems on which `rai` must compile besides Linux.
const SYSTEMS: [&str; 2] = ["x86_64-pc-windows-gnu", "aarch64-apple-darwin"];

fn done<T>(result: Result<T>) -> Result<Done> {
    result.map(|_| Done::Passed)
}

fn cargo(arguments: &[&str]) -> Result<Done> {
    done(spawn(&mut command(arguments)))
}

/// Builds a program and runs it.
fn run(program: &str, arguments: &[&str]) -> Result<Done> {
    let mut command = std::process::Command::new(build(program)?);
    done(spawn(for_a_person(command.args(arguments))))
}

fn rig(arguments: &[&str]) -> Result<Done> {
    run("rig", arguments)
}

fn lints_of_the_image() -> Result<Done> {
    let target = format!("--target={}", TARGETS[0]);
    let what = [
        "--profile=firmware",
        &target,
        "--package=raim-stm32f405",
        "--package=instruments",
        "--features=instruments/stm32f405",
    ];
    cargo(&[&["clippy"], &what[..], &["--", "-D", "warnings"]].concat())
}

fn libraries() -> Result<Done> {
    let mut arguments =
        vec!["check", "--profile=firmware", "--package=raim-core", "--package=raim-firmware", "--lib"];
    arguments.extend(TARGETS.iter().flat_map(|target| ["--target", target]));
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

/// Lints the core without features, with each alone and with all. The test has the packages that were
/// compiled for the others.
fn features_of_the_core() -> Result<Done> {
    let lint = |features: &[&str]| {
        let what = ["clippy", "--quiet", "--package=raim-core", "--lib"];
        cargo(&[&what[..], features, &["--", "-D", "warnings"]].concat())
    };
    let features = "araim searches tables double-tables policies past hypotheses aiding authentication";
    for feature in std::iter::once("").chain(features.split(' ')) {
        lint(&["--no-default-features", "--features", feature])?;
    }
    lint(&["--all-features"])?;
    let what = ["--package=raim-core", "--lib", "--no-default-features", "method_that_this_build_lacks"];
    cargo(&[&["test", "--quiet"], &what[..]].concat())
}

/// Share of the tests.
#[derive(Clone, Copy)]
enum Share {
    /// Tests of the module and of its programs.
    Short,
    /// Tests that take many seconds each, and all of the packages whose manifests say `test = false`:
    /// attacks, experiments, evidence and releases. A test of the product needs none of these.
    AtLength,
}

/// Tests that take many seconds each stand in modules of this name.
const AT_LENGTH: &str = "at_length::";

/// Options of the first share: the whole workspace, so that its features are those of the second one
/// and nothing is compiled twice.
const FIRST: [&str; 2] = ["--workspace", "--tests"];

/// Returns the filter of nextest for all that the first share leaves out.
fn left_out() -> Result<String> {
    let mut list = command(&["nextest", "list", "--list-type=binaries-only", "--message-format=oneline"]);
    let output = list.args(FIRST).stderr(Stdio::inherit()).output()?;
    ensure!(output.status.success(), "the programs of the tests cannot be built");
    let programs = String::from_utf8(output.stdout)?;
    let programs: Vec<_> = programs.lines().map(|program| format!("binary_id(={program})")).collect();
    Ok(format!("test({AT_LENGTH}) | not ({})", programs.join(" | ")))
}

/// Runs a share of the tests, by nextest if it is installed because it is faster, and counts those
/// that cannot run here.
fn tests(share: Share, Options { all }: Options) -> Result<Done> {
    let is_nextest = has_command("nextest");
    let mut arguments = if is_nextest { nextest_command() } else { command(&["test"]) };
    arguments.arg("--no-fail-fast");
    match share {
        Share::Short => arguments.args(FIRST).args(["--", "--skip", AT_LENGTH]),
        Share::AtLength => arguments.args(["--workspace", "--lib", "--bins", "--test=*"]),
    };
    // By cargo alone, the first share runs again in the second one.
    if is_nextest && matches!(share, Share::AtLength) {
        arguments.arg("--filterset").arg(left_out()?);
    }
    let skips = root().join("target/skipped-tests");
    forget(&skips)?;
    let outcome = spawn(arguments.env("INSTA_UPDATE", "no").env("RAI_SKIPS", &skips));
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

/// Returns the command that runs tests by nextest.
fn nextest_command() -> std::process::Command {
    let mut nextest = command(&["nextest", "run", "--config-file"]);
    nextest.arg(root().join("xtask/nextest.toml"));
    // Three more than there are processors, because the tests of services mostly wait.
    let threads = std::thread::available_parallelism().map_or(2, |count| count.get() + 3);
    nextest.args(["--test-threads", &threads.to_string()]);
    nextest
}

/// Removes a file that may be there.
fn forget(path: &Path) -> Result<()> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => {
            Err(error).with_context(|| path.display().to_string())
        }
        _ => Ok(()),
    }
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
    if !has_command("deny") {
        return Ok(Done::Skipped("cargo-deny (cargo install cargo-deny)".into()));
    }
    cargo(&["deny", "check", "bans", "licenses", "sources"])
}

/// Compares the libraries with the last release: what breaks a user asks for another version.
fn interface() -> Result<Done> {
    if !has_command("semver-checks") {
        return Ok(Done::Skipped("cargo-semver-checks (cargo install cargo-semver-checks)".into()));
    }
    let mut git = std::process::Command::new("git");
    git.args(["describe", "--tags", "--abbrev=0", "--match=v*"]).current_dir(root());
    let Some(output) = git.output().ok().filter(|output| output.status.success()) else {
        return Ok(Done::Skipped("the tag of a release, such as v0.2.0 (git fetch --tags)".into()));
    };
    let release = String::from_utf8(output.stdout)?;
    cargo(&[
        "semver-checks",
        "--package=raim-core",
        "--package=raim-firmware",
        "--baseline-rev",
        release.trim(),
    ])
}

/// Returns true if cargo has a command.
fn has_command(name: &str) -> bool {
    command(&[name, "--version"]).output().is_ok_and(|output| output.status.success())
}

/// Every warning counts.
fn documentation() -> Result<Done> {
    let arguments = ["doc", "--quiet", "--workspace", "--no-deps"];
    done(spawn(command(&arguments).env("RUSTDOCFLAGS", "-D warnings")))
}

#[cfg(test)]
mod tests {
    use super::{CHECK, QUICK, TEST, skipped};

    #[test]
    fn test_that_lacks_two_things_is_skipped_once() {
        let have = skipped("sky::a\tx\nsky::a\ty\nsky::a\tx\nboard::b\tx\n");
        assert_eq!(have.len(), 2);
        assert_eq!(have["sky::a"], ["x", "y"]);
    }

    #[test]
    fn every_short_step_is_one_of_the_others_but_for_the_unit_tests() {
        let is_known = |name| TEST.iter().chain(CHECK).any(|step| step.name == name);
        let alone: Vec<_> = QUICK.iter().map(|step| step.name).filter(|name| !is_known(*name)).collect();
        assert_eq!(alone, ["unit tests"]);
    }
}
