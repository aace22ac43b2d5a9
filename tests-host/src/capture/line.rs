//! Where the bytes of a capture come from: a file, standard input, a TCP server, a serial port.
//!
//! A file has an end. A server and a port need not: they are listened to for a time, and until they have been silent for
//! [`SILENCE`].

use std::fs::File;
use std::io::Read;
use std::net::TcpStream;
use std::path::Path;
use std::process::Command;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};
use flate2::read::MultiGzDecoder;

/// Longest silence of a line that goes on.
const SILENCE: Duration = Duration::from_secs(10);

/// How much longer a line is listened to than epochs are wanted: the first one comes within it.
const GRACE: Duration = Duration::from_secs(2);

/// Longest time that anything is listened to: a hundred days.
const LONGEST_S: f64 = 8.64e6;

/// Bit rate where none is said: what the module's own port has.
const BIT_RATE: &str = "115200";

/// Reads all of a source: a path, `-`, `tcp://host:port`, `serial:path` or `serial:path@rate`. What has no end of its
/// own is read for `limit_s` seconds.
///
/// # Errors
/// What cannot be opened or read, or says nothing; a source without an end where there is no limit.
pub(super) fn read(name: &str, limit_s: f64) -> Result<Vec<u8>> {
    let limit = limit_s.is_finite().then(|| Duration::from_secs_f64(limit_s.clamp(0.0, LONGEST_S)) + GRACE);
    let bytes = if name == "-" {
        listen(&spawn(std::io::stdin()), limit, None)?
    } else if let Some(address) = name.strip_prefix("tcp://") {
        check_limit(limit)?;
        let stream = TcpStream::connect(address).context("does not answer")?;
        listen(&spawn(stream), limit, Some(SILENCE))?
    } else if let Some(port) = name.strip_prefix("serial:") {
        let (path, rate) = port.rsplit_once('@').unwrap_or((port, BIT_RATE));
        check_limit(limit)?;
        listen(&spawn(serial(Path::new(path), rate)?), limit, Some(SILENCE))?
    } else if is_terminal(Path::new(name)) {
        check_limit(limit)?;
        listen(&spawn(serial(Path::new(name), BIT_RATE)?), limit, Some(SILENCE))?
    } else {
        std::fs::read(name).context("cannot be read")?
    };
    unpack(bytes)
}

fn check_limit(limit: Option<Duration>) -> Result<()> {
    ensure!(limit.is_some(), "does not end by itself: say with --to how many seconds of it to take");
    Ok(())
}

/// Whether a path is that of a device that sends characters.
fn is_terminal(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt as _;
    let is_null = path == Path::new("/dev/null");
    !is_null && path.metadata().is_ok_and(|metadata| metadata.file_type().is_char_device())
}

/// A serial port, set to a bit rate.
fn serial(path: &Path, rate: &str) -> Result<File> {
    let port = File::open(path).context("cannot be opened")?;
    if is_terminal(path) {
        let status = Command::new("stty")
            .args([rate, "raw", "-echo", "-crtscts"])
            .stdin(port.try_clone()?)
            .status()
            .context("stty cannot be run")?;
        ensure!(status.success(), "is no serial port of {rate} bit/s");
    }
    Ok(port)
}

/// Reads in a thread of its own, since a read waits for as long as nothing comes.
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

/// All that comes until the end, until the limit after the first byte, or until a silence.
fn listen(
    chunks: &Receiver<std::io::Result<Vec<u8>>>,
    limit: Option<Duration>,
    silence: Option<Duration>,
) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut end: Option<Instant> = None;
    loop {
        let left = end.map(|end| end.saturating_duration_since(Instant::now()));
        if left == Some(Duration::ZERO) {
            return Ok(bytes);
        }
        let patience = left.into_iter().chain(silence).min().unwrap_or(Duration::MAX);
        let read = match chunks.recv_timeout(patience) {
            Ok(read) => read.context("cannot be read")?,
            Err(RecvTimeoutError::Timeout) if bytes.is_empty() => {
                bail!("sends nothing: not a byte in {} s", SILENCE.as_secs())
            }
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => return Ok(bytes),
        };
        if read.is_empty() {
            return Ok(bytes);
        }
        end = end.or_else(|| limit.and_then(|limit| Instant::now().checked_add(limit)));
        bytes.extend(read);
    }
}

/// The bytes in whatever they are wrapped in, told by content.
pub(super) fn unpack(bytes: Vec<u8>) -> Result<Vec<u8>> {
    match bytes.as_slice() {
        [0x1f, 0x8b, ..] => {
            let mut unpacked = Vec::with_capacity(bytes.len() * 2);
            MultiGzDecoder::new(bytes.as_slice()).read_to_end(&mut unpacked).context("is damaged gzip")?;
            Ok(unpacked)
        }
        [0x1f, 0x9d, ..] => bail!("is packed by `compress`: unpack it with `gzip -d`"),
        [b'P', b'K', 3, 4, ..] => bail!("is a zip archive: unpack it first"),
        _ => Ok(bytes),
    }
}
