//! `rai run` for an hour between a receiver that is cut off, clients that die, and kills.
//!
//! The service is a program of its own. It gets one epoch a second over TCP, in real time, and
//! feeds a TCP client that reads, others that do not, a pseudo-terminal without a reader, UDP
//! without a listener, and standard output on a full disk. Incidents come in turn:
//!
//! | incident | every | must hold |
//! |---|---|---|
//! | the receiver's line is closed for 6 s | 60 s | the pin falls; epochs before and after are reported |
//! | a client connects and is gone | 10 s | nothing |
//! | a client connects and reads nothing for 20 s | 40 s | nothing |
//! | `SIGKILL`, then a new process | 300 s | the pin is low once `--lower-pin` has run, and rises again |
//!
//! An epoch that was sent and not reported is lost. Two kinds do not count. The module discards the
//! first epoch on a line, because it may have begun before the service connected. Those of the two
//! seconds before a kill may be on their way.
//!
//! [`readers`] runs it at ten epochs a second with every kind of reader at once, and without incidents.
//!
//! A test program brings a clock that this program moves ([`raim::run::clock`]), so that two minutes
//! take some seconds. The processes, their connections, their ends and their pins are real.
//!
//! | figure | source |
//! |---|---|
//! | memory | `VmRSS` of `/proc/PID/status`, once a second |
//! | processor | `utime` and `stime` of `/proc/PID/stat`, over the life of each process |

mod feed;
mod pace;
mod process;
pub mod readers;

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fmt;
use std::net::TcpListener;
use std::path::Path;
use std::time::Duration;

use anyhow::{Context as _, Result};

use feed::{Feed, Reader, Sky};
use pace::Pace;
use process::{Process, is_high};

/// Largest resident memory, KiB.
pub const MEMORY_KIB: u64 = 32 * 1024;
/// Largest growth from the first quarter of a process's life to its last, KiB.
pub const GROWTH_KIB: u64 = 1024;
/// Largest share of one processor.
pub const LOAD: f64 = 0.01;

/// Time to alert that the service is set to, s.
const TIME_TO_ALERT_S: u32 = 2;
/// Epochs that may be on their way when the process is killed.
const ON_THEIR_WAY: u32 = 2;
const CUT_EVERY: u32 = 60;
const CUT_FOR: u32 = 6;
const KILL_EVERY: u32 = 300;
const KILL_AT: u32 = 90;

/// The program that runs the service.
#[derive(Clone, Debug)]
pub struct Program {
    /// Path, and arguments before those of the service.
    pub command: Vec<OsString>,
    /// Variables of its environment, name and value. A program with variables is a test program: it
    /// takes the arguments of the service from `RAI_ARGUMENTS`, one on each line, and lets its clock
    /// be moved from the address in `RAI_CLOCK`.
    pub variables: Vec<(String, String)>,
}

/// Result of a run.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Epochs that were sent.
    pub sent: u32,
    /// Epochs that were sent, should have been reported, and were not.
    pub lost: Vec<u32>,
    /// Epochs reported as protected.
    pub protected: u32,
    /// Cuts of the line, and those after which the pin stayed high.
    pub cuts: [u32; 2],
    /// Longest time from the last epoch before a cut to the fall of the pin, s.
    pub slowest_fall_s: f64,
    /// Kills, and those after which the pin was high.
    pub kills: [u32; 2],
    /// Minutes at whose end the pin was low, although nothing had disturbed the receiver for 25 s.
    pub dark: u32,
    /// Clients that died or did not read.
    pub clients: u32,
    /// Largest resident memory, KiB.
    pub memory_kib: u64,
    /// Largest growth of one process, KiB.
    pub growth_kib: u64,
    /// Share of one processor.
    pub load: f64,
}

