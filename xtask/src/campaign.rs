//! `cargo xtask campaign`: `rai campaign`, optimised.

use anyhow::Result;
use raim::campaign::command::{self, Arguments};

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    // The specification is checked first, because building takes minutes.
    if cfg!(debug_assertions) && arguments.computes()? {
        return crate::cargo::again_optimised("the campaign was not finished");
    }
    command::run(arguments)
}
