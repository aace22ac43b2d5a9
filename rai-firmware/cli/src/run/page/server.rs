//! The server of the page: one thread for all connections, each bounded in bytes and time.
//!
//! | bound | |
//! |---|---|
//! | connections at once | as many as `--clients`; further ones are closed |
//! | bytes of a request | [`REQUEST_BYTES`] |
//! | time of a request, and of an answer without progress | [`PATIENCE`] |
//! | bytes that wait for a page | [`MOST_WAITING`]; a slower one is closed, and connects again |

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result};
use mio::net::{TcpListener, TcpStream};
use mio::{Events, Interest, Poll, Token, Waker};

use super::request::{self, Asked, REQUEST_BYTES, Request};
use super::text::{self, Html};
use crate::page::live::{self, State};
use crate::run::share::Back;
use crate::run::words::say;

/// Longest time of a request, and of an answer of which nothing is taken.
const PATIENCE: Duration = Duration::from_secs(5);
/// Bytes that may wait for a page.
const MOST_WAITING: usize = 1 << 19;
/// Time between two signs of life to a page.
const BEAT: Duration = Duration::from_secs(1);
/// Pause of the listener after a failure to accept.
const REST: Duration = Duration::from_secs(1);

const LISTENER: Token = Token(0);
const WAKER: Token = Token(1);
const FIRST: usize = 2;

/// Starts the server's thread; returns its address and the waker that says that there is news.
///
/// # Errors
/// If the address cannot be used.
pub(super) fn start(
    address: &str,
    most: usize,
    state: Arc<Mutex<State>>,
    back: Option<Arc<Back>>,
) -> Result<(SocketAddr, Arc<Waker>)> {
    let listener = std::net::TcpListener::bind(address)?;
    listener.set_nonblocking(true)?;
    let own = listener.local_addr()?;
    let poll = Poll::new()?;
    let waker = Arc::new(Waker::new(poll.registry(), WAKER).context("a waker")?);
    let mut server = Server {
        poll,
        listener: TcpListener::from_std(listener),
        is_local: own.ip().is_loopback(),
        html: Html::new(),
        state,
        back,
        most,
        connections: Vec::new(),
        next: FIRST,
        rests: None,
        told: 0,
        beaten: Instant::now(),
    };
    server.watch()?;
    thread::spawn(move || {
        if let Err(error) = server.run() {
            say!("error: the page: {error}");
        }
    });
    Ok((own, waker))
}

/// A connection.
#[derive(Debug)]
struct Connection {
    token: Token,
    stream: TcpStream,
    request: Vec<u8>,
    /// Bytes that wait to be sent.
    waiting: Vec<u8>,
    /// True once the answer goes on for as long as the page is open.
    is_page: bool,
    /// True once the answer is complete.
    has_answer: bool,
    /// Time of the last progress.
    last: Instant,
}

