//! Consumers of the sentences: standard output, a pseudo-terminal, TCP clients, UDP.
//!
//! Each has a thread and a bounded queue; all TCP clients share one thread (`clients`). A
//! pseudo-terminal that nobody reads loses sentences and nothing else. A serial port that is gone, and
//! an address that cannot be reached any more, are tried again.

mod datagrams;
mod serial;
mod terminal;

use std::fmt;
use std::io::{self, Write};
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;
use std::sync::mpsc::Receiver;

use anyhow::{Context as _, Result, bail};

use super::clients::Clients;
use super::inbox::Inbox;
use super::outbox::{Kind, Outbox};
use super::px4::Px4;
use datagrams::Datagrams;
use serial::SerialPort;
use terminal::terminal;

/// A place that sentences or messages go to, as the user names it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Sink {
    /// `-`: standard output.
    Standard,
    /// `pty:/run/rai/nmea`: a pseudo-terminal behind this link. Commands may come from it.
    Pty(PathBuf),
    /// `tcp://127.0.0.1:2950`: clients connect here.
    Tcp(String),
    /// `udp://127.0.0.1:10110`: sentences are sent there.
    Udp(String),
    /// `serial:/dev/ttyS1@115200`: sentences on a serial port.
    Serial(String, u32),
    /// `mavlink-udp://127.0.0.1:14550`: `MAVLink` is sent there.
    MavlinkUdp(String),
    /// `mavlink-serial:/dev/ttyS1@57600`: `MAVLink` on a serial port.
    MavlinkSerial(String, u32),
    /// `px4-udp://127.0.0.1:14540`: what PX4 reads of `MAVLink`.
    Px4Udp(String),
    /// `px4-serial:/dev/ttyS1@57600`: the same on a serial port.
    Px4Serial(String, u32),
    /// `chrony:/run/chrony.rai.sock`: the time of protected epochs for chronyd, which makes the
    /// socket.
    Chrony(PathBuf),
}

impl FromStr for Sink {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        if text == "-" {
            return Ok(Self::Standard);
        }
        if let Some(path) = text.strip_prefix("pty:") {
            return Ok(Self::Pty(path.into()));
        }
        if let Some(path) = text.strip_prefix("chrony:") {
            return Ok(Self::Chrony(path.into()));
        }
        if let Some(address) = text.strip_prefix("tcp://") {
            return Ok(Self::Tcp(address.to_owned()));
        }
        if let Some(address) = text.strip_prefix("udp://") {
            return Ok(Self::Udp(address.to_owned()));
        }
        if let Some(address) = text.strip_prefix("mavlink-udp://") {
            return Ok(Self::MavlinkUdp(address.to_owned()));
        }
        if let Some(address) = text.strip_prefix("px4-udp://") {
            return Ok(Self::Px4Udp(address.to_owned()));
        }
        for (prefix, sink) in [
            ("px4-serial:", Self::Px4Serial as fn(String, u32) -> Self),
            ("mavlink-serial:", Self::MavlinkSerial as fn(String, u32) -> Self),
            ("serial:", Self::Serial as fn(String, u32) -> Self),
        ] {
            if let Some((port, baud)) = text.strip_prefix(prefix).and_then(|port| port.rsplit_once('@')) {
                let baud =
                    baud.parse().with_context(|| format!("the rate behind @ must be a number: `{text}`"))?;
                return Ok(sink(port.to_owned(), baud));
            }
        }
        bail!(
            "an output is -, pty:PATH, serial:PORT@BAUD, tcp://ADDRESS:PORT, udp://ADDRESS:PORT, \
             mavlink-udp://ADDRESS:PORT, mavlink-serial:PORT@BAUD, px4-udp://ADDRESS:PORT, px4-serial:PORT@BAUD or \
             chrony:PATH, not `{text}`"
        )
    }
}

impl Sink {
    /// Returns true if PX4 reads it, for which the module must send messages of its own.
    pub(super) const fn is_px4(&self) -> bool {
        matches!(self, Self::Px4Udp(_) | Self::Px4Serial(..))
    }
}

impl fmt::Display for Sink {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Standard => f.write_str("standard output"),
            Self::Pty(path) => write!(f, "pty:{}", path.display()),
            Self::Chrony(path) => write!(f, "chrony:{}", path.display()),
            Self::Tcp(address) => write!(f, "tcp://{address}"),
            Self::Udp(address) => write!(f, "udp://{address}"),
            Self::Serial(port, baud) => write!(f, "serial:{port}@{baud}"),
            Self::MavlinkUdp(address) => write!(f, "mavlink-udp://{address}"),
            Self::MavlinkSerial(port, baud) => write!(f, "mavlink-serial:{port}@{baud}"),
            Self::Px4Udp(address) => write!(f, "px4-udp://{address}"),
            Self::Px4Serial(port, baud) => write!(f, "px4-serial:{port}@{baud}"),
        }
    }
}

