//! Sentences to every consumer, each through a bounded queue of its own.
//!
//! The epoch loop never waits for a consumer. A consumer whose queue is full loses that sentence,
//! and the loss is counted; one that is gone is forgotten. A recording is another matter: it can
//! wait, so that no consumer loses a sentence of it. Whoever stops the service waits for nobody.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, TrySendError, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use std::{fmt, thread};

use mio::Waker;
use raim_firmware::settings::Configuration;

use super::Plan;
use super::clients::Way;
use super::log::Log;
use crate::page::report::settings_of;
use crate::satellites::Seen;

/// Sentences that may wait for a consumer: some ten epochs.
pub(super) const QUEUE: usize = 256;

/// Pause between two looks at a full queue.
const LOOK: Duration = Duration::from_millis(1);

/// Time between two looks at the consumers at the end.
const LAST_LOOK: Duration = Duration::from_millis(50);

/// Longest time in which consumers may read their queues at the end of a live line, or of a service
/// that was stopped.
const FAREWELL: Duration = Duration::from_secs(3);

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

/// A consumer: the messages that it wants, its queue, and the waker of a thread that waits for more
/// than its queue.
#[derive(Debug)]
struct Consumer {
    wanted: Kind,
    queue: SyncSender<Arc<[u8]>>,
    waker: Option<Arc<Waker>>,
    /// True if the thread has not been woken for what is in its queue.
    sleeps: bool,
}

impl Consumer {
    /// Puts a message into the queue, as soon as there is room if that is waited for.
    fn take(&mut self, wait: Option<&Wait>, message: &Arc<[u8]>) -> Result<(), TrySendError<Arc<[u8]>>> {
        let mut start = None;
        let outcome = loop {
            match (self.queue.try_send(Arc::clone(message)), wait) {
                (Err(TrySendError::Full(_)), Some(wait)) if !wait.stop.load(Ordering::Relaxed) => {
                    self.wake();
                    (wait.meanwhile)(start.get_or_insert_with(Instant::now).elapsed());
                    thread::sleep(LOOK);
                }
                (outcome, _) => break outcome,
            }
        };
        if let (Some(_), Some(wait)) = (start, wait) {
            (wait.after)();
        }
        self.sleeps = true;
        outcome
    }

    /// Wakes the thread for what is in its queue; returns false if it has ended.
    fn wake(&mut self) -> bool {
        !std::mem::take(&mut self.sleeps) || self.waker.as_ref().is_none_or(|waker| waker.wake().is_ok())
    }
}

/// How a recording waits for its consumers.
#[derive(Clone)]
pub(super) struct Wait {
    /// Ends every wait once it is true.
    pub(super) stop: Arc<AtomicBool>,
    /// Called at each look at a full queue, with the time that the wait has taken.
    pub(super) meanwhile: Arc<dyn Fn(Duration) + Send + Sync>,
    /// Called at the end of a wait.
    pub(super) after: Arc<dyn Fn() + Send + Sync>,
}

impl fmt::Debug for Wait {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Wait").field("stop", &self.stop).finish_non_exhaustive()
    }
}

/// The way out.
#[derive(Debug)]
pub(super) struct Outbox {
    consumers: Vec<Consumer>,
    /// How a full queue is waited for; `None` on a live line, which never waits.
    wait: Option<Wait>,
    lost: Arc<AtomicU32>,
    /// The first error of each consumer.
    errors: Arc<Mutex<Vec<std::io::Error>>>,
    /// Every thread of a consumer holds a copy of the first, so that the second ends with the last
    /// of them.
    done: (Sender<()>, Receiver<()>),
    log: Log,
}

impl Outbox {
    /// Returns a way out without consumers, which waits for a full queue like this.
    pub(super) fn new(wait: Option<Wait>) -> Self {
        Self {
            consumers: Vec::new(),
            wait,
            lost: Arc::default(),
            errors: Arc::default(),
            done: channel(),
            log: Log::new(None),
        }
    }

