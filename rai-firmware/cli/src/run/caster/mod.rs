//! Orbits from an NTRIP caster, for a receiver that sends ranges alone: `ntrip://` over TCP as it is,
//! `ntrips://` over TLS.
//!
//! A caster's stream also carries the ranges of its own station. They never reach the module: only
//! whole frames of RTCM 3 that hold an ephemeris are passed on, each with its check.

use std::io::{Read, Write};
use std::str::FromStr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, bail, ensure};

mod tls;

use super::inbox::Inbox;
use crate::page::report::base64_text;
use crate::run::words::say;
use crate::signal::checksum::crc24q;
use crate::source::{Pause, connect, is_timeout};

/// Messages of RTCM 3 that hold an ephemeris.
const EPHEMERIDES: [u16; 6] = [1019, 1020, 1042, 1044, 1045, 1046];
/// A read comes back after this time even if nothing arrives.
const READ_TIMEOUT: Duration = Duration::from_secs(2);
/// Longest table of mountpoints that is read, bytes.
const LONGEST_TABLE: u64 = 1 << 18;
/// A caster that sends nothing for this time is taken for gone.
const DEAD: Duration = Duration::from_mins(1);

/// Longest first line of an answer, bytes.
const LONGEST_STATUS: usize = 512;
/// Longest time to that line.
const ANSWER: Duration = Duration::from_secs(10);

/// A stream of a caster: `ntrip://user:password@host:port/mountpoint`, or `ntrips://` for TLS.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Caster {
    is_secure: bool,
    address: String,
    mountpoint: String,
    credentials: Option<String>,
}

impl FromStr for Caster {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let form = "a caster is ntrip://USER:PASSWORD@HOST:PORT/MOUNTPOINT, or ntrips:// for TLS";
        let (is_secure, rest) = match (text.strip_prefix("ntrips://"), text.strip_prefix("ntrip://")) {
            (Some(rest), _) => (true, rest),
            (None, Some(rest)) => (false, rest),
            // It may have a password.
            (None, None) => bail!("{form}"),
        };
        ensure!(!is_secure || tls::IS_BUILT, "{}", tls::MISSING);
        let (credentials, rest) = match rest.rsplit_once('@') {
            Some((credentials, rest)) => (Some(credentials.to_owned()), rest),
            None => (None, rest),
        };
        let Some((address, mountpoint)) = rest.split_once('/') else {
            bail!("{form}: the mountpoint is missing")
        };
        ensure!(!address.is_empty() && !mountpoint.is_empty(), "{form}");
        let port = if is_secure { 443 } else { 2101 };
        let address = if address.contains(':') { address.to_owned() } else { format!("{address}:{port}") };
        Ok(Self { is_secure, address, mountpoint: mountpoint.to_owned(), credentials })
    }
}

/// Starts the thread that reads the caster.
pub(super) fn start(caster: Caster, inbox: &Arc<Inbox>, stop: &Arc<AtomicBool>) {
    let (inbox, stop) = (Arc::clone(inbox), Arc::clone(stop));
    thread::spawn(move || {
        let mut pause = Pause::CASTER;
        while !stop.load(Ordering::Relaxed) {
            let mut has_orbit = false;
            if let Err(error) = read(&caster, &inbox, &stop, &mut has_orbit) {
                let scheme = if caster.is_secure { "ntrips" } else { "ntrip" };
                say!("{scheme}://{}/{}: {error:#}", caster.address, caster.mountpoint);
            }
            if has_orbit {
                pause.reset();
            }
            inbox.clock().sleep(pause.next(), &stop);
            pause.double();
        }
    });
}

fn read(caster: &Caster, inbox: &Inbox, stop: &AtomicBool, has_orbit: &mut bool) -> Result<()> {
    let mut reader = request(caster)?;
    let (mut waiting, mut bytes, mut last) = (Vec::new(), [0; 2048], Instant::now());
    while !stop.load(Ordering::Relaxed) {
        match reader.read(&mut bytes) {
            Ok(0) => bail!("the caster has closed the stream"),
            Ok(count) => {
                waiting.extend_from_slice(bytes.get(..count).unwrap_or_default());
                take_frames(&mut waiting, |frame| {
                    *has_orbit = true;
                    inbox.push_orbit(frame.to_vec());
                });
                last = Instant::now();
            }
            Err(error) if is_timeout(&error) => {
                ensure!(last.elapsed() < DEAD, "the caster has been silent for {} s", DEAD.as_secs());
            }
            Err(error) => return Err(error.into()),
        }
    }
    Ok(())
}

