//! `cargo xtask campaign`: `rai campaign`, optimised if that is faster.

use anyhow::Result;
use raim::campaign::command::{self, Arguments};

use crate::optimise::{Work, done_elsewhere};

/// Time of an epoch in the development profile, s of one processor: `lpv200.toml`, half of it ARAIM
/// (7.5 s for 373,248 epochs).
const EPOCH_S: f64 = 20e-6;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    // The specification is checked first, because building takes minutes.
    let epochs = arguments.epochs()?;
    let work = Work {
        serial_s: 0.0,
        parallel_s: EPOCH_S * epochs as f64,
        source: format!("{epochs} epochs, at {:.0} µs each in lpv200.toml", 1e6 * EPOCH_S),
    };
    if done_elsewhere(&work, "the campaign was not finished")? {
        return Ok(());
    }
    command::run(arguments)
}
