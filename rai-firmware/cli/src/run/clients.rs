//! TCP clients: one thread for all of them and their listeners.
//!
//! A client has a queue of its own. It loses sentences when the queue is full, and is disconnected
//! if it takes nothing for [`PATIENCE`]. A client that is gone is noticed by a read, so that it
//! keeps no descriptor; what it sends is discarded, unless it is for the receiver ([`super::share`]).
//! A client beyond the largest number is closed at once. If the system refuses
//! a new descriptor, the listeners rest for [`REST`], because they would otherwise be ready without
//! an end.

use std::collections::VecDeque;
use std::io::{self, ErrorKind, IoSlice, Read as _, Write as _};
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, Sender, SyncSender, TryRecvError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result};
use mio::net::{TcpListener, TcpStream};
use mio::{Events, Interest, Poll, Token, Waker};

use super::outbox::QUEUE;
use super::share::Back;
use crate::run::words::say;

/// Clients at once, unless the user names another number.
pub(super) const MOST_CLIENTS: usize = 16;
/// Longest time that a client may take to read.
const PATIENCE: Duration = Duration::from_secs(5);
/// Messages of a client that are sent together.
const AT_ONCE: usize = 16;
/// Reads of one client in a row; a consumer has nothing to send.
const MOST_READS: usize = 64;
/// Pause of the listeners after a failure to accept.
const REST: Duration = Duration::from_secs(1);

/// Token of the waker; a listener has its place as its token, and a client a number from
/// [`FIRST_CLIENT`].
const WAKER: Token = Token(usize::MAX);
const FIRST_CLIENT: usize = 1024;

/// The listeners, before their thread starts.
#[derive(Debug)]
pub(super) struct Clients {
    poll: Poll,
    listeners: Vec<TcpListener>,
    most: usize,
    /// True if sentences wait for a client instead of being lost.
    waits: bool,
    /// Takes what clients send.
    back: Option<Arc<Back>>,
}

/// The way to the thread: a queue, and the waker that says that there is something in it.
pub(super) type Way = (SyncSender<Arc<[u8]>>, Arc<Waker>);

impl Clients {
    pub(super) fn new(most: usize, waits: bool) -> Result<Self> {
        Ok(Self { poll: Poll::new()?, listeners: Vec::new(), most, waits, back: None })
    }

    /// Lets this have what clients send.
    #[must_use]
    pub(super) fn with_back(self, back: Arc<Back>) -> Self {
        Self { back: Some(back), ..self }
    }

    /// Listens on an address.
    ///
    /// # Errors
    /// If the address cannot be used.
    pub(super) fn listen(&mut self, address: &str) -> Result<()> {
        let listener = std::net::TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        self.listeners.push(TcpListener::from_std(listener));
        Ok(())
    }

    /// Returns true if there is a listener.
    pub(super) fn has_listeners(&self) -> bool {
        !self.listeners.is_empty()
    }

    /// Starts the thread; `lost` counts the sentences that a client's full queue has lost, and
    /// `done` is dropped at its end.
    ///
    /// # Errors
    /// If the system refuses to watch the listeners.
    pub(super) fn start(self, lost: Arc<AtomicU32>, done: Sender<()>) -> Result<Way> {
        let waker = Arc::new(Waker::new(self.poll.registry(), WAKER).context("a waker")?);
        let (queue, messages) = sync_channel(QUEUE);
        let Self { poll, listeners, most, waits, back } = self;
        let mut server = Server {
            poll,
            listeners,
            most,
            waits,
            back,
            clients: Vec::new(),
            next: FIRST_CLIENT,
            lost,
            rests: None,
            is_full: false,
        };
        server.watch_listeners()?;
        thread::spawn(move || {
            // An error of the poll itself ends the clients, and the queue's other side finds its
            // receiver gone.
            if let Err(error) = server.run(&messages) {
                say!("error: the TCP clients: {error}");
            }
            drop(done);
        });
        Ok((queue, waker))
    }
}

/// A client and its queue.
#[derive(Debug)]
struct Client {
    token: Token,
    stream: TcpStream,
    queue: VecDeque<Arc<[u8]>>,
    /// Bytes of the first message that are sent.
    sent: usize,
    /// Time of the last byte that the client took, or at which its queue was empty.
    last: Instant,
}

impl Client {
    fn is_full(&self) -> bool {
        self.queue.len() >= QUEUE
    }

