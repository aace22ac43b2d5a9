//! `cargo xtask replay`: `rai replay`, also on the emulated board.

use anyhow::Result;
use raim::replay::command::{self, Arguments};
use raim::replay::{BoardRun, Lump, Setup};
use rig::setup::{self, Need};
use rig::{image, lockstep};

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    command::run(arguments, Some(&on_board))
}

/// Plays the lumps on the board.
fn on_board(lumps: &mut dyn Iterator<Item = Result<Lump>>, commands: &Setup) -> Result<BoardRun> {
    setup::ensure(&[Need::Chip, Need::Emulator])?;
    let image = image::build()?;
    lockstep::on_board(&image, lumps, commands, |_| ())
}
