//! The module, and its report on each epoch beside the truth.

use std::fmt;
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

use anyhow::{Result, ensure};
use raim::sentence;
use raim::verdict::EpochOutput;
use raim_core::frame::{Ecef, Enu, LocalFrame};

use super::module::Module;
use super::tally::Tally;

pub use super::seen::Seen;

/// Delay between an epoch's bytes and the next look at the clock, as a share of the time between
/// epochs.
const LOOK: f64 = 0.6;

/// Tally of all modules since it was taken last.
static ALL: LazyLock<Mutex<Tally>> = LazyLock::new(Mutex::default);

fn all() -> MutexGuard<'static, Tally> {
    // A tally is whole after each epoch, so that one of a thread that panicked is too.
    ALL.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the tally of all modules since the last call.
pub fn take_tally() -> Tally {
    std::mem::take(&mut *all())
}

/// Error of an attack that finds no opportunity.
#[derive(Debug)]
pub struct NoOpportunity(pub &'static str);

impl fmt::Display for NoOpportunity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.0)
    }
}

impl std::error::Error for NoOpportunity {}

/// A module under attack.
pub struct Victim {
    pub(super) module: Module,
    now_ms: u64,
    step_ms: u64,
}

impl Victim {
    /// Returns a module that has received these commands and nothing else. Epochs are `step_s`
    /// apart by its clock.
    ///
    /// # Errors
    /// If a command is refused.
    pub fn new(commands: &[&str], step_s: f64) -> Result<Self> {
        let mut victim = Self { module: Module::start()?, now_ms: 0, step_ms: (step_s * 1e3) as u64 };
        for command in commands {
            let answer = victim.obey(command)?;
            // A module without this part is attacked without it.
            if answer.contains("not in this build") {
                continue;
            }
            ensure!(answer.contains(",OK"), "`{command}` is refused: {answer}");
        }
        Ok(victim)
    }

    /// Sends a command and returns the answer.
    ///
    /// # Errors
    /// If the answer is not UTF-8.
    pub fn obey(&mut self, command: &str) -> Result<String> {
        Ok(String::from_utf8(self.module.command(sentence::command(command).as_bytes())?)?)
    }

    /// Sends the bytes of one time step to the GNSS port and returns the reports. At the end of the
    /// step the antenna is at `truth`.
    ///
    /// # Errors
    /// If a sentence cannot be read.
    pub fn receive(&mut self, bytes: &[u8], truth: Ecef) -> Result<Vec<Seen>> {
        let mut reported = self.module.gnss(bytes, self.now_ms)?;
        reported.extend(self.module.tick(self.now_ms + (self.step_ms as f64 * LOOK) as u64)?);
        self.now_ms += self.step_ms;
        self.seen(&reported, truth)
    }

    /// Sends the bytes of one time step after another, and counts the reports.
    ///
    /// # Errors
    /// If a sentence cannot be read.
    pub fn judge(&mut self, steps: impl IntoIterator<Item: AsRef<[u8]>>, truth: Ecef) -> Result<Tally> {
        let mut tally = Tally::default();
        for bytes in steps {
            tally.add_all(&self.receive(bytes.as_ref(), truth)?);
        }
        Ok(tally)
    }

    /// Keeps the line silent for `for_s` seconds and returns the reports.
    ///
    /// # Errors
    /// If a sentence cannot be read.
    pub fn silence(&mut self, for_s: f64, truth: Ecef) -> Result<Vec<Seen>> {
        let mut reported = Vec::new();
        let end_ms = self.now_ms + (for_s * 1e3) as u64;
        for now_ms in (self.now_ms..=end_ms).step_by(100) {
            reported.extend(self.module.tick(now_ms)?);
        }
        self.now_ms = end_ms;
        self.seen(&reported, truth)
    }

    fn seen(&self, reported: &[u8], truth: Ecef) -> Result<Vec<Seen>> {
        let outputs = sentence::epochs(std::str::from_utf8(reported)?)?;
        let (is_promised, last) = (self.module.is_promised(), outputs.len().saturating_sub(1));
        let seen = |(index, reported): (usize, EpochOutput)| {
            let error =
                reported.position.map(|position| LocalFrame::at(truth).rotate(position.to_ecef() - truth));
            Seen {
                horizontal_error_m: error.map_or(f64::INFINITY, Enu::horizontal),
                vertical_error_m: error.map_or(f64::INFINITY, |error| error.up.abs()),
                // If another epoch follows at once, the pin can no longer be read, so the sentence
                // counts.
                is_promised: if index == last { is_promised } else { reported.state.is_protected() },
                reported,
            }
        };
        let seen: Vec<Seen> = outputs.into_iter().enumerate().map(seen).collect();
        // Recordings without a known place are told from the centre of the earth.
        if truth != Ecef::CENTRE {
            all().add_all(&seen);
        }
        Ok(seen)
    }

    /// Returns the module's own clock, s.
    pub fn now_s(&self) -> f64 {
        self.now_ms as f64 * 1e-3
    }

    /// Returns true while the pin is high.
    pub fn is_promised(&self) -> bool {
        self.module.is_promised()
    }

    /// Returns a counter, or 0 if no counter has this name.
    ///
    /// # Errors
    /// If the module does not answer.
    pub fn counter(&mut self, name: &str) -> Result<u32> {
        self.module.counter(name)
    }
}
