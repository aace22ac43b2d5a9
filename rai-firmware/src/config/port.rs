//! The host port's incoming side: bytes to commands, and their answers.

use embedded_io::Write;

use super::key::Key;
use super::line::{Line, LineAssembler, LineError};
use super::{Command, Configuration, Refusal};
use crate::counters::{self, count};
use crate::output::nmea::write_answer;

/// What a command asks of the receiver, beyond the answer that it got already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// The configuration has changed, and the change was answered.
    Reconfigured,
    /// Answer with [`crate::output::nmea::write_counters`].
    Statistics,
    /// Run the known-answer tests and answer with [`crate::output::nmea::write_answer`] or [`crate::output::nmea::write_refusal`].
    SelfTest,
    /// The settings in force are meant; this was answered.
    Confirmed,
    /// The last position counts for nothing; this was answered.
    Forget,
    /// The next epoch is of this GPS week; this was answered.
    Week(u16),
    /// Start again; this was answered.
    Reset,
}

/// What a byte of the host port has led to.
///
/// Two things, since neither waits for the other: a host that does not read its answers is obeyed nevertheless.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub struct Heard<E> {
    /// What is to be done.
    pub action: Option<Action>,
    /// Whether the answer got out, where there was one to give.
    pub answered: Result<(), E>,
}

/// What came in on the host port.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Counters {
    obeyed: u32,
    refused: u32,
    checksum: u32,
    too_long: u32,
    unknown_key: u32,
    foreign: u32,
    noise: u32,
}

/// The host port's incoming side: bytes to commands.
#[derive(Clone, Debug, Default)]
pub struct CommandPort {
    lines: LineAssembler,
    counters: Counters,
}

impl CommandPort {
    /// A port that has heard nothing.
    pub const fn new() -> Self {
        let counters = Counters {
            obeyed: 0,
            refused: 0,
            checksum: 0,
            too_long: 0,
            unknown_key: 0,
            foreign: 0,
            noise: 0,
        };
        Self { lines: LineAssembler::new(), counters }
    }

    /// Takes one byte. Where it completes a command, that is obeyed or refused, and answered.
    pub fn push<W: Write>(
        &mut self,
        byte: u8,
        configuration: &mut Configuration,
        host: &mut W,
    ) -> Heard<W::Error> {
        let counters = &mut self.counters;
        let answered = match self.lines.push(byte) {
            None => Ok(()),
            Some(Err(LineError::Foreign)) => {
                count(&mut counters.foreign);
                Ok(())
            }
            Some(Err(LineError::Noise)) => {
                count(&mut counters.noise);
                Ok(())
            }
            Some(Err(LineError::TooLong)) => {
                count(&mut counters.too_long);
                Refusal::TooLong.answer("", host)
            }
            Some(Ok(line)) => return obey(line, counters, configuration, host),
        };
        Heard { action: None, answered }
    }

    /// What came in, by name: commands obeyed and refused (wrong checksums and unknown keys among them), sentences that are no
    /// command, and breaks by characters that belong to none.
    pub fn counters(&self) -> impl Iterator<Item = (&'static str, u32)> + use<> {
        COUNTERS.into_iter().zip(self.counts())
    }

    /// The counter of a number.
    pub(crate) fn counter(&self, mut number: usize) -> Option<(&'static str, u32)> {
        counters::at(&COUNTERS, &self.counts(), &mut number)
    }

    /// In the order of [`COUNTERS`].
    const fn counts(&self) -> [u32; COUNTERS.len()] {
        let Counters { obeyed, refused, checksum, too_long, unknown_key, foreign, noise } = self.counters;
        [obeyed, refused, checksum, unknown_key, too_long, foreign, noise]
    }
}

/// What the counters are called.
const COUNTERS: [&str; 7] =
    ["cmd_ok", "cmd_refused", "cmd_checksum", "cmd_unknown_key", "cmd_too_long", "cmd_foreign", "cmd_noise"];

/// Obeys a complete line that is addressed to the module.
fn obey<W: Write>(
    line: Line<'_>,
    counters: &mut Counters,
    configuration: &mut Configuration,
    host: &mut W,
) -> Heard<W::Error> {
    match understand(line, configuration) {
        Ok(Understood::Question(key)) => {
            count(&mut counters.obeyed);
            Heard { action: None, answered: configuration.answer(key, host) }
        }
        Ok(Understood::Order(action)) => {
            count(&mut counters.obeyed);
            let answered = match action {
                Action::Reconfigured => {
                    write_answer(line.key(), line.values(), warning(line, configuration), host)
                }
                Action::Forget | Action::Confirmed | Action::Week(_) | Action::Reset => {
                    write_answer(line.key(), line.values(), None, host)
                }
                Action::Statistics | Action::SelfTest => Ok(()),
            };
            Heard { action: Some(action), answered }
        }
        Err(refusal) => {
            count(&mut counters.refused);
            match refusal {
                Refusal::Checksum => count(&mut counters.checksum),
                Refusal::UnknownKey => count(&mut counters.unknown_key),
                _ => {}
            }
            Heard { action: None, answered: refusal.answer(line.short_key(), host) }
        }
    }
}

/// What has been obeyed already, but for what is left to do or to say.
enum Understood {
    Question(Key),
    Order(Action),
}

/// What whoever sets this ought to know.
fn warning(line: Line<'_>, configuration: &Configuration) -> Option<&'static str> {
    match line.key() {
        "POLICY" | "PHASE" | "HAL" => configuration.warning(),
        "ISM" => configuration.warning_of_promises(),
        _ => None,
    }
}

/// Checks, reads and applies a line.
fn understand(line: Line<'_>, configuration: &mut Configuration) -> Result<Understood, Refusal> {
    if !line.checksum_matches() {
        return Err(Refusal::Checksum);
    }
    Ok(match Command::read(line.key(), line.values())? {
        Command::Set(setting) => {
            let mut changed = *configuration;
            changed.change(setting)?;
            *configuration = changed;
            Understood::Order(Action::Reconfigured)
        }
        Command::Ask(key) => Understood::Question(key),
        Command::Statistics => Understood::Order(Action::Statistics),
        Command::SelfTest => Understood::Order(Action::SelfTest),
        Command::Confirm => Understood::Order(Action::Confirmed),
        Command::Forget => Understood::Order(Action::Forget),
        Command::Week(week) => Understood::Order(Action::Week(week)),
        Command::Reset => Understood::Order(Action::Reset),
    })
}
