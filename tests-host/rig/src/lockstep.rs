//! Replay on the emulated board, beside the module in process.
//!
//! The board has its own time: it judges an epoch as soon as it has come, whatever the tags. The
//! module in process therefore receives each lump at the time of the board's clock. Both then use
//! the same time for the distance that a receiver can have moved, and for the time that satellites
//! have agreed after an alert.
//!
//! During a recovery, the next lump waits as long as it would by the tags, and [`RECOVERY_MS`] at
//! most. Without the wait, the two clocks would decide on which epoch the recovery ends, and they
//! differ by the milliseconds that bytes need.

use std::collections::VecDeque;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use raim::replay::host::{Module, Setup, check_answers, counters_of};
use raim::replay::{BoardRun, Lump};
use raim::sentence::command;

use crate::board::{EmulatedBoard, Monitor, MonitorSocket, Settings};

/// Longest time that the emulated board may take for an epoch: hundreds of times what it needs.
const PATIENCE: Duration = Duration::from_secs(20);

/// Longest recovery that is waited for, ms: the module's setting at start, and less than the time
/// to alert.
const RECOVERY_MS: u64 = 3000;

/// Verdicts after which the next one depends on time.
const RECOVERING: [&str; 2] = [",U,RECOVERING,", ",A,JUMP,"];

/// Sentences of both since the last lump, without those that are repeated at intervals.
#[derive(Clone, Debug)]
pub struct Heard {
    /// Sentences of the module in process.
    pub host: String,
    /// Sentences of the board.
    pub board: String,
}

/// Runs the lumps on the emulated board and in process, in lock step: the next one follows the
/// verdict on the last. `each` receives the sentences of both, lump by lump and at the end.
///
/// # Errors
/// The board does not start, does not answer in time, or refuses a setup command; or the source of
/// the lumps fails.
pub fn on_board(
    image: &Path,
    lumps: impl Iterator<Item = Result<Lump>>,
    setup: &Setup,
    mut each: impl FnMut(Heard),
) -> Result<BoardRun> {
    let mut both = Both::start(image, setup)?;
    for lump in lumps {
        let lump = lump?;
        each(both.receive(&lump).with_context(|| format!("{} s", lump.elapsed_s))?);
    }
    let (run, board) = both.end()?;
    each(Heard { host: String::new(), board });
    Ok(run)
}

/// Returns true for sentences that are repeated at intervals, whatever the epochs: settings and
/// losses.
pub fn is_said_by_the_clock(line: &str) -> bool {
    line.starts_with("$PRAIQ") || line.starts_with("$PRAIL")
}

/// Counter that ends the answer to `STATS`.
const LAST_COUNTER: &str = "cmd_noise";

/// The module on the board and in process.
struct Both {
    board: EmulatedBoard,
    monitor: Monitor,
    host: Module,
    comparison: Comparison,
    /// Times of the last lump by the board's clock and by the tags, ms.
    last_ms: Option<(u64, u64)>,
    is_recovering: bool,
}

impl Both {
    fn start(image: &Path, setup: &Setup) -> Result<Self> {
        let socket = MonitorSocket::open()?;
        let settings = Settings { arguments: socket.arguments()?, ..Settings::default() };
        let mut board = EmulatedBoard::start_with(image, &settings)?;
        let monitor = socket.accept(image)?;
        board.read_through("$PRAIV", PATIENCE).context("the board does not say that it started")?;
        for body in setup {
            board.send(command(body).as_bytes())?;
            let answers = board.read_through("$PRAIA", PATIENCE)?;
            check_answers(std::slice::from_ref(body), answers.last().map_or("", String::as_str))?;
        }
        let host = Module::start(setup)?;
        let comparison = Comparison::default();
        Ok(Self { board, monitor, host, comparison, last_ms: None, is_recovering: false })
    }

