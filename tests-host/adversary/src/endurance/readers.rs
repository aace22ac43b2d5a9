//! `rai run` at ten epochs a second, with every kind of reader at once.
//!
//! | reader | how | must have at the end |
//! |---|---|---|
//! | sentences, as gpsd reads them | TCP | a verdict for each epoch |
//! | the receiver's bytes, as u-center reads them | `--share` | each byte |
//! | the page | `/events`, left open | an event for each epoch at least |
//! | Prometheus | `/metrics`, every 15 s | an answer each time |
//! | chronyd | its socket | a sample for each protected epoch |
//!
//! Nothing is cut or killed: the figures are those of a service in use. The sky is that of the
//! present, because the time that chronyd gets is compared with that of the computer.

use std::collections::BTreeSet;
use std::fmt;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::os::unix::net::UnixDatagram;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant, SystemTime};

use anyhow::{Context as _, Result, ensure};
use raim::signal::encode::{Frequency, Selection, ubx};
use raim::signal::sky::raw::Simulation;
use raim_firmware::time::GpsTime;

use super::feed::{LEAP_MS, judged, utc_of_day};
use super::pace::Pace;
use super::process::Process;
use super::{LOAD, Program};

/// Epochs a second.
pub const RATE_HZ: u32 = 10;
/// Largest resident memory, KiB.
pub const MEMORY_KIB: u64 = 16 * 1024;

/// Start of GPS time in Unix time, ms.
const GPS_BEGAN_MS: u64 = 315_964_800_000;
/// A sky starts at a multiple of this, ms.
const GRID_MS: u64 = 16_000;
/// Longest wait for a connection, and pause between two attempts.
const PATIENCE: Duration = Duration::from_secs(30);
const PAUSE: Duration = Duration::from_millis(20);
/// Seconds between two visits of Prometheus.
const SCRAPE_S: u64 = 15;
/// Time in which what is on its way arrives.
const ON_THE_WAY: Duration = Duration::from_secs(2);

/// Result of a run.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Epochs that were sent, those without a verdict, and those that were protected.
    pub epochs: [u64; 3],
    /// Places of those without a verdict in the run, from 0.
    pub lost: Vec<usize>,
    /// Bytes that were sent, and those that the program behind `--share` got.
    pub bytes: [u64; 2],
    /// Events that the page got.
    pub events: u64,
    /// Visits of Prometheus, and those without an answer.
    pub visits: [u64; 2],
    /// Samples that chronyd got.
    pub samples: u64,
    /// Largest resident memory, KiB.
    pub memory_kib: u64,
    /// Share of one processor.
    pub load: f64,
}

impl Outcome {
    /// Returns the promises that were broken.
    pub fn broken(&self) -> Vec<String> {
        let ([sent, lost, protected], [bytes, shared]) = (self.epochs, self.bytes);
        let checks = [
            (lost > 0, format!("the epochs {:?} were lost", self.lost)),
            // Ephemerides come before the first epoch, and the first epoch on a line is dropped.
            (protected + 50 < sent, format!("{protected} epochs of {sent} were protected")),
            (bytes != shared, format!("{shared} bytes of {bytes} were shared")),
            (self.events + 50 < sent, format!("{} events of {sent} epochs", self.events)),
            (self.visits[1] > 0, format!("{} visits without an answer", self.visits[1])),
            (self.samples + 50 < protected, format!("{} samples for chronyd", self.samples)),
            (self.memory_kib > MEMORY_KIB, format!("{} KiB of memory", self.memory_kib)),
            (self.load > LOAD, format!("{:.2} % of a processor", 100.0 * self.load)),
        ];
        checks.into_iter().filter(|(is_broken, _)| *is_broken).map(|(_, what)| what).collect()
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [sent, lost, protected] = self.epochs;
        writeln!(f, "epochs sent            {sent:>10}")?;
        writeln!(f, "epochs lost            {lost:>10}")?;
        writeln!(f, "epochs protected       {protected:>10}")?;
        writeln!(f, "bytes sent, shared     {:>10} {:>10}", self.bytes[0], self.bytes[1])?;
        writeln!(f, "events of the page     {:>10}", self.events)?;
        writeln!(f, "visits, unanswered     {:>10} {:>10}", self.visits[0], self.visits[1])?;
        writeln!(f, "samples for chronyd    {:>10}", self.samples)?;
        writeln!(f, "memory, KiB            {:>10}", self.memory_kib)?;
        write!(f, "processor, %           {:>10.3}", 100.0 * self.load)
    }
}

