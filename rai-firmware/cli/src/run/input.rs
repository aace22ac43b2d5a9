//! The receiver's bytes: from a serial port, a TCP server or standard input.
//!
//! A port that fails or ends is opened again, after a pause that doubles from a quarter of a second
//! to eight. Meanwhile nothing arrives, so the module reports `STALE` and drops the pin by itself.
//! A serial port takes another rate when [`super::contact`] asks for one.

use std::fmt;
use std::io::{self, IsTerminal as _, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::str::FromStr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::thread;
use std::time::Duration;

use anyhow::{Context as _, Result, bail, ensure};
use serialport::SerialPort;

use super::inbox::Inbox;
use super::played;
use super::reserve::Reserve;
use super::share::Share;
use crate::run::words::say;
use crate::serial;

/// Rate of a serial port if none is named: the module's own first guess.
const BAUD: u32 = 115_200;
/// A read comes back after this time even if nothing arrives, so that a dead line is noticed.
const READ_TIMEOUT: Duration = Duration::from_secs(2);
/// A TCP server that sends nothing for this time is taken for gone.
const DEAD: Duration = Duration::from_secs(15);
const FIRST_PAUSE: Duration = Duration::from_millis(250);
const LONGEST_PAUSE: Duration = Duration::from_secs(8);

/// The source of the receiver's bytes, as the user names it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// `serial:/dev/ttyUSB0@115200`
    Serial(String, u32),
    /// `tcp://host:port`
    Tcp(String),
    /// `-`: standard input, at whose end the service ends.
    Standard,
}

impl FromStr for Source {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        if text == "-" {
            return Ok(Self::Standard);
        }
        if let Some(address) = text.strip_prefix("tcp://") {
            return Ok(Self::Tcp(address.to_owned()));
        }
        ensure!(
            !["ntrip://", "ntrips://"].iter().any(|scheme| text.starts_with(scheme)),
            "{text} is a caster, which sends ephemerides beside a receiver: --input RECEIVER --caster {text}"
        );
        let Some(port) = text.strip_prefix("serial:") else {
            bail!("an input is serial:PORT@BAUD, tcp://HOST:PORT, - or a file, and `{text}` is none");
        };
        let (port, baud) =
            port.rsplit_once('@').map_or((port, Ok(BAUD)), |(port, baud)| (port, baud.parse()));
        let Ok(baud) = baud else { bail!("the rate behind @ must be a number: `{text}`") };
        Ok(Self::Serial(port.to_owned(), baud))
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial(port, baud) => write!(f, "serial:{port}@{baud}"),
            Self::Tcp(address) => write!(f, "tcp://{address}"),
            Self::Standard => f.write_str("standard input"),
        }
    }
}

/// The kinds of input, by what a stop of it means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Nature {
    /// A file: it has an end, and its time is that of its epochs.
    File,
    /// A pipe: it has an end and waits for its reader, and it may be that of a receiver.
    Pipe,
    /// A line that waits for nobody.
    Live,
}

impl Nature {
    /// Returns the nature of a source.
    pub(super) fn of(source: &Source) -> Self {
        match source {
            Source::Standard => Self::of_standard_input(),
            Source::Serial(..) | Source::Tcp(_) => Self::Live,
        }
    }

    #[cfg(unix)]
    fn of_standard_input() -> Self {
        use std::os::unix::fs::FileTypeExt as _;
        match std::fs::metadata(played::NAME).map(|metadata| metadata.file_type()) {
            // It is opened by its name, which only Linux allows again from its beginning.
            Ok(kind) if kind.is_file() && cfg!(target_os = "linux") => Self::File,
            Ok(kind) if kind.is_file() || kind.is_fifo() => Self::Pipe,
            _ => Self::Live,
        }
    }

    #[cfg(not(unix))]
    fn of_standard_input() -> Self {
        if io::stdin().is_terminal() { Self::Live } else { Self::Pipe }
    }
}

/// Starts the thread that reads.
///
/// # Errors
/// If a serial port does not exist when the service starts: a wrong name should not be retried
/// forever.
pub(super) fn start(source: &Source, line: &Line, inbox: &Arc<Inbox>, stop: &Arc<AtomicBool>) -> Result<()> {
    let (source, inbox, stop) = (source.clone(), Arc::clone(inbox), Arc::clone(stop));
    let line = line.clone();
    let first = match &source {
        Source::Serial(..) => Some(open(&source, &line).with_context(|| source.to_string())?),
        Source::Standard if io::stdin().is_terminal() => {
            // Otherwise it would seem to hang.
            say!("waiting for a receiver's bytes on standard input; --input names a port (rai run --help)");
            None
        }
        Source::Tcp(_) | Source::Standard => None,
    };
    thread::spawn(move || keep_reading(&source, &line, first, &inbox, &stop));
    Ok(())
}

/// What a reader shares with others: the rate that it follows, bit/s, and the programs to which it
/// passes the bytes.
#[derive(Clone, Debug)]
pub(super) struct Line {
    pub(super) rate: Arc<AtomicU32>,
    pub(super) share: Option<Arc<Share>>,
}

impl Line {
    /// Returns the line of a source at start.
    pub(super) fn of(source: &Source, share: Option<Arc<Share>>) -> Self {
        let rate = match source {
            Source::Serial(_, baud) => *baud,
            Source::Tcp(_) | Source::Standard => 0,
        };
        Self { rate: Arc::new(AtomicU32::new(rate)), share }
    }

