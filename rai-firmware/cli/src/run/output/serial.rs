//! A serial port among the outputs.

use std::io::{self, Write};
use std::time::{Duration, Instant};

use anyhow::Result;

use crate::run::words::say;
use crate::source::{Pause, open_serial};

/// Longest time that a port may take to send a message.
const PATIENCE: Duration = Duration::from_secs(5);

/// A serial port, which is opened again if it fails. Until then its messages are lost.
pub(super) struct SerialPort {
    name: String,
    baud: u32,
    port: Option<Box<dyn Write + Send>>,
    pause: Pause,
    /// When it is opened again.
    due: Instant,
    /// True if it is opened again.
    is_live: bool,
}

impl SerialPort {
    pub(super) fn open(name: &str, baud: u32, is_live: bool) -> Result<Self> {
        let port = open_serial(name, baud, PATIENCE)?;
        let (name, pause) = (name.to_owned(), Pause::RECEIVER);
        Ok(Self { name, baud, port: Some(Box::new(port)), pause, due: Instant::now(), is_live })
    }

    fn open_again(&mut self) {
        if let Ok(port) = open_serial(&self.name, self.baud, PATIENCE) {
            say!("{}: open again", self.name);
            self.port = Some(Box::new(port));
        } else {
            self.wait();
        }
    }

    fn wait(&mut self) {
        self.due = Instant::now() + self.pause.next();
        self.pause.double();
    }
}

impl Write for SerialPort {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.port.is_none() && Instant::now() >= self.due {
            self.open_again();
        }
        let Some(port) = &mut self.port else { return Ok(bytes.len()) };
        match port.write_all(bytes).and_then(|()| port.flush()) {
            Ok(()) => self.pause.reset(),
            Err(error) if !self.is_live => return Err(error),
            Err(error) => {
                say!("{}: {error}; it is opened again", self.name);
                self.port = None;
                self.wait();
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::io::Read as _;
    use std::thread;

    use super::*;

    /// Plugs a port in behind a link: a pseudo-terminal, whose other end is returned.
    fn plug(link: &std::path::Path) -> nix::pty::OpenptyResult {
        let ends = nix::pty::openpty(None, None).unwrap();
        let _ = std::fs::remove_file(link);
        std::os::unix::fs::symlink(nix::unistd::ttyname(&ends.slave).unwrap(), link).unwrap();
        ends
    }

    #[test]
    fn port_that_was_gone_is_written_again() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("tty");
        let ends = plug(&link);
        let mut port = SerialPort::open(link.to_str().unwrap(), 57_600, true).unwrap();
        drop(ends);
        while port.port.is_some() {
            port.write_all(b"lost").unwrap();
        }
        let ends = plug(&link);
        let start = Instant::now();
        while port.port.is_none() {
            assert!(start.elapsed() < PATIENCE, "it is not opened again");
            port.write_all(b"heard").unwrap();
            thread::sleep(Duration::from_millis(10));
        }
        let mut heard = [0; 5];
        std::fs::File::from(ends.master).read_exact(&mut heard).unwrap();
        assert_eq!(&heard, b"heard");
        drop(ends.slave);
    }
}