/// Runs the service for so many seconds in this folder; `tell` gets the number of epochs sent, once a
/// minute.
///
/// # Errors
/// If the program does not start or ends by itself, or a port cannot be opened.
pub fn run(program: &Program, seconds: u32, folder: &Path, tell: impl Fn(u64)) -> Result<Outcome> {
    let count = seconds * RATE_HZ;
    let sky = sky(count)?;
    let receiver = TcpListener::bind("127.0.0.1:0")?;
    let [sentences, share, page] = [0; 3].map(|_| free_address());
    let (sentences, share, page) = (sentences?, share?, page?);
    let chronyd = folder.join("chrony.rai.sock");
    let socket = UnixDatagram::bind(&chronyd).context("a socket")?;
    let arguments = [
        format!("--input=tcp://{}", receiver.local_addr()?),
        format!("--output=tcp://{sentences}"),
        format!("--output=chrony:{}", chronyd.display()),
        "--output=udp://127.0.0.1:9".to_owned(),
        format!("--share=tcp://{share}"),
        format!("--page={page}"),
        format!("--pin=file:{}", folder.join("pin").display()),
        "--set=OUTPUT=GSV,1".to_owned(),
        "--quiet".to_owned(),
    ];
    let mut process = Process::start(program, &arguments, &Pace::Real(Instant::now()))?;
    let readers = Arc::new(Readers::default());
    for (address, read) in
        [(sentences, read_sentences as fn(TcpStream, &Readers)), (share, read_bytes), (page, read_events)]
    {
        let (stream, own) = (connect(address)?, Arc::clone(&readers));
        thread::spawn(move || read(stream, &own));
    }
    let own = Arc::clone(&readers);
    thread::spawn(move || {
        while let Ok(1..) = socket.recv(&mut [0; 64]) {
            own.samples.fetch_add(1, Ordering::Relaxed);
        }
    });
    let own = Arc::clone(&readers);
    thread::spawn(move || visit(page, &own));
    let (mut line, _) = receiver.accept()?;
    // The service takes the readers that have just connected.
    thread::sleep(Duration::from_millis(500));
    let (sent, expected) = send(&sky, &mut line, &mut process, tell)?;
    thread::sleep(ON_THE_WAY);
    readers.has_ended.store(true, Ordering::Relaxed);
    let [busy_s, life_s] = process.times_s();
    let outcome = readers.outcome(&expected, sent);
    let memory_kib = process.most_kib();
    process.kill().context("the service has ended before its time")?;
    Ok(Outcome { memory_kib, load: busy_s / life_s, ..outcome })
}

/// Returns the sky of the present.
fn sky(epochs: u32) -> Result<Simulation> {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH)?;
    let gps_ms = (u64::try_from(since.as_millis())? - GPS_BEGAN_MS + LEAP_MS).next_multiple_of(1000) + 2000;
    let origin_ms = gps_ms / GRID_MS * GRID_MS;
    let mut sky = Simulation::above_xian((gps_ms - origin_ms) as f64 * 1e-3, epochs, 7);
    sky.origin = GpsTime::from_ms(origin_ms);
    sky.step_s = 1.0 / f64::from(RATE_HZ);
    sky.has_range_rates = true;
    Ok(sky)
}

/// Sends every epoch in its time; returns the number of bytes, and the times of day of the epochs
/// that must be judged.
fn send(
    sky: &Simulation,
    line: &mut TcpStream,
    process: &mut Process,
    tell: impl Fn(u64),
) -> Result<(u64, BTreeSet<u64>)> {
    let ephemerides = sky.ephemerides();
    let mut encoder = ubx::Encoder::new(&ephemerides, Selection::new("GC", Frequency::Dual)?, None);
    let time = sky.epochs().next().context("an epoch")?.time;
    let pages = ephemerides.iter().map(|set| ubx::pages(set, time)).collect::<Result<Vec<_>>>()?.concat();
    line.write_all(&pages)?;
    let (mut sent, mut expected) = (pages.len() as u64, BTreeSet::new());
    let start = Instant::now();
    for (number, epoch) in (0_u64..).zip(sky.epochs()) {
        let due = Duration::from_millis(number * 1000 / u64::from(RATE_HZ));
        thread::sleep(due.saturating_sub(start.elapsed()));
        let bytes = encoder.epoch(&epoch)?;
        line.write_all(&bytes).context("the service has closed its line")?;
        sent += bytes.len() as u64;
        // The first epoch on a line may have begun before the service connected.
        if number > 0 {
            expected.insert(utc_of_day(epoch.time));
        }
        if number % u64::from(RATE_HZ) == 0 {
            process.sample();
        }
        if number % u64::from(60 * RATE_HZ) == 0 {
            tell(number);
        }
    }
    Ok((sent, expected))
}