    /// Sends as much as the client takes, several messages at a time.
    fn flush(&mut self) -> io::Result<()> {
        while !self.queue.is_empty() {
            let mut parts = [IoSlice::new(&[]); AT_ONCE];
            let mut skipped = self.sent;
            for (part, message) in parts.iter_mut().zip(&self.queue) {
                *part = IoSlice::new(message.get(std::mem::take(&mut skipped)..).unwrap_or_default());
            }
            let count = parts.len().min(self.queue.len());
            match self.stream.write_vectored(parts.get(..count).unwrap_or_default()) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(count) => self.forget(count),
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        if self.queue.is_empty() {
            self.last = Instant::now();
        }
        Ok(())
    }

    /// Forgets the messages of so many bytes that the client has taken.
    fn forget(&mut self, bytes: usize) {
        self.last = Instant::now();
        self.sent += bytes;
        while let Some(message) = self.queue.pop_front_if(|message| message.len() <= self.sent) {
            self.sent -= message.len();
        }
    }

    /// Reads what the client sends; an error if it is gone, or sends without an end.
    fn read(&mut self, back: Option<&Back>) -> io::Result<()> {
        let mut bytes = [0; 512];
        for _ in 0..MOST_READS {
            match self.stream.read(&mut bytes) {
                Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
                Ok(count) => {
                    if let Some(back) = back {
                        back.take(bytes.get(..count).unwrap_or_default());
                    }
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(()),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Err(ErrorKind::InvalidData.into())
    }
}

#[derive(Debug)]
struct Server {
    poll: Poll,
    listeners: Vec<TcpListener>,
    most: usize,
    waits: bool,
    back: Option<Arc<Back>>,
    clients: Vec<Client>,
    next: usize,
    lost: Arc<AtomicU32>,
    /// End of the listeners' rest.
    rests: Option<Instant>,
    /// True once a client beyond the largest number was reported.
    is_full: bool,
}

impl Server {
    fn run(&mut self, messages: &Receiver<Arc<[u8]>>) -> io::Result<()> {
        let mut events = Events::with_capacity(64);
        loop {
            if let Err(error) = self.poll.poll(&mut events, self.timeout())
                && error.kind() != ErrorKind::Interrupted
            {
                return Err(error);
            }
            for event in &events {
                match event.token() {
                    WAKER => {}
                    Token(place) if place < FIRST_CLIENT => self.accept(place),
                    token => self.serve(token),
                }
            }
            let has_ended = self.take(messages);
            self.forget_the_slow();
            if self.rests.is_some_and(|until| until <= Instant::now()) {
                self.rests = None;
                self.watch_listeners()?;
            }
            if has_ended && self.clients.iter().all(|client| client.queue.is_empty()) {
                return Ok(());
            }
        }
    }

    /// Returns the time to the next instant at which a client or the listeners are due.
    fn timeout(&self) -> Option<Duration> {
        let slow = self.clients.iter().filter(|client| !client.queue.is_empty());
        let due = slow.map(|client| client.last + PATIENCE).chain(self.rests).min()?;
        // A millisecond more, because the system rounds down.
        Some(due.saturating_duration_since(Instant::now()) + Duration::from_millis(1))
    }

    fn watch_listeners(&mut self) -> io::Result<()> {
        for (place, listener) in self.listeners.iter_mut().enumerate() {
            self.poll.registry().register(listener, Token(place), Interest::READABLE)?;
        }
        Ok(())
    }

    /// Accepts every client that waits at a listener.
    fn accept(&mut self, place: usize) {
        while let Some(listener) = self.listeners.get(place) {
            match listener.accept() {
                Ok((stream, from)) if self.clients.len() < self.most => self.add(stream, from),
                Ok((stream, from)) => {
                    drop(stream);
                    if !std::mem::replace(&mut self.is_full, true) {
                        say!("{from}: refused, because {} clients are connected (--clients)", self.most);
                    }
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => return,
                Err(error) => return self.rest(&error),
            }
        }
    }

    /// Lets the listeners rest, because a failure repeats at once.
    fn rest(&mut self, error: &io::Error) {
        if self.rests.is_none() {
            say!("a client cannot be accepted: {error}");
            for listener in &mut self.listeners {
                let _ = self.poll.registry().deregister(listener);
            }
        }
        self.rests = Some(Instant::now() + REST);
    }

    fn add(&mut self, mut stream: TcpStream, from: SocketAddr) {
        let token = Token(self.next);
        self.next += 1;
        let interest = Interest::READABLE | Interest::WRITABLE;
        let ready = stream
            .set_nodelay(true)
            .and_then(|()| self.poll.registry().register(&mut stream, token, interest));
        match ready {
            Ok(()) => self.clients.push(Client {
                token,
                stream,
                queue: VecDeque::new(),
                sent: 0,
                last: Instant::now(),
            }),
            Err(error) => say!("{from}: {error}"),
        }
    }

    /// Reads from a client that is ready, and sends what it has room for.
    fn serve(&mut self, token: Token) {
        let back = self.back.clone();
        self.keep(|client| {
            client.token != token || client.read(back.as_deref()).and_then(|()| client.flush()).is_ok()
        });
    }

    /// Hands every message to every client; returns true once no more come.
    fn take(&mut self, messages: &Receiver<Arc<[u8]>>) -> bool {
        let has_ended = loop {
            if self.waits && self.clients.iter().any(Client::is_full) {
                self.keep(|client| client.flush().is_ok());
                if self.clients.iter().any(Client::is_full) {
                    return false;
                }
            }
            match messages.try_recv() {
                Ok(message) => self.hand_on(&message),
                Err(TryRecvError::Empty) => break false,
                Err(TryRecvError::Disconnected) => break true,
            }
        };
        self.keep(|client| client.flush().is_ok());
        has_ended
    }

    fn hand_on(&mut self, message: &Arc<[u8]>) {
        let lost = Arc::clone(&self.lost);
        self.keep(|client| {
            let is_there = !client.is_full() || client.flush().is_ok();
            if client.is_full() {
                lost.fetch_add(1, Ordering::Relaxed);
            } else {
                client.queue.push_back(Arc::clone(message));
            }
            is_there
        });
    }

    fn forget_the_slow(&mut self) {
        self.keep(|client| client.queue.is_empty() || client.last.elapsed() < PATIENCE);
    }

    /// Keeps the clients for which the answer is true, and closes the others.
    fn keep(&mut self, is_kept: impl FnMut(&mut Client) -> bool) {
        let before = self.clients.len();
        self.clients.retain_mut(is_kept);
        self.is_full &= self.clients.len() == before;
    }
}