/// Asks for the stream, in the form that every caster of version 1 and 2 answers.
fn request(caster: &Caster) -> Result<Box<dyn Read>> {
    let stream = connect(&caster.address, READ_TIMEOUT)?;
    let mut stream: Box<dyn Line> =
        if caster.is_secure { tls::secure(stream, host(&caster.address))? } else { Box::new(stream) };
    let authorization = caster.credentials.as_ref().map_or_else(String::new, |credentials| {
        format!("Authorization: Basic {}\r\n", base64_text(credentials.as_bytes()))
    });
    let (mountpoint, version) = (&caster.mountpoint, env!("CARGO_PKG_VERSION"));
    let request =
        format!("GET /{mountpoint} HTTP/1.0\r\nUser-Agent: NTRIP rai/{version}\r\n{authorization}\r\n");
    stream.write_all(request.as_bytes())?;
    let status = status_line(&mut stream)?;
    let status = status.trim();
    ensure!(!status.is_empty(), "the caster closed the connection without an answer");
    if status.starts_with("SOURCETABLE ") {
        let mut table = Vec::new();
        // A table that is cut by an error still names mountpoints.
        let _ = (&mut stream).take(LONGEST_TABLE).read_to_end(&mut table);
        bail!("the caster has no mountpoint `{mountpoint}`; it has {}", mountpoints(&table));
    }
    ensure!(is_stream(status), "the caster answers `{status}`: are mountpoint and password right?");
    if status.starts_with("HTTP/") && has_chunks(&mut stream)? {
        return Ok(Box::new(Chunks::of(stream)));
    }
    Ok(Box::new(stream))
}

/// A line in both directions.
trait Line: Read + Write {}

impl<T: Read + Write> Line for T {}

/// Returns the host of an address.
fn host(address: &str) -> &str {
    let host = address.rsplit_once(':').map_or(address, |(host, _)| host);
    host.trim_start_matches('[').trim_end_matches(']')
}

/// Reads the lines of a header up to the empty one; returns true if the stream comes in chunks.
fn has_chunks(stream: &mut impl Read) -> Result<bool> {
    const MOST_LINES: usize = 64;
    let mut has_chunks = false;
    for _ in 0..MOST_LINES {
        let line = status_line(stream)?.trim().to_ascii_lowercase();
        if line.is_empty() {
            return Ok(has_chunks);
        }
        has_chunks |= line.starts_with("transfer-encoding:") && line.ends_with("chunked");
    }
    bail!("the answer has more than {MOST_LINES} lines of header");
}

/// A stream in chunks ([RFC 9112] 7.1), without the lines between them: a frame may go on behind the
/// edge of a chunk.
///
/// [RFC 9112]: https://www.rfc-editor.org/rfc/rfc9112
struct Chunks<R> {
    source: R,
    /// Bytes of the chunk that have not come yet.
    left: usize,
    /// Line with the length of the next chunk, as far as it has come.
    line: Vec<u8>,
}

impl<R: Read> Chunks<R> {
    const fn of(source: R) -> Self {
        Self { source, left: 0, line: Vec::new() }
    }

    /// Returns the length of the next chunk; 0 at the end.
    fn next_length(&mut self) -> std::io::Result<usize> {
        let malformed = || std::io::Error::new(std::io::ErrorKind::InvalidData, "a chunk has no length");
        loop {
            let mut byte = [0];
            if self.source.read(&mut byte)? == 0 {
                return Ok(0);
            }
            self.line.extend(byte);
            if self.line.len() > LONGEST_STATUS {
                return Err(malformed());
            }
            // An empty line ends the chunk before.
            if byte == [b'\n'] {
                let line = String::from_utf8_lossy(&std::mem::take(&mut self.line)).trim().to_owned();
                let digits = line.split(';').next().unwrap_or("").trim();
                if !line.is_empty() {
                    return usize::from_str_radix(digits, 16).map_err(|_| malformed());
                }
            }
        }
    }
}

