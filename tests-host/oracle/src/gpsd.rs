//! A real gpsd that reads our sentences: an independent check of the module's output.
//!
//! The daemon connects to a port of ours for the sentences, or reads a terminal, as a serial line,
//! and serves its JSON on a port. Every wait has a deadline, and the daemon is killed when the
//! [`Gpsd`] is dropped.

use std::ffi::{OsStr, OsString};
use std::io::{self, ErrorKind, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use serde_json::Value;

/// Time within which gpsd must start and connect.
const START: Duration = Duration::from_secs(10);

/// Time between two attempts at a port that is not ready.
const PAUSE: Duration = Duration::from_millis(20);

/// A running gpsd, fed with sentences.
pub struct Gpsd {
    daemon: Daemon,
    /// The line that we feed; `None` if another program does.
    sentences: Option<TcpStream>,
    json: TcpStream,
    unread: Vec<u8>,
}

/// A process that is killed when dropped, even if the start fails half-way.
pub(crate) struct Daemon(pub(crate) Child);

impl Drop for Daemon {
    fn drop(&mut self) {
        // It does not matter if the daemon has already ended.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Gpsd {
    /// Starts gpsd; returns `None` and reports a skip if it is not installed.
    ///
    /// # Errors
    /// If it is installed and does not start or connect within ten seconds.
    pub fn start_or_skip() -> Result<Option<Self>> {
        Self::launched_by(Command::new("gpsd"))
    }

    /// Starts gpsd as [`Self::start_or_skip`] does, with shared memory that only processes in its
    /// namespace can see. Only the superuser can do this.
    ///
    /// # Errors
    /// As [`Self::start_or_skip`].
    pub fn start_apart_or_skip() -> Result<Option<Self>> {
        Self::launched_by(apart())
    }

    /// Starts gpsd on a terminal that another program writes to.
    ///
    /// # Errors
    /// As [`Self::start_or_skip`].
    pub fn on_terminal_or_skip(terminal: &Path) -> Result<Option<Self>> {
        Self::reading(terminal.as_os_str(), Command::new("gpsd"))
    }

    /// Starts gpsd on a port that another program serves, with its memory apart as
    /// [`Self::start_apart_or_skip`] does.
    ///
    /// # Errors
    /// As [`Self::start_or_skip`].
    pub fn on_port_apart_or_skip(address: SocketAddr) -> Result<Option<Self>> {
        Self::reading(OsStr::new(&format!("tcp://{address}")), apart())
    }

    /// Starts gpsd on a UDP port to which another program sends.
    ///
    /// # Errors
    /// As [`Self::start_or_skip`].
    pub fn on_datagrams_or_skip(address: SocketAddr) -> Result<Option<Self>> {
        Self::reading(OsStr::new(&format!("udp://{address}")), Command::new("gpsd"))
    }

    fn reading(source: &OsStr, command: Command) -> Result<Option<Self>> {
        let served = free_port()?;
        let Some(daemon) = launch(command, source, served)? else {
            rig::skip::say("gpsd (apt-get install gpsd)");
            return Ok(None);
        };
        Self::watching(daemon, None, served).map(Some)
    }

    /// Returns the process id.
    pub(crate) fn process(&self) -> u32 {
        self.daemon.0.id()
    }

    fn launched_by(command: Command) -> Result<Option<Self>> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
        let served = free_port()?;
        let source = format!("tcp://127.0.0.1:{}", listener.local_addr()?.port());
        let Some(daemon) = launch(command, OsStr::new(&source), served)? else {
            rig::skip::say("gpsd (apt-get install gpsd)");
            return Ok(None);
        };
        let sentences = accept(&listener)?;
        Self::watching(daemon, Some(sentences), served).map(Some)
    }

    /// Connects to the daemon's port and asks for its objects.
    fn watching(daemon: Daemon, sentences: Option<TcpStream>, served: u16) -> Result<Self> {
        let mut json = connect(served)?;
        json.write_all(b"?WATCH={\"enable\":true,\"json\":true};\n")?;
        json.set_read_timeout(Some(PAUSE))?;
        let mut gpsd = Self { daemon, sentences, json, unread: Vec::new() };
        gpsd.wait_for(START, |object| object["class"] == "WATCH")?;
        Ok(gpsd)
    }

    /// Sends sentences of a module.
    ///
    /// # Errors
    /// If gpsd has closed the connection, or reads a terminal.
    pub fn feed(&mut self, sentences: &[u8]) -> Result<()> {
        let line = self.sentences.as_mut().context("another program feeds this gpsd")?;
        line.write_all(sentences).context("gpsd closed the connection for the sentences")
    }

    /// Returns the first object that satisfies `wanted`; earlier ones are dropped.
    ///
    /// # Errors
    /// If none came in time, with the last few that did come.
    pub fn wait_for(&mut self, within: Duration, wanted: impl Fn(&Value) -> bool) -> Result<Value> {
        let deadline = Instant::now() + within;
        let mut seen = Vec::new();
        while Instant::now() < deadline {
            for object in self.objects()? {
                if wanted(&object) {
                    return Ok(object);
                }
                seen.push(object.to_string());
            }
        }
        let last = seen.split_off(seen.len().saturating_sub(5));
        bail!(
            "gpsd (process {}) did not say it within {within:?}; its last words: {last:#?}",
            self.daemon.0.id()
        )
    }

    /// Returns gpsd's objects since the last call, after waiting briefly for more.
    ///
    /// # Errors
    /// If gpsd has closed the connection or does not send JSON.
    pub fn objects(&mut self) -> Result<Vec<Value>> {
        let mut chunk = [0; 4096];
        match self.json.read(&mut chunk) {
            Ok(0) => bail!("gpsd closed the connection"),
            Ok(count) => self.unread.extend_from_slice(&chunk[..count]),
            Err(error) if is_not_yet(&error) => {}
            Err(error) => return Err(error.into()),
        }
        let complete = self.unread.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        let lines: Vec<u8> = self.unread.drain(..complete).collect();
        lines
            .split(|byte| *byte == b'\n')
            .filter(|line| !line.trim_ascii().is_empty())
            .map(|line| serde_json::from_slice(line).context("gpsd must send JSON"))
            .collect()
    }
}

/// Returns the command of a gpsd whose shared memory only processes in its namespace can see.
fn apart() -> Command {
    let mut command = Command::new("unshare");
    command.args(["--ipc", "gpsd"]);
    command
}

fn is_not_yet(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut)
}

