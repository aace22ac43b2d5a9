//! Sentences to every consumer, each through a bounded queue of its own.
//!
//! The epoch loop never waits for a consumer. A consumer whose queue is full loses that sentence,
//! and the loss is counted; one that is gone is forgotten.

use std::sync::mpsc::{SyncSender, TrySendError};
use std::sync::{Arc, Mutex, PoisonError};

/// Sentences that may wait for a consumer: some ten epochs.
pub(super) const QUEUE: usize = 256;

/// First byte of a frame of `MAVLink` 2.
const MAVLINK: u8 = 0xFD;

/// The messages that a consumer wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Sentences of NMEA 0183.
    Nmea,
    /// Frames of `MAVLink`.
    Mavlink,
}

impl Kind {
    fn of(message: &[u8]) -> Self {
        if message.first() == Some(&MAVLINK) { Self::Mavlink } else { Self::Nmea }
    }
}

/// The queue of a consumer.
type Queue = SyncSender<Arc<[u8]>>;

/// A place to which new consumers are added, from any thread.
#[derive(Clone, Debug, Default)]
pub(super) struct Consumers(Arc<Mutex<Vec<(Kind, Queue)>>>);

impl Consumers {
    /// Adds a consumer.
    pub(super) fn add(&self, kind: Kind, queue: Queue) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push((kind, queue));
    }
}

/// The way out.
#[derive(Debug, Default)]
pub(super) struct Outbox {
    consumers: Consumers,
    lost: u32,
    /// Sentences for the report; `None` if there is none.
    tape: Option<Vec<u8>>,
}

impl Outbox {
    /// Returns the place to which new consumers are added.
    pub(super) fn consumers(&self) -> Consumers {
        self.consumers.clone()
    }

    /// Lets the sentences be kept for the report, or not.
    pub(super) fn keep_tape(&mut self, is_kept: bool) {
        self.tape = is_kept.then(Vec::new);
    }

    /// Returns the sentences since the last call.
    pub(super) fn take_tape(&mut self) -> Vec<u8> {
        self.tape.as_mut().map(std::mem::take).unwrap_or_default()
    }

    /// Messages that a consumer's full queue has lost.
    pub(super) fn lost(&self) -> u32 {
        self.lost
    }

    /// Sends a whole message to every consumer of its kind.
    pub(super) fn send(&mut self, message: &[u8]) {
        let kind = Kind::of(message);
        if let Some(tape) = self.tape.as_mut().filter(|_| kind == Kind::Nmea) {
            tape.extend_from_slice(message);
        }
        let message: Arc<[u8]> = message.into();
        let mut consumers = self.consumers.0.lock().unwrap_or_else(PoisonError::into_inner);
        consumers.retain(|(wanted, queue)| {
            if *wanted != kind {
                return true;
            }
            match queue.try_send(Arc::clone(&message)) {
                Ok(()) => true,
                Err(TrySendError::Full(_)) => {
                    self.lost = self.lost.saturating_add(1);
                    true
                }
                Err(TrySendError::Disconnected(_)) => false,
            }
        });
    }

    /// Lets every consumer end once it has read its queue.
    pub(super) fn close(self) {
        self.consumers.0.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::sync_channel;

    use super::*;

    #[test]
    fn full_and_dead_consumers_cost_nobody_else_a_sentence() {
        let mut outbox = Outbox::default();
        let (quick, read) = sync_channel(8);
        let (slow, kept) = sync_channel(1);
        let (dead, gone) = sync_channel(1);
        for queue in [dead, slow, quick] {
            outbox.consumers().add(Kind::Nmea, queue);
        }
        drop(gone);
        for _ in 0..3 {
            outbox.send(b"$GPRMC\r\n");
        }
        outbox.send(&[MAVLINK, 0]);
        assert_eq!((read.try_iter().count(), kept.try_iter().count(), outbox.lost()), (3, 1, 2));
    }
}
