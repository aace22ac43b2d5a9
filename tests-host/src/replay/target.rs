//! The module on the emulated board.

use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result};

use super::Lump;
use super::host::{HostRun, Setup, check_answers, command, counters_of};
use crate::board::EmulatedBoard;

/// The longest that the emulated board may take for an epoch: hundreds of times what it needs.
const PATIENCE: Duration = Duration::from_secs(20);

/// What came of a run on the emulated board.
#[derive(Clone, Debug)]
pub struct BoardRun {
    /// The sentences, of all epochs in one piece.
    pub sentences: String,
    /// Target instructions of each epoch, where the board logged them.
    pub instructions: Vec<u64>,
    /// The board's counters at the end, by name.
    pub counters: Vec<(String, u32)>,
    /// Times that the board logged lost bytes or sentences.
    pub losses: usize,
}

/// Runs the lumps on the emulated board, in lock step: the next follows the verdict on the last.
///
/// `expected` is the host's run in lock step; an epoch of which the host says nothing is not waited for.
///
/// # Errors
/// The board does not start, does not answer in time, or refuses a setup command.
pub fn on_board(
    image: &Path,
    lumps: &[Lump],
    expected: &HostRun,
    setup: &Setup,
    mut progress: impl FnMut(usize),
) -> Result<BoardRun> {
    let mut board = EmulatedBoard::start(image)?;
    board.read_through("$PRAIV", PATIENCE).context("the board does not say that it started")?;
    for body in setup {
        board.send(command(body).as_bytes())?;
        let answers = board.read_through("$PRAIA", PATIENCE)?;
        check_answers(std::slice::from_ref(body), answers.last().map_or("", String::as_str))?;
    }
    let mut lines = Vec::new();
    for (done, (lump, expected)) in lumps.iter().zip(&expected.said).enumerate() {
        board.feed(&lump.bytes)?;
        if expected.of_epoch.contains("$PRAIS") {
            let epoch = board.read_through("$PRAIS", PATIENCE);
            lines.append(&mut epoch.with_context(|| format!("epoch {done}, {} s", lump.elapsed_s))?);
        }
        progress(done + 1);
    }
    // Whatever follows the last verdict comes before the answer to a last command.
    board.send(command("STATS").as_bytes())?;
    let mut counters = Vec::new();
    while !counters.iter().any(|(name, _): &(String, u32)| name == LAST_COUNTER) {
        let mut answers = board.read_through("$PRAIA,STATS", PATIENCE)?;
        counters.append(&mut answers.pop().map_or_else(Vec::new, |answer| counters_of(&answer)));
        lines.append(&mut answers);
    }
    let instructions = board.epoch_instructions();
    let losses = board.log().iter().filter(|line| line.text.contains("bytes lost")).count();
    board.stop()?;
    let sentences = lines.into_iter().filter(|line| !is_said_by_the_clock(line)).collect();
    Ok(BoardRun { sentences, instructions, counters, losses })
}

/// True for what is said from time to time, whatever epochs come: settings and losses.
pub fn is_said_by_the_clock(line: &str) -> bool {
    line.starts_with("$PRAIQ") || line.starts_with("$PRAIL")
}

/// The counter that ends the answer to `STATS`.
const LAST_COUNTER: &str = "cmd_noise";