impl<R: Read> Read for Chunks<R> {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        if self.left == 0 {
            self.left = self.next_length()?;
        }
        if self.left == 0 {
            return Ok(0);
        }
        let most = into.len().min(self.left);
        let count = self.source.read(into.get_mut(..most).unwrap_or_default())?;
        self.left -= count;
        Ok(count)
    }
}

/// Returns true for the first line of an answer that a stream follows.
fn is_stream(status: &str) -> bool {
    let mut words = status.split_ascii_whitespace();
    let is_known = words.next().is_some_and(|form| form == "ICY" || form.starts_with("HTTP/1."));
    is_known && words.next() == Some("200")
}

/// Returns the names of the mountpoints in a table: lines of NTRIP that begin with `STR`.
fn mountpoints(table: &[u8]) -> String {
    let text = String::from_utf8_lossy(table);
    let names = text.lines().filter_map(|line| line.strip_prefix("STR;")?.split(';').next());
    let names: Vec<&str> = names.collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

/// Reads the first line of an answer, byte by byte, because ranges may follow it. Its length and
/// its time are bounded, because a caster may send anything.
fn status_line(stream: &mut impl Read) -> Result<String> {
    let (start, mut line, mut byte) = (Instant::now(), Vec::new(), [0]);
    while line.last() != Some(&b'\n') {
        ensure!(
            line.len() < LONGEST_STATUS,
            "the answer must begin with a line of at most {LONGEST_STATUS} bytes"
        );
        ensure!(start.elapsed() < ANSWER, "the answer must come within {} s", ANSWER.as_secs());
        match stream.read(&mut byte) {
            Ok(0) => break,
            Ok(_) => line.extend(byte),
            Err(error) if is_timeout(&error) => {}
            Err(error) => return Err(error).context("no answer"),
        }
    }
    Ok(String::from_utf8_lossy(&line).into_owned())
}

/// Takes every whole frame off the front of the bytes, and hands on those with an ephemeris.
fn take_frames(waiting: &mut Vec<u8>, mut hand_on: impl FnMut(&[u8])) {
    let mut front = 0;
    while let Some(rest) = waiting.get(front..).filter(|rest| rest.len() >= 6) {
        let [0xD3, high, low, first, second, ..] = rest else {
            front += 1;
            continue;
        };
        let length = 6 + (usize::from(high & 3) << 8 | usize::from(*low));
        let Some(frame) = rest.get(..length) else { break };
        if high & !3 != 0 || crc24q(frame) != [0; 3] {
            front += 1;
            continue;
        }
        let number = u16::from(*first) << 4 | u16::from(second >> 4);
        if EPHEMERIDES.contains(&number) {
            hand_on(frame);
        }
        front += length;
    }
    waiting.drain(..front);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::checksum::rtcm_frame;

    #[test]
    fn casters_are_read_or_refused_with_their_form() {
        let caster = "ntrip://me:secret@example.org/MOUNT".parse::<Caster>().unwrap();
        assert_eq!((&*caster.address, &*caster.mountpoint), ("example.org:2101", "MOUNT"));
        assert_eq!(caster.credentials.as_deref(), Some("me:secret"));
        for wrong in ["", "ntrip://host:1", "http://host/MOUNT"] {
            assert!(wrong.parse::<Caster>().is_err(), "{wrong}");
        }
        let secure = "ntrips://example.org/MOUNT".parse::<Caster>();
        if tls::IS_BUILT {
            let secure = secure.unwrap();
            assert!(secure.is_secure && secure.address == "example.org:443" && !caster.is_secure);
        } else {
            assert!(secure.unwrap_err().to_string().contains("--features tls"));
        }
        assert_eq!(["a.b:1", "[::1]:443"].map(host), ["a.b", "::1"]);
    }

    /// NTRIP 1.0 answers an unknown mountpoint with its table.
    #[test]
    fn only_a_stream_counts_as_success() {
        for status in ["ICY 200 OK", "ICY 200", "HTTP/1.0 200 OK", "HTTP/1.1 200 OK"] {
            assert!(is_stream(status), "{status}");
        }
        for status in ["SOURCETABLE 200 OK", "HTTP/1.1 404 Not Found", "HTTP/1.0 401 200 x", "200 OK", ""] {
            assert!(!is_stream(status), "{status}");
        }
        let table = b"CAS;example;2101\r\nSTR;OTHER;Town;RTCM 3\r\nSTR;MORE;x\r\nENDSOURCETABLE\r\n";
        assert_eq!(mountpoints(table), "OTHER, MORE");
        assert_eq!(mountpoints(b"ENDSOURCETABLE\r\n"), "none");
    }

    /// An answer without an end.
    struct Endless;

    impl Read for Endless {
        fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
            into.fill(b'x');
            Ok(into.len())
        }
    }

    #[test]
    fn answer_without_an_end_of_its_line_is_refused() {
        let error = status_line(&mut Endless).unwrap_err().to_string();
        assert!(error.contains("at most 512 bytes"), "{error}");
        assert_eq!(status_line(&mut &b"ICY 200 OK\r\nrest"[..]).unwrap(), "ICY 200 OK\r\n");
    }

    /// A source that gives a byte at a time, and times out between them.
    struct Slow<'a>(&'a [u8], bool);

    impl Read for Slow<'_> {
        fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
            self.1 = !self.1;
            if self.1 {
                return Err(std::io::ErrorKind::WouldBlock.into());
            }
            let most = into.len().min(1);
            self.0.read(into.get_mut(..most).unwrap_or_default())
        }
    }

    #[test]
    fn frames_are_whole_across_the_edges_of_chunks() {
        let frames = [frame(1019), frame(1046), frame(1042)].concat();
        for size in 1..=frames.len() {
            let chunk =
                |bytes: &[u8]| [format!("{:X};x=y\r\n", bytes.len()).as_bytes(), bytes, b"\r\n"].concat();
            let mut sent: Vec<u8> = frames.chunks(size).flat_map(chunk).collect();
            sent.extend_from_slice(b"0\r\n\r\n");
            let (mut chunks, mut waiting, mut have) = (Chunks::of(Slow(&sent, false)), Vec::new(), 0);
            let mut bytes = [0; 16];
            loop {
                match chunks.read(&mut bytes) {
                    Ok(0) => break,
                    Ok(count) => waiting.extend_from_slice(&bytes[..count]),
                    Err(error) => assert!(is_timeout(&error), "{error}"),
                }
                take_frames(&mut waiting, |_| have += 1);
            }
            assert_eq!((have, waiting.len()), (3, 0), "chunks of {size} bytes");
        }
        assert!(Chunks::of(&b"what\r\n"[..]).read(&mut [0]).is_err());
    }

    #[test]
    fn header_says_whether_a_stream_has_chunks() {
        for (header, want) in [
            ("\r\n", false),
            ("Server: x\r\nTransfer-Encoding: chunked\r\n\r\n", true),
            ("transfer-encoding: identity\r\n\r\n", false),
        ] {
            assert_eq!(has_chunks(&mut header.as_bytes()).unwrap(), want, "{header:?}");
        }
        assert!(has_chunks(&mut "x: y\r\n".repeat(99).as_bytes()).is_err());
    }

    /// Returns a frame of RTCM 3 with a message of this number and nothing else in it.
    fn frame(number: u16) -> Vec<u8> {
        rtcm_frame(&[(number >> 4) as u8, (number << 4) as u8])
    }

    #[test]
    fn only_whole_frames_with_orbits_are_passed_on() {
        // The check of the standard's own example.
        let example = [
            0xD3, 0x00, 0x13, 0x3E, 0xD7, 0xD3, 0x02, 0x02, 0x98, 0x0E, 0xDE, 0xEF, 0x34, 0xB4, 0xBD, 0x62,
            0xAC, 0x09, 0x41, 0x98, 0x6F, 0x33, 0x36, 0x0B, 0x98,
        ];
        assert_eq!(crc24q(&example), [0; 3]);
        let mut spoilt = frame(1045);
        spoilt[4] ^= 1;
        let stream = [&example[..], &frame(1019), b"noise", &frame(1077), &spoilt, &frame(1046)].concat();
        let (mut waiting, mut have) = (Vec::new(), Vec::new());
        for byte in stream {
            waiting.push(byte);
            take_frames(&mut waiting, |frame| have.push(u16::from(frame[3]) << 4 | u16::from(frame[4] >> 4)));
        }
        assert_eq!(have, [1019, 1046]);
    }
}
