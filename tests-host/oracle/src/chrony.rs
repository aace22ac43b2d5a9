//! A real chronyd that takes the time from a gpsd that reads our sentences, or from a socket of its
//! own, as a time server does.
//!
//! gpsd writes the time of each sentence and that of its arrival to shared memory; chronyd reads
//! them once a second. It runs without touching the clock of this machine, and both share memory
//! with no other process. Only the superuser can arrange these two things and the rights of that
//! memory.

use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use tempfile::TempDir;

use crate::gpsd::{Daemon, Gpsd, free_port, path_of_daemons};

/// A running chronyd with one source.
pub struct Chronyd {
    port: u16,
    _daemon: Daemon,
    _folder: TempDir,
}

/// State of chronyd's source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source {
    /// True if the clock would follow the source.
    pub is_followed: bool,
    /// Results of the last eight polls, one bit each, set for a new time; the last one in the
    /// lowest bit.
    pub reach: u8,
    /// Lead of this machine's clock over the last time, s.
    pub ahead_s: f64,
}

/// Returns true if this process has the rights that a [`Chronyd`] needs and the programs are
/// installed.
pub fn is_possible() -> bool {
    let is_superuser = fs::metadata("/proc/self").is_ok_and(|status| {
        use std::os::unix::fs::MetadataExt as _;
        status.uid() == 0
    });
    let can_share_apart = || Command::new("unshare").args(["--ipc", "true"]).stderr(Stdio::null()).status();
    let answers = |program: &str| {
        let mut command = Command::new(program);
        let command = command.arg("-v").stdout(Stdio::null()).stderr(Stdio::null());
        path_of_daemons().is_ok_and(|path| command.env("PATH", path).status().is_ok())
    };
    is_superuser
        && can_share_apart().is_ok_and(|status| status.success())
        && answers("chronyd")
        && answers("chronyc")
}

impl Chronyd {
    /// Starts chronyd beside a gpsd that shares its memory with no other process.
    ///
    /// # Errors
    /// If chronyd does not start.
    pub fn beside(gpsd: &Gpsd) -> Result<Self> {
        let mut apart = Command::new("nsenter");
        apart.args(["--ipc", "--target", &gpsd.process().to_string(), "chronyd"]);
        Self::launched_by(apart, TempDir::new()?, "SHM 0")
    }

    /// Starts chronyd with a socket for samples, and returns the path of the socket too.
    ///
    /// # Errors
    /// If chronyd does not start.
    pub fn with_socket() -> Result<(Self, PathBuf)> {
        let folder = TempDir::new()?;
        let path = folder.path().join("chrony.rai.sock");
        // Each sample counts by itself, so that each poll shows whether one came.
        let source = format!("SOCK {} filter 1", path.display());
        Ok((Self::launched_by(Command::new("chronyd"), folder, &source)?, path))
    }

    fn launched_by(mut command: Command, folder: TempDir, source: &str) -> Result<Self> {
        fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o700))?;
        let (port, place) = (free_port()?, folder.path().display());
        let settings = folder.path().join("chrony.conf");
        fs::write(
            &settings,
            format!(
                "refclock {source} refid GNSS poll 0\ncmdport {port}\nbindcmdaddress 127.0.0.1\n\
                 bindcmdaddress {place}/chronyd.sock\npidfile {place}/chronyd.pid\nport 0\n"
            ),
        )?;
        // The daemon runs in the foreground and leaves the clock of this machine alone.
        command.args(["-x", "-d", "-u", "root", "-f"]).arg(&settings);
        command.env("PATH", path_of_daemons()?);
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        let daemon = Daemon(command.spawn().context("starting chronyd")?);
        Ok(Self { port, _daemon: daemon, _folder: folder })
    }

    /// Returns the state of its source; `None` until it answers.
    ///
    /// # Errors
    /// If `chronyc` is missing, or its answer has an unknown form.
    pub fn source(&self) -> Result<Option<Source>> {
        let answer = Command::new("chronyc")
            .args(["-h", "127.0.0.1", "-p", &self.port.to_string(), "-c", "sources"])
            .output()
            .context("chronyc")?;
        if !answer.status.success() {
            return Ok(None);
        }
        let line = String::from_utf8(answer.stdout)?;
        let fields: Vec<&str> = line.trim().split(',').collect();
        ensure!(fields.len() == 10 && fields[2] == "GNSS", "chronyc: {line}");
        Ok(Some(Source {
            is_followed: fields[1] == "*",
            reach: u8::from_str_radix(fields[5], 8).context("octal")?,
            ahead_s: fields[8].parse().context("seconds")?,
        }))
    }
}
