//! `cargo xtask test`: everything that must hold.
//!
//! Each step runs whatever became of the ones before it, so that one run tells all that is wrong. There are two lanes of
//! them, which build in folders of their own: linking an image as a whole keeps one core busy, and leaves the other to the
//! host.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use anyhow::{Context as _, ensure};
use tests_host::image::{self, Chip, Image};

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Take what the snapshot tests have now as what they want.
    #[arg(long)]
    bless: bool,
}

type Step = (&'static str, Box<dyn Fn() -> anyhow::Result<()> + Send>);

/// What became of a step, and how long it took, s.
type Outcome = (&'static str, Option<anyhow::Error>, f64);

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    tests_host::setup::ensure()?;
    let (on_host, on_target) = (on_host(arguments.bless), on_target());
    let outcomes: Vec<Outcome> = std::thread::scope(|scope| {
        let target = scope.spawn(|| walk(on_target));
        let host = walk(on_host);
        let target = target.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        host.into_iter().chain(target).collect()
    });
    summarise(&outcomes)
}

/// One step after another.
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

fn on_host(bless: bool) -> Vec<Step> {
    vec![
        ("format", cargo(&["fmt", "--all", "--check"])),
        ("lints, host", cargo(&["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"])),
        ("tests", Box::new(move || tests(bless))),
        ("documentation's examples", cargo(&["test", "--workspace", "--doc"])),
        ("documentation", Box::new(documentation)),
    ]
}

/// And what builds beside both: the fuzzing targets.
fn on_target() -> Vec<Step> {
    let mut clippy_target = vec!["clippy"];
    clippy_target.extend(FIRMWARE);
    vec![
        ("lints, target", cargo(&clippy_target)),
        ("image", Box::new(|| image::build().map(drop))),
        ("memory of the image", Box::new(sizes)),
        ("no panic", Box::new(tests_host::no_panic::prove)),
        ("costs on the target", Box::new(costs)),
        ("threshold tables", Box::new(tables)),
        ("hostile input", Box::new(crate::fuzz::smoke)),
    ]
}

pub(crate) fn cargo(arguments: &[&str]) -> Box<dyn Fn() -> anyhow::Result<()> + Send> {
    let arguments: Vec<String> = arguments.iter().map(ToString::to_string).collect();
    Box::new(move || spawn(&mut command(&arguments)))
}

fn command(arguments: &[impl AsRef<std::ffi::OsStr>]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("..")).args(arguments);
    command
}

fn spawn(command: &mut Command) -> anyhow::Result<()> {
    let words: Vec<_> = command.get_args().map(|argument| argument.to_string_lossy().into_owned()).collect();
    eprintln!("$ cargo {}", words.join(" "));
    let status = command.status().context("cargo cannot be run")?;
    ensure!(status.success(), "`cargo {}` failed", words.join(" "));
    Ok(())
}

/// The faster runner where it is installed; it runs the same tests.
fn tests(bless: bool) -> anyhow::Result<()> {
    let nextest = command(&["nextest", "--version"]).output().is_ok_and(|output| output.status.success());
    let arguments: &[&str] = if nextest {
        &["nextest", "run", "--workspace", "--no-fail-fast"]
    } else {
        &["test", "--workspace", "--all-targets", "--no-fail-fast"]
    };
    spawn(command(arguments).env("INSTA_UPDATE", if bless { "always" } else { "no" }))
}

/// Every warning counts, but for the tags of the literature: `[Lin2016]` looks like a link and is none.
fn documentation() -> anyhow::Result<()> {
    let mut doc = command(&["doc", "--workspace", "--no-deps"]);
    eprintln!("$ cargo doc --workspace --no-deps");
    let output = doc
        .env("RUSTDOCFLAGS", "-A rustdoc::private_intra_doc_links")
        .output()
        .context("cargo cannot be run")?;
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "`cargo doc` failed:\n{said}");
    let flaws = documentation_flaws(&said);
    ensure!(flaws.is_empty(), "{}", flaws.join("\n"));
    Ok(())
}

fn documentation_flaws(said: &str) -> Vec<&str> {
    let is_tag = |link: &str| {
        let alphanumeric = link.chars().all(|c| c.is_ascii_alphanumeric());
        let (digits, lower) =
            (link.contains(|c: char| c.is_ascii_digit()), link.contains(|c: char| c.is_ascii_lowercase()));
        alphanumeric && link.starts_with(|c: char| c.is_ascii_uppercase()) && (digits || !lower)
    };
    let is_flaw = |line: &&str| match line.strip_prefix("warning: unresolved link to `") {
        Some(link) => !is_tag(link.trim_end_matches('`')),
        // Cargo counts the warnings of a crate in a warning of its own.
        None => line.starts_with("warning: ") && !line.contains(" generated "),
    };
    said.lines().filter(is_flaw).collect()
}

fn sizes() -> anyhow::Result<()> {
    let image = Image::open(&image::build()?)?;
    println!("{image}");
    let findings = image.check(&Chip::named("STM32F405RGTx")?);
    ensure!(findings.is_empty(), "{}", findings.join("; "));
    Ok(())
}

fn costs() -> anyhow::Result<()> {
    crate::bench::run(&crate::bench::Arguments { check: true, save: false, host: false })
}

fn tables() -> anyhow::Result<()> {
    crate::tables::run(&crate::tables::Arguments { check: true })
}

#[cfg(test)]
mod tests {
    use super::documentation_flaws;

    #[test]
    fn tag_of_the_literature_is_no_broken_link_and_a_renamed_item_is() {
        let said = "warning: unresolved link to `Lin2016`\n  --> src/lib.rs:1\nwarning: unresolved link to `MOPS`\n\
                    warning: unresolved link to `Ephemeris::new`\nwarning: unresolved link to `Snapshot`\n\
                    warning: `rai-core` (lib doc) generated 4 warnings\n";
        let want = ["warning: unresolved link to `Ephemeris::new`", "warning: unresolved link to `Snapshot`"];
        assert_eq!(documentation_flaws(said), want);
    }
}
