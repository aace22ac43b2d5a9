//! A soak: hours on the emulated board with every kind of disturbance, and counts that must be zero
//! at the end.
//!
//! ```text
//! sky, recording ─► incidents ─► RTCM ─► cable ─► bad line ─► board ─┬─► sentences ─► tally ┐
//!                                                                    └─► log ───────► watch ┴─► table, page
//! ```
//!
//! | module | content |
//! |---|---|
//! | [`plan`] | the epochs, their pace, and the rate of incidents |
//! | [`scenario`], [`incident`], `early` | false ranges, pulled cables, resets, times that go back, early ephemerides, questions of the host |
//! | [`noise`] | the effect of the line on the bytes |
//! | [`rig`] | the board, its clock, its reset button |
//! | [`tally`], [`watch`] | the module's reports, and the pin over time |
//! | [`table`], [`page`] | both for readers |
//!
//! Time is the board's. While its core sleeps, the emulated clock leaps to the next interrupt, so
//! an hour passes in minutes. An epoch is sent when its time has come on the board; the emulator
//! passes about one byte per millisecond. The seed determines the input, but not the exact arrival
//! of a byte, which is measured on the board.
//!
//! # What it does not show
//!
//! - An instruction takes one nanosecond, so ten milliseconds of board time are ten million
//!   instructions. On the chip at 168 MHz they take at least six times as long.
//! - The emulated transmitter never waits. If the host port is not read for long, the whole chip
//!   stops together with its clock. A full ring is tested in process, with a wire that accepts
//!   nothing (`tests/hostile`).
//! - A reset is that of the reset line: RAM keeps its content, and start-up must clear it.
//! - Several false satellites at once, or a whole false constellation, are beyond the promise of
//!   the protection levels. They are part of the soak and are counted separately.

mod early;
pub mod incident;
pub mod noise;
pub mod page;
pub mod plan;
pub mod rig;
pub mod scenario;
pub mod table;
pub mod tally;
pub mod watch;

use std::path::Path;

use anyhow::{Result, anyhow};
use rig::Rig;

use noise::{Carried, Disturbance, Line, Piece};
pub use plan::Plan;
use scenario::{Mishap, Scenario, Tempo, Turn};
use tally::{Heard, Tally};
use watch::Watch;

/// Result of a soak.
pub struct Outcome {
    /// Name of the plan.
    pub name: &'static str,
    /// Pace of the soak.
    pub tempo: Tempo,
    /// Seed of the soak.
    pub seed: u64,
    /// Board time over all starts, s.
    pub board_s: f64,
    /// Counts of the module's reports.
    pub tally: Tally,
    /// Record of the pin.
    pub watch: Watch,
    /// Number of disturbances of the line, by kind.
    pub disturbances: Vec<(Disturbance, u64)>,
    /// Number of periods in which the host port was not read.
    pub unread: u64,
}

/// Soaks several boards in parallel, one per plan. `progress` receives the index of a plan and its
/// epochs so far.
///
/// # Errors
/// As [`run`].
pub fn run_all(image: &Path, plans: Vec<Plan>, progress: impl Fn(usize, u64) + Sync) -> Result<Vec<Outcome>> {
    let progress = &progress;
    std::thread::scope(|scope| {
        let soak = |(index, plan)| scope.spawn(move || run(image, plan, |epochs| progress(index, epochs)));
        let running: Vec<_> = plans.into_iter().enumerate().map(soak).collect();
        running.into_iter().map(|board| board.join().map_err(|_| anyhow!("a soak panicked"))?).collect()
    })
}

/// Soaks the image according to a plan. `progress` receives the number of epochs sent so far.
///
/// # Errors
/// If the board does not start, or stops answering.
pub fn run(image: &Path, plan: Plan, progress: impl FnMut(u64)) -> Result<Outcome> {
    let mut bench = Bench::start(image, &plan, progress)?;
    let mut scenario = Scenario::new(plan.tempo, plan.seed);
    let (name, tempo, seed) = (plan.name, plan.tempo, plan.seed);
    for passage in plan.passages() {
        scenario.perform(&passage?, |turn| bench.play(&turn))?;
    }
    bench.finish()?;
    let Bench { rig, line, tally, watch, unread, next_ms, .. } = bench;
    rig.board.stop()?;
    let disturbances = line.counts().collect();
    Ok(Outcome { name, tempo, seed, board_s: next_ms as f64 * 1e-3, tally, watch, disturbances, unread })
}

/// All participants of a soak.
struct Bench<P> {
    rig: Rig,
    line: Line,
    tally: Tally,
    watch: Watch,
    tempo: Tempo,
    progress: P,
    /// Board time at which the next epoch is due, ms.
    next_ms: u64,
    was_reset: bool,
    /// True once the host has sent its settings.
    is_set_up: bool,
    unread_left: u32,
    unread: u64,
}

