//! Monitor of the emulator: it replaces an oscilloscope and a finger on the reset button.
//!
//! The board's clock is read from the image's own count of milliseconds, in RAM. The host thus
//! knows the time that has passed on the board, which at [`super::Pace::Leap`] has little to do
//! with its own.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use object::{Object, ObjectSymbol};

/// Time within which the emulator must connect, or answer.
const PATIENCE: Duration = Duration::from_secs(20);

/// The static of the image that counts milliseconds.
const CLOCK: &str = "MS_LOW";

/// Prompt of the monitor.
const PROMPT: &str = "(qemu) ";

/// Socket to which the emulator connects its monitor.
#[derive(Debug)]
pub struct MonitorSocket(TcpListener);

impl MonitorSocket {
    /// Opens a free socket.
    ///
    /// # Errors
    /// If this machine has none.
    pub fn open() -> Result<Self> {
        TcpListener::bind(("127.0.0.1", 0)).map(Self).context("no local port for the monitor")
    }

    /// Returns the emulator's arguments for the socket.
    ///
    /// # Errors
    /// If the socket has no address.
    pub fn arguments(&self) -> Result<Vec<String>> {
        let port = self.0.local_addr()?.port();
        let socket = format!("socket,id=monitor,host=127.0.0.1,port={port},nodelay=on");
        Ok(["-chardev", &socket, "-mon", "chardev=monitor,mode=readline"].map(str::to_owned).to_vec())
    }

    /// Accepts the monitor of the emulator that was started with these arguments and with `image`.
    ///
    /// # Errors
    /// If the emulator has not connected, or the image has no clock.
    pub fn accept(self, image: &Path) -> Result<Monitor> {
        self.0.set_nonblocking(true)?;
        let deadline = Instant::now() + PATIENCE;
        let port = loop {
            match self.0.accept() {
                Ok((port, _)) => break port,
                Err(_) if Instant::now() < deadline => std::thread::sleep(Duration::from_millis(5)),
                Err(error) => return Err(error).context("the emulator does not connect its monitor"),
            }
        };
        port.set_nonblocking(false)?;
        port.set_nodelay(true)?;
        port.set_read_timeout(Some(PATIENCE))?;
        let mut monitor = Monitor { port, clock_address: clock_address(image)? };
        monitor.answer()?;
        Ok(monitor)
    }
}

/// The monitor of a running emulator.
#[derive(Debug)]
pub struct Monitor {
    port: TcpStream,
    clock_address: u64,
}

impl Monitor {
    /// Returns the time on the board since its last start, ms.
    ///
    /// # Errors
    /// If the emulator does not answer.
    pub fn clock_ms(&mut self) -> Result<u32> {
        let reported = self.ask(&format!("xp /1uw {:#x}", self.clock_address))?;
        number_behind_colon(&reported).with_context(|| format!("the monitor printed no number: {reported:?}"))
    }

    /// Resets the chip, wherever its program is.
    ///
    /// # Errors
    /// If the emulator does not answer.
    pub fn reset(&mut self) -> Result<()> {
        self.ask("system_reset").map(drop)
    }

    fn ask(&mut self, command: &str) -> Result<String> {
        self.port
            .write_all(format!("{command}\n").as_bytes())
            .context("the monitor does not accept a command")?;
        self.answer()
    }

    fn answer(&mut self) -> Result<String> {
        let mut reported = Vec::new();
        let mut chunk = [0; 1024];
        while !reported.ends_with(PROMPT.as_bytes()) {
            let count = self.port.read(&mut chunk).context("the monitor does not answer")?;
            ensure!(count > 0, "the emulator has closed its monitor");
            reported.extend_from_slice(&chunk[..count]);
        }
        Ok(String::from_utf8_lossy(&reported).into_owned())
    }
}

/// Returns the address of the image's count of milliseconds, whose name the compiler mangles.
fn clock_address(image: &Path) -> Result<u64> {
    let bytes = std::fs::read(image).with_context(|| format!("{} cannot be read", image.display()))?;
    let elf = object::File::parse(&*bytes)?;
    let found = elf.symbols().find(|symbol| symbol.name().is_ok_and(|name| name.contains(CLOCK)));
    found.map(|symbol| symbol.address()).with_context(|| format!("the image has no static {CLOCK}"))
}

/// Parses the number of a line such as `0000000020009574: 15858`.
fn number_behind_colon(reported: &str) -> Option<u32> {
    reported.lines().rev().find_map(|line| line.split_once(": ")?.1.trim().parse().ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn word_is_read_behind_the_echo_of_the_command() {
        let reported = "xp /1uw 0x20009574\r\n0000000020009574: 15858\r\n(qemu) ";
        assert_eq!(number_behind_colon(reported), Some(15_858));
        assert_eq!(number_behind_colon("unknown command: 'xq'\r\n(qemu) "), None);
    }
}
