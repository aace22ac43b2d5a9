//! A terminal with an empty home.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, ensure};

use super::people::Line;
use xtask::cargo::root;

/// Longest duration of a line, s.
const LIMIT_S: u32 = 3600;

/// A home with a clone.
pub(super) struct Terminal {
    home: PathBuf,
    toolchains: String,
}

/// A line that was typed, and its result.
pub(super) struct Typed {
    /// The line.
    pub(super) line: &'static Line,
    /// Everything that it printed; the home is `~`.
    pub(super) output: String,
    /// Time that it took.
    pub(super) took: Duration,
    /// Reason why it did not do what it must.
    pub(super) failure: Option<String>,
}

impl Typed {
    /// Returns the result in a few words.
    pub(super) fn summary(&self) -> String {
        let result = self.failure.as_deref().unwrap_or("as it must");
        format!("{}, {result}", self.duration())
    }

    /// Returns the duration as seconds, or as minutes and seconds.
    pub(super) fn duration(&self) -> String {
        match self.took.as_secs() {
            seconds @ 0..60 => format!("{seconds} s"),
            seconds => format!("{}:{:02} min", seconds / 60, seconds % 60),
        }
    }
}

impl Terminal {
    /// Makes the home, and clones the last commit into it.
    ///
    /// # Errors
    /// If the folder exists, or git fails.
    pub(super) fn open(home: &Path) -> Result<Self> {
        ensure!(!home.exists(), "{} must not exist", home.display());
        fs::create_dir_all(home).with_context(|| home.display().to_string())?;
        let clone =
            Command::new("git").args(["clone", "--quiet"]).arg(root()).arg(home.join("rai")).status()?;
        ensure!(clone.success(), "git cannot clone {}", root().display());
        let shown = Command::new("rustup").args(["show", "home"]).output().context("rustup cannot be run")?;
        let toolchains = String::from_utf8_lossy(&shown.stdout).trim().to_owned();
        ensure!(!toolchains.is_empty(), "rustup does not name its home");
        Ok(Self { home: home.to_owned(), toolchains })
    }

    /// Returns the folder of the clone.
    pub(super) fn clone_folder(&self) -> PathBuf {
        self.home.join("rai")
    }

    /// Types a line, and waits until it ends.
    ///
    /// # Errors
    /// If the shell cannot be run.
    pub(super) fn enter(&self, line: &'static Line) -> Result<Typed> {
        let log = self.home.join("output");
        let file = File::create(&log)?;
        let begun = Instant::now();
        let mut shell = Command::new("timeout");
        shell.args(["--kill-after=10", &LIMIT_S.to_string(), "bash", "-c", line.typed]);
        // What cargo and rustup set for this command is not for the person.
        let own = |name: &str| ["CARGO", "RUST"].iter().any(|prefix| name.starts_with(prefix));
        for (name, _) in std::env::vars().filter(|(name, _)| own(name)) {
            shell.env_remove(name);
        }
        let status = shell
            .current_dir(self.clone_folder())
            .env("HOME", &self.home)
            .env("RUSTUP_HOME", &self.toolchains)
            .env("PATH", self.path())
            .stdin(Stdio::null())
            .stdout(file.try_clone()?)
            .stderr(file)
            .status()
            .context("`timeout` and `bash` cannot be run")?;
        let took = begun.elapsed();
        let output = String::from_utf8_lossy(&fs::read(&log)?).replace(&*self.home.to_string_lossy(), "~");
        let failure = line.judge(status.code(), &output);
        Ok(Typed { line, output, took, failure })
    }

    /// Returns the search path: programs that the person installed come first.
    fn path(&self) -> String {
        let own = self.home.join(".cargo/bin");
        format!("{}:{}", own.display(), std::env::var("PATH").unwrap_or_default())
    }

    /// Deletes the home.
    ///
    /// # Errors
    /// If it cannot be deleted.
    pub(super) fn close(self) -> Result<()> {
        fs::remove_dir_all(&self.home).with_context(|| self.home.display().to_string())
    }
}
