//! Serial ports: the one place that opens them, by the crate `serialport`.

use std::io;
use std::time::Duration;

use anyhow::{Result, anyhow};
use serialport::{Error, ErrorKind, SerialPort};

/// Opens a port, of which a read returns after the timeout even if nothing comes.
///
/// # Errors
/// If the port does not open; the message has the reason and the next step.
pub(crate) fn open(path: &str, baud: u32, timeout: Duration) -> Result<Box<dyn SerialPort>> {
    native(path, baud, timeout).map_err(|error| anyhow!("{error}: {}", advice(&error)))
}

#[cfg(not(unix))]
fn native(path: &str, baud: u32, timeout: Duration) -> serialport::Result<Box<dyn SerialPort>> {
    serialport::new(path, baud).timeout(timeout).open()
}

/// Opens a port. A pseudo-terminal outlives this program, and would stay closed to all users but
/// root if it stayed exclusive; the lock on it, which other instances of `rai` respect, ends with
/// the program.
#[cfg(unix)]
fn native(path: &str, baud: u32, timeout: Duration) -> serialport::Result<Box<dyn SerialPort>> {
    let is_pseudo = is_pseudo_terminal(path);
    // macOS refuses a rate for a pseudo-terminal, and the crate takes 0 for "leave it".
    let baud = if is_pseudo && cfg!(target_os = "macos") { 0 } else { baud };
    let mut port = serialport::new(path, baud).timeout(timeout).open_native()?;
    if is_pseudo {
        port.set_exclusive(false)?;
    }
    Ok(Box::new(port))
}

/// Returns true for a path or a link to a pseudo-terminal of Linux or macOS.
#[cfg(unix)]
fn is_pseudo_terminal(path: &str) -> bool {
    let device = std::fs::canonicalize(path).unwrap_or_default();
    let device = device.to_string_lossy();
    ["/dev/pts/", "/dev/ttys"].iter().any(|folder| device.starts_with(folder))
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

    #[cfg(target_os = "linux")]
    mod pseudo {
        use std::fs::File;
        use std::io::{Read as _, Write as _};

        use nix::pty::openpty;

        use super::*;
        use crate::source::line::Both;
        use crate::source::{Source, listen};

        fn listen_at(path: &str, baud: u32) -> Result<Both> {
            listen(&Source::Serial(path.to_owned(), baud))
        }

        /// Returns both sides of a terminal, and its path.
        fn terminal() -> (File, File, String) {
            let pair = openpty(None, None).unwrap();
            let path = nix::unistd::ttyname(&pair.slave).unwrap().display().to_string();
            (File::from(pair.master), File::from(pair.slave), path)
        }

        /// Returns the settings of a terminal, as another program prints them.
        fn settings(path: &str) -> String {
            let output = std::process::Command::new("stty").args(["-a", "-F", path]).output().unwrap();
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            String::from_utf8(output.stdout).unwrap()
        }

        #[test]
        fn a_terminal_passes_every_byte_both_ways() {
            let (mut other, _side, path) = terminal();
            // A new terminal echoes, and waits for the ends of lines.
            assert!(!settings(&path).contains("-echo "), "{}", settings(&path));
            let (mut port, commands) = listen_at(&path, 57_600).unwrap();
            let set = settings(&path);
            for want in ["-echo ", "-icanon", "-isig", "-ixon", "-opost", "-crtscts", " cs8"] {
                assert!(set.contains(want), "{want}: {set}");
            }
            // Bytes that a terminal that is not raw would change, hold back or take as a command.
            let want = b"\x00\x03\x04\x0a\x0d\x11\x13\x1a\x7f\xb5\x62\xff";
            let mut have = [0; 12];
            other.write_all(want).unwrap();
            port.read_exact(&mut have).unwrap();
            assert_eq!(&have, want);
            commands.unwrap().write_all(want).unwrap();
            other.read_exact(&mut have).unwrap();
            assert_eq!(&have, want, "without an echo of what came first");
        }

        /// The kernel returns the rate. A u-blox may have one that is not among the usual ones.
        #[test]
        fn a_terminal_has_the_rate_that_was_asked_for() {
            let (_other, _side, path) = terminal();
            for want in [9_600, 115_200, 250_000] {
                let port = open(&path, want, Duration::from_millis(10)).unwrap();
                assert_eq!(port.baud_rate().unwrap(), want);
            }
        }

        #[test]
        fn the_end_of_the_other_side_is_the_end() {
            let (other, _side, path) = terminal();
            let (mut port, _commands) = listen_at(&path, 115_200).unwrap();
            drop(other);
            assert_eq!(port.read(&mut [0; 9]).unwrap(), 0);
        }

        #[test]
        fn a_terminal_has_one_reader_at_a_time_and_is_free_after_it() {
            let (_other, _side, path) = terminal();
            let first = listen_at(&path, 115_200).unwrap();
            let error = listen_at(&path, 115_200).err().unwrap().to_string();
            assert!(error.contains("another program holds it"), "{error}");
            drop(first);
            assert!(listen_at(&path, 115_200).is_ok());
        }
    }
}
