//! Open inputs.
//!
//! | function | a read comes back |
//! |---|---|
//! | [`Line::open`] | after a time, even if nothing comes |
//! | [`listen`] | when bytes come, or at the end |

use std::fs::File;
use std::io::{self, Read, Stdin, Write};
use std::net::{TcpStream, ToSocketAddrs as _};
use std::path::Path;
use std::time::Duration;

use anyhow::{Context as _, Result};
use serialport::SerialPort;

use super::{Source, is_port, serial};

/// Longest wait for a server to answer.
const PATIENCE: Duration = Duration::from_secs(5);

/// Longest time that a write may take.
const TO_WRITE: Duration = Duration::from_secs(2);

/// Time after which a read that waits begins again.
const LONG: Duration = Duration::from_hours(1);

/// An open input.
pub(crate) enum Line {
    /// Standard input.
    Standard(Stdin),
    /// A connection.
    Tcp(TcpStream),
    /// A serial port, at this rate.
    Serial(Box<dyn SerialPort>, u32),
    /// A file.
    File(File),
}

impl Line {
    /// Opens an input. A read of a connection or a port returns after `timeout`.
    ///
    /// # Errors
    /// It cannot be opened; the message has the reason and the next step.
    pub(crate) fn open(source: &Source, timeout: Duration) -> Result<Self> {
        Ok(match source {
            Source::Standard => Self::Standard(io::stdin()),
            Source::Tcp(address) => Self::Tcp(connect(address, timeout)?),
            Source::Serial(port, baud) => Self::Serial(serial::open(port, *baud, timeout)?, *baud),
            Source::File(path) => Self::File(File::open(path).context("cannot be opened")?),
        })
    }

    /// Returns the other direction; `None` of an input without one.
    ///
    /// # Errors
    /// The system's own.
    pub(crate) fn writer(&self) -> Result<Option<Box<dyn Write + Send>>> {
        Ok(match self {
            Self::Tcp(stream) => Some(Box::new(stream.try_clone()?)),
            Self::Serial(port, _) => Some(Box::new(port.try_clone()?)),
            Self::Standard(_) | Self::File(_) => None,
        })
    }

    /// Sets the rate of a serial port, bit/s; returns true if the port had another one.
    ///
    /// # Errors
    /// The port cannot have this rate.
    pub(crate) fn follow(&mut self, baud: u32) -> io::Result<bool> {
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

impl Read for Line {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Standard(input) => input.read(into),
            Self::Tcp(stream) => stream.read(into),
            Self::Serial(port, _) => port.read(into),
            Self::File(file) => file.read(into),
        }
    }
}

impl Write for Line {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Tcp(stream) => stream.write(bytes),
            Self::Serial(port, _) => port.write(bytes),
            Self::Standard(_) | Self::File(_) => Err(io::ErrorKind::Unsupported.into()),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Tcp(stream) => stream.flush(),
            Self::Serial(port, _) => port.flush(),
            Self::Standard(_) | Self::File(_) => Ok(()),
        }
    }
}

/// The bytes of an input, and its writer if it takes commands.
pub(crate) type Both = (Box<dyn Read + Send>, Option<Box<dyn Write + Send>>);

/// Opens an input of which a read waits for as long as nothing comes. It ends if the other side is
/// gone. A file or a pipe may stand in for a serial port.
///
/// # Errors
/// As for [`Line::open`].
pub(crate) fn listen(source: &Source) -> Result<Both> {
    let line = match source {
        // A name without a file may be that of a port on Windows; its error names the ports.
        Source::Serial(port, _) if Path::new(port).exists() && !is_port(Path::new(port)) => {
            Line::open(&Source::File(port.into()), LONG)?
        }
        source => Line::open(source, LONG)?,
    };
    let commands = line.writer()?;
    Ok((Box::new(Waiting(line)), commands))
}

/// Reader that waits until bytes come, or until the other side is gone, which is its end.
struct Waiting(Line);

impl Read for Waiting {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        loop {
            match self.0.read(into) {
                Err(error) if is_timeout(&error) || error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) if error.kind() == io::ErrorKind::BrokenPipe => return Ok(0),
                other => return other,
            }
        }
    }
}

/// Returns true for the error of a read that came back without bytes.
pub(crate) fn is_timeout(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock)
}

/// Connects to the first address that answers. A read returns after `timeout`.
///
/// # Errors
/// The address has not the form `HOST:PORT`, or nothing answers.
pub(crate) fn connect(address: &str, timeout: Duration) -> Result<TcpStream> {
    let addresses = address.to_socket_addrs().with_context(|| format!("`{address}` must be HOST:PORT"))?;
    let connected =
        addresses.into_iter().find_map(|address| TcpStream::connect_timeout(&address, PATIENCE).ok());
    let stream = connected.with_context(|| format!("nothing answers at {address}"))?;
    stream.set_read_timeout(Some(timeout))?;
    stream.set_write_timeout(Some(TO_WRITE))?;
    Ok(stream)
}