/// Opens a consumer. The clients of a TCP port are served once their thread is started.
///
/// # Errors
/// If its address or port cannot be used.
pub(super) fn open(
    sink: &Sink,
    outbox: &mut Outbox,
    inbox: &Arc<Inbox>,
    clients: &mut Clients,
    is_file: bool,
) -> Result<()> {
    // The sentences of a file all reach their consumer, or the service fails.
    let is_live = !is_file;
    match sink {
        Sink::Standard => spawn(outbox, Kind::Nmea, io::stdout()),
        Sink::Serial(port, baud) => spawn(outbox, Kind::Nmea, SerialPort::open(port, *baud, is_live)?),
        Sink::Udp(address) => spawn(outbox, Kind::Nmea, Datagrams::to(address)?),
        Sink::MavlinkUdp(address) => spawn(outbox, Kind::Mavlink, Datagrams::to(address)?),
        Sink::MavlinkSerial(port, baud) => {
            spawn(outbox, Kind::Mavlink, SerialPort::open(port, *baud, is_live)?);
        }
        Sink::Px4Udp(address) => spawn(outbox, Kind::Mavlink, Px4::new(Datagrams::to(address)?)),
        Sink::Px4Serial(port, baud) => {
            spawn(outbox, Kind::Mavlink, Px4::new(SerialPort::open(port, *baud, is_live)?));
        }
        Sink::Tcp(address) => clients.listen(address)?,
        Sink::Pty(path) => terminal(path, outbox, inbox)?,
        // It gets no messages: `time_server` sends it the time of epochs.
        Sink::Chrony(_) if cfg!(unix) => {}
        Sink::Chrony(_) => bail!("chrony has its socket on Unix only"),
    }
    Ok(())
}

/// Adds a consumer that a thread writes to until it fails.
fn spawn(outbox: &mut Outbox, kind: Kind, writer: impl Write + Send + 'static) {
    outbox.add(kind, move |messages| write_all(writer, messages));
}

fn write_all(mut writer: impl Write, messages: &Receiver<Arc<[u8]>>) -> io::Result<()> {
    // An error ends the thread, and the queue's other side finds its receiver gone.
    while let Ok(message) = messages.recv() {
        writer.write_all(&message)?;
        writer.flush()?;
    }
    Ok(())
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::fs::OpenOptions;
    use std::sync::mpsc::Sender;
    use std::time::Duration;

    use super::*;

    /// Longest wait for a thread.
    const PATIENCE: Duration = Duration::from_secs(5);

    /// A reader that hands on what it is sent.
    struct Reader(Sender<Vec<u8>>);

    impl Write for Reader {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.send(bytes.to_vec()).map_err(io::Error::other)?;
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    /// A full disk, which reports that its writer gave up.
    struct FullDisk(std::fs::File, Sender<()>);

    impl Write for FullDisk {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.write(bytes)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Drop for FullDisk {
        fn drop(&mut self) {
            let _ = self.1.send(());
        }
    }

    #[test]
    fn outputs_are_read_or_refused_with_their_form() {
        for text in [
            "pty:/x",
            "tcp://a:1",
            "udp://a:1",
            "serial:/dev/x@9600",
            "mavlink-udp://a:1",
            "mavlink-serial:/dev/x@57600",
            "chrony:/run/x",
        ] {
            assert_eq!(text.parse::<Sink>().unwrap().to_string(), text);
        }
        for wrong in ["", "serial:/dev/x", "serial:/dev/x@fast", "http://x"] {
            assert!(wrong.parse::<Sink>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn full_disk_costs_no_other_consumer_a_sentence() {
        let mut outbox = Outbox::new(None);
        let (receive, heard) = std::sync::mpsc::channel();
        let full = OpenOptions::new().write(true).open("/dev/full").expect("the device of Linux");
        let (give_up, gave_up) = std::sync::mpsc::channel();
        spawn(&mut outbox, Kind::Nmea, FullDisk(full, give_up));
        spawn(&mut outbox, Kind::Nmea, Reader(receive));
        outbox.send(b"$GPRMC\r\n");
        assert_eq!(heard.recv_timeout(PATIENCE).expect("the sentence"), b"$GPRMC\r\n");
        gave_up.recv_timeout(PATIENCE).expect("the end of the writer");
        for _ in 0..2 * crate::run::outbox::QUEUE {
            outbox.send(b"$GPRMC\r\n");
            assert_eq!(heard.recv_timeout(PATIENCE).expect("the sentence"), b"$GPRMC\r\n");
        }
        assert_eq!(outbox.lost(), 0);
    }
}
