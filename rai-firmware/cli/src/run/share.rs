//! The receiver's raw bytes for other programs, while the service holds its port:
//! `--share tcp://127.0.0.1:2006`.
//!
//! ```text
//! receiver ─► input ─┬─► inbox
//!                    └─► share ─► TCP clients
//! receiver ◄─── back ◄────────── TCP clients   only with --share-write; else counted and dropped
//! ```
//!
//! Clients get the bytes as they come, before they are judged. Whoever may write to the receiver
//! can take its ranges away or change what it says, so that this is forbidden unless it is asked
//! for.

use std::fmt;
use std::io::Write;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex, PoisonError};

use anyhow::{Context as _, Result};

use super::clients::{Clients, Way};
use crate::run::words::say;

/// The way back to the receiver.
pub(super) struct Back {
    is_allowed: bool,
    /// The port, while it is open.
    port: Mutex<Option<Box<dyn Write + Send>>>,
    passed: AtomicU64,
    refused: AtomicU64,
}

impl fmt::Debug for Back {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Back").field("is_allowed", &self.is_allowed).finish_non_exhaustive()
    }
}

impl Back {
    fn new(is_allowed: bool) -> Self {
        Self { is_allowed, port: Mutex::new(None), passed: AtomicU64::new(0), refused: AtomicU64::new(0) }
    }

    /// Takes bytes of a client. Those of a port that is not open, or does not take them, count as
    /// refused.
    pub(super) fn take(&self, bytes: &[u8]) {
        let mut port = self.port.lock().unwrap_or_else(PoisonError::into_inner);
        let is_passed = self.is_allowed
            && port.as_mut().is_some_and(|port| port.write_all(bytes).and_then(|()| port.flush()).is_ok());
        let counter = if is_passed { &self.passed } else { &self.refused };
        let before = counter.fetch_add(bytes.len() as u64, Ordering::Relaxed);
        if !self.is_allowed && before == 0 {
            say!("share: bytes towards the receiver are refused (--share-write passes them)");
        }
    }

    /// Bytes that went to the receiver, and those that did not.
    pub(super) fn counts(&self) -> [u64; 2] {
        [&self.passed, &self.refused].map(|counter| counter.load(Ordering::Relaxed))
    }
}

/// The input's side.
#[derive(Debug)]
pub(super) struct Share {
    way: Way,
    back: Arc<Back>,
    lost: Arc<AtomicU32>,
}

impl Share {
    /// Listens on an address.
    ///
    /// # Errors
    /// If the address has another form or cannot be used.
    pub(super) fn serve(name: &str, is_allowed: bool, most: usize) -> Result<Self> {
        let address = name.strip_prefix("tcp://").context("a share is tcp://ADDRESS:PORT")?;
        let back = Arc::new(Back::new(is_allowed));
        let mut clients = Clients::new(most, false)?.with_back(Arc::clone(&back));
        clients.listen(address)?;
        let lost = Arc::default();
        // Nobody waits for the end of these clients.
        let (done, _) = channel();
        let way = clients.start(Arc::clone(&lost), done)?;
        Ok(Self { way, back, lost })
    }

    /// Passes bytes of the receiver on. Clients that are too slow lose some.
    pub(super) fn pass(&self, bytes: &[u8]) {
        if self.way.0.try_send(bytes.into()).is_err() {
            self.lost.fetch_add(1, Ordering::Relaxed);
        }
        // A waker fails only if its thread has ended.
        let _ = self.way.1.wake();
    }

    /// Takes the writing side of the receiver's port; `None` while it is closed.
    pub(super) fn connect(&self, port: Option<Box<dyn Write + Send>>) {
        *self.back.port.lock().unwrap_or_else(PoisonError::into_inner) = port;
    }

    pub(super) fn back(&self) -> &Arc<Back> {
        &self.back
    }
}
