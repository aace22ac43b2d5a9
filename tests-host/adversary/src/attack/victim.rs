//! The module in process, and its report on each epoch beside the truth.

use anyhow::{Context as _, Result, ensure};
use raim::sentence::{self, EpochOutput};
use raim_core::frame::{Ecef, Enu, LocalFrame};
use raim_core::velocity::Velocity;
use raim_firmware::input::Suspicion;
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};
use raim_firmware::settings::SEALED_BYTES;

/// Delay between an epoch's bytes and the next look at the clock, as a share of the time between
/// epochs.
const LOOK: f64 = 0.6;

/// A module under attack.
pub struct Victim {
    receiver: Receiver<MemoryPin>,
    now_ms: u64,
    step_ms: u64,
}

/// Returns a module that has received nothing.
fn started() -> Result<Receiver<MemoryPin>> {
    let boot = Boot::on_host("attack");
    Receiver::new(MemoryPin::default(), boot).context("the module cannot start")
}

/// The report on one epoch, and its error.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// Sentences of the epoch.
    pub said: EpochOutput,
    /// Horizontal distance from the truth, m; infinite without a position.
    pub horizontal_error_m: f64,
    /// Difference in height, m; infinite without a position.
    pub vertical_error_m: f64,
    /// True if the pin was high at the end.
    pub is_promised: bool,
}

impl Seen {
    /// Returns true for a promised position with an error above one of its levels.
    pub fn is_misleading(&self) -> bool {
        // A missing level bounds nothing.
        let exceeds = |error_m: f64, level_m: Option<f64>| level_m.is_none_or(|level_m| error_m > level_m);
        let state = &self.said.state;
        self.is_promised
            && (exceeds(self.horizontal_error_m, state.hpl_m) || exceeds(self.vertical_error_m, state.vpl_m))
    }

    /// Returns true for a promised position with an error above one of the limits in force.
    pub fn is_hazardous(&self) -> bool {
        let exceeds = |error_m: f64, limit_m: Option<f64>| limit_m.is_some_and(|limit_m| error_m > limit_m);
        let state = &self.said.state;
        self.is_promised
            && (exceeds(self.horizontal_error_m, state.hal_m) || exceeds(self.vertical_error_m, state.val_m))
    }
}

impl Victim {
    /// Returns a module that has received these commands and nothing else. Epochs are `step_s`
    /// apart by its clock.
    ///
    /// # Errors
    /// If a command is refused.
    pub fn new(commands: &[&str], step_s: f64) -> Result<Self> {
        let mut victim = Self { receiver: started()?, now_ms: 0, step_ms: (step_s * 1e3) as u64 };
        for command in commands {
            let answer = victim.obey(command)?;
            ensure!(answer.contains(",OK"), "`{command}` is refused: {answer}");
        }
        Ok(victim)
    }

    /// Seals the settings and restarts from that memory, without a power cycle.
    ///
    /// # Errors
    /// If the module cannot start.
    pub fn restart(&mut self, sealed: &mut [u8; SEALED_BYTES]) -> Result<()> {
        self.receiver.seal(sealed);
        self.restart_from(sealed)
    }

    /// Restarts from the memory, without a power cycle, and then seals the settings as a board
    /// does.
    ///
    /// # Errors
    /// If the module cannot start.
    pub fn restart_from(&mut self, sealed: &mut [u8; SEALED_BYTES]) -> Result<()> {
        self.receiver = started()?;
        self.receiver.restore(sealed, false);
        self.receiver.seal(sealed);
        Ok(())
    }

    /// Returns the hash of the settings in force.
    pub fn settings_hash(&self) -> u32 {
        self.receiver.configuration().hash()
    }

    /// Sends a command and returns the answer.
    ///
    /// # Errors
    /// If the answer is not UTF-8.
    pub fn obey(&mut self, command: &str) -> Result<String> {
        let mut answer = Vec::new();
        self.receiver.command(sentence::command(command).as_bytes(), &mut answer);
        Ok(String::from_utf8(answer)?)
    }

    /// Sends the bytes of one time step to the GNSS port and returns the reports. At the end of the
    /// step the antenna is at `truth`.
    ///
    /// # Errors
    /// If a sentence cannot be read.
    pub fn hear(&mut self, bytes: &[u8], truth: Ecef) -> Result<Vec<Seen>> {
        let mut said = Vec::new();
        self.receiver.gnss(bytes, self.now_ms, &mut said);
        self.receiver.tick(self.now_ms + (self.step_ms as f64 * LOOK) as u64, &mut said);
        self.now_ms += self.step_ms;
        self.seen(&said, truth)
    }

    /// Keeps the line silent for `for_s` seconds and returns the reports.
    ///
    /// # Errors
    /// If a sentence cannot be read.
    pub fn silence(&mut self, for_s: f64, truth: Ecef) -> Result<Vec<Seen>> {
        let mut said = Vec::new();
        let end_ms = self.now_ms + (for_s * 1e3) as u64;
        for now_ms in (self.now_ms..=end_ms).step_by(100) {
            self.receiver.tick(now_ms, &mut said);
        }
        self.now_ms = end_ms;
        self.seen(&said, truth)
    }

    fn seen(&self, said: &[u8], truth: Ecef) -> Result<Vec<Seen>> {
        let outputs = sentence::epochs(std::str::from_utf8(said)?)?;
        let (is_promised, last) = (self.receiver.pin().high, outputs.len().saturating_sub(1));
        let seen = |(index, said): (usize, EpochOutput)| {
            let error =
                said.position.map(|position| LocalFrame::at(truth).rotate(position.to_ecef() - truth));
            Seen {
                horizontal_error_m: error.map_or(f64::INFINITY, Enu::horizontal),
                vertical_error_m: error.map_or(f64::INFINITY, |error| error.up.abs()),
                // If another epoch follows at once, the pin can no longer be read, so the sentence
                // counts.
                is_promised: if index == last { is_promised } else { said.state.is_protected() },
                said,
            }
        };
        Ok(outputs.into_iter().enumerate().map(seen).collect())
    }

    /// Returns the module's own clock, s.
    pub fn now_s(&self) -> f64 {
        self.now_ms as f64 * 1e-3
    }

    /// Returns true while the pin is high.
    pub fn is_promised(&self) -> bool {
        self.receiver.pin().high
    }

    /// Returns the current state of spoofing detection.
    pub fn spoofing(&self) -> Suspicion {
        self.receiver.interference().1
    }

    /// Returns the velocity of the last epoch, if there is one.
    pub fn velocity(&self) -> Option<&Velocity> {
        self.receiver.velocity()
    }

    /// Returns a counter, or 0 if no counter has this name.
    pub fn counter(&self, name: &str) -> u32 {
        self.receiver.statistics().find(|(counter, _)| *counter == name).map_or(0, |(_, count)| count)
    }
}
