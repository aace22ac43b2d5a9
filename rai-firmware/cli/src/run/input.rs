//! The receiver's bytes: from a serial port, a TCP server or standard input.
//!
//! A port that fails or ends is opened again, after a [`Pause`]. Meanwhile nothing arrives, so the
//! module reports `STALE` and drops the pin by itself. A serial port takes another rate when
//! [`super::contact`] asks for one.

use std::io::{self, IsTerminal as _, Read as _, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::thread;
use std::time::Duration;

use anyhow::{Context as _, Result};

use super::inbox::Inbox;
use super::played;
use super::record::Record;
use super::reserve::Reserve;
use super::share::Share;
use crate::run::words::say;
use crate::source::{self, Pause, Source, is_timeout};

/// A read comes back after this time even if nothing arrives, so that a dead line is noticed.
const READ_TIMEOUT: Duration = Duration::from_secs(2);
/// A TCP server that sends nothing for this time, or for so many of the longest of its last silences,
/// is taken for gone; and at the latest after this time.
const DEAD: Duration = Duration::from_secs(15);
const SILENCES: u32 = 3;
const LATEST: Duration = Duration::from_mins(2);
/// Shortest time between two reads that is a silence. The module completes an epoch after it.
const SILENCE: Duration = Duration::from_millis(100);
/// Number of silences that are remembered.
const REMEMBERED: usize = 8;

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
            Source::Standard | Source::File(_) => Self::of_standard_input(),
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
        Source::Tcp(_) | Source::Standard | Source::File(_) => None,
    };
    thread::spawn(move || keep_reading(&source, &line, first, &inbox, &stop));
    Ok(())
}

/// What a reader shares with others: the rate that it follows, bit/s, and the programs and the file
/// to which it passes the bytes.
#[derive(Clone, Debug)]
pub(super) struct Line {
    pub(super) rate: Arc<AtomicU32>,
    pub(super) share: Option<Arc<Share>>,
    pub(super) record: Option<Arc<Record>>,
}

impl Line {
    /// Returns the line of a source at start.
    pub(super) fn of(source: &Source, share: Option<Arc<Share>>, record: Option<Arc<Record>>) -> Self {
        let rate = match source {
            Source::Serial(_, baud) => *baud,
            Source::Tcp(_) | Source::Standard | Source::File(_) => 0,
        };
        Self { rate: Arc::new(AtomicU32::new(rate)), share, record }
    }

    /// Notes the writing side of the port, or that it is closed.
    fn connect(&self, port: Option<Box<dyn Write + Send>>) {
        if let Some(share) = &self.share {
            share.connect(port);
        }
    }
}

/// Opens a source at the rate that is followed.
fn open(source: &Source, line: &Line) -> Result<source::Line> {
    let source = match source {
        Source::Serial(port, _) => Source::Serial(port.clone(), line.rate.load(Ordering::Relaxed)),
        other => other.clone(),
    };
    let open = source::Line::open(&source, READ_TIMEOUT)?;
    line.connect(open.writer()?);
    Ok(open)
}

/// The silences of a line, which a new connection goes on with.
#[derive(Debug, Default)]
struct Silences {
    heard: Option<Duration>,
    last: [Duration; REMEMBERED],
}

impl Silences {
    /// Notes that bytes have come.
    fn end(&mut self, now: Duration) {
        let silence = now.saturating_sub(self.heard.unwrap_or(now));
        if silence >= SILENCE {
            self.last.rotate_right(1);
            self.last[0] = silence;
        }
        self.heard = Some(now);
    }

    /// Returns the time without a byte after which the other side is gone.
    fn longest(&self) -> Duration {
        let usual = self.last.into_iter().max().unwrap_or_default();
        DEAD.max(SILENCES * usual).min(LATEST)
    }
}

fn keep_reading(source: &Source, line: &Line, first: Option<source::Line>, inbox: &Inbox, stop: &AtomicBool) {
    let (mut pause, mut port, mut silences) = (Pause::RECEIVER, first, Silences::default());
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
                let (count, reason) = read(open, line, inbox, &mut silences, stop);
                line.connect(None);
                if is_standard {
                    return inbox.end();
                }
                if stop.load(Ordering::Relaxed) {
                    return;
                }
                if count > 0 {
                    pause.reset();
                }
                say!("{source}: {reason}; trying again in {} ms", pause.next().as_millis());
            }
            Err(error) => say!("{source}: {error:#}; trying again in {} ms", pause.next().as_millis()),
        }
        inbox.clock().sleep(pause.next(), stop);
        pause.double();
    }
}

/// Reads until the port ends; returns how many bytes came, and why it ended.
fn read(
    mut port: source::Line,
    line: &Line,
    inbox: &Inbox,
    silences: &mut Silences,
    stop: &AtomicBool,
) -> (u64, String) {
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
                if let Some(record) = &line.record {
                    record.keep(bytes);
                }
                total += count as u64;
                last = inbox.clock().now();
                silences.end(last);
            }
            Err(error) if is_timeout(&error) => {
                let longest = silences.longest();
                if inbox.clock().now().saturating_sub(last) >= longest {
                    return (total, format!("silent for {} s", longest.as_secs()));
                }
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return (total, error.to_string()),
        }
    }
    (total, "stopped".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_is_gone_after_three_of_its_silences_and_at_the_latest_after_two_minutes() {
        let (mut silences, mut now_s) = (Silences::default(), 10.0);
        let mut after = |gap_s: f64| {
            now_s += gap_s;
            silences.end(Duration::from_secs_f64(now_s));
            silences.longest()
        };
        for gap_s in [0.0, 1.0] {
            assert_eq!(after(gap_s), DEAD);
        }
        // An epoch every 20 s, in two parts 40 ms apart, or 300 ms.
        for gap_s in [20.0, 0.04, 20.0, 0.3, 20.0, 0.3] {
            assert!((59.0..61.0).contains(&after(gap_s).as_secs_f64()), "{gap_s}");
        }
        assert_eq!(after(600.0), LATEST);
        assert!((1..REMEMBERED).all(|_| after(1.0) > DEAD));
        assert_eq!(after(1.0), DEAD, "an outage is forgotten");
    }
}
