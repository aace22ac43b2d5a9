//! Consumers of the sentences: standard output, a pseudo-terminal, TCP clients, UDP.
//!
//! Each has a thread and a bounded queue; all TCP clients share one thread (`clients`). A
//! pseudo-terminal that nobody reads loses sentences and nothing else. A serial port that is gone, and
//! an address that cannot be reached any more, are tried again.

use std::fmt;
use std::io::{self, Write};
use std::net::UdpSocket;
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, bail};

use super::clients::Clients;
use super::inbox::Inbox;
use super::outbox::{Kind, Outbox};
use super::px4::Px4;
use crate::run::words::say;
use crate::source::{Pause, open_serial};

/// Longest time that a serial port may take to send a message.
const PATIENCE: Duration = Duration::from_secs(5);

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

/// A serial port, which is opened again if it fails. Until then its messages are lost.
struct SerialPort {
    name: String,
    baud: u32,
    port: Option<Box<dyn Write + Send>>,
    pause: Pause,
    /// When it is opened again.
    due: Instant,
    /// True if it is opened again.
    is_live: bool,
}

impl SerialPort {
    fn open(name: &str, baud: u32, is_live: bool) -> Result<Self> {
        let port = open_serial(name, baud, PATIENCE)?;
        let (name, pause) = (name.to_owned(), Pause::RECEIVER);
        Ok(Self { name, baud, port: Some(Box::new(port)), pause, due: Instant::now(), is_live })
    }

    fn open_again(&mut self) {
        if let Ok(port) = open_serial(&self.name, self.baud, PATIENCE) {
            say!("{}: open again", self.name);
            self.port = Some(Box::new(port));
        } else {
            self.wait();
        }
    }

    fn wait(&mut self) {
        self.due = Instant::now() + self.pause.next();
        self.pause.double();
    }
}

