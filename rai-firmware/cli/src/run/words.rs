//! Lines on standard error, for which the service never waits.
//!
//! ```text
//! any thread ─► say! ─► queue ─► thread ─► standard error
//! ```
//!
//! Whoever reads standard error may stop, as a terminal after Ctrl-S or a program behind a pipe, and
//! its disk may be full. A line that finds no room is lost, and so is one that cannot be written. In
//! contrast, `eprintln!` waits for the first and panics at the second.

use std::io::Write as _;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{OnceLock, mpsc};
use std::thread;
use std::time::Duration;

/// Lines that may wait.
const QUEUE: usize = 256;
/// Longest time in which the lines so far are written before the program ends.
const FAREWELL: Duration = Duration::from_millis(500);

/// A line, or a sender that is dropped once all lines before it were written.
enum Entry {
    Line(String),
    Mark(mpsc::Sender<()>),
}

/// The way to the thread that writes.
static WAY: OnceLock<SyncSender<Entry>> = OnceLock::new();

/// Formats a line and lets it be written on standard error.
macro_rules! say {
    ($($words:tt)*) => { $crate::run::words::line(format!($($words)*)) };
}
pub(crate) use say;

/// Lets a line be written, and returns at once.
pub(crate) fn line(words: String) {
    // A full queue is that of a reader who has stopped.
    let _ = way().try_send(Entry::Line(words));
}

/// Waits until the lines so far have been written, at most half a second.
pub(crate) fn flush() {
    let (written, end) = mpsc::channel();
    if WAY.get().is_some_and(|way| way.try_send(Entry::Mark(written)).is_ok()) {
        let _ = end.recv_timeout(FAREWELL);
    }
}

fn way() -> &'static SyncSender<Entry> {
    WAY.get_or_init(|| {
        let (way, entries) = sync_channel(QUEUE);
        thread::spawn(move || write(&entries));
        way
    })
}

fn write(entries: &Receiver<Entry>) {
    for entry in entries {
        match entry {
            // A disk that is full may have room again.
            Entry::Line(words) => drop(writeln!(std::io::stderr(), "{words}")),
            Entry::Mark(written) => drop(written),
        }
    }
}
