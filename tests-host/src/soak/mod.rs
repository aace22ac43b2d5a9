//! A soak: hours on the emulated board with everything that can go wrong, and counts that must be zero at the end.
//!
//! ```text
//! sky, recording ─► incidents ─► RTCM ─► cable ─► bad line ─► board ─┬─► sentences ─► tally ┐
//!                                                                    └─► log ───────► watch ┴─► table, page
//! ```
//!
//! | module | what |
//! |---|---|
//! | [`plan`] | which epochs, how fast, how eventful |
//! | [`scenario`], [`incident`], `early` | what is offered when: false ranges, pulled cables, resets, times that go back, ephemerides that come too early, a host that asks without end |
//! | [`noise`] | what the line does to the bytes |
//! | [`rig`] | the board, its clock, its reset button |
//! | [`tally`], [`watch`] | what the module said, and what the pin did when |
//! | [`table`], [`page`] | both, to be read |
//!
//! Time is the board's: while its core sleeps, the emulated clock leaps to the next interrupt, so an hour passes in
//! minutes. An epoch is sent when its time has come on the board; the emulator passes on about one byte a millisecond.
//! What is offered follows from the seed; when exactly a byte arrives does not, and is measured on the board.
//!
//! # What it does not show
//!
//! - An instruction takes one nanosecond, so ten milliseconds of board time are ten million instructions: on the chip at
//!   168 MHz at least six times as long.
//! - The emulated transmitter never waits: where nobody reads the host port for long, the whole chip stands still with
//!   its clock. What a full ring does is tested in process, with a wire that takes nothing (`tests/hostile`).
//! - A reset is that of the reset line: RAM keeps its content, and start-up has to clear it.
//! - Several satellites false at once, or a whole constellation, are beyond the promise of the protection levels. They are
//!   part of the soak and counted apart.

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

use noise::{Carried, Disturbance, Line, Piece};
pub use plan::Plan;
use rig::Rig;
use scenario::{Mishap, Scenario, Tempo, Turn};
use tally::{Heard, Tally};
use watch::Watch;

/// What came of a soak.
pub struct Outcome {
    /// What was soaked.
    pub name: &'static str,
    /// Its tempo.
    pub tempo: Tempo,
    /// Its seed.
    pub seed: u64,
    /// Time on the board, over all starts, s.
    pub board_s: f64,
    /// What the module said.
    pub tally: Tally,
    /// What the pin did.
    pub watch: Watch,
    /// What the line did.
    pub disturbances: Vec<(Disturbance, u64)>,
    /// How often the host port was not read for a while.
    pub unread: u64,
}

/// Soaks several boards at a time, one for each plan. `progress` gets the number of a plan and its epochs so far.
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

/// Soaks the image as planned. `progress` gets the number of epochs offered so far.
///
/// # Errors
/// The board does not start, or stops answering.
pub fn run(image: &Path, plan: Plan, progress: impl FnMut(u64)) -> Result<Outcome> {
    let mut bench = Bench::start(image, &plan, progress)?;
    let mut scenario = Scenario::new(plan.tempo, plan.seed);
    let (name, tempo, seed) = (plan.name, plan.tempo, plan.seed);
    for passage in plan.passages() {
        scenario.perform(&passage?, |turn| bench.play(&turn))?;
    }
    bench.finish()?;
    let Bench { rig, line, tally, watch, unread, next_ms, .. } = bench;
    rig.stop()?;
    let disturbances = line.counts().collect();
    Ok(Outcome { name, tempo, seed, board_s: next_ms as f64 * 1e-3, tally, watch, disturbances, unread })
}

/// Everything that takes part.
struct Bench<P> {
    rig: Rig,
    line: Line,
    tally: Tally,
    watch: Watch,
    tempo: Tempo,
    progress: P,
    /// When the next epoch is to be sent, board time, ms.
    next_ms: u64,
    was_reset: bool,
    /// Whether the host has set what it wants.
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

    /// One epoch, from its first byte to that of the next.
    fn play(&mut self, turn: &Turn) -> Result<()> {
        // What was said before this epoch is not about it, however long the host thought it over.
        self.hear()?;
        let Carried { pieces, is_harmed } = self.line.carry(&turn.bytes);
        let is_reset = matches!(turn.mishap, Some(Mishap::PowerOn { .. }));
        // What comes while the module starts is lost.
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

    /// Sends a piece after its pause; gives how long that pause was on the board, ms.
    fn send(&mut self, piece: &Piece) -> Result<u64> {
        if piece.pause_ms == 0 {
            return self.rig.feed(&piece.bytes).map(|()| 0);
        }
        let start_ms = self.rig.now_ms()?;
        self.rig.wait_until(start_ms + piece.pause_ms)?;
        self.rig.feed(&piece.bytes)?;
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
                self.rig.listen(false);
                self.tally.stop_listening();
                (self.unread_left, self.unread) = (epochs, self.unread + 1);
                Ok(())
            }
            Some(Mishap::Setting(setting)) => self.set(setting),
            Some(&Mishap::Questions { count }) => (0..count).try_for_each(|_| self.rig.command("STATS")),
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
        self.rig.command(setting)
    }

    /// Lets time pass until the next epoch is due; listens meanwhile.
    fn pass_interval(&mut self) -> Result<()> {
        self.next_ms = self.rig.now_ms()?.max(self.next_ms + self.tempo.interval_ms);
        self.rig.wait_until(self.next_ms)?;
        self.hear()?;
        match self.unread_left {
            0 => self.tally.caught_up(),
            1 => self.rig.listen(true),
            _ => {}
        }
        self.unread_left = self.unread_left.saturating_sub(1);
        Ok(())
    }

    fn hear(&mut self) -> Result<()> {
        for line in self.rig.heard() {
            // What is set once survives every restart.
            if self.tally.hear(&line) == Heard::Greeting && !std::mem::replace(&mut self.is_set_up, true) {
                // A line has one rate: noise on it for seconds would have the module look for another, and lose an epoch.
                self.rig.command("BAUD,115200")?;
                // No other phase waits as long as the hours of a recording ask for.
                self.rig.command("PHASE,CUSTOM")?;
                self.rig.command(&format!("TTA,{}", self.tempo.time_to_alert_s))?;
                self.set(&format!("HAL,{}", self.tempo.alert_limits_m[0]))?;
            }
        }
        self.rig.logged().iter().for_each(|line| self.watch.see(line));
        Ok(())
    }

    /// Lets the line be silent until the module has said so.
    fn finish(&mut self) -> Result<()> {
        self.rig.listen(true);
        let due_ms = self.rig.now_ms()? + (self.tempo.time_to_alert_s * 1e3) as u64 + 1000;
        self.rig.wait_until(due_ms)?;
        self.hear()
    }
}