    /// Notes the writing side of the port, or that it is closed.
    fn connect(&self, port: Option<Box<dyn Write + Send>>) {
        if let Some(share) = &self.share {
            share.connect(port);
        }
    }
}

/// An open source.
enum Port {
    /// One without a rate.
    Plain(Box<dyn Read + Send>),
    /// A serial port, at this rate.
    Serial(Box<dyn SerialPort>, u32),
}

impl Port {
    /// Takes this rate; returns true if the port had another one.
    fn follow(&mut self, baud: u32) -> io::Result<bool> {
        match self {
            Self::Serial(port, now) if *now != baud => {
                port.set_baud_rate(baud)?;
                *now = baud;
                Ok(true)
            }
            _ => Ok(false),
        }
    }
}

impl Read for Port {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Plain(port) => port.read(into),
            Self::Serial(port, _) => port.read(into),
        }
    }
}

fn open(source: &Source, line: &Line) -> Result<Port> {
    Ok(match source {
        Source::Standard => Port::Plain(Box::new(io::stdin())),
        Source::Serial(port, _) => {
            let baud = line.rate.load(Ordering::Relaxed);
            let port = serial::open(port, baud, READ_TIMEOUT)?;
            line.connect(Some(Box::new(port.try_clone()?)));
            Port::Serial(port, baud)
        }
        Source::Tcp(address) => {
            let stream = connect(address)?;
            stream.set_write_timeout(Some(READ_TIMEOUT))?;
            line.connect(Some(Box::new(stream.try_clone()?)));
            Port::Plain(Box::new(stream))
        }
    })
}

/// Connects to the first address that answers.
pub(super) fn connect(address: &str) -> Result<TcpStream> {
    let patience = Duration::from_secs(5);
    let addresses = address.to_socket_addrs().with_context(|| format!("`{address}` must be HOST:PORT"))?;
    let connected =
        addresses.into_iter().find_map(|address| TcpStream::connect_timeout(&address, patience).ok());
    let stream = connected.with_context(|| format!("nothing answers at {address}"))?;
    stream.set_read_timeout(Some(READ_TIMEOUT))?;
    Ok(stream)
}

fn keep_reading(source: &Source, line: &Line, first: Option<Port>, inbox: &Inbox, stop: &AtomicBool) {
    let mut pause = FIRST_PAUSE;
    let mut port = first;
    // Clients may take all other descriptors while the line is away.
    let reserve = Reserve::new();
    while !stop.load(Ordering::Relaxed) {
        match port.take().map_or_else(|| reserve.with(|| open(source, line)), Ok) {
            Ok(open) => {
                // Standard input is whole from its first byte, and ends once.
                let is_standard = *source == Source::Standard;
                if !is_standard {
                    inbox.interrupt();
                }
                let (count, reason) = read(open, line, inbox, stop);
                line.connect(None);
                if is_standard {
                    return inbox.end();
                }
                if count > 0 {
                    pause = FIRST_PAUSE;
                }
                say!("{source}: {reason}; trying again in {} ms", pause.as_millis());
            }
            Err(error) => say!("{source}: {error:#}; trying again in {} ms", pause.as_millis()),
        }
        inbox.clock().sleep(pause, stop);
        pause = LONGEST_PAUSE.min(2 * pause);
    }
}

/// Reads until the port ends; returns how many bytes came, and why it ended.
fn read(mut port: Port, line: &Line, inbox: &Inbox, stop: &AtomicBool) -> (u64, String) {
    let (mut bytes, mut total, mut last) = ([0; 4096], 0, inbox.clock().now());
    while !stop.load(Ordering::Relaxed) {
        match port.follow(line.rate.load(Ordering::Relaxed)) {
            Ok(true) => inbox.interrupt(),
            Ok(false) => {}
            Err(error) => return (total, format!("cannot have another rate: {error}")),
        }
        match port.read(&mut bytes) {
            Ok(0) => return (total, "the other side has closed it".into()),
            Ok(count) => {
                let bytes = bytes.get(..count).unwrap_or_default();
                inbox.push_in_turn(bytes);
                if let Some(share) = &line.share {
                    share.pass(bytes);
                }
                total += count as u64;
                last = inbox.clock().now();
            }
            Err(error) if is_timeout(&error) && inbox.clock().now().saturating_sub(last) < DEAD => {}
            Err(error) if is_timeout(&error) => return (total, format!("silent for {} s", DEAD.as_secs())),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return (total, error.to_string()),
        }
    }
    (total, "stopped".into())
}

pub(super) fn is_timeout(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock)
}

#[cfg(test)]
mod tests {
    use super::Source;

    #[test]
    fn sources_are_read_or_refused_with_their_form() {
        let source = |text: &str| text.parse::<Source>();
        assert_eq!(source("-").unwrap(), Source::Standard);
        assert_eq!(source("serial:/dev/ttyUSB0").unwrap(), Source::Serial("/dev/ttyUSB0".into(), 115_200));
        assert_eq!(source("serial:COM3@9600").unwrap(), Source::Serial("COM3".into(), 9_600));
        assert_eq!(source("tcp://[::1]:2000").unwrap(), Source::Tcp("[::1]:2000".into()));
        for wrong in ["", "/dev/ttyUSB0", "serial:/dev/ttyUSB0@fast", "udp://x:1"] {
            assert!(source(wrong).is_err(), "{wrong}");
        }
    }
}
