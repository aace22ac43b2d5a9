//! Serial ports: opening one, with the next step if it fails.

use std::io;
use std::time::Duration;

use anyhow::{Result, anyhow};
use serialport::{Error, ErrorKind, SerialPort};

/// Timeout of a port that is read for as long as nothing comes: a day.
#[cfg(not(unix))]
pub(crate) const PATIENCE: Duration = Duration::from_secs(86_400);

/// Opens a port, of which a read returns after the timeout even if nothing comes.
///
/// # Errors
/// If the port does not open; the message has the reason and the next step.
pub(crate) fn open(path: &str, baud: u32, timeout: Duration) -> Result<Box<dyn SerialPort>> {
    serialport::new(path, baud)
        .timeout(timeout)
        .open()
        .map_err(|error| anyhow!("{error}: {}", advice(&error)))
}

/// Returns the next step after an error.
fn advice(error: &Error) -> String {
    match error.kind {
        ErrorKind::Io(io::ErrorKind::NotFound) => present(),
        ErrorKind::Io(io::ErrorKind::PermissionDenied) => {
            "join the group of the port, often `sudo usermod -aG dialout $USER`, and log in again".to_owned()
        }
        ErrorKind::NoDevice => {
            "if it is plugged in, another program holds it, such as gpsd or ModemManager: stop that"
                .to_owned()
        }
        _ => "is it a serial port, and can it have this rate?".to_owned(),
    }
}

/// Returns the ports of this computer.
fn present() -> String {
    let ports = serialport::available_ports().unwrap_or_default();
    let names: Vec<String> = ports.into_iter().map(|port| port.port_name).collect();
    if names.is_empty() {
        return "this computer has no serial port now; is the receiver plugged in?".to_owned();
    }
    format!("the serial ports of this computer are {}", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_followed_by_the_next_step() {
        let error = open("/dev/no-such-port", 9600, Duration::from_millis(10)).err().unwrap().to_string();
        assert!(error.contains("No such file") && error.contains("this computer"), "{error}");
        let kind = ErrorKind::Io(io::ErrorKind::PermissionDenied);
        assert!(advice(&Error::new(kind, "denied")).contains("dialout"));
        assert!(advice(&Error::new(ErrorKind::NoDevice, "busy")).contains("gpsd"));
    }
}
