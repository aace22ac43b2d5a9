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
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result};

use crate::run::words::say;

/// Reads of the receiver's port that may wait for the disk: minutes of a receiver.
const QUEUE: usize = 4096;
/// Longest wait for the disk when the service ends.
const FAREWELL: Duration = Duration::from_secs(2);
/// Pause between two looks at what is not written yet.
const LOOK: Duration = Duration::from_millis(5);

/// The input's side.
#[derive(Debug)]
pub(super) struct Record {
    way: SyncSender<Box<[u8]>>,
    /// Bytes that found no room.
    lost: AtomicU64,
    /// Bytes in the queue, shared with the thread.
    waiting: Arc<AtomicU64>,
}

impl Record {
    /// Opens a file, behind what it has already.
    ///
    /// # Errors
    /// If it cannot be opened.
    pub(super) fn open(path: &Path) -> Result<Self> {
        let file = File::options().create(true).append(true).open(path);
        let file = file.with_context(|| path.display().to_string())?;
        Ok(Self::to(file, path.display().to_string()))
    }

    fn to(file: impl std::io::Write + Send + 'static, name: String) -> Self {
        let (way, entries) = sync_channel(QUEUE);
        let waiting = Arc::new(AtomicU64::new(0));
        let left = Arc::clone(&waiting);
        thread::spawn(move || write(file, &entries, &left, &name));
        Self { way, lost: AtomicU64::new(0), waiting }
    }

    /// Keeps bytes of the receiver. Those that find no room are counted.
    pub(super) fn keep(&self, bytes: &[u8]) {
        let count = bytes.len() as u64;
        self.waiting.fetch_add(count, Ordering::Relaxed);
        if let Err(error) = self.way.try_send(bytes.into()) {
            self.waiting.fetch_sub(count, Ordering::Relaxed);
            // Without its reader the recording has ended, which was said.
            if matches!(error, TrySendError::Full(_)) {
                self.lost.fetch_add(count, Ordering::Relaxed);
            }
        }
    }

    /// Waits until what was kept is written, and reports what was not.
    pub(super) fn end(&self) {
        let lost = self.unwritten();
        if lost > 0 {
            say!("record: {lost} bytes of the receiver found no room, or were not written in time");
        }
    }

    /// Waits for the disk; returns the number of bytes that it has not taken.
    fn unwritten(&self) -> u64 {
        let start = Instant::now();
        // The thread that writes is the other owner.
        while self.waiting.load(Ordering::Acquire) > 0
            && Arc::strong_count(&self.waiting) > 1
            && start.elapsed() < FAREWELL
        {
            thread::sleep(LOOK);
        }
        self.lost.load(Ordering::Relaxed) + self.waiting.load(Ordering::Acquire)
    }
}

fn write(mut file: impl std::io::Write, entries: &Receiver<Box<[u8]>>, waiting: &Arc<AtomicU64>, name: &str) {
    for bytes in entries {
        if let Err(error) = file.write_all(&bytes) {
            say!("record: {name}: {error}; nothing more is recorded");
            return;
        }
        waiting.fetch_sub(bytes.len() as u64, Ordering::Release);
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
        while !matches!(record.way.try_send((*b"bytes").into()), Err(TrySendError::Disconnected(_))) {
            assert!(start.elapsed() < 5 * FAREWELL, "the recording goes on");
        }
        record.keep(b"bytes");
        record.end();
    }

    /// A disk that takes nothing for a long time, as a network drive that is gone.
    struct Stuck;

    impl std::io::Write for Stuck {
        fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
            loop {
                thread::park();
            }
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn what_a_stuck_disk_has_not_taken_is_counted() {
        for reads in [1, QUEUE + 10] {
            let record = Record::to(Stuck, "a disk".to_owned());
            (0..reads).for_each(|_| record.keep(b"bytes"));
            assert_eq!(record.unwritten(), 5 * reads as u64);
        }
    }

    #[test]
    fn file_that_cannot_be_made_is_named() {
        let error = Record::open(Path::new("/no/such/folder/capture")).unwrap_err();
        assert!(format!("{error:#}").contains("/no/such/folder/capture"), "{error:#}");
    }
}