    /// Adds a consumer; a thread of its own runs `write` with its messages.
    pub(super) fn add(
        &mut self,
        wanted: Kind,
        write: impl FnOnce(&Receiver<Arc<[u8]>>) -> std::io::Result<()> + Send + 'static,
    ) {
        let (queue, messages) = sync_channel(QUEUE);
        self.consumers.push(Consumer { wanted, queue, waker: None, sleeps: false });
        let (errors, done) = (Arc::clone(&self.errors), self.done.0.clone());
        thread::spawn(move || {
            if let Err(error) = write(&messages) {
                errors.lock().unwrap_or_else(PoisonError::into_inner).push(error);
            }
            drop(done);
        });
    }

    /// Adds the TCP clients, whose thread is started with what [`Self::for_clients`] returns.
    pub(super) fn add_clients(&mut self, (queue, waker): Way) {
        self.consumers.push(Consumer { wanted: Kind::Nmea, queue, waker: Some(waker), sleeps: false });
    }

    /// Returns the counter of lost sentences, and the sender that the thread of the clients holds.
    pub(super) fn for_clients(&self) -> (Arc<AtomicU32>, Sender<()>) {
        (Arc::clone(&self.lost), self.done.0.clone())
    }

    /// Lets this log have the states.
    pub(super) fn keep_log(&mut self, log: Log) {
        self.log = log;
    }

    /// Reports the start of the service in the log.
    pub(super) fn report_start(&self, plan: &Plan, configuration: &Configuration) {
        let outputs: Vec<String> = plan.outputs.iter().map(ToString::to_string).collect();
        let (_, settings) = settings_of(configuration);
        self.log.start(&plan.named, &outputs, &plan.pin.to_string(), &settings);
    }

    /// Reports a verdict in the log if it changes the state.
    pub(super) fn note(&mut self, seen: &Seen) {
        self.log.note(&seen.output.state);
    }

    /// Returns true if a full queue is waited for.
    pub(super) const fn waits(&self) -> bool {
        self.wait.is_some()
    }

    /// Messages that a consumer's full queue has lost.
    pub(super) fn lost(&self) -> u32 {
        self.lost.load(Ordering::Relaxed)
    }

    /// Returns true if a consumer has failed.
    pub(super) fn has_failed(&self) -> bool {
        !self.errors.lock().unwrap_or_else(PoisonError::into_inner).is_empty()
    }

    /// Sends a whole message to every consumer of its kind. Those that wait for more than their queue
    /// have it at the next [`Self::wake`].
    pub(super) fn send(&mut self, message: &[u8]) {
        let kind = Kind::of(message);
        let message: Arc<[u8]> = message.into();
        let Self { consumers, lost, wait, .. } = self;
        consumers.retain_mut(|consumer| {
            if consumer.wanted != kind {
                return true;
            }
            match consumer.take(wait.as_ref(), &message) {
                Ok(()) => true,
                Err(TrySendError::Full(_)) => {
                    lost.fetch_add(1, Ordering::Relaxed);
                    true
                }
                Err(TrySendError::Disconnected(_)) => false,
            }
        });
    }

    /// Wakes the consumers that wait for more than their queue: once for all sentences of an epoch.
    pub(super) fn wake(&mut self) {
        self.consumers.retain_mut(Consumer::wake);
    }

