//! Cost of the core on a host: instructions of an epoch in each precision.
//!
//! Valgrind counts the instructions of a program that judges one epoch again and again. The
//! difference of two runs is that of the epochs alone:
//!
//! ```text
//! I = (I(n + m) − I(n)) / m
//! ```
//!
//! | symbol | where | unit |
//! |---|---|---|
//! | I | [`Cost`] | instructions of the host's processor |
//! | n, m | [`BEFORE`], [`COUNTED`] | epochs |
//!
//! Assumes that every epoch after the first `n` costs the same, because the input is the same. The
//! memory of an epoch is made once, as the module does it, so that the comparison is one of
//! arithmetic and not of clearing memory, of which `f64` has twice as much. The C library clears
//! memory by vectors here: one instruction that clears kilobytes would otherwise count once for
//! each byte.
//!
//! A test compares the two precisions in its own build. The workspace therefore compiles the crates
//! that instantiate the core (`raim-single` for `f32`, this one for `f64`) in one part for tests
//! too, as a release inlines them: cut into 16 parts, an epoch in `f32` took 18,903 instructions
//! instead of 14,288.

use std::fmt;
use std::process::Command;

use anyhow::{Context as _, Result, bail, ensure};
use raim_core::internals::numeric::real::Real;
use raim_core::internals::velocity::VelocityError;
use raim_core::monitor::{Method, Monitor, MonitorMemory, Search, Strategy};
use raim_core::requirements::Requirements;
use raim_firmware::correction::CAPACITY;

use super::workload;

/// Environment variable that asks a program to [`judge`], in its words.
pub const VARIABLE: &str = "RAI_JUDGED";

/// Epochs of the shorter run.
const BEFORE: u64 = 20;

/// Epochs that the longer run has more.
const COUNTED: u64 = 200;

/// Usual skies: satellites, and faulty ones among them.
pub const SKIES: [(usize, usize); 5] = [(8, 0), (20, 0), (40, 0), (20, 1), (20, 2)];

/// Instructions of an epoch of one sky.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cost {
    /// Number of satellites.
    pub satellites: usize,
    /// Number of faulty satellites.
    pub faults: usize,
    /// Instructions in single precision.
    pub single: u64,
    /// Instructions in double precision.
    pub double: u64,
}

impl fmt::Display for Cost {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { satellites, faults, single, double } = self;
        write!(formatter, "{satellites:>10} {faults:>7} {single:>10} {double:>10}")
    }
}

/// Returns true if valgrind is installed.
pub fn is_measurable() -> bool {
    Command::new("valgrind").arg("--version").output().is_ok_and(|output| output.status.success())
}

/// Measures a sky, by a program that calls [`judge`] with the words of [`VARIABLE`].
///
/// # Errors
/// If valgrind or the program fails.
pub fn measure(program: &[&str], (satellites, faults): (usize, usize)) -> Result<Cost> {
    let of = |precision: &str| {
        let run = |epochs| counted(program, &format!("{precision} {satellites} {faults} {epochs}"));
        anyhow::Ok((run(BEFORE + COUNTED)? - run(BEFORE)?) / COUNTED)
    };
    Ok(Cost { satellites, faults, single: of("f32")?, double: of("f64")? })
}

/// Returns the instructions of a program that judges.
fn counted(program: &[&str], words: &str) -> Result<u64> {
    let mut command = Command::new("valgrind");
    command.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]).args(program);
    command.env(VARIABLE, words).env("GLIBC_TUNABLES", "glibc.cpu.x86_rep_stosb_threshold=1000000000");
    let output = command.output().context("valgrind cannot be run")?;
    let reported = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{words}: {reported}");
    let count = reported.lines().find_map(|line| line.split_once("Collected :")?.1.trim().parse().ok());
    count.with_context(|| format!("valgrind counts nothing: {reported}"))
}

/// Judges epochs as words tell: precision (`f32` or `f64`), satellites, faults, epochs.
///
/// # Errors
/// If the words are no such request, or there is no such sky.
pub fn judge(words: &str) -> Result<()> {
    let (precision, numbers) = words.split_once(' ').context("no precision is given")?;
    let numbers = numbers.split(' ').map(str::parse).collect::<Result<Vec<usize>, _>>()?;
    let &[satellites, faults, epochs] = numbers.as_slice() else { bail!("three numbers are needed") };
    match precision {
        "f32" => judge_in::<f32>(satellites, faults, epochs),
        "f64" => judge_in::<f64>(satellites, faults, epochs),
        other => bail!("`{other}` is no precision"),
    }
}

fn judge_in<T: Real>(satellites: usize, faults: usize, epochs: usize) -> Result<()> {
    let epoch = workload::epoch(satellites, 2, faults)?;
    let mut monitor = Monitor::<T, CAPACITY>::new(Requirements::non_precision_approach())?;
    monitor.set_strategy(Strategy::CLASSIC.with_method(Method::Baarda))?;
    monitor.start_from(workload::site().position);
    let mut memory = MonitorMemory::new();
    for _ in 0..epochs {
        let (epoch, start) = (std::hint::black_box(&epoch), monitor.start());
        let outcome = monitor.judge(epoch, start, Search::Anew, None, &mut memory);
        monitor.learn(outcome, None, Err(VelocityError::Redundancy));
        std::hint::black_box(&outcome.report);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{VARIABLE, judge};

    /// Is the measured program, and passes at once if nobody asks for epochs.
    #[test]
    fn epochs_that_are_asked_for_are_judged() {
        if let Ok(words) = std::env::var(VARIABLE) {
            judge(&words).expect("a sky that exists");
        }
    }

    mod at_length {
        use super::super::{is_measurable, measure};

        #[test]
        fn a_host_pays_nothing_for_single_precision() {
            if !is_measurable() {
                return crate::skip::say("valgrind");
            }
            let program = std::env::current_exe().expect("this program").display().to_string();
            let name = "bench::host::tests::epochs_that_are_asked_for_are_judged";
            let cost = measure(&[&program, "--exact", name], (20, 0)).expect("a measurement");
            println!("{cost}");
            assert!(cost.single <= cost.double, "{cost:?}");
            // A program that judges nothing costs nothing.
            assert!(cost.double > 1_000, "{cost:?}");
        }
    }
}