/// What the readers have got.
#[derive(Debug, Default)]
struct Readers {
    /// Times of day of the epochs that were judged, and of those that were protected.
    judged: Mutex<[BTreeSet<u64>; 2]>,
    bytes: AtomicU64,
    events: AtomicU64,
    visits: AtomicU64,
    unanswered: AtomicU64,
    samples: AtomicU64,
    has_ended: AtomicBool,
}

impl Readers {
    fn outcome(&self, expected: &BTreeSet<u64>, sent: u64) -> Outcome {
        let count = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        let judged = self.judged.lock().unwrap_or_else(PoisonError::into_inner);
        let lost = expected.iter().enumerate().filter(|(_, time)| !judged[0].contains(time));
        let lost: Vec<usize> = lost.map(|(place, _)| place).collect();
        Outcome {
            epochs: [expected.len() as u64, lost.len() as u64, judged[1].len() as u64],
            lost,
            bytes: [sent, count(&self.bytes)],
            events: count(&self.events),
            visits: [count(&self.visits), count(&self.unanswered)],
            samples: count(&self.samples),
            ..Outcome::default()
        }
    }
}

fn read_sentences(stream: TcpStream, readers: &Readers) {
    for line in BufReader::new(stream).lines().map_while(Result::ok) {
        if let Some((time, state)) = judged(&line) {
            let mut judged = readers.judged.lock().unwrap_or_else(PoisonError::into_inner);
            judged[0].insert(time);
            if state == 'P' {
                judged[1].insert(time);
            }
        }
    }
}

fn read_bytes(mut stream: TcpStream, readers: &Readers) {
    let mut chunk = [0; 4096];
    while let Ok(count @ 1..) = stream.read(&mut chunk) {
        readers.bytes.fetch_add(count as u64, Ordering::Relaxed);
    }
}

fn read_events(mut stream: TcpStream, readers: &Readers) {
    if stream.write_all(b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n").is_ok() {
        for line in BufReader::new(stream).lines().map_while(Result::ok) {
            readers.events.fetch_add(u64::from(line == "event: state"), Ordering::Relaxed);
        }
    }
}

fn visit(page: SocketAddr, readers: &Readers) {
    let answer = || -> Result<String> {
        let (mut stream, mut text) = (TcpStream::connect(page)?, String::new());
        stream.set_read_timeout(Some(PATIENCE))?;
        stream.write_all(b"GET /metrics HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")?;
        stream.read_to_string(&mut text)?;
        ensure!(text.contains("rai_"), "no metrics");
        Ok(text)
    };
    while !readers.has_ended.load(Ordering::Relaxed) {
        let has_failed = answer().is_err();
        if readers.has_ended.load(Ordering::Relaxed) {
            return;
        }
        readers.visits.fetch_add(1, Ordering::Relaxed);
        readers.unanswered.fetch_add(u64::from(has_failed), Ordering::Relaxed);
        thread::sleep(Duration::from_secs(SCRAPE_S));
    }
}

fn free_address() -> Result<SocketAddr> {
    Ok(TcpListener::bind("127.0.0.1:0")?.local_addr()?)
}

/// Connects to a port of the service, which has just started.
fn connect(address: SocketAddr) -> Result<TcpStream> {
    let start = Instant::now();
    loop {
        match TcpStream::connect(address) {
            Ok(stream) => return Ok(stream),
            Err(error) if start.elapsed() > PATIENCE => return Err(error).context("the service"),
            Err(_) => thread::sleep(PAUSE),
        }
    }
}
