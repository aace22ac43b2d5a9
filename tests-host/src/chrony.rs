//! A real chronyd that takes the time from a gpsd that reads our sentences, as a server of time does.
//!
//! gpsd leaves the time of each sentence beside that of its arrival in shared memory; chronyd looks there once a second. It
//! runs without touching the clock of this machine, and both share memory with nobody else: two more things, beside that
//! memory's own rights, that only the superuser can arrange.

use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use tempfile::TempDir;

use crate::gpsd::{Daemon, Gpsd, free_port, path_of_daemons};

/// A running chronyd with gpsd as its only source.
pub struct Chronyd {
    port: u16,
    _daemon: Daemon,
    _folder: TempDir,
}

/// What chronyd says of its source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source {
    /// Whether the clock would follow it.
    pub is_followed: bool,
    /// Whether each of the last eight looks found a new time, the last one in the lowest bit.
    pub reach: u8,
    /// By how much the clock of this machine is ahead of the last time, s.
    pub ahead_s: f64,
}

/// True where this process may do all that a [`Chronyd`] needs and the programs are there.
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
    /// Starts it beside a gpsd that shares its memory with nobody else.
    ///
    /// # Errors
    /// chronyd does not start.
    pub fn beside(gpsd: &Gpsd) -> Result<Self> {
        let folder = TempDir::new()?;
        fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o700))?;
        let (port, place) = (free_port()?, folder.path().display());
        let settings = folder.path().join("chrony.conf");
        fs::write(
            &settings,
            format!(
                "refclock SHM 0 refid GNSS poll 0\ncmdport {port}\nbindcmdaddress 127.0.0.1\n\
                 bindcmdaddress {place}/chronyd.sock\npidfile {place}/chronyd.pid\nport 0\n"
            ),
        )?;
        let mut command = Command::new("nsenter");
        command.args(["--ipc", "--target", &gpsd.process().to_string()]);
        // In the foreground, leaving the clock of this machine alone.
        command.args(["chronyd", "-x", "-d", "-u", "root", "-f"]).arg(&settings);
        command.env("PATH", path_of_daemons()?);
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        let daemon = Daemon(command.spawn().context("starting chronyd")?);
        Ok(Self { port, _daemon: daemon, _folder: folder })
    }

    /// What it says of its source; `None` until it answers.
    ///
    /// # Errors
    /// There is no `chronyc`, or it says what it never should.
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