impl Outcome {
    /// Returns the promises that were broken.
    pub fn broken(&self) -> Vec<String> {
        let checks = [
            (!self.lost.is_empty(), format!("epochs {:?} were lost", self.lost)),
            (self.protected == 0, "no epoch was protected".into()),
            (self.cuts[1] > 0, format!("the pin stayed high after {} cuts", self.cuts[1])),
            (self.kills[1] > 0, format!("the pin was wrong after {} kills", self.kills[1])),
            (self.dark > 0, format!("the pin did not rise again in {} minutes", self.dark)),
            (self.memory_kib >= MEMORY_KIB, format!("{} KiB of memory", self.memory_kib)),
            (self.growth_kib > GROWTH_KIB, format!("memory grew by {} KiB", self.growth_kib)),
            (self.load >= LOAD, format!("{:.2} % of a processor", 100.0 * self.load)),
        ];
        checks.into_iter().filter(|(is_broken, _)| *is_broken).map(|(_, what)| what).collect()
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "epochs sent            {:>8}", self.sent)?;
        writeln!(f, "epochs lost            {:>8}", self.lost.len())?;
        writeln!(f, "epochs protected       {:>8}", self.protected)?;
        writeln!(f, "cuts, pin stayed high  {:>8} {:>8}", self.cuts[0], self.cuts[1])?;
        writeln!(f, "slowest fall, s        {:>8.2}", self.slowest_fall_s)?;
        writeln!(f, "kills, pin wrong       {:>8} {:>8}", self.kills[0], self.kills[1])?;
        writeln!(f, "pin low after a minute {:>8}", self.dark)?;
        writeln!(f, "dead and slow clients  {:>8}", self.clients)?;
        writeln!(f, "memory, KiB            {:>8}", self.memory_kib)?;
        writeln!(f, "growth, KiB            {:>8}", self.growth_kib)?;
        write!(f, "processor, %           {:>8.3}", 100.0 * self.load)
    }
}

/// Runs the service for so many seconds in this folder; `tell` gets the outcome so far, once a
/// minute.
///
/// # Errors
/// If the program does not start, or a port cannot be opened.
pub fn run(program: &Program, seconds: u32, folder: &Path, tell: impl Fn(&Outcome)) -> Result<Outcome> {
    let mut trial = Trial::start(program, seconds, folder)?;
    for second in 0..seconds {
        trial.pace.wait_until(Duration::from_secs(second.into()))?;
        trial.second(second)?;
        if second % 60 == 59 {
            tell(&trial.outcome);
        }
    }
    trial.pace.pass(Duration::from_secs(2))?;
    trial.pace.settle();
    trial.end()
}

/// A run in progress.
struct Trial<'p> {
    program: &'p Program,
    folder: &'p Path,
    arguments: Vec<String>,
    sky: Sky,
    feed: Feed,
    reader: Reader,
    process: Process,
    pace: Pace,
    /// Epochs that must be reported.
    expected: BTreeSet<u32>,
    last_sent: Duration,
    outcome: Outcome,
    idle: Vec<(u32, std::net::TcpStream)>,
    /// Processor time and life of the processes that have ended, s.
    spent_s: [f64; 2],
}

impl<'p> Trial<'p> {
    fn start(program: &'p Program, seconds: u32, folder: &'p Path) -> Result<Self> {
        let sky = Sky::of(seconds)?;
        let receiver = TcpListener::bind("127.0.0.1:0")?;
        let clients = TcpListener::bind("127.0.0.1:0")?.local_addr()?;
        let arguments: Vec<String> = [
            format!("--input=tcp://{}", receiver.local_addr()?),
            format!("--output=tcp://{clients}"),
            format!("--output=pty:{}", folder.join("nmea").display()),
            "--output=udp://127.0.0.1:9".into(),
            "--output=-".into(),
            format!("--pin=file:{}", folder.join("pin").display()),
            format!("--set=TTA={TIME_TO_ALERT_S}"),
            "--set=OUTPUT=GSV,1".into(),
        ]
        .into();
        let mut pace = Pace::of(program)?;
        let process = Process::start(program, &arguments, &pace)?;
        pace.connect()?;
        let reader = Reader::of(clients);
        let feed = Feed::accept(receiver, &mut pace)?;
        Ok(Self {
            program,
            folder,
            arguments,
            sky,
            feed,
            reader,
            process,
            pace,
            expected: BTreeSet::new(),
            last_sent: Duration::ZERO,
            outcome: Outcome::default(),
            idle: Vec::new(),
            spent_s: [0.0; 2],
        })
    }

