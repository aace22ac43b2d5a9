//! Time between two seconds of a run: real, or that of a test program whose clock is moved.
//!
//! A test program connects here and obeys lines of text, each of which it answers with `ok`:
//!
//! | line | the service |
//! |---|---|
//! | `pass N` | judges N milliseconds |
//! | `bytes N` | waits until N bytes of the receiver have come since its start |

use std::io::{BufRead as _, BufReader, Write as _};
use std::net::{TcpListener, TcpStream};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, bail, ensure};

use super::Program;

/// Longest real wait for a test program to connect or to answer.
const PATIENCE: Duration = Duration::from_secs(30);
/// Real time in which sentences that are on their way arrive.
const ON_THE_WAY: Duration = Duration::from_millis(300);
/// Real time that a moved clock leaves to the threads around the loop, such as one that connects.
const TURN: Duration = Duration::from_millis(2);

/// The time of a run.
pub(super) enum Pace {
    /// That of the computer.
    Real(Instant),
    /// That of a clock that this program moves.
    Led(Box<Led>),
}

/// The clock of the process that runs.
pub(super) struct Led {
    listener: TcpListener,
    line: Option<BufReader<TcpStream>>,
    now: Duration,
    /// Bytes that were sent to this process.
    bytes: usize,
}

impl Pace {
    pub(super) fn of(program: &Program) -> Result<Self> {
        if program.variables.is_empty() {
            return Ok(Self::Real(Instant::now()));
        }
        let listener = TcpListener::bind("127.0.0.1:0")?;
        listener.set_nonblocking(true)?;
        Ok(Self::Led(Box::new(Led { listener, line: None, now: Duration::ZERO, bytes: 0 })))
    }

    /// Returns the address that the process connects to.
    pub(super) fn address(&self) -> Option<String> {
        match self {
            Self::Real(_) => None,
            Self::Led(led) => led.listener.local_addr().ok().map(|address| address.to_string()),
        }
    }

    /// Waits for a process that has just started.
    pub(super) fn connect(&mut self) -> Result<()> {
        let Self::Led(led) = self else { return Ok(()) };
        let start = Instant::now();
        led.bytes = 0;
        loop {
            if let Ok((stream, _)) = led.listener.accept() {
                stream.set_nonblocking(false)?;
                stream.set_nodelay(true)?;
                stream.set_read_timeout(Some(PATIENCE))?;
                led.line = Some(BufReader::new(stream));
                return Ok(());
            }
            if start.elapsed() > PATIENCE {
                bail!("the test program does not ask for the time");
            }
            thread::sleep(TURN);
        }
    }

    /// Returns the time since the start of the run.
    pub(super) fn now(&self) -> Duration {
        match self {
            Self::Real(start) => start.elapsed(),
            Self::Led(led) => led.now,
        }
    }

    /// Lets time pass.
    pub(super) fn pass(&mut self, by: Duration) -> Result<()> {
        match self {
            Self::Real(_) => thread::sleep(by),
            Self::Led(led) => {
                led.ask(&format!("pass {}", by.as_millis()))?;
                led.now += by;
                // Consumers read in real time, and their queues hold some ten epochs.
                thread::sleep(TURN.max(by / 25));
            }
        }
        Ok(())
    }

    /// Lets time pass up to this instant of the run.
    pub(super) fn wait_until(&mut self, due: Duration) -> Result<()> {
        self.pass(due.saturating_sub(self.now()))
    }

    /// Notes bytes that were sent, and waits until a moved service has them.
    pub(super) fn sent(&mut self, bytes: usize) -> Result<()> {
        let Self::Led(led) = self else { return Ok(()) };
        led.bytes += bytes;
        led.ask(&format!("bytes {}", led.bytes))
    }

    /// Lets sentences that are on their way arrive, if the clock is moved. In real time they have
    /// had their time.
    pub(super) fn settle(&self) {
        if matches!(self, Self::Led(_)) {
            thread::sleep(ON_THE_WAY);
        }
    }
}

impl Led {
    fn ask(&mut self, what: &str) -> Result<()> {
        let line = self.line.as_mut().context("no process")?;
        writeln!(line.get_mut(), "{what}").context("the clock of the test program")?;
        let mut answer = String::new();
        line.read_line(&mut answer).context("the clock of the test program")?;
        ensure!(answer == "ok\n", "{what}: the test program answers `{answer}`");
        Ok(())
    }
}