impl Connection {
    /// Sends what the other side takes; an error if it is gone, or has all of its answer.
    fn flush(&mut self) -> io::Result<()> {
        while !self.waiting.is_empty() {
            match self.stream.write(&self.waiting) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(count) => {
                    self.waiting.drain(..count);
                    self.last = Instant::now();
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(()),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        if self.has_answer {
            // The other side has all of it before it sees the end.
            let _ = self.stream.shutdown(std::net::Shutdown::Write);
            return Err(ErrorKind::ConnectionAborted.into());
        }
        if self.is_page {
            self.last = Instant::now();
        }
        Ok(())
    }

    /// Reads what has come; an error if the other side is gone or sends too much.
    fn read(&mut self) -> io::Result<()> {
        let mut bytes = [0; 2048];
        loop {
            match self.stream.read(&mut bytes) {
                Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
                // Nothing that follows the request is read.
                Ok(_) if self.is_page || self.has_answer => return Ok(()),
                Ok(count) => {
                    self.request.extend_from_slice(bytes.get(..count).unwrap_or_default());
                    if self.request.len() > REQUEST_BYTES {
                        return Ok(());
                    }
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(()),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// Adds an event of a page.
    fn tell(&mut self, event: &[u8]) {
        self.waiting.extend_from_slice(event);
    }
}

#[derive(Debug)]
struct Server {
    poll: Poll,
    listener: TcpListener,
    is_local: bool,
    html: Html,
    state: Arc<Mutex<State>>,
    /// The way from other programs to the receiver.
    back: Option<Arc<Back>>,
    most: usize,
    connections: Vec<Connection>,
    next: usize,
    /// End of the listener's rest.
    rests: Option<Instant>,
    /// Number of verdicts of which the pages know.
    told: u64,
    beaten: Instant,
}

impl Server {
    fn run(&mut self) -> io::Result<()> {
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
                    LISTENER => self.accept(),
                    token => self.serve(token),
                }
            }
            if self.state.lock().unwrap_or_else(PoisonError::into_inner).has_ended {
                return Ok(());
            }
            self.tell();
            self.connections.retain_mut(|connection| {
                let is_quick =
                    connection.last.elapsed() < PATIENCE && connection.waiting.len() < MOST_WAITING;
                is_quick && connection.flush().is_ok()
            });
            if self.rests.is_some_and(|until| until <= Instant::now()) {
                self.rests = None;
                self.watch()?;
            }
        }
    }

    /// Returns the time to the next instant at which something is due; `None` without connections.
    fn timeout(&self) -> Option<Duration> {
        let now = Instant::now();
        let quickest = self.connections.iter().map(|connection| connection.last + PATIENCE);
        let beat = (!self.connections.is_empty()).then(|| self.beaten + BEAT);
        let due = quickest.chain(beat).chain(self.rests).min()?;
        Some(due.saturating_duration_since(now) + Duration::from_millis(1))
    }

    fn watch(&mut self) -> io::Result<()> {
        self.poll.registry().register(&mut self.listener, LISTENER, Interest::READABLE)
    }

    fn accept(&mut self) {
        loop {
            match self.listener.accept() {
                Ok((stream, _)) if self.connections.len() < self.most => self.add(stream),
                Ok((stream, _)) => drop(stream),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => return,
                Err(_) => {
                    // A failure, such as too many open files, repeats at once.
                    let _ = self.poll.registry().deregister(&mut self.listener);
                    self.rests = Some(Instant::now() + REST);
                    return;
                }
            }
        }
    }

    fn add(&mut self, mut stream: TcpStream) {
        let token = Token(self.next);
        self.next += 1;
        let interest = Interest::READABLE | Interest::WRITABLE;
        let ready = stream
            .set_nodelay(true)
            .and_then(|()| self.poll.registry().register(&mut stream, token, interest));
        if ready.is_ok() {
            self.connections.push(Connection {
                token,
                stream,
                request: Vec::new(),
                waiting: Vec::new(),
                is_page: false,
                has_answer: false,
                last: Instant::now(),
            });
        }
    }

    /// Reads from a connection, and answers its request once it is complete.
    fn serve(&mut self, token: Token) {
        let Self { connections, html, state, back, is_local, .. } = self;
        connections.retain_mut(|connection| {
            if connection.token != token {
                return true;
            }
            if connection.read().is_err() {
                return false;
            }
            if !connection.is_page && !connection.has_answer {
                answer(connection, html, state, back.as_deref(), *is_local);
            }
            connection.flush().is_ok()
        });
    }

    /// Tells the pages a new verdict, and that the service lives.
    fn tell(&mut self) {
        if !self.connections.iter().any(|connection| connection.is_page) {
            return;
        }
        let state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let is_new = std::mem::replace(&mut self.told, state.verdicts) != state.verdicts;
        if !is_new && self.beaten.elapsed() < BEAT {
            return;
        }
        self.beaten = Instant::now();
        let event = event("state", &live::json(&state));
        drop(state);
        for connection in self.connections.iter_mut().filter(|connection| connection.is_page) {
            connection.tell(&event);
        }
    }
}

/// Answers a request, if it is complete.
fn answer(
    connection: &mut Connection,
    html: &Html,
    state: &Mutex<State>,
    back: Option<&Back>,
    is_local: bool,
) {
    const TEXT: &str = "text/plain; charset=utf-8";
    let state = || state.lock().unwrap_or_else(PoisonError::into_inner);
    let (asked, is_head) = match request::read(&connection.request, is_local) {
        Request::Partial => return,
        Request::Refused(status) => {
            connection.has_answer = true;
            return connection.tell(&request::answer(status, TEXT, &format!("{status}\n"), html, false));
        }
        Request::Whole(asked, is_head) => (asked, is_head),
    };
    let (status, kind, body) = match asked {
        Asked::Events if !is_head => {
            let head = format!("{}\r\n", request::head("200 OK", "text/event-stream; charset=utf-8", html));
            let (past, now) = {
                let state = state();
                (state.past(), live::json(&state))
            };
            connection.is_page = true;
            connection.tell(head.as_bytes());
            connection.tell(&event("past", &past));
            return connection.tell(&event("state", &now));
        }
        Asked::Events => ("200 OK", "text/event-stream; charset=utf-8", String::new()),
        Asked::Page => ("200 OK", "text/html; charset=utf-8", html.page.clone()),
        Asked::State => ("200 OK", "application/json", format!("{}\n", live::json(&state()))),
        Asked::Metrics => {
            ("200 OK", "text/plain; version=0.0.4; charset=utf-8", text::metrics(&state(), back))
        }
        Asked::Health => {
            let state = state();
            let status = if state.is_healthy() { "200 OK" } else { "503 Service Unavailable" };
            (status, TEXT, format!("{} {}\n", state.word(), state.reason()))
        }
    };
    connection.has_answer = true;
    connection.tell(&request::answer(status, kind, &body, html, is_head));
}

/// Returns a server-sent event.
fn event(name: &str, data: &serde_json::Value) -> Vec<u8> {
    format!("event: {name}\ndata: {data}\n\n").into_bytes()
}
