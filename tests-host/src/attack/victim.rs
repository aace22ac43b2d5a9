//! The module in process, and what it says of each epoch beside the truth.

use anyhow::{Context as _, Result, ensure};
use rai_core::frame::{Ecef, Enu, LocalFrame};
use rai_core::velocity::Velocity;
use rai_firmware::input::Suspicion;
use rai_firmware::receiver::{Boot, Receiver};
use rai_firmware::settings::SEALED_BYTES;

use crate::pin::Pin;
use crate::sentence::{self, EpochOutput};

/// How long after an epoch's bytes the module looks at the clock, as a share of the time between epochs.
const LOOK: f64 = 0.6;

/// A module under attack.
pub struct Victim {
    receiver: Receiver<Pin>,
    now_ms: u64,
    step_ms: u64,
}

/// A module that has heard nothing.
fn started() -> Result<Receiver<Pin>> {
    let boot = Boot::on_host("attack");
    Receiver::new(Pin::default(), boot).context("the module cannot start")
}

/// What was said of one epoch, and how wrong it was.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// The sentences.
    pub said: EpochOutput,
    /// Distance over the ground from the truth, m; infinite without a position.
    pub horizontal_error_m: f64,
    /// Difference in height, m; infinite without a position.
    pub vertical_error_m: f64,
    /// Whether the pin was high in the end.
    pub is_promised: bool,
}

impl Seen {
    /// A promised position beyond one of its levels.
    pub fn is_misleading(&self) -> bool {
        // A level that is not said bounds nothing.
        let exceeds = |error_m: f64, level_m: Option<f64>| level_m.is_none_or(|level_m| error_m > level_m);
        let state = &self.said.state;
        self.is_promised
            && (exceeds(self.horizontal_error_m, state.hpl_m) || exceeds(self.vertical_error_m, state.vpl_m))
    }

    /// A promised position beyond one of the limits that are set.
    pub fn is_hazardous(&self) -> bool {
        let exceeds = |error_m: f64, limit_m: Option<f64>| limit_m.is_some_and(|limit_m| error_m > limit_m);
        let state = &self.said.state;
        self.is_promised
            && (exceeds(self.horizontal_error_m, state.hal_m) || exceeds(self.vertical_error_m, state.val_m))
    }
}

impl Victim {
    /// A module that has heard nothing but these commands; epochs are `step_s` apart by its clock.
    ///
    /// # Errors
    /// A command that is refused.
    pub fn new(commands: &[&str], step_s: f64) -> Result<Self> {
        let mut victim = Self { receiver: started()?, now_ms: 0, step_ms: (step_s * 1e3) as u64 };
        for command in commands {
            let answer = victim.obey(command)?;
            ensure!(answer.contains(",OK"), "`{command}` is refused: {answer}");
        }
        Ok(victim)
    }

    /// Seals the settings and starts again with what the memory then holds, not after power-on.
    ///
    /// # Errors
    /// A module that cannot start.
    pub fn restart(&mut self, sealed: &mut [u8; SEALED_BYTES]) -> Result<()> {
        self.receiver.seal(sealed);
        self.restart_from(sealed)
    }

    /// Starts again with what the memory holds, not after power-on; like a board it then seals the settings.
    ///
    /// # Errors
    /// A module that cannot start.
    pub fn restart_from(&mut self, sealed: &mut [u8; SEALED_BYTES]) -> Result<()> {
        self.receiver = started()?;
        self.receiver.restore(sealed, false);
        self.receiver.seal(sealed);
        Ok(())
    }

    /// What tells settings from others.
    pub fn settings_hash(&self) -> u32 {
        self.receiver.configuration().hash()
    }

    /// Gives a command; gives the answer.
    ///
    /// # Errors
    /// An answer that is no text.
    pub fn obey(&mut self, command: &str) -> Result<String> {
        let mut answer = Vec::new();
        self.receiver.command(sentence::command(command).as_bytes(), &mut answer);
        Ok(String::from_utf8(answer)?)
    }

    /// Takes the bytes of the GNSS port of one step of time, at whose end the antenna is at `truth`; gives what is said.
    ///
    /// # Errors
    /// A sentence that cannot be read.
    pub fn hear(&mut self, bytes: &[u8], truth: Ecef) -> Result<Vec<Seen>> {
        let mut said = Vec::new();
        self.receiver.gnss(bytes, self.now_ms, &mut said);
        self.receiver.tick(self.now_ms + (self.step_ms as f64 * LOOK) as u64, &mut said);
        self.now_ms += self.step_ms;
        self.seen(&said, truth)
    }

    /// Lets the line be silent for a while; gives what is said.
    ///
    /// # Errors
    /// A sentence that cannot be read.
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
                // Of an epoch that another follows at once the pin is seen no more: what was said counts.
                is_promised: if index == last { is_promised } else { said.state.is_protected() },
                said,
            }
        };
        Ok(outputs.into_iter().enumerate().map(seen).collect())
    }

    /// The module's own clock, s.
    pub fn now_s(&self) -> f64 {
        self.now_ms as f64 * 1e-3
    }

    /// Whether the pin is high.
    pub fn is_promised(&self) -> bool {
        self.receiver.pin().high
    }

    /// What is held for said of spoofing.
    pub fn spoofing(&self) -> Suspicion {
        self.receiver.interference().1
    }

    /// The velocity of the last epoch, where it is told one.
    pub fn velocity(&self) -> Option<&Velocity> {
        self.receiver.velocity()
    }

    /// A counter, 0 where there is none of the name.
    pub fn counter(&self, name: &str) -> u32 {
        self.receiver.statistics().find(|(counter, _)| *counter == name).map_or(0, |(_, count)| count)
    }
}