/// Returns a port that was free a moment ago, because gpsd cannot be asked for the port it took.
pub(crate) fn free_port() -> io::Result<u16> {
    Ok(TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?.local_addr()?.port())
}

/// Launches the program; returns `None` if it does not exist.
fn launch(mut command: Command, source: &OsStr, served: u16) -> Result<Option<Daemon>> {
    // gpsd runs in the foreground, reads without a client and serves on its own port.
    command.args(["-N", "-n", "-S", &served.to_string()]).arg(source);
    command.env("PATH", path_of_daemons()?);
    match command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn() {
        Ok(child) => Ok(Some(Daemon(child))),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error).context("starting gpsd"),
    }
}

/// Returns the search path with the folders in which Debian installs daemons; the path of an
/// ordinary user lacks them.
pub(crate) fn path_of_daemons() -> Result<OsString> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let with_sbin = std::env::split_paths(&path).chain(["/usr/sbin".into(), "/usr/local/sbin".into()]);
    Ok(std::env::join_paths(with_sbin)?)
}

fn accept(listener: &TcpListener) -> Result<TcpStream> {
    listener.set_nonblocking(true)?;
    let stream = retry(|| listener.accept().map(|(stream, _)| stream))
        .context("gpsd did not connect for the sentences")?;
    stream.set_nonblocking(false)?;
    stream.set_write_timeout(Some(START))?;
    Ok(stream)
}

fn connect(port: u16) -> Result<TcpStream> {
    retry(|| TcpStream::connect((Ipv4Addr::LOCALHOST, port))).context("gpsd does not serve its JSON")
}

/// Repeats an attempt until it succeeds, for as long as gpsd may take to start.
fn retry<T>(mut attempt: impl FnMut() -> io::Result<T>) -> io::Result<T> {
    let deadline = Instant::now() + START;
    loop {
        match attempt() {
            Err(_) if Instant::now() < deadline => std::thread::sleep(PAUSE),
            outcome => return outcome,
        }
    }
}
