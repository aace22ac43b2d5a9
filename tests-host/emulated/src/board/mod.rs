//! The emulated board as an object that is started, fed, read and stopped.
//!
//! The three ports of the image are three sockets on which this process listens and to which the
//! emulator connects. No port number is guessed, and no byte is lost before both sides are ready.
//! Threads constantly drain the outgoing ports, because an emulated transmitter waits for its
//! reader and would stop the whole board.
//!
//! Every wait has a deadline. The emulator ends with the object, even if a test panics, and with
//! this process, even if it is killed.
//!
//! Time on the board is counted: one instruction is one nanosecond, so the ticks that the image
//! logs for an epoch give its instructions exactly, `instructions = ticks / f_core · 10⁹`.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `f_core` | [`CORE_HZ`] | Hz |

mod emulator;
mod log;
mod monitor;

use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

use anyhow::{Context, bail, ensure};
use raim::sentence::{FRAME_AROUND, FRAME_BEGIN};

use emulator::Emulator;
pub use emulator::{Machine, Pace, Settings, is_installed};
pub use log::{Judgement, LogLine};
pub use monitor::{Monitor, MonitorSocket};

/// Frequency of the emulated core, Hz.
pub const CORE_HZ: u64 = 168_000_000;

/// Time for which a port may refuse bytes before the board counts as stuck.
const WRITE_PATIENCE: Duration = Duration::from_secs(20);

/// A running emulated board.
pub struct EmulatedBoard {
    gnss: TcpStream,
    host: TcpStream,
    lines: Receiver<Vec<u8>>,
    ear: Arc<Ear>,
    log: Receiver<LogLine>,
    seen: Vec<LogLine>,
    emulator: Emulator,
}

impl EmulatedBoard {
    /// Boots `image` at the pace of the host.
    ///
    /// # Errors
    /// If the image cannot be read or the emulator does not start.
    pub fn start(image: &Path) -> anyhow::Result<Self> {
        Self::start_with(image, &Settings::default())
    }

    /// Boots `image` with `settings`.
    ///
    /// # Errors
    /// If the image cannot be read or the emulator does not start.
    pub fn start_with(image: &Path, settings: &Settings) -> anyhow::Result<Self> {
        let elf = std::fs::read(image).with_context(|| format!("{} cannot be read", image.display()))?;
        let table = log::table(&elf)?;
        let (emulator, [host, gnss, log_port]) = Emulator::start(image, settings)?;
        gnss.set_write_timeout(Some(WRITE_PATIENCE))?;
        host.set_write_timeout(Some(WRITE_PATIENCE))?;
        let ear = Arc::new(Ear::default());
        let lines = read_lines(host.try_clone()?, Arc::clone(&ear));
        Ok(Self { gnss, host, lines, ear, log: log::follow(log_port, table), seen: Vec::new(), emulator })
    }

    /// Sends bytes to the GNSS port.
    ///
    /// # Errors
    /// If the board does not accept them in time.
    pub fn feed(&mut self, bytes: &[u8]) -> anyhow::Result<()> {
        self.gnss.write_all(bytes).context("the board does not accept GNSS bytes")
    }

    /// Sends bytes to the host port.
    ///
    /// # Errors
    /// If the board does not accept them in time.
    pub fn send(&mut self, bytes: &[u8]) -> anyhow::Result<()> {
        self.host.write_all(bytes).context("the board does not accept commands")
    }

    /// Sends the command `$PRAIC,{text}` with its checksum, for instance `PHASE,NPA`.
    ///
    /// # Errors
    /// If the board does not accept it in time.
    pub fn command(&mut self, text: &str) -> anyhow::Result<()> {
        self.send(raim::sentence::command(text).as_bytes())
    }

    /// Returns the next line of the host port, with its line end. It discards `MAVLink` frames
    /// before it.
    ///
    /// # Errors
    /// If none comes within `patience`.
    pub fn read_line(&mut self, patience: Duration) -> anyhow::Result<String> {
        let deadline = Instant::now() + patience;
        let next = || loop {
            let left = deadline.saturating_duration_since(Instant::now());
            match self.lines.recv_timeout(left) {
                Ok(frame) if frame.first() == Some(&FRAME_BEGIN) => {}
                other => return other,
            }
        };
        match next() {
            Ok(line) => String::from_utf8(line).context("the board sent bytes that are not UTF-8"),
            Err(RecvTimeoutError::Timeout) => bail!("no line from the board within {patience:?}"),
            Err(RecvTimeoutError::Disconnected) => {
                bail!("the emulator has ended: {}", self.emulator.complaint())
            }
        }
    }

