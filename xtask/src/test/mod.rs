//! `cargo xtask test` and `cargo xtask check`: what every change must pass.
//!
//! Each step runs in a process of its own, whatever the steps before it found, so that one run
//! reports all failures. Its output goes to a log; the terminal gets one line per step, and the end
//! of the log if the step fails. Two lanes run side by side and build in folders of their own: the
//! link of a whole image keeps one core busy, and leaves the other to the host.

mod counts;
mod steps;

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::time::Instant;

use anyhow::{Context as _, Result, ensure};
use pico_args::Arguments;
use xtask::cargo::root;
use xtask::setup::{self, Need};

use counts::Counts;
use steps::{CHECK, Done, Lane, Options, QUICK, Step, TEST};

/// Options of both commands.
pub(crate) const OPTIONS: &str = "
  --quick      Run only format, lints, unit tests and the size of the image (`test`)
  --step NAME  Run one step with its output on the terminal; a wrong name lists the names
  --all        Fail if a test is skipped because a recording or a program is missing
";

/// The result of one step, after so many seconds.
struct Outcome {
    step: &'static Step,
    result: Result<Done>,
    seconds: f64,
}

/// Runs the tests.
pub(crate) fn test(arguments: &mut Arguments) -> Result<()> {
    let is_quick = arguments.contains("--quick");
    if is_quick {
        setup::ensure(&[Need::Components])?;
    }
    run("test", if is_quick { QUICK } else { TEST }, arguments)
}

/// Runs the other checks.
pub(crate) fn check(arguments: &mut Arguments) -> Result<()> {
    run("check", CHECK, arguments)
}

/// Fails if the command line has words that no option has taken.
///
/// # Errors
/// With the words.
pub(crate) fn ensure_none_is_left(arguments: &mut Arguments) -> Result<()> {
    let left = std::mem::replace(arguments, Arguments::from_vec(Vec::new())).finish();
    let words: Vec<_> = left.iter().map(|word| word.to_string_lossy()).collect();
    ensure!(words.is_empty(), "unexpected: {}; --help lists the options", words.join(" "));
    Ok(())
}

fn run(verb: &'static str, steps: &'static [Step], arguments: &mut Arguments) -> Result<()> {
    let step: Option<String> = arguments.opt_value_from_str("--step")?;
    let options = Options { all: arguments.contains("--all") };
    ensure_none_is_left(arguments)?;
    if let Some(name) = step {
        return alone(&name, options);
    }
    let logs = root().join("target").join(verb);
    fs::create_dir_all(&logs).with_context(|| logs.display().to_string())?;
    // The steps on the chip need it, and the tests all that it is made of: otherwise they would wait for one another's
    // build. What goes wrong here, the steps report.
    let _ = xtask::cargo::build("rig");
    println!("{} steps; their output is in {}", steps.len(), logs.display());
    let outcomes = Mutex::new(Vec::new());
    let walk = |lane: Lane| {
        for step in steps.iter().filter(|step| step.lane == lane) {
            let outcome = take(step, options, &logs);
            let mut outcomes = outcomes.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            outcomes.push(outcome);
            let number = outcomes.len();
            if let Some(outcome) = outcomes.last() {
                report(outcome, number, steps.len(), &logs);
            }
        }
    };
    std::thread::scope(|scope| {
        scope.spawn(|| walk(Lane::Target));
        walk(Lane::Host);
    });
    let outcomes = outcomes.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    summarise(&outcomes, &logs)
}

/// Runs a step in this process, for its parent or for a person.
fn alone(name: &str, options: Options) -> Result<()> {
    let all = || [QUICK, TEST, CHECK].into_iter().flatten();
    let step = all().find(|step| step.name == name).with_context(|| {
        let names: std::collections::BTreeSet<_> = all().map(|step| step.name).collect();
        format!("there is no step `{name}`: choose one of {}", Vec::from_iter(names).join(", "))
    })?;
    match (step.run)(options)? {
        Done::Passed => Ok(()),
        Done::Skipped(needs) => {
            println!("{SKIPPED}{needs}");
            Ok(())
        }
    }
}

/// Beginning of the line in which a skipped step prints the requirement that it lacks.
const SKIPPED: &str = "step skipped: needs ";

/// Runs a step in a process of its own.
fn take(step: &'static Step, options: Options, logs: &Path) -> Outcome {
    let start = Instant::now();
    let result = child(step, options, &log_of(step, logs));
    Outcome { step, result, seconds: start.elapsed().as_secs_f64() }
}

fn child(step: &Step, options: Options, log: &Path) -> Result<Done> {
    let file = File::create(log).with_context(|| log.display().to_string())?;
    // Not the path of the running file: a build may have replaced it.
    let program = std::env::args_os().next().context("this program has no name")?;
    let mut child = Command::new(program);
    child.args(["test", "--step", step.name]);
    child.args(options.all.then_some("--all"));
    let status = child.stdout(file.try_clone()?).stderr(file).status().context("a step cannot be started")?;
    ensure!(status.success(), "see {}", log.display());
    let text = fs::read_to_string(log).unwrap_or_default();
    let needs = text.lines().rev().find_map(|line| line.strip_prefix(SKIPPED));
    Ok(needs.map_or(Done::Passed, |needs| Done::Skipped(needs.to_owned())))
}

fn log_of(step: &Step, logs: &Path) -> PathBuf {
    logs.join(step.name.replace(|letter: char| !letter.is_ascii_alphanumeric(), "-")).with_extension("log")
}

/// Lines of a failed step's log that the terminal gets.
const TAIL_LINES: usize = 60;

/// Prints the line of a step, and the end of its log if it failed.
fn report(outcome: &Outcome, number: usize, count: usize, logs: &Path) {
    let Outcome { step, result, seconds } = outcome;
    let (word, reason) = match result {
        Ok(Done::Passed) => ("passed", String::new()),
        Ok(Done::Skipped(needs)) => ("skipped", format!(": needs {needs}")),
        Err(error) => ("FAILED", format!(": {error:#}")),
    };
    println!("[{number:2}/{count}] {word:7} {} ({seconds:.1} s){reason}", step.name);
    if result.is_err() {
        let text = fs::read_to_string(log_of(step, logs)).unwrap_or_default();
        let lines: Vec<_> = text.lines().collect();
        let tail = lines.get(lines.len().saturating_sub(TAIL_LINES)..).unwrap_or_default();
        for line in tail {
            println!("    {line}");
        }
    }
}

/// Prints the closing lines: steps, and the tests in them.
fn summarise(outcomes: &[Outcome], logs: &Path) -> Result<()> {
    let of = |is: fn(&Result<Done>) -> bool| outcomes.iter().filter(|outcome| is(&outcome.result)).count();
    let steps = Counts {
        passed: of(|result| matches!(result, Ok(Done::Passed))),
        failed: of(Result::is_err),
        skipped: of(|result| matches!(result, Ok(Done::Skipped(_)))),
    };
    let logs =
        outcomes.iter().map(|outcome| fs::read_to_string(log_of(outcome.step, logs)).unwrap_or_default());
    let tests = logs.map(|log| Counts::in_log(&log)).fold(Counts::default(), Counts::plus);
    println!("\nsteps: {steps}\ntests: {tests}");
    ensure!(steps.failed == 0, "{} of {} steps failed", steps.failed, outcomes.len());
    Ok(())
}
