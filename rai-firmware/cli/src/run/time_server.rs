//! The time for chrony, by its `refclock SOCK`: one datagram for each protected epoch, and none
//! otherwise.
//!
//! ```text
//! offset = t_UTC − t_computer                       s
//! t_UTC = tag − clock / c − leap seconds            of the epoch, as the module judged it
//! t_computer = when the first byte of its ranges came
//! ```
//!
//! | bytes | type | content |
//! |---|---|---|
//! | 0 to 15 | `struct timeval` | `t_computer` |
//! | 16 to 23 | `double` | `offset`, s |
//! | 24 to 27 | `int` | 0: the sample is no pulse, it has whole seconds |
//! | 28 to 31 | `int` | 0: no leap second is announced, because no message says so |
//! | 32 to 35 | `int` | unused |
//! | 36 to 39 | `int` | `0x534F434B` |
//!
//! This is the layout where `long` has 64 bits; `struct timeval` is that of the computer. The
//! sample is late by the time that the receiver takes until it sends, which is constant for a
//! receiver and a rate: the option `offset` of `refclock` corrects it. chrony makes the socket when
//! it starts. A datagram that it does not take is lost.
//!
//! Reference: chrony, `doc/chrony.conf.adoc` (refclock, SOCK) and `refclock_sock.c`.

use std::fmt;
use std::io;
use std::os::unix::net::UnixDatagram;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use anyhow::{Result, ensure};
use nix::libc;

use crate::run::words::say;

/// Identifies a sample.
const MAGIC: i32 = 0x534F_434B;
/// Most bytes of a path of a socket, of which the last is 0.
const PATH_BYTES: usize = 108;
/// The GPS epoch, 1980-01-06, in Unix time, s.
const GPS_EPOCH_S: f64 = 315_964_800.0;
/// Age of the first byte beyond which it does not belong to the epoch.
const LONGEST_AGE: Duration = Duration::from_secs(1);

/// An epoch whose time may be trusted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    /// GPS time of the epoch, s since the GPS epoch.
    pub(super) gps_s: f64,
    /// GPS time minus UTC, s.
    pub(super) leap_s: u8,
    /// Time of the computer when the first byte came, and its age.
    pub(super) came: SystemTime,
    pub(super) age: Duration,
}

impl Sample {
    /// Returns the datagram.
    #[allow(clippy::unnecessary_fallible_conversions, reason = "a time has 32 bits elsewhere")]
    fn bytes(&self) -> Option<Vec<u8>> {
        let came = self.came.duration_since(SystemTime::UNIX_EPOCH).ok()?;
        let utc_s = GPS_EPOCH_S + self.gps_s - f64::from(self.leap_s);
        let offset_s = utc_s - came.as_secs_f64();
        if !offset_s.is_finite() || self.age > LONGEST_AGE {
            return None;
        }
        let mut bytes = libc::time_t::try_from(came.as_secs()).ok()?.to_ne_bytes().to_vec();
        bytes.extend(libc::suseconds_t::try_from(came.subsec_micros()).ok()?.to_ne_bytes());
        bytes.resize(size_of::<libc::timeval>(), 0);
        bytes.extend(offset_s.to_ne_bytes());
        for number in [0, 0, 0, MAGIC] {
            bytes.extend(number.to_ne_bytes());
        }
        Some(bytes)
    }
}

/// The socket of a chronyd.
pub(super) struct TimeServer {
    path: PathBuf,
    socket: UnixDatagram,
    /// True once a failure was reported, until a datagram is taken.
    is_reported: bool,
}

impl fmt::Debug for TimeServer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("TimeServer").field(&self.path).finish()
    }
}

impl TimeServer {
    /// Prepares datagrams to a path, at which chronyd may be listening later.
    ///
    /// # Errors
    /// If the path is too long for a socket, or the system refuses one.
    pub(super) fn at(path: &Path) -> Result<Self> {
        let length = path.as_os_str().len();
        ensure!(
            length < PATH_BYTES,
            "{} is too long for a socket: at most {} bytes",
            path.display(),
            PATH_BYTES - 1
        );
        let socket = UnixDatagram::unbound()?;
        socket.set_nonblocking(true)?;
        Ok(Self { path: path.to_owned(), socket, is_reported: false })
    }

    /// Sends a sample. A failure is reported once.
    pub(super) fn tell(&mut self, sample: &Sample) {
        let Some(bytes) = sample.bytes() else { return };
        // The path is looked up each time, because chronyd replaces its socket when it restarts.
        match self.socket.send_to(&bytes, &self.path) {
            Err(error) if error.kind() != io::ErrorKind::WouldBlock => {
                if !std::mem::replace(&mut self.is_reported, true) {
                    say!("chrony:{}: {error}; the time is not sent", self.path.display());
                }
            }
            _ => self.is_reported = false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The offsets in a datagram are those of the documented structure.
    #[test]
    #[cfg(target_pointer_width = "64")]
    fn datagram_has_the_documented_layout() {
        // 2026-01-06 12:00:00 UTC is 1,767,700,800 in Unix time and 18 s less than GPS time.
        let came = SystemTime::UNIX_EPOCH + Duration::new(1_767_700_800, 123_456_000);
        let gps_s = 1_767_700_800.0 - 315_964_800.0 + 18.0;
        let sample = Sample { gps_s, leap_s: 18, came, age: Duration::from_millis(20) };
        let bytes = sample.bytes().unwrap();
        assert_eq!(bytes.len(), 40);
        let int = |at: usize| i32::from_ne_bytes(bytes[at..at + 4].try_into().unwrap());
        let long = |at: usize| i64::from_ne_bytes(bytes[at..at + 8].try_into().unwrap());
        assert_eq!([long(0), long(8)], [1_767_700_800, 123_456]);
        let offset_s = f64::from_ne_bytes(bytes[16..24].try_into().unwrap());
        assert!((offset_s + 0.123_456).abs() < 1e-6, "{offset_s}");
        assert_eq!([int(24), int(28), int(32), int(36)], [0, 0, 0, 0x534F_434B]);
        assert_eq!(Sample { age: Duration::from_secs(2), ..sample }.bytes(), None);
    }

    #[test]
    fn restart_of_chronyd_loses_samples_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("chrony.rai.sock");
        let mut server = TimeServer::at(&path).unwrap();
        let sample = Sample { gps_s: 1.4e9, leap_s: 18, came: SystemTime::now(), age: Duration::ZERO };
        server.tell(&sample);
        assert!(server.is_reported);
        for _ in 0..2 {
            let _ = std::fs::remove_file(&path);
            let chronyd = UnixDatagram::bind(&path).unwrap();
            server.tell(&sample);
            assert!(!server.is_reported);
            assert_eq!(chronyd.recv(&mut [0; 64]).unwrap(), sample.bytes().unwrap().len());
        }
        assert!(TimeServer::at(&folder.path().join("x".repeat(100))).is_err());
    }
}
