//! The service as a process: its start and end, and what it costs.

use std::fs::{self, OpenOptions};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Instant;

use anyhow::{Context as _, Result, ensure};

use super::Program;
use super::pace::Pace;

/// Ticks of `/proc/PID/stat` in a second, on every Linux.
const TICKS: f64 = 100.0;
/// Seconds of a process's life that do not count for its growth.
const WARM_UP: usize = 30;

/// A running service, killed when dropped.
pub(super) struct Process {
    child: Child,
    start: Instant,
    memory_kib: Vec<u64>,
}

fn command(program: &Program, arguments: &[String]) -> Result<Command> {
    let (first, rest) = program.command.split_first().context("a program")?;
    let mut command = Command::new(first);
    command.args(rest).stdin(Stdio::null()).stderr(Stdio::null());
    let variables = program.variables.iter().map(|(name, value)| (name.as_str(), value.as_str()));
    command.envs(variables).env("RAI_ARGUMENTS", arguments.join("\n"));
    if program.variables.is_empty() {
        command.arg("run").args(arguments);
    }
    Ok(command)
}

impl Process {
    /// Starts the service with standard output on a disk that is full; a test program, which prints
    /// lines of its own, without any.
    pub(super) fn start(program: &Program, arguments: &[String], pace: &Pace) -> Result<Self> {
        let full = OpenOptions::new().write(true).open("/dev/full").context("/dev/full")?;
        let out = if program.variables.is_empty() { full.into() } else { Stdio::null() };
        let mut command = command(program, arguments)?;
        command.envs(pace.address().map(|address| ("RAI_CLOCK", address)));
        let child = command.stdout(out).spawn().context("the service")?;
        Ok(Self { child, start: Instant::now(), memory_kib: Vec::new() })
    }

    /// Drives the pin low, as a service manager does after the service has ended.
    pub(super) fn lower_pin(program: &Program, arguments: &[String]) -> Result<()> {
        let arguments = [arguments, &["--lower-pin".to_owned()]].concat();
        let status = command(program, &arguments)?.stdout(Stdio::null()).status()?;
        ensure!(status.success(), "the pin cannot be lowered");
        Ok(())
    }

    /// Reads the resident memory.
    pub(super) fn sample(&mut self) {
        let status = fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap_or_default();
        let memory = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        self.memory_kib
            .extend(memory.and_then(|text| text.trim().trim_end_matches(" kB").parse::<u64>().ok()));
    }

    /// Returns the largest resident memory, KiB.
    pub(super) fn most_kib(&self) -> u64 {
        self.memory_kib.iter().copied().max().unwrap_or(0)
    }

    /// Returns the growth from the first quarter of the life to the last, KiB, or 0 after a short
    /// one.
    pub(super) fn growth_kib(&self) -> u64 {
        let settled = self.memory_kib.get(WARM_UP..).unwrap_or_default();
        let quarter = settled.len() / 4;
        let most = |part: &[u64]| part.iter().copied().max().unwrap_or(0);
        let (first, last) = (settled.get(..quarter), settled.get(settled.len() - quarter..));
        most(last.unwrap_or_default()).saturating_sub(most(first.unwrap_or_default()))
    }

    /// Returns the processor time and the life so far, s.
    pub(super) fn times_s(&self) -> [f64; 2] {
        let stat = fs::read_to_string(format!("/proc/{}/stat", self.child.id())).unwrap_or_default();
        // The name of the program stands in brackets; utime and stime are fields 14 and 15.
        let fields = stat.rsplit_once(')').map_or("", |(_, rest)| rest).split_whitespace().skip(11).take(2);
        let ticks: f64 = fields.filter_map(|field| field.parse::<f64>().ok()).sum();
        [ticks / TICKS, self.start.elapsed().as_secs_f64()]
    }

    /// Kills the process by `SIGKILL`; it is an error if it has ended by itself.
    pub(super) fn kill(&mut self) -> Result<()> {
        let ended = self.child.try_wait()?;
        ensure!(ended.is_none(), "the service has ended by itself: {ended:?}");
        self.child.kill()?;
        self.child.wait()?;
        Ok(())
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // It does not matter if the process has already ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Returns true if the pin in this folder is high.
pub(super) fn is_high(folder: &Path) -> bool {
    fs::read_to_string(folder.join("pin")).is_ok_and(|level| level == "1\n")
}