    /// Sends a lump to both; returns their sentences. An epoch without sentences of the host is not
    /// waited for.
    fn receive(&mut self, lump: &Lump) -> Result<Heard> {
        let now_ms = self.wait(lump.elapsed_ms())?;
        let (reported, seen) = self.host.receive(&lump.bytes, now_ms)?;
        let host = lasting(reported.split_inclusive('\n'));
        self.board.feed(&lump.bytes)?;
        let mut board = String::new();
        if !seen.is_empty() {
            board = lasting(self.board.read_through("$PRAIS", PATIENCE)?.iter().map(String::as_str));
            self.is_recovering = RECOVERING.iter().any(|words| host.contains(words));
        }
        self.comparison.receive(&host, &board);
        Ok(Heard { host, board })
    }

    /// Waits until both clocks agree that a recovery continues; returns the board's time, ms.
    fn wait(&mut self, tag_ms: u64) -> Result<u64> {
        let deadline = Instant::now() + PATIENCE;
        loop {
            let now_ms = u64::from(self.monitor.clock_ms()?);
            let (last_ms, last_tag_ms) = self.last_ms.unwrap_or((0, tag_ms));
            let wanted_ms = tag_ms.saturating_sub(last_tag_ms).min(RECOVERY_MS);
            let left_ms = (last_ms + wanted_ms).saturating_sub(now_ms);
            if left_ms == 0 || !self.is_recovering {
                self.last_ms = Some((now_ms, tag_ms));
                return Ok(now_ms);
            }
            ensure!(Instant::now() < deadline, "the clock of the board does not go on: {now_ms} ms");
            thread::sleep(Duration::from_millis(left_ms));
        }
    }

    /// Requests the counters; the answer follows all sentences of the last verdict.
    fn end(mut self) -> Result<(BoardRun, String)> {
        self.board.send(command("STATS").as_bytes())?;
        let (mut counters, mut rest) = (Vec::new(), String::new());
        while !counters.iter().any(|(name, _): &(String, u32)| name == LAST_COUNTER) {
            let mut answers = self.board.read_through("$PRAIA,STATS", PATIENCE)?;
            counters.append(&mut answers.pop().map_or_else(Vec::new, |answer| counters_of(&answer)));
            rest.push_str(&lasting(answers.iter().map(String::as_str)));
        }
        self.comparison.receive("", &rest);
        let instructions = self.board.epoch_instructions();
        let losses = self.board.log().iter().filter(|line| line.text.contains("bytes lost")).count();
        self.board.stop()?;
        Ok((BoardRun { instructions, counters, losses, difference: self.comparison.difference() }, rest))
    }
}

/// Returns the lines without those that are repeated at intervals.
fn lasting<'a>(lines: impl Iterator<Item = &'a str>) -> String {
    lines.filter(|line| !is_said_by_the_clock(line)).collect()
}

/// Comparison of two streams of sentences that should be equal. Only the lead of one over the other
/// is stored.
#[derive(Default)]
struct Comparison {
    host: VecDeque<String>,
    board: VecDeque<String>,
    first: Option<(String, String)>,
}

impl Comparison {
    fn receive(&mut self, host: &str, board: &str) {
        if self.first.is_some() {
            return;
        }
        self.host.extend(host.lines().map(str::to_owned));
        self.board.extend(board.lines().map(str::to_owned));
        while let (Some(host), Some(board)) = (self.host.front(), self.board.front()) {
            if host != board {
                self.first = Some((host.clone(), board.clone()));
                return;
            }
            self.host.pop_front();
            self.board.pop_front();
        }
    }

    /// Returns the first difference. Sentences of one side alone are a difference.
    fn difference(&self) -> Option<(String, String)> {
        let front = |lines: &VecDeque<String>| lines.front().cloned().unwrap_or_default();
        let left = (!self.host.is_empty() || !self.board.is_empty())
            .then(|| (front(&self.host), front(&self.board)));
        self.first.clone().or(left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentences_are_compared_in_their_order_whoever_is_ahead() {
        let mut comparison = Comparison::default();
        comparison.receive("a\r\nb\r\nc\r\n", "a\r\n");
        comparison.receive("d\r\n", "b\r\nc\r\n");
        comparison.receive("", "d\r\n");
        assert_eq!(comparison.difference(), None);
        comparison.receive("e\r\n", "");
        assert_eq!(comparison.difference(), Some(("e".to_owned(), String::new())));
        comparison.receive("g\r\n", "f\r\n");
        assert_eq!(comparison.difference(), Some(("e".to_owned(), "f".to_owned())));
    }
}
