//! Both ends of the service: a receiver under a simulated sky, and a client that reads.

use std::collections::BTreeMap;
use std::io::{BufRead as _, BufReader, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use super::pace::Pace;
use anyhow::{Context as _, Result, bail};
use raim::signal::encode::{Frequency, Selection, ubx};
use raim::signal::recording::Recording;
use raim::signal::sky::raw::Simulation;
use raim_firmware::time::GpsTime;

/// GPS time less UTC of the simulated day, ms.
pub(super) const LEAP_MS: u64 = 18_000;
const DAY_MS: u64 = 86_400_000;
/// Longest wait for a connection.
const PATIENCE: Duration = Duration::from_secs(30);

/// The receiver's messages.
pub(super) struct Sky {
    recording: Recording,
    encoder: ubx::Encoder,
    orbits: Vec<u8>,
}

impl Sky {
    pub(super) fn of(seconds: u32) -> Result<Self> {
        let recording = Simulation::above_xian(3600.0, seconds, 7).record();
        let encoder = ubx::Encoder::new(&recording.ephemerides, Selection::new("GC", Frequency::Dual)?, None);
        let time = recording.epochs.first().context("an epoch")?.time;
        let pages = recording.ephemerides.iter().map(|set| ubx::pages(set, time));
        let orbits = pages.collect::<Result<Vec<_>>>()?.concat();
        Ok(Self { recording, encoder, orbits })
    }

    /// Returns the messages with all orbits.
    pub(super) fn orbits(&self) -> Vec<u8> {
        self.orbits.clone()
    }

    /// Returns one epoch; orbits stand before the first one.
    pub(super) fn epoch(&mut self, second: u32) -> Result<Vec<u8>> {
        let epoch = self.recording.epochs.get(second as usize).context("an epoch")?;
        let ranges = self.encoder.epoch(epoch)?;
        Ok(if second == 0 { [self.orbits(), ranges].concat() } else { ranges })
    }

    fn of_day(&self, second: u32) -> Option<u64> {
        self.recording.epochs.get(second as usize).map(|epoch| utc_of_day(epoch.time))
    }
}

/// The receiver's end of its line.
pub(super) struct Feed {
    listener: Arc<TcpListener>,
    line: Option<TcpStream>,
    /// True until an epoch has been sent on this line.
    is_fresh: bool,
}

impl Feed {
    pub(super) fn accept(listener: TcpListener, pace: &mut Pace) -> Result<Self> {
        listener.set_nonblocking(true)?;
        Self::of(Arc::new(listener), pace)
    }

    /// Closes the line and waits for the service to connect anew.
    pub(super) fn again(&mut self, pace: &mut Pace) -> Result<Self> {
        self.cut();
        Self::of(Arc::clone(&self.listener), pace)
    }

    fn of(listener: Arc<TcpListener>, pace: &mut Pace) -> Result<Self> {
        let start = Instant::now();
        loop {
            if let Ok((line, _)) = listener.accept() {
                line.set_nonblocking(false)?;
                line.set_write_timeout(Some(PATIENCE))?;
                return Ok(Self { listener, line: Some(line), is_fresh: true });
            }
            if start.elapsed() > PATIENCE {
                bail!("the service does not connect to its receiver");
            }
            // The service tries again by its own clock.
            pace.pass(Duration::from_millis(20))?;
        }
    }

    pub(super) fn cut(&mut self) {
        self.line = None;
    }

    /// Sends an epoch; returns true if it is not the first one on this line.
    pub(super) fn send_epoch(&mut self, bytes: &[u8]) -> Result<bool> {
        self.send(bytes)?;
        Ok(!std::mem::take(&mut self.is_fresh))
    }

    pub(super) fn send(&mut self, bytes: &[u8]) -> Result<()> {
        self.line.as_mut().context("the line is cut")?.write_all(bytes).context("the line")
    }
}

/// States by time of day, in hundredths of a second.
type States = Arc<Mutex<BTreeMap<u64, char>>>;

/// The client that reads every sentence, and connects again when the service does.
pub(super) struct Reader {
    address: SocketAddr,
    states: States,
}

impl Reader {
    pub(super) fn of(address: SocketAddr) -> Self {
        let reader = Self { address, states: States::default() };
        reader.connect();
        reader
    }

    /// Returns a further connection, which nobody reads.
    pub(super) fn other(&self) -> Option<TcpStream> {
        TcpStream::connect_timeout(&self.address, Duration::from_secs(1)).ok()
    }

    /// Connects to a process that has just started, and returns once it has.
    pub(super) fn connect(&self) {
        let start = Instant::now();
        while start.elapsed() < PATIENCE {
            if let Some(stream) = self.other() {
                let states = Arc::clone(&self.states);
                thread::spawn(move || read(stream, &states));
                return;
            }
            thread::sleep(Duration::from_millis(20));
        }
    }

    /// Returns true if the epoch was reported.
    pub(super) fn has(&self, sky: &Sky, second: u32) -> bool {
        let states = self.states.lock().unwrap_or_else(PoisonError::into_inner);
        sky.of_day(second).is_some_and(|time| states.contains_key(&time))
    }

    /// Returns the number of epochs that were protected.
    pub(super) fn protected(&self) -> u32 {
        let states = self.states.lock().unwrap_or_else(PoisonError::into_inner);
        states.values().filter(|state| **state == 'P').count() as u32
    }
}

fn read(stream: TcpStream, states: &States) {
    for line in BufReader::new(stream).lines().map_while(Result::ok) {
        if let Some((time, state)) = judged(&line) {
            states.lock().unwrap_or_else(PoisonError::into_inner).insert(time, state);
        }
    }
}

/// Returns the time of day of an epoch in UTC, as a sentence has it, in hundredths of a second.
pub(super) fn utc_of_day(time: GpsTime) -> u64 {
    (time.to_ms() - LEAP_MS + 5) % DAY_MS / 10
}

/// Returns the time of day and the state of an epoch, if a sentence is its verdict.
pub(super) fn judged(sentence: &str) -> Option<(u64, char)> {
    let fields: Vec<_> = sentence.split(',').collect();
    let ["$PRAIS", time, state, reason, ..] = fields[..] else { return None };
    (reason != "STALE").then_some((of_day(time)?, state.chars().next()?))
}

/// Parses `hhmmss.ss` to hundredths of a second of the day.
fn of_day(text: &str) -> Option<u64> {
    let number = |range: std::ops::Range<usize>| text.get(range)?.parse::<u64>().ok();
    Some(((number(0..2)? * 60 + number(2..4)?) * 60 + number(4..6)?) * 100 + number(7..9)?)
}