    fn second(&mut self, second: u32) -> Result<()> {
        self.process.sample();
        self.clients(second);
        let phase = second % CUT_EVERY;
        let is_cut = second >= CUT_EVERY && phase < CUT_FOR;
        if second >= CUT_EVERY && phase == 0 {
            self.feed.cut();
        } else if second >= CUT_EVERY && phase == CUT_FOR {
            self.feed = self.feed.again(&mut self.pace)?;
        }
        if is_cut {
            return self.watch_fall(phase);
        }
        if second % CUT_EVERY == CUT_EVERY - 1 && !is_high(self.folder) {
            self.outcome.dark += 1;
        }
        if second % KILL_EVERY == KILL_AT {
            self.kill(second)?;
        }
        let epoch = self.sky.epoch(second)?;
        if let Ok(must_be_reported) = self.feed.send_epoch(&epoch) {
            self.pace.sent(epoch.len())?;
            self.outcome.sent += 1;
            self.last_sent = self.pace.now();
            if must_be_reported {
                self.expected.insert(second);
            }
        }
        Ok(())
    }

    /// Starts the clients that are due and ends those that have waited.
    fn clients(&mut self, second: u32) {
        self.idle.retain(|(until, _)| second < *until);
        let patience = if second % 40 == 20 { 20 } else { 0 };
        if second.is_multiple_of(10)
            && let Some(client) = self.reader.other()
        {
            self.outcome.clients += 1;
            self.idle.push((second + patience, client));
        }
    }

    /// Notes when the pin falls during a cut; the pause between two seconds is spent here.
    fn watch_fall(&mut self, phase: u32) -> Result<()> {
        if phase + 1 < CUT_FOR && phase > 0 {
            return Ok(());
        }
        if phase == 0 {
            self.outcome.cuts[0] += 1;
            let longest = Duration::from_secs((CUT_FOR - 2).into());
            let until = self.pace.now() + longest;
            while is_high(self.folder) && self.pace.now() < until {
                self.pace.pass(Duration::from_millis(10))?;
            }
            let fall_s = self.pace.now().saturating_sub(self.last_sent).as_secs_f64();
            self.outcome.slowest_fall_s = self.outcome.slowest_fall_s.max(fall_s);
        } else if is_high(self.folder) {
            self.outcome.cuts[1] += 1;
        }
        Ok(())
    }

    /// Kills the process, does what the service manager does then, and starts another one.
    fn kill(&mut self, second: u32) -> Result<()> {
        self.pace.settle();
        self.expected.retain(|epoch| *epoch + ON_THEIR_WAY < second || self.reader.has(&self.sky, *epoch));
        self.account();
        self.process.kill()?;
        self.outcome.kills[0] += 1;
        Process::lower_pin(self.program, &self.arguments)?;
        if is_high(self.folder) {
            self.outcome.kills[1] += 1;
        }
        self.process = Process::start(self.program, &self.arguments, &self.pace)?;
        self.pace.connect()?;
        self.feed = self.feed.again(&mut self.pace)?;
        self.reader.connect();
        // The service takes the client that has just connected.
        std::thread::sleep(Duration::from_millis(200));
        let orbits = self.sky.orbits();
        self.feed.send(&orbits)?;
        self.pace.sent(orbits.len())
    }

    /// Adds the figures of the process to the outcome.
    fn account(&mut self) {
        let [busy_s, life_s] = self.process.times_s();
        self.spent_s = [self.spent_s[0] + busy_s, self.spent_s[1] + life_s];
        self.outcome.load = self.spent_s[0] / self.spent_s[1];
        self.outcome.memory_kib = self.outcome.memory_kib.max(self.process.most_kib());
        self.outcome.growth_kib = self.outcome.growth_kib.max(self.process.growth_kib());
    }

    fn end(mut self) -> Result<Outcome> {
        self.account();
        self.process.kill().context("the service has ended before its time")?;
        self.outcome.lost =
            self.expected.iter().copied().filter(|epoch| !self.reader.has(&self.sky, *epoch)).collect();
        self.outcome.protected = self.reader.protected();
        Ok(self.outcome)
    }
}
