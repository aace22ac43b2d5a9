//! The port of a receiver, to read from and to write to.

use std::io::{Read, Write};
use std::net::{TcpStream, ToSocketAddrs as _};
use std::time::Duration;

use anyhow::{Context as _, Result};

use crate::serial;

/// Rate of a serial port if none is named: that of u-blox generation 9 and later at start.
const BAUD: u32 = 38_400;

/// A read returns after this time even if nothing comes.
const READ_TIMEOUT: Duration = Duration::from_millis(50);

/// Longest wait for a TCP server.
const PATIENCE: Duration = Duration::from_secs(5);

/// A port in both directions.
pub(super) trait Port: Read + Write {}

impl<P: Read + Write> Port for P {}

/// Opens a port: `tcp://host:port`, or a serial port with an optional `@` and rate.
///
/// # Errors
/// If the port does not exist, or the rate is not a number.
pub(super) fn open(name: &str) -> Result<Box<dyn Port>> {
    if let Some(address) = name.strip_prefix("tcp://") {
        let mut addresses = address.to_socket_addrs().context("a TCP port must be tcp://HOST:PORT")?;
        let stream = addresses.find_map(|address| TcpStream::connect_timeout(&address, PATIENCE).ok());
        let stream = stream.context("nothing answers there")?;
        stream.set_read_timeout(Some(READ_TIMEOUT))?;
        return Ok(Box::new(stream));
    }
    let name = name.strip_prefix("serial:").unwrap_or(name);
    let (path, baud) = match name.rsplit_once('@') {
        Some((path, baud)) => (path, baud.parse().context("the rate behind @ must be a number")?),
        None => (name, BAUD),
    };
    Ok(Box::new(serial::open(path, baud, READ_TIMEOUT)?))
}
