//! Datagrams among the outputs.

use std::io::{self, Write};
use std::net::UdpSocket;
use std::time::Instant;

use anyhow::{Context as _, Result};

use crate::run::words::say;
use crate::source::Pause;

/// One datagram for each message. Nobody has to listen.
pub(super) struct Datagrams {
    address: String,
    socket: UdpSocket,
    /// When the socket may be connected again, and the pause before the time after that. A name is
    /// looked up each time, which may take long.
    due: Instant,
    pause: Pause,
    is_reported: bool,
}

impl Datagrams {
    pub(super) fn to(address: &str) -> Result<Self> {
        let socket = Self::connect(address).with_context(|| format!("`{address}` must be ADDRESS:PORT"))?;
        let (address, due) = (address.to_owned(), Instant::now());
        Ok(Self { address, socket, due, pause: Pause::ADDRESS, is_reported: false })
    }

    fn connect(address: &str) -> io::Result<UdpSocket> {
        let any = if address.starts_with('[') { "[::]:0" } else { "0.0.0.0:0" };
        let socket = UdpSocket::bind(any)?;
        socket.connect(address)?;
        Ok(socket)
    }

    /// Connects again: the address of this computer, or that of the name, may be another one now.
    fn connect_again(&mut self, error: &io::Error) {
        if !std::mem::replace(&mut self.is_reported, true) {
            say!("{}: {error}", self.address);
        }
        if Instant::now() >= self.due {
            if let Ok(socket) = Self::connect(&self.address) {
                self.socket = socket;
            }
            self.due = Instant::now() + self.pause.next();
            self.pause.double();
        }
    }
}

impl Write for Datagrams {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.socket.send(bytes) {
            Ok(_) => {
                self.is_reported = false;
                self.pause.reset();
            }
            // Nobody listens there yet.
            Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => {}
            Err(error) => self.connect_again(&error),
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    /// A socket without a connection stands for one whose computer has another address now.
    #[test]
    fn socket_that_sends_no_more_is_connected_again() {
        let listener = UdpSocket::bind("127.0.0.1:0").unwrap();
        listener.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
        let mut datagrams = Datagrams::to(&listener.local_addr().unwrap().to_string()).unwrap();
        datagrams.socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        for message in [b"lost!", b"heard"] {
            datagrams.write_all(message).unwrap();
        }
        let mut heard = [0; 8];
        assert_eq!(listener.recv(&mut heard).unwrap(), 5);
        assert_eq!(&heard[..5], b"heard");
    }
}
