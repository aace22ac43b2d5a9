//! Command `evaluate`: linearised epochs through the core.

use std::fs::File;
use std::io::{BufRead, BufReader, stdin, stdout};
use std::path::PathBuf;

use super::{HELP, Part, Scalar, run_part};
use anyhow::{Context as _, ensure};

/// Arguments of the command.
#[derive(clap::Args)]
#[allow(clippy::struct_excessive_bools, reason = "one flag for each kind of line, and one at most")]
#[command(after_long_help = HELP)]
pub struct Arguments {
    /// JSON lines, plain or gzip (default: standard input)
    file: Option<PathBuf>,
    /// Scalar type of the core, f64 or f32; overrides the lines
    #[arg(long)]
    scalar: Option<Scalar>,
    /// The lines are degrees of freedom, probabilities and a non-centrality
    #[arg(long, conflicts_with_all = ["clock", "clock_raim"])]
    thresholds: bool,
    /// The lines are windows of receiver clocks
    #[arg(long)]
    clock: bool,
    /// The lines are epochs aided by a forecast receiver clock
    #[arg(long, conflicts_with = "clock")]
    clock_raim: bool,
    /// The lines are epochs with integrity parameters of each satellite
    #[arg(long, conflicts_with_all = ["thresholds", "clock", "clock_raim"])]
    araim: bool,
}

impl Arguments {
    fn part(&self) -> Part {
        if self.araim {
            return Part::Araim;
        }
        match (self.thresholds, self.clock, self.clock_raim) {
            (true, _, _) => Part::Thresholds,
            (_, true, _) => Part::Clock,
            (_, _, true) => Part::ClockRaim,
            _ => Part::Epochs,
        }
    }
}

/// Runs the command.
///
/// # Errors
/// If the lines cannot be read, or if one could not be evaluated.
pub fn run(arguments: Arguments) -> anyhow::Result<()> {
    let part = arguments.part();
    let input: Box<dyn BufRead> = match arguments.file {
        Some(path) => {
            Box::new(BufReader::new(File::open(&path).with_context(|| path.display().to_string())?))
        }
        None => Box::new(stdin().lock()),
    };
    let summary = run_part(part, input, stdout().lock(), arguments.scalar)?;
    let reason = summary.first_error.unwrap_or_default();
    ensure!(
        summary.errors == 0,
        "{} of {} lines could not be evaluated; the first: {reason}",
        summary.errors,
        summary.lines
    );
    Ok(())
}