impl Write for SerialPort {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.port.is_none() && Instant::now() >= self.due {
            self.open_again();
        }
        let Some(port) = &mut self.port else { return Ok(bytes.len()) };
        match port.write_all(bytes).and_then(|()| port.flush()) {
            Ok(()) => self.pause.reset(),
            Err(error) if !self.is_live => return Err(error),
            Err(error) => {
                say!("{}: {error}; it is opened again", self.name);
                self.port = None;
                self.wait();
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// One datagram for each message. Nobody has to listen.
struct Datagrams {
    address: String,
    socket: UdpSocket,
    /// When the socket may be connected again, and the pause before the time after that. A name is
    /// looked up each time, which may take long.
    due: Instant,
    pause: Pause,
    is_reported: bool,
}

impl Datagrams {
    fn to(address: &str) -> Result<Self> {
        let socket = Self::connect(address).with_context(|| format!("`{address}` must be ADDRESS:PORT"))?;
        let (address, due) = (address.to_owned(), Instant::now());
        Ok(Self { address, socket, due, pause: Pause::ADDRESS, is_reported: false })
    }

    fn connect(address: &str) -> io::Result<UdpSocket> {
        let any = if address.starts_with('[') { "[::]:0" } else { "0.0.0.0:0" };
        let socket = UdpSocket::bind(any)?;
        socket.connect(address)?;
        Ok(socket)
    }

    /// Connects again: the address of this computer, or that of the name, may be another one now.
    fn connect_again(&mut self, error: &io::Error) {
        if !std::mem::replace(&mut self.is_reported, true) {
            say!("{}: {error}", self.address);
        }
        if Instant::now() >= self.due {
            if let Ok(socket) = Self::connect(&self.address) {
                self.socket = socket;
            }
            self.due = Instant::now() + self.pause.next();
            self.pause.double();
        }
    }
}

impl Write for Datagrams {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.socket.send(bytes) {
            Ok(_) => {
                self.is_reported = false;
                self.pause.reset();
            }
            // Nobody listens there yet.
            Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => {}
            Err(error) => self.connect_again(&error),
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(unix)]
fn terminal(path: &std::path::Path, outbox: &mut Outbox, inbox: &Arc<Inbox>) -> Result<()> {
    use std::fs::File;
    use std::io::Read as _;
    use std::os::fd::AsFd as _;

    use nix::fcntl::{FcntlArg, OFlag, fcntl};
    use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
    use nix::pty::openpty;
    use nix::sys::termios::{SetArg, cfmakeraw, tcgetattr, tcsetattr};

    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    }
    let pair = openpty(None, None)?;
    let mut settings = tcgetattr(&pair.slave)?;
    cfmakeraw(&mut settings);
    tcsetattr(&pair.slave, SetArg::TCSANOW, &settings)?;
    admit_the_group(&pair.slave);
    let name = nix::unistd::ttyname(&pair.slave)?;
    match std::fs::symlink_metadata(path) {
        Ok(there) if there.file_type().is_symlink() => std::fs::remove_file(path)?,
        Ok(_) => bail!("{} exists and is no link: remove it, or name another path", path.display()),
        Err(_) => {}
    }
    std::os::unix::fs::symlink(&name, path)
        .with_context(|| format!("cannot make the link {}", path.display()))?;
    fcntl(pair.master.as_fd(), FcntlArg::F_SETFL(OFlag::O_NONBLOCK))?;
    let master = File::from(pair.master);
    spawn(outbox, Kind::Nmea, Terminal(master.try_clone()?));
    let (inbox, mut commands, slave) = (Arc::clone(inbox), master, pair.slave);
    thread::spawn(move || {
        // While this end is open, the terminal exists without a reader.
        let _slave = slave;
        let mut bytes = [0; 256];
        loop {
            let mut ready = [PollFd::new(commands.as_fd(), PollFlags::POLLIN)];
            // An error returns at once, and the read then has it too.
            let _ = poll(&mut ready, PollTimeout::NONE);
            match commands.read(&mut bytes) {
                Ok(count) => inbox.push_commands(bytes.get(..count).unwrap_or_default()),
                Err(error)
                    if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted) => {}
                Err(_) => return,
            }
        }
    });
    Ok(())
}

/// Lets the group of serial ports read and write the terminal, if there is one and this user may say
/// so; otherwise the group that the system gives it.
#[cfg(unix)]
fn admit_the_group(slave: &std::os::fd::OwnedFd) {
    use nix::sys::stat::{Mode, fchmod};
    use nix::unistd::{Group, fchown};

    if let Ok(Some(group)) = Group::from_name("dialout") {
        let _ = fchown(slave, None, Some(group.gid));
    }
    // A terminal that stays closed to others is still one for this user.
    let _ = fchmod(slave, Mode::from_bits_truncate(0o660));
}

#[cfg(not(unix))]
fn terminal(_: &std::path::Path, _: &mut Outbox, _: &Arc<Inbox>) -> Result<()> {
    bail!("pseudo-terminals exist on Unix only: use tcp:// or udp://")
}

/// The side of a pseudo-terminal to which the service writes. Sentences without a reader are lost.
#[cfg(unix)]
struct Terminal(std::fs::File);

#[cfg(unix)]
impl Write for Terminal {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.0.write(bytes) {
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => Ok(bytes.len()),
            other => other,
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::fs::OpenOptions;
    use std::sync::mpsc::Sender;

    use super::*;

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
    fn terminal_is_open_to_its_group() {
        use std::os::unix::fs::MetadataExt as _;

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("nmea");
        let inbox = Arc::new(Inbox::new(super::super::clock::Clock::of_the_computer(), false));
        terminal(&path, &mut Outbox::new(None), &inbox).unwrap();
        assert_eq!(std::fs::metadata(&path).unwrap().mode() & 0o777, 0o660);
    }

    /// Plugs a port in behind a link: a pseudo-terminal, whose other end is returned.
    fn plug(link: &std::path::Path) -> nix::pty::OpenptyResult {
        let ends = nix::pty::openpty(None, None).unwrap();
        let _ = std::fs::remove_file(link);
        std::os::unix::fs::symlink(nix::unistd::ttyname(&ends.slave).unwrap(), link).unwrap();
        ends
    }

    #[test]
    fn port_that_was_gone_is_written_again() {
        use std::io::Read as _;

        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("tty");
        let ends = plug(&link);
        let mut port = SerialPort::open(link.to_str().unwrap(), 57_600, true).unwrap();
        drop(ends);
        while port.port.is_some() {
            port.write_all(b"lost").unwrap();
        }
        let ends = plug(&link);
        let start = Instant::now();
        while port.port.is_none() {
            assert!(start.elapsed() < PATIENCE, "it is not opened again");
            port.write_all(b"heard").unwrap();
            thread::sleep(Duration::from_millis(10));
        }
        let mut heard = [0; 5];
        std::fs::File::from(ends.master).read_exact(&mut heard).unwrap();
        assert_eq!(&heard, b"heard");
        drop(ends.slave);
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
        for _ in 0..2 * super::super::outbox::QUEUE {
            outbox.send(b"$GPRMC\r\n");
            assert_eq!(heard.recv_timeout(PATIENCE).expect("the sentence"), b"$GPRMC\r\n");
        }
        assert_eq!(outbox.lost(), 0);
    }
}
