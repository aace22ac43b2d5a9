//! `rai run` between a receiver that falls silent and consumers of which some are dead.
//!
//! | module | content |
//! |---|---|
//! | [`consumers`] | gpsd on the pseudo-terminal, `pymavlink` over UDP |
//! | [`time`] | chrony behind gpsd |
//! | [`ports`] | a serial port, and a caster for a receiver without orbits |
//! | [`endurance`] | the service as a program, between cuts, kills and dead clients |

mod consumers;
#[cfg(target_os = "linux")]
mod endurance;
mod ports;
mod time;

use std::fs;
use std::io::{Read as _, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use raim::run::{Arguments, Plan, serve};
use raim::signal::encode::{Frequency, Selection, ubx};
use raim::signal::sky::raw::Simulation;

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

/// Sends each piece in its time.
fn send(line: &mut impl Write, pieces: &[Vec<u8>]) {
    for piece in pieces {
        line.write_all(piece).unwrap();
        thread::sleep(Duration::from_secs(1) / RATE_HZ);
    }
}

/// Service, until it is dropped.
struct Service {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<anyhow::Result<()>>>,
}

impl Service {
    /// Starts the service with its pin in this folder.
    fn start(folder: &Path, arguments: Arguments) -> Self {
        let mut arguments =
            Arguments { pin: Some(format!("file:{}", folder.join("pin").display())), ..arguments };
        arguments.set.insert(0, format!("TTA={TIME_TO_ALERT_S}"));
        let plan = Plan::read(arguments).unwrap();
        let stop = Arc::new(AtomicBool::new(false));
        let until = Arc::clone(&stop);
        let thread = Some(thread::spawn(move || serve(&plan, &until)));
        Self { stop, thread }
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

/// Returns an address on which nobody listens.
fn free_address() -> SocketAddr {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap()
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

/// Waits until the pin has this level, and returns the time that it took.
fn wait_for(folder: &Path, high: bool, longest: Duration) -> Duration {
    let start = Instant::now();
    while is_high(folder) != high {
        assert!(
            start.elapsed() < longest,
            "the pin is {} after {longest:?}",
            if high { "low" } else { "high" }
        );
        thread::sleep(Duration::from_millis(5));
    }
    start.elapsed()
}

#[test]
fn pin_falls_within_the_time_to_alert_of_a_silent_receiver_whatever_clients_do() {
    let folder = tempfile::tempdir().unwrap();
    let ((receiver, input), clients) = (receiver(), free_address());
    let terminal = format!("pty:{}", folder.path().join("nmea").display());
    let output = vec![format!("tcp://{clients}"), terminal];
    let _service = Service::start(folder.path(), Arguments { input, output, ..Arguments::default() });
    // One client reads, one never reads, one is gone at once; nothing opens the terminal.
    let (mut reader, _idle) = (client(clients), client(clients));
    drop(client(clients));
    let (mut line, _) = receiver.accept().unwrap();
    send(&mut line, &pieces(20));
    assert!(is_high(folder.path()), "the sky is good");
    let last_epoch = Instant::now();
    // The line stays open and is silent.
    let silent = wait_for(folder.path(), false, Duration::from_secs(5)).as_secs_f64();
    assert!(silent <= TIME_TO_ALERT_S + ALLOWANCE_S, "{silent:.3} s");
    thread::sleep(Duration::from_millis(100));
    reader.set_nonblocking(true).unwrap();
    let mut sentences = Vec::new();
    let _ = reader.read_to_end(&mut sentences);
    let sentences = String::from_utf8_lossy(&sentences);
    assert!(sentences.contains(",P,OK,") && sentences.contains(",A,STALE,"), "{sentences}");
    // The receiver returns on time, because epochs with the tags of before would be late, and the
    // position is protected again.
    let missed = (last_epoch.elapsed().as_secs_f64() * f64::from(RATE_HZ)).ceil() as usize;
    let next = 21 + missed;
    send(&mut line, &pieces(60)[next..next + 20]);
    assert!(is_high(folder.path()), "nothing contradicted");
}
