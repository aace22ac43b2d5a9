//! `cargo xtask monitor`: a module on a serial port, as it speaks.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, ensure};
use tests_host::sentence::{self, Sentence, State};

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The serial port that the module's host port is on, such as /dev/ttyUSB0.
    #[arg(long)]
    port: PathBuf,
    /// Print every sentence as it comes, not only states and exclusions.
    #[arg(long)]
    raw: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let port = open(&arguments.port)?;
    for line in BufReader::new(port).split(b'\n') {
        let line = line.with_context(|| format!("{} can no longer be read", arguments.port.display()))?;
        let line = String::from_utf8_lossy(&line);
        if arguments.raw {
            println!("{}", line.trim_end());
        } else if let Some(words) = words(line.trim_end()) {
            println!("{words}");
        }
    }
    Ok(())
}

/// A terminal is set to the module's rate and left alone otherwise; a pipe or a file is read as it is.
fn open(path: &Path) -> anyhow::Result<File> {
    use std::os::unix::fs::FileTypeExt as _;
    let port = File::open(path).with_context(|| format!("{} cannot be opened", path.display()))?;
    if port.metadata()?.file_type().is_char_device() {
        let status = Command::new("stty")
            .args(["115200", "raw", "-echo", "-crtscts"])
            .stdin(port.try_clone()?)
            .status()
            .context("stty cannot be run")?;
        ensure!(status.success(), "{} is no serial port", path.display());
    }
    Ok(port)
}

fn words(line: &str) -> Option<String> {
    match sentence::parse(line) {
        Ok(Sentence::State(state)) => Some(state_words(&state)),
        Ok(Sentence::Excluded(_)) => Some(format!("           excluded: {line}")),
        Ok(_) => line.starts_with("$PRAI").then(|| line.to_owned()),
        // The first line after the port was opened is cut; noise is for `--raw` to show.
        Err(_) => None,
    }
}

fn state_words(state: &State) -> String {
    let verdict = match state.state {
        'P' => "protected",
        'A' => "ALERT",
        _ => "unavailable",
    };
    let number =
        |value: Option<f64>, unit: &str| value.map_or("–".to_owned(), |value| format!("{value:.1}{unit}"));
    format!(
        "{:>9} {verdict:<11} {:<10} {:>2}/{:<2} statistic {} of {}  HPL {}  VPL {}",
        state.time_s.map_or("–".to_owned(), |time| format!("{time:.1}")),
        state.reason,
        state.used,
        state.tracked,
        number(state.statistic, ""),
        number(state.threshold, ""),
        number(state.hpl_m, " m"),
        number(state.vpl_m, " m"),
    )
}
