//! The board on the bench, with its clock and its reset button.

use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use rig::board::{EmulatedBoard, LogLine, Monitor, MonitorSocket, Pace, Settings};

/// Time without progress of the board's clock after which the board counts as stuck.
const PATIENCE: Duration = Duration::from_mins(1);

/// Approximate time that the emulator takes for an idle millisecond.
const PER_MS: Duration = Duration::from_micros(40);

/// Interval between two readings of the board's clock: short enough for an epoch per second, long
/// enough to cost little.
const LOOKS: std::ops::RangeInclusive<Duration> = Duration::from_millis(2)..=Duration::from_millis(100);

/// A board with its bench.
pub struct Rig {
    /// The board, with its ports.
    pub board: EmulatedBoard,
    monitor: Monitor,
    lines_seen: usize,
    earlier_starts_ms: u64,
}

impl Rig {
    /// Powers the board, with a clock that leaps over idle time.
    ///
    /// # Errors
    /// If the emulator does not start, or the image cannot be read.
    pub fn start(image: &Path) -> Result<Self> {
        let socket = MonitorSocket::open()?;
        let settings = Settings { pace: Pace::Leap, arguments: socket.arguments()?, ..Settings::default() };
        let board = EmulatedBoard::start_with(image, &settings)?;
        let monitor = socket.accept(image)?;
        Ok(Self { board, monitor, lines_seen: 0, earlier_starts_ms: 0 })
    }

    /// Returns board time since the first start, over all resets, ms.
    ///
    /// # Errors
    /// If the emulator does not answer.
    pub fn now_ms(&mut self) -> Result<u64> {
        Ok(self.earlier_starts_ms + u64::from(self.monitor.clock_ms()?))
    }

    /// Waits until board time reaches `due_ms`.
    ///
    /// # Errors
    /// If the board's clock does not advance.
    pub fn wait_until(&mut self, due_ms: u64) -> Result<()> {
        let (mut before_ms, mut moved) = (self.now_ms()?, Instant::now());
        while before_ms < due_ms {
            let left = PER_MS.saturating_mul(u32::try_from(due_ms - before_ms).unwrap_or(u32::MAX));
            std::thread::sleep(left.clamp(*LOOKS.start(), *LOOKS.end()));
            let now_ms = self.now_ms()?;
            if now_ms != before_ms {
                (before_ms, moved) = (now_ms, Instant::now());
            }
            ensure!(moved.elapsed() < PATIENCE, "the board's clock has stopped at {now_ms} ms");
        }
        Ok(())
    }

    /// Resets the chip, whatever it is doing.
    ///
    /// # Errors
    /// If the emulator does not answer.
    pub fn reset(&mut self) -> Result<()> {
        let before_ms = self.monitor.clock_ms()?;
        self.earlier_starts_ms += u64::from(before_ms);
        self.monitor.reset().context("the reset line")?;
        // RAM keeps the old time until start-up clears it.
        let deadline = Instant::now() + PATIENCE;
        while self.monitor.clock_ms()? >= before_ms {
            ensure!(Instant::now() < deadline, "the board does not restart");
            std::thread::sleep(*LOOKS.start());
        }
        Ok(())
    }

    /// Returns the lines of the log since the last call.
    pub fn logged(&mut self) -> Vec<LogLine> {
        let lines = self.board.log().get(self.lines_seen..).unwrap_or_default().to_vec();
        self.lines_seen += lines.len();
        lines
    }
}