    /// Returns the next lines up to the first that starts with `prefix`, including it.
    ///
    /// # Errors
    /// If it has not come within `patience`; the message contains the last line that did.
    pub fn read_through(&mut self, prefix: &str, patience: Duration) -> anyhow::Result<Vec<String>> {
        let deadline = Instant::now() + patience;
        let mut lines: Vec<String> = Vec::new();
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            let line = self.read_line(left).with_context(|| {
                format!(
                    "waiting for {prefix}, after {:?}",
                    lines.last().map_or("nothing", |line| line.trim_end())
                )
            })?;
            let found = line.starts_with(prefix);
            lines.push(line);
            if found {
                return Ok(lines);
            }
        }
    }

    /// Returns the lines and `MAVLink` frames of the host port since the last call, unchanged and
    /// without waiting.
    pub fn heard(&mut self) -> Vec<Vec<u8>> {
        self.lines.try_iter().collect()
    }

    /// Stops or resumes reading the host port, like a busy host.
    pub fn listen(&mut self, listens: bool) {
        *self.ear.is_closed.lock().unwrap_or_else(PoisonError::into_inner) = !listens;
        self.ear.opened.notify_all();
    }

    /// Returns all that the board has logged so far.
    pub fn log(&mut self) -> &[LogLine] {
        self.seen.extend(self.log.try_iter());
        &self.seen
    }

    /// Returns the first log line from number `from` on that contains `words`, and its number.
    ///
    /// # Errors
    /// If it has not come within `patience`.
    pub fn log_with(
        &mut self,
        words: &str,
        from: usize,
        patience: Duration,
    ) -> anyhow::Result<(usize, LogLine)> {
        let deadline = Instant::now() + patience;
        loop {
            let found = self.log().iter().enumerate().skip(from).find(|(_, line)| line.text.contains(words));
            if let Some((number, line)) = found {
                return Ok((number, line.clone()));
            }
            let left = deadline.saturating_duration_since(Instant::now());
            ensure!(!left.is_zero(), "the board did not log `{words}` within {patience:?}");
            self.seen.extend(self.log.recv_timeout(left).ok());
        }
    }

    /// Returns the level of the integrity pin according to the log: low until a line says
    /// otherwise.
    pub fn pin_is_high(&mut self) -> bool {
        self.log().iter().rev().find_map(LogLine::pin_level).unwrap_or(false)
    }

    /// Returns the instructions that each epoch has cost so far, from the first byte after the last
    /// one to its last sentence.
    pub fn epoch_instructions(&mut self) -> Vec<u64> {
        self.log().iter().filter_map(LogLine::epoch_ticks).map(instructions).collect()
    }

    /// Returns the process id of the emulator.
    pub fn process_id(&self) -> u32 {
        self.emulator.process_id()
    }

    /// Ends the emulator and waits for its end. Dropping the board does the same silently.
    ///
    /// # Errors
    /// If the emulator had ended before, which a board does not do.
    pub fn stop(self) -> anyhow::Result<()> {
        self.emulator.stop()
    }
}

/// Returns the instructions that pass in `ticks` of the core clock: one each nanosecond.
pub const fn instructions(ticks: u64) -> u64 {
    Machine::Stm32f405.instructions(ticks)
}

/// State of the reader of the host port.
#[derive(Default)]
struct Ear {
    is_closed: Mutex<bool>,
    opened: Condvar,
}

impl Ear {
    fn wait_until_open(&self) {
        let is_closed = self.is_closed.lock().unwrap_or_else(PoisonError::into_inner);
        drop(self.opened.wait_while(is_closed, |is_closed| *is_closed));
    }
}

fn read_lines(port: TcpStream, ear: Arc<Ear>) -> Receiver<Vec<u8>> {
    let (sender, lines) = channel();
    std::thread::spawn(move || {
        let mut reader = BufReader::new(port);
        let mut line = Vec::new();
        while read_item(&mut reader, &mut line).is_ok_and(|count| count > 0) {
            if sender.send(std::mem::take(&mut line)).is_err() {
                return;
            }
            ear.wait_until_open();
        }
    });
    lines
}

/// Reads a `MAVLink` frame, or a line; returns the number of its bytes, 0 at the end.
fn read_item(reader: &mut impl BufRead, item: &mut Vec<u8>) -> std::io::Result<usize> {
    if reader.fill_buf()?.first() != Some(&FRAME_BEGIN) {
        return reader.read_until(b'\n', item);
    }
    let mut head = [0; 2];
    reader.read_exact(&mut head)?;
    item.extend_from_slice(&head);
    item.resize(FRAME_AROUND + usize::from(head[1]), 0);
    reader.read_exact(&mut item[head.len()..])?;
    Ok(item.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_between_lines_is_an_item_whatever_it_holds() {
        let frame = [&[FRAME_BEGIN, 3][..], b"\n$\n", &[0; 10]].concat();
        let reported = [b"$A*41\r\n", frame.as_slice(), b"$B*42\r\n"].concat();
        let (mut reader, mut items) = (reported.as_slice(), Vec::new());
        loop {
            let mut item = Vec::new();
            if read_item(&mut reader, &mut item).expect("bytes in memory") == 0 {
                break;
            }
            items.push(item);
        }
        assert_eq!(items, [b"$A*41\r\n".as_slice(), &frame, b"$B*42\r\n"]);
        assert_eq!(raim::sentence::sentences(&reported).expect("sentences"), "$A*41\r\n$B*42\r\n");
        assert!(raim::sentence::sentences(&reported[..12]).is_err(), "cut off");
    }

    #[test]
    fn thousand_instructions_are_168_ticks() {
        assert_eq!(instructions(168), 1000);
        assert_eq!(instructions(672_000), 4_000_000);
    }
}