    /// Lets every consumer end once it has read its queue, and waits for that; returns the errors
    /// of the consumers.
    pub(super) fn close(self) -> Vec<std::io::Error> {
        let Self { consumers, done: (own, all), errors, wait, .. } = self;
        let wakers: Vec<_> = consumers.iter().filter_map(|consumer| consumer.waker.clone()).collect();
        drop((consumers, own));
        for waker in wakers {
            let _ = waker.wake();
        }
        let start = Instant::now();
        let may_wait = || {
            wait.as_ref().is_some_and(|wait| !wait.stop.load(Ordering::Relaxed)) || start.elapsed() < FAREWELL
        };
        let mut errors = std::mem::take(&mut *errors.lock().unwrap_or_else(PoisonError::into_inner));
        while all.recv_timeout(LAST_LOOK) == Err(RecvTimeoutError::Timeout) {
            if !may_wait() {
                errors.push(std::io::Error::other("a consumer does not read; its last sentences are lost"));
                break;
            }
        }
        errors
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Wait {
        fn until(stop: &Arc<AtomicBool>) -> Self {
            Self { stop: Arc::clone(stop), meanwhile: Arc::new(|_| ()), after: Arc::new(|| ()) }
        }
    }

    impl Outbox {
        fn push(&mut self, wanted: Kind, queue: SyncSender<Arc<[u8]>>) {
            self.consumers.push(Consumer { wanted, queue, waker: None, sleeps: false });
        }
    }

    #[test]
    fn full_and_dead_consumers_cost_nobody_else_a_sentence() {
        let mut outbox = Outbox::new(None);
        let (quick, read) = sync_channel(8);
        let (slow, kept) = sync_channel(1);
        let (dead, gone) = sync_channel(1);
        for queue in [dead, slow, quick] {
            outbox.push(Kind::Nmea, queue);
        }
        drop(gone);
        for _ in 0..3 {
            outbox.send(b"$GPRMC\r\n");
        }
        outbox.send(&[MAVLINK, 0]);
        assert_eq!((read.try_iter().count(), kept.try_iter().count(), outbox.lost()), (3, 1, 2));
    }

    #[test]
    fn last_sentences_are_written_before_the_end() {
        let mut outbox = Outbox::new(None);
        let written = Arc::new(Mutex::new(Vec::new()));
        let copy = Arc::clone(&written);
        outbox.add(Kind::Nmea, move |messages| {
            for message in messages {
                thread::sleep(Duration::from_millis(5));
                copy.lock().unwrap().extend_from_slice(&message);
            }
            Ok(())
        });
        for _ in 0..10 {
            outbox.send(b"$GPRMC\r\n");
        }
        assert!(outbox.close().is_empty());
        assert_eq!(*written.lock().unwrap(), b"$GPRMC\r\n".repeat(10));
    }

    #[test]
    fn sentences_of_a_recording_wait_for_a_slow_consumer() {
        let mut outbox = Outbox::new(Some(Wait::until(&Arc::default())));
        let count = Arc::new(AtomicU32::new(0));
        let copy = Arc::clone(&count);
        outbox.add(Kind::Nmea, move |messages| {
            for _ in messages {
                thread::sleep(Duration::from_micros(50));
                copy.fetch_add(1, Ordering::Relaxed);
            }
            Ok(())
        });
        for _ in 0..3 * QUEUE {
            outbox.send(b"$GPRMC\r\n");
        }
        assert_eq!(outbox.lost(), 0);
        outbox.close();
        assert_eq!(count.load(Ordering::Relaxed) as usize, 3 * QUEUE);
    }

    /// A reader that has stopped, and a service that is told to stop.
    #[test]
    fn stop_ends_every_wait_for_a_consumer() {
        let stop = Arc::new(AtomicBool::new(false));
        let mut outbox = Outbox::new(Some(Wait::until(&stop)));
        let (queue, _kept) = sync_channel(1);
        outbox.push(Kind::Nmea, queue);
        let start = Instant::now();
        let until = thread::spawn(move || {
            thread::sleep(Duration::from_millis(50));
            stop.store(true, Ordering::Relaxed);
        });
        outbox.send(b"$GPRMC\r\n");
        outbox.send(b"$GPRMC\r\n");
        until.join().unwrap();
        assert!(start.elapsed() < Duration::from_secs(5));
        assert_eq!(outbox.lost(), 1);
    }
}
