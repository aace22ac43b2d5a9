//! The receiver's raw bytes in a file, for a replay: `--record capture.ubx`.
//!
//! ```text
//! receiver ─► input ─┬─► inbox
//!                    └─► record ─► queue ─► thread ─► file
//! ```
//!
//! Nobody waits for the disk. A disk that is full or gone ends the recording, with a line that says
//! so, and nothing else.

use std::fs::File;
use std::io::Write as _;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, SyncSender, TrySendError, sync_channel};
use std::thread;
use std::time::Duration;

use anyhow::{Context as _, Result};

use crate::run::words::say;

/// Reads of the receiver's port that may wait for the disk: minutes of a receiver.
const QUEUE: usize = 4096;
/// Longest wait for the disk when the service ends.
const FAREWELL: Duration = Duration::from_secs(2);

/// Bytes to write, or a sender that is dropped once all before it are written.
enum Entry {
    Bytes(Box<[u8]>),
    Mark(mpsc::Sender<()>),
}

/// The input's side.
#[derive(Debug)]
pub(super) struct Record {
    way: SyncSender<Entry>,
    lost: AtomicU64,
}

impl Record {
    /// Opens a file, behind what it has already.
    ///
    /// # Errors
    /// If it cannot be opened.
    pub(super) fn open(path: &Path) -> Result<Self> {
        let file = File::options().create(true).append(true).open(path);
        let file = file.with_context(|| path.display().to_string())?;
        let (way, entries) = sync_channel(QUEUE);
        let name = path.display().to_string();
        thread::spawn(move || write(file, &entries, &name));
        Ok(Self { way, lost: AtomicU64::new(0) })
    }

    /// Keeps bytes of the receiver. Those that find no room are counted.
    pub(super) fn keep(&self, bytes: &[u8]) {
        // Without its reader the recording has ended, which was said.
        if let Err(TrySendError::Full(_)) = self.way.try_send(Entry::Bytes(bytes.into())) {
            self.lost.fetch_add(bytes.len() as u64, Ordering::Relaxed);
        }
    }

    /// Waits until what was kept is written, and reports what was not.
    pub(super) fn end(&self) {
        let (written, end) = mpsc::channel();
        if self.way.try_send(Entry::Mark(written)).is_ok() {
            let _ = end.recv_timeout(FAREWELL);
        }
        let lost = self.lost.load(Ordering::Relaxed);
        if lost > 0 {
            say!("record: {lost} bytes of the receiver found no room");
        }
    }
}

fn write(mut file: File, entries: &Receiver<Entry>, name: &str) {
    for entry in entries {
        let bytes = match entry {
            Entry::Bytes(bytes) => bytes,
            Entry::Mark(end) => {
                drop(end);
                continue;
            }
        };
        if let Err(error) = file.write_all(&bytes) {
            say!("record: {name}: {error}; nothing more is recorded");
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;

    #[test]
    fn bytes_go_behind_what_a_file_has() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("capture.ubx");
        for bytes in [b"one", b"two"] {
            let record = Record::open(&path).unwrap();
            record.keep(bytes);
            record.end();
        }
        assert_eq!(std::fs::read(&path).unwrap(), b"onetwo");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn full_disk_ends_the_recording_and_holds_nobody() {
        let record = Record::open(Path::new("/dev/full")).unwrap();
        let start = Instant::now();
        while !matches!(
            record.way.try_send(Entry::Bytes((*b"bytes").into())),
            Err(TrySendError::Disconnected(_))
        ) {
            assert!(start.elapsed() < 5 * FAREWELL, "the recording goes on");
        }
        record.keep(b"bytes");
        record.end();
    }

    #[test]
    fn file_that_cannot_be_made_is_named() {
        let error = Record::open(Path::new("/no/such/folder/capture")).unwrap_err();
        assert!(format!("{error:#}").contains("/no/such/folder/capture"), "{error:#}");
    }
}