impl<P: FnMut(u64)> Bench<P> {
    fn start(image: &Path, plan: &Plan, progress: P) -> Result<Self> {
        let mut bench = Self {
            rig: Rig::start(image)?,
            line: Line::new(plan.tempo.disturbance, plan.seed),
            tally: Tally::new(plan.tempo.time_to_alert_s),
            watch: Watch::new(plan.tempo.time_to_alert_s),
            tempo: plan.tempo,
            progress,
            next_ms: 0,
            was_reset: false,
            is_set_up: false,
            unread_left: 0,
            unread: 0,
        };
        bench.pass_interval()?;
        Ok(bench)
    }

    /// Plays one epoch, from its first byte to that of the next.
    fn play(&mut self, turn: &Turn) -> Result<()> {
        // Earlier sentences are not about this epoch, however long the host left them unread.
        self.receive()?;
        let Carried { pieces, is_harmed } = self.line.carry(&turn.bytes);
        let is_reset = matches!(turn.mishap, Some(Mishap::PowerOn { .. }));
        // Bytes that arrive while the module starts are lost.
        let was_reset = std::mem::replace(&mut self.was_reset, is_reset);
        let mut is_whole = !is_harmed && !is_reset && !was_reset;
        for piece in pieces {
            is_whole &= self.send(&piece)? <= noise::HARMLESS_PAUSE_MS;
        }
        self.tally.offer(turn.offer, is_whole, self.rig.now_ms()? as f64 * 1e-3);
        self.suffer(turn.mishap.as_ref())?;
        self.pass_interval()?;
        (self.progress)(self.tally.offered);
        Ok(())
    }

    /// Sends a piece after its pause; returns the length of that pause on the board, ms.
    fn send(&mut self, piece: &Piece) -> Result<u64> {
        if piece.pause_ms == 0 {
            return self.rig.board.feed(&piece.bytes).map(|()| 0);
        }
        let start_ms = self.rig.now_ms()?;
        self.rig.wait_until(start_ms + piece.pause_ms)?;
        self.rig.board.feed(&piece.bytes)?;
        Ok(self.rig.now_ms()? - start_ms)
    }

    fn suffer(&mut self, mishap: Option<&Mishap>) -> Result<()> {
        match mishap {
            Some(&Mishap::PowerOn { after_ms }) => {
                self.rig.wait_until(self.next_ms + after_ms)?;
                self.tally.expect_start();
                self.rig.reset()
            }
            Some(&Mishap::Unread { epochs }) => {
                self.rig.board.listen(false);
                self.tally.stop_listening();
                (self.unread_left, self.unread) = (epochs, self.unread + 1);
                Ok(())
            }
            Some(Mishap::Setting(setting)) => self.set(setting),
            Some(&Mishap::Questions { count }) => {
                (0..count).try_for_each(|_| self.rig.board.command("STATS"))
            }
            None => Ok(()),
        }
    }

    fn set(&mut self, setting: &str) -> Result<()> {
        if let Some(limit_m) = setting.strip_prefix("HAL,").and_then(|limit_m| limit_m.parse().ok()) {
            self.tally.expect_limit(limit_m);
        }
        if setting == "FORGET" {
            self.tally.expect_lateness();
        }
        self.rig.board.command(setting)
    }

    /// Waits until the next epoch is due, and reads the host port meanwhile.
    fn pass_interval(&mut self) -> Result<()> {
        self.next_ms = self.rig.now_ms()?.max(self.next_ms + self.tempo.interval_ms);
        self.rig.wait_until(self.next_ms)?;
        self.receive()?;
        match self.unread_left {
            0 => self.tally.caught_up(),
            1 => self.rig.board.listen(true),
            _ => {}
        }
        self.unread_left = self.unread_left.saturating_sub(1);
        Ok(())
    }

    fn receive(&mut self) -> Result<()> {
        for line in self.rig.board.heard() {
            // Settings survive every restart, so they are sent once.
            if self.tally.receive(&line) == Heard::Greeting && !std::mem::replace(&mut self.is_set_up, true) {
                // The rate of the line is fixed. With seconds of noise the module would otherwise
                // search for another rate and lose an epoch.
                self.rig.board.command("BAUD,115200")?;
                // Only this phase allows a time to alert as long as the intervals of a recording
                // require.
                self.rig.board.command("PHASE,CUSTOM")?;
                self.rig.board.command(&format!("TTA,{}", self.tempo.time_to_alert_s))?;
                self.set(&format!("HAL,{}", self.tempo.alert_limits_m[0]))?;
            }
        }
        self.rig.logged().iter().for_each(|line| self.watch.see(line));
        Ok(())
    }

    /// Keeps the line silent until the module has reported it.
    fn finish(&mut self) -> Result<()> {
        self.rig.board.listen(true);
        let due_ms = self.rig.now_ms()? + (self.tempo.time_to_alert_s * 1e3) as u64 + 1000;
        self.rig.wait_until(due_ms)?;
        self.receive()
    }
}
