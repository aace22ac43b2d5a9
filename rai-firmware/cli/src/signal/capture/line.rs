//! Sources of a capture's bytes: a file, standard input, a TCP server, a serial port.
//!
//! A file has an end. A server and a port are read for a time, and until they have been silent for
//! [`SILENCE`].

use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Error, ErrorKind, Read};
use std::net::TcpStream;
use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};
use flate2::read::MultiGzDecoder;

use crate::serial;
use crate::signal::recording::packed_by;

/// Longest silence of a live line.
const SILENCE: Duration = Duration::from_secs(10);

/// Extra time for which a line is read, so that the first epoch comes within it.
const GRACE: Duration = Duration::from_secs(2);

/// Longest time for which a source is read, s: a hundred days.
const LONGEST_S: f64 = 8.64e6;

/// Bit rate without another choice: that of the module's own port.
const BIT_RATE: &str = "115200";

/// Bytes of a source, unpacked.
pub struct Bytes {
    /// First bytes, which identify the kind of the source.
    head: Vec<u8>,
    read: usize,
    rest: Box<dyn Read + Send>,
}

impl Bytes {
    /// Opens a source: a path, `-`, `tcp://host:port`, `serial:path` or `serial:path@rate`. A
    /// source without an end of its own ends after `limit_s` seconds.
    ///
    /// # Errors
    /// The source cannot be opened or read, sends nothing, is packed by something other than gzip,
    /// or needs a limit.
    pub fn open(name: &str, limit_s: f64) -> Result<Self> {
        let limit =
            limit_s.is_finite().then(|| Duration::from_secs_f64(limit_s.clamp(0.0, LONGEST_S)) + GRACE);
        if name == "-" {
            return Self::unpacked(Line::new(spawn(std::io::stdin()), limit, None));
        }
        if let Some(address) = name.strip_prefix("tcp://") {
            check_limit(limit)?;
            let stream = TcpStream::connect(address).context("does not answer")?;
            return Self::unpacked(Line::new(spawn(stream), limit, Some(SILENCE)));
        }
        let port = name.strip_prefix("serial:");
        let (path, rate) =
            port.map_or((name, BIT_RATE), |port| port.rsplit_once('@').unwrap_or((port, BIT_RATE)));
        if port.is_some() || serial::is_port(Path::new(path)) {
            check_limit(limit)?;
            let rate = rate.parse().with_context(|| format!("{rate} is no bit rate"))?;
            let (port, _) = serial::listen(Path::new(path), rate)?;
            return Self::unpacked(Line::new(spawn(port), limit, Some(SILENCE)));
        }
        let path = Path::new(path);
        ensure!(!path.is_dir(), "cannot be read: it is a folder");
        Self::unpacked(File::open(path).context("cannot be read")?)
    }

    /// Unpacks a source by its content.
    fn unpacked(mut packed: impl Read + Send + 'static) -> Result<Self> {
        let head = head(&mut packed)?;
        if let Some((packer, command)) = packed_by(&head) {
            bail!("is packed by {packer}: unpack it first, `{command}`");
        }
        if head.starts_with(&[0x1f, 0x8b]) {
            let packed = BufReader::new(Cursor::new(head).chain(packed));
            let mut rest: Box<dyn Read + Send> = Box::new(Gzip(MultiGzDecoder::new(packed)));
            return Ok(Self { head: self::head(&mut rest)?, read: 0, rest });
        }
        Ok(Self { head, read: 0, rest: Box::new(packed) })
    }

    /// Returns the first bytes, at most [`HEAD`] of them.
    pub fn head(&self) -> &[u8] {
        &self.head
    }
}

/// Number of bytes that identify a source.
const HEAD: usize = 65_536;

fn head(source: &mut impl Read) -> Result<Vec<u8>> {
    let mut head = Vec::new();
    source.take(HEAD as u64).read_to_end(&mut head).context("cannot be read")?;
    Ok(head)
}

impl Read for Bytes {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let mut ahead = self.head.get(self.read..).unwrap_or_default();
        if ahead.is_empty() {
            return self.rest.read(into);
        }
        let count = ahead.read(into)?;
        self.read += count;
        Ok(count)
    }
}

/// Gzip reader whose errors state that the source is gzip.
struct Gzip<R>(MultiGzDecoder<R>);

impl<R: BufRead> Read for Gzip<R> {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        self.0.read(into).map_err(|error| Error::new(error.kind(), format!("is damaged gzip: {error}")))
    }
}

fn check_limit(limit: Option<Duration>) -> Result<()> {
    ensure!(limit.is_some(), "does not end by itself: say with --to how many seconds of it to take");
    Ok(())
}

/// Reads in a separate thread, because a read waits as long as no byte comes.
fn spawn(mut source: impl Read + Send + 'static) -> Receiver<std::io::Result<Vec<u8>>> {
    let (sender, receiver) = sync_channel(64);
    thread::spawn(move || {
        let mut buffer = vec![0; 65_536];
        loop {
            let read = source.read(&mut buffer).map(|count| buffer.get(..count).unwrap_or_default().to_vec());
            let is_end = read.as_ref().map_or(true, Vec::is_empty);
            if sender.send(read).is_err() || is_end {
                return;
            }
        }
    });
    receiver
}

/// Line that is read until its end, until the limit after the first byte, or until a silence.
struct Line {
    chunks: Receiver<std::io::Result<Vec<u8>>>,
    limit: Option<Duration>,
    silence: Option<Duration>,
    end: Option<Instant>,
    has_ended: bool,
    /// Bytes that came and were not requested yet.
    chunk: Cursor<Vec<u8>>,
}

impl Line {
    fn new(
        chunks: Receiver<std::io::Result<Vec<u8>>>,
        limit: Option<Duration>,
        silence: Option<Duration>,
    ) -> Self {
        Self { chunks, limit, silence, end: None, has_ended: false, chunk: Cursor::default() }
    }

    /// Returns the next bytes; empty at the end.
    fn next(&mut self) -> std::io::Result<Vec<u8>> {
        let left = self.end.map(|end| end.saturating_duration_since(Instant::now()));
        if self.has_ended || left == Some(Duration::ZERO) {
            return Ok(Vec::new());
        }
        let patience = left.into_iter().chain(self.silence).min().unwrap_or(Duration::MAX);
        match self.chunks.recv_timeout(patience) {
            Ok(read) => {
                self.end =
                    self.end.or_else(|| self.limit.and_then(|limit| Instant::now().checked_add(limit)));
                read
            }
            Err(RecvTimeoutError::Timeout) if self.end.is_none() => {
                let silent = format!("sends nothing: not a byte in {} s", SILENCE.as_secs());
                Err(Error::new(ErrorKind::TimedOut, silent))
            }
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => Ok(Vec::new()),
        }
    }
}

impl Read for Line {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let count = self.chunk.read(into)?;
        if count > 0 || into.is_empty() {
            return Ok(count);
        }
        self.chunk = Cursor::new(self.next()?);
        self.has_ended |= self.chunk.get_ref().is_empty();
        self.chunk.read(into)
    }
}
