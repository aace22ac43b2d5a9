//! Sources of a capture's bytes: a file, standard input, a TCP server, a serial port.
//!
//! A file has an end. A server and a port are read for a time, and until they have been silent for
//! [`SILENCE`]. A gzip file that is cut off is read as far as it goes, and [`Cut`] has its name.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Error, ErrorKind, Read};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};
use flate2::read::MultiGzDecoder;

use crate::signal::recording::packed_by;
use crate::source::Source;

/// Longest silence of a live line.
const SILENCE: Duration = Duration::from_secs(10);

/// Extra time for which a line is read, so that the first epoch comes within it.
const GRACE: Duration = Duration::from_secs(2);

/// Longest time for which a source is read, s: a hundred days.
const LONGEST_S: f64 = 8.64e6;

/// Bytes of a source, unpacked.
pub struct Bytes {
    /// First bytes, which identify the kind of the source.
    head: Vec<u8>,
    read: usize,
    rest: Box<dyn Read + Send>,
    cut: Cut,
}

/// Names of the gzip files of a source that end before their end, so far.
#[derive(Clone, Debug, Default)]
pub struct Cut(Arc<Mutex<Vec<String>>>);

impl Cut {
    fn note(&self, name: &str) {
        let mut names = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if names.last().is_none_or(|last| last != name) {
            names.push(name.to_owned());
        }
    }

    /// Returns what is to be said of the files; `None` if all are whole.
    pub fn words(&self) -> Option<String> {
        let names = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let verb = if names.len() == 1 { "is" } else { "are" };
        let words = || format!("{} {verb} cut off, and read as far as the gzip data goes", names.join(", "));
        (!names.is_empty()).then(words)
    }
}

impl Bytes {
    /// Opens a [`Source`] by its name. One without an end of its own ends after `limit_s` seconds.
    ///
    /// # Errors
    /// The source cannot be opened or read, sends nothing, is packed by something other than gzip,
    /// or needs a limit.
    pub fn open(name: &str, limit_s: f64) -> Result<Self> {
        Self::open_with(name, limit_s, Cut::default())
    }

    fn open_with(name: &str, limit_s: f64, cut: Cut) -> Result<Self> {
        let limit =
            limit_s.is_finite().then(|| Duration::from_secs_f64(limit_s.clamp(0.0, LONGEST_S)) + GRACE);
        match name.parse()? {
            Source::Standard => {
                Self::unpacked(Line::new(spawn(std::io::stdin()), limit, None), "standard input", cut)
            }
            Source::File(path) => {
                ensure!(!path.is_dir(), "cannot be read: it is a folder");
                Self::unpacked(File::open(path).context("cannot be read")?, name, cut)
            }
            line => {
                ensure!(
                    limit.is_some(),
                    "does not end by itself: say with --to how many seconds of it to take"
                );
                Self::unpacked(Line::new(spawn(listen(&line)?), limit, Some(SILENCE)), name, cut)
            }
        }
    }

    /// Opens files as one source, in this order. One may end inside a frame that the next one
    /// continues.
    ///
    /// # Errors
    /// The first file cannot be opened; the others are opened when they are read.
    pub fn of_files(names: &[String]) -> Result<Self> {
        let cut = Cut::default();
        let mut series = Series { names: names.iter().cloned().collect(), open: None, cut: cut.clone() };
        Ok(Self { head: head(&mut series)?, read: 0, rest: Box::new(series), cut })
    }

    /// Unpacks a source by its content.
    fn unpacked(mut packed: impl Read + Send + 'static, name: &str, cut: Cut) -> Result<Self> {
        let head = head(&mut packed)?;
        if let Some((packer, command)) = packed_by(&head) {
            bail!("is packed by {packer}: unpack it first, `{command}`");
        }
        if head.starts_with(&[0x1f, 0x8b]) {
            let packed = BufReader::new(Cursor::new(head).chain(packed));
            let gzip = Gzip { packed: MultiGzDecoder::new(packed), name: name.to_owned(), cut: cut.clone() };
            let mut rest: Box<dyn Read + Send> = Box::new(gzip);
            return Ok(Self { head: self::head(&mut rest)?, read: 0, rest, cut });
        }
        Ok(Self { head, read: 0, rest: Box::new(packed), cut })
    }

    /// Returns the names of the files that are cut off, which grow while the source is read.
    pub fn cut(&self) -> Cut {
        self.cut.clone()
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

/// Gzip reader whose errors state that the source is gzip. Data that end too early are no error.
struct Gzip<R> {
    packed: MultiGzDecoder<R>,
    name: String,
    cut: Cut,
}

impl<R: BufRead> Read for Gzip<R> {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        match self.packed.read(into) {
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => {
                self.cut.note(&self.name);
                Ok(0)
            }
            read => read.map_err(|error| Error::new(error.kind(), format!("is damaged gzip: {error}"))),
        }
    }
}

/// Files that are read one after another.
struct Series {
    names: VecDeque<String>,
    open: Option<Bytes>,
    cut: Cut,
}

impl Read for Series {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        loop {
            if let Some(open) = &mut self.open {
                let count = open.read(into)?;
                if count > 0 || into.is_empty() {
                    return Ok(count);
                }
            }
            let Some(name) = self.names.pop_front() else { return Ok(0) };
            let open = Bytes::open_with(&name, f64::INFINITY, self.cut.clone());
            self.open = Some(open.map_err(|error| Error::other(format!("{name}: {error:#}")))?);
        }
    }
}

/// Opens a server or a serial port.
#[cfg(feature = "commands")]
fn listen(line: &Source) -> Result<Box<dyn Read + Send>> {
    Ok(crate::source::listen(line)?.0)
}

/// Opens no line: a replay without the command reads files.
#[cfg(not(feature = "commands"))]
fn listen(_: &Source) -> Result<std::io::Empty> {
    bail!("cannot be read here: give a file")
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
