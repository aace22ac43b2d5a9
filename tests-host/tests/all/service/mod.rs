//! `rai run` between a receiver that falls silent and consumers of which some are dead.
//!
//! | module | content |
//! |---|---|
//! | [`consumers`] | gpsd on the pseudo-terminal, `pymavlink` over UDP |
//! | [`time`] | chrony by its own socket, and behind gpsd |
//! | [`casters`] | casters that answer in chunks, or with the table of their mountpoints |
//! | [`ports`] | a serial port, and a caster for a receiver without orbits |
//! | [`played`] | a file or a pipe on standard input |
//! | [`named`] | a file by its name, and settings in every form |
//! | [`share`] | the receiver's bytes for other programs |
//! | [`limits`] | the pin while clients take all places and files |
//! | [`computer`] | the pin while the date steps, the machine sleeps, readers stop, the disk is full |
//! | [`page`] | the page in a browser |
//! | [`program`] | the service in a process of its own |

mod casters;
#[cfg(target_os = "linux")]
mod computer;
mod consumers;
#[cfg(target_os = "linux")]
mod limits;
#[cfg(target_os = "linux")]
mod named;
mod page;
#[cfg(target_os = "linux")]
mod played;
mod ports;
mod program;
mod share;
mod time;

use std::fs;
use std::io::{Read as _, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use raim::run::clock::Clock;
use raim::run::{Arguments, Plan, serve_by};
use raim::signal::encode::{Frequency, Selection, ubx};
use raim::signal::sky::raw::Simulation;

use program::{service, started_by};

/// Epochs per second that the receiver sends.
const RATE_HZ: u32 = 5;
/// Time to alert that the service is set to, s.
const TIME_TO_ALERT_S: f64 = 1.0;
/// Largest excess of the service over it, s.
const ALLOWANCE_S: f64 = 0.2;

/// Returns the sky at five epochs a second.
fn sky(epochs: u32) -> Simulation {
    let mut simulation = Simulation::above_xian(3600.0, epochs, 11);
    simulation.step_s = 1.0 / f64::from(RATE_HZ);
    simulation
}

/// Returns the stream of a u-blox receiver under a sky: orbits first, then one epoch in each piece.
fn pieces_of(simulation: &Simulation) -> Vec<Vec<u8>> {
    let recording = simulation.record();
    let selection = Selection::new("GCE", Frequency::Dual).unwrap();
    let mut encoder = ubx::Encoder::new(&recording.ephemerides, selection, None);
    let time = recording.epochs[0].time;
    let orbits: Vec<_> =
        recording.ephemerides.iter().flat_map(|set| ubx::pages(set, time).unwrap()).collect();
    let epochs = recording.epochs.iter().map(|epoch| encoder.epoch(epoch).unwrap());
    [orbits].into_iter().chain(epochs).collect()
}

fn pieces(epochs: u32) -> Vec<Vec<u8>> {
    pieces_of(&sky(epochs))
}

/// Service, until it is dropped. Its clock stands still until a test moves it.
struct Service {
    clock: Arc<Clock>,
    /// Bytes of the receiver that were sent.
    sent: u64,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<anyhow::Result<()>>>,
}

impl Service {
    /// Starts the service with its pin in this folder.
    fn start(folder: &Path, arguments: Arguments) -> Self {
        Self::start_by(folder, arguments, Clock::led())
    }

    fn start_by(folder: &Path, arguments: Arguments, clock: Arc<Clock>) -> Self {
        let mut arguments =
            Arguments { pin: Some(format!("file:{}", folder.join("pin").display())), ..arguments };
        arguments.set.insert(0, format!("TTA={TIME_TO_ALERT_S}"));
        let plan = Plan::read(arguments).unwrap();
        let stop = Arc::new(AtomicBool::new(false));
        let (until, own) = (Arc::clone(&stop), Arc::clone(&clock));
        let thread = Some(thread::spawn(move || serve_by(&plan, &until, &own)));
        Self { clock, sent: 0, stop, thread }
    }

    /// Sends each piece in its time.
    fn send(&mut self, line: &mut impl Write, pieces: &[Vec<u8>]) {
        self.send_each(line, pieces, || ());
    }

    /// Sends each piece in its time, and does something else after each.
    fn send_each(&mut self, line: &mut impl Write, pieces: &[Vec<u8>], mut then: impl FnMut()) {
        for piece in pieces {
            line.write_all(piece).unwrap();
            self.sent += piece.len() as u64;
            self.clock.await_bytes(self.sent);
            self.clock.advance(Duration::from_secs(1) / RATE_HZ);
            then();
        }
    }

    /// Lets time pass until the pin has this level, and returns the time that it took.
    fn wait_for(&self, folder: &Path, high: bool, longest: Duration) -> Duration {
        let (mut passed, step) = (Duration::ZERO, Duration::from_millis(5));
        while is_high(folder) != high {
            let level = if high { "low" } else { "high" };
            assert!(passed < longest, "the pin is {level} after {longest:?}");
            self.clock.advance(step);
            passed += step;
        }
        passed
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(Err(panic)) = self.thread.take().map(JoinHandle::join) {
            std::panic::resume_unwind(panic);
        }
    }
}

/// Returns the port of a receiver, and the input that connects to it.
fn receiver() -> (TcpListener, Option<String>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let input = format!("tcp://{}", listener.local_addr().unwrap());
    (listener, Some(input))
}

/// Ports below those that a system gives to connections of its own choice.
const PORTS: Range<u32> = 10_000..32_000;

/// Returns an address on which nobody listens, and which no connection takes before the service does.
fn free_address() -> SocketAddr {
    static TAKEN: AtomicU32 = AtomicU32::new(0);
    // Tests that run at the same time are processes with consecutive numbers.
    let first = std::process::id().wrapping_mul(32);
    let mut ports = std::iter::repeat_with(|| {
        let number = first.wrapping_add(TAKEN.fetch_add(1, Ordering::Relaxed));
        PORTS.start + number % (PORTS.end - PORTS.start)
    });
    let bind =
        |port: u32| TcpListener::bind(("127.0.0.1", u16::try_from(port).ok()?)).ok()?.local_addr().ok();
    ports.find_map(bind).unwrap()
}

/// Connects to the service as soon as it listens.
fn client(address: SocketAddr) -> TcpStream {
    let start = Instant::now();
    loop {
        if let Ok(client) = TcpStream::connect(address) {
            return client;
        }
        assert!(start.elapsed() < Duration::from_secs(20), "the service does not listen");
        thread::sleep(Duration::from_millis(20));
    }
}

/// Returns true if the pin is high.
fn is_high(folder: &Path) -> bool {
    fs::read_to_string(folder.join("pin")).is_ok_and(|level| level == "1\n")
}

/// Reads until the sentences have all of this, in real time.
fn read_until(reader: &mut TcpStream, want: &[&str]) -> String {
    let (start, mut bytes, mut chunk) = (Instant::now(), Vec::new(), [0; 4096]);
    reader.set_read_timeout(Some(Duration::from_millis(20))).unwrap();
    loop {
        let count = reader.read(&mut chunk).unwrap_or(0);
        bytes.extend_from_slice(&chunk[..count]);
        let text = String::from_utf8_lossy(&bytes);
        if want.iter().all(|want| text.contains(want)) {
            return text.into_owned();
        }
        assert!(start.elapsed() < Duration::from_secs(5), "{want:?}: {text}");
    }
}

#[test]
fn pin_falls_within_the_time_to_alert_of_a_silent_receiver_whatever_clients_do() {
    let folder = tempfile::tempdir().unwrap();
    let ((receiver, input), clients) = (receiver(), free_address());
    let terminal = format!("pty:{}", folder.path().join("nmea").display());
    let output = vec![format!("tcp://{clients}"), terminal];
    let arguments = Arguments { input, output, ..Arguments::default() };
    let mut service = Service::start(folder.path(), arguments);
    // One client reads, one never reads, one is gone at once; nothing opens the terminal.
    let (mut reader, _idle) = (client(clients), client(clients));
    drop(client(clients));
    let (mut line, _) = receiver.accept().unwrap();
    service.send(&mut line, &pieces(20));
    assert!(is_high(folder.path()), "the sky is good");
    // The line stays open and is silent. The last piece has had the time of an epoch.
    let silent = service.wait_for(folder.path(), false, Duration::from_secs(5)).as_secs_f64();
    let silent = silent + 1.0 / f64::from(RATE_HZ);
    assert!(silent <= TIME_TO_ALERT_S + ALLOWANCE_S, "{silent:.3} s");
    read_until(&mut reader, &[",P,OK,", ",A,STALE,"]);
    // The receiver returns on time, because epochs with the tags of before would be late, and the
    // position is protected again.
    let missed = (silent * f64::from(RATE_HZ)).ceil();
    service.clock.advance(Duration::from_secs_f64(missed / f64::from(RATE_HZ) - silent));
    let next = 20 + missed as usize;
    service.send(&mut line, &pieces(60)[next..next + 20]);
    assert!(is_high(folder.path()), "nothing contradicted");
}

/// The fall by the clock of the computer, beside that of a clock that is moved.
#[test]
fn pin_falls_within_the_time_to_alert_by_the_clock_of_the_computer() {
    let folder = tempfile::tempdir().unwrap();
    let (receiver, input) = receiver();
    let output = vec!["udp://127.0.0.1:9".to_owned()];
    let arguments = Arguments { input, output, ..Arguments::default() };
    let _service = Service::start_by(folder.path(), arguments, Clock::of_the_computer());
    let (mut line, _) = receiver.accept().unwrap();
    for piece in pieces(10) {
        line.write_all(&piece).unwrap();
        thread::sleep(Duration::from_secs(1) / RATE_HZ);
    }
    assert!(is_high(folder.path()), "the sky is good");
    let start = Instant::now();
    while is_high(folder.path()) && start.elapsed() < Duration::from_secs(5) {
        thread::sleep(Duration::from_millis(5));
    }
    let silent = start.elapsed().as_secs_f64() + 1.0 / f64::from(RATE_HZ);
    assert!(silent <= TIME_TO_ALERT_S + ALLOWANCE_S, "{silent:.3} s");
}
