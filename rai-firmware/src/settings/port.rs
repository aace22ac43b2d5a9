//! Command side of the host port: bytes to commands, and their answers.

use embedded_io::Write;

use super::line::{Line, LineAssembler, LineError};
use super::order::Order;
use super::{Configuration, Refusal, Setting};
use crate::counters::{self, count};
use crate::output::nmea::write_answer;

/// Work that a command leaves to the receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Action {
    /// The settings have changed, and the change has been answered.
    Reconfigured,
    /// Order to carry out. `STATS` and `SELFTEST` are still unanswered; the others are answered.
    Order(Order),
}

/// Outcome of one byte of the host port.
///
/// Action and answer are separate, because a command is obeyed even if the host does not read its
/// answer.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Heard<E> {
    /// Action left to the receiver.
    pub action: Option<Action>,
    /// Reason of a command that was refused.
    pub refusal: Option<Refusal>,
    /// Result of writing the answer; `Ok` if no answer was due.
    pub answered: Result<(), E>,
}

/// Counters of the lines received on the host port.
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

/// Command side of the host port.
#[derive(Clone, Debug, Default)]
pub struct CommandPort {
    lines: LineAssembler,
    counters: Counters,
}

impl CommandPort {
    /// Returns a port without received bytes.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
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

    /// Takes one byte. If it completes a command, obeys or refuses the command, and answers it.
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
            Some(Ok(line)) if !line.checksum_matches() => {
                count(&mut counters.checksum);
                return refuse(Refusal::Checksum, line, counters, host);
            }
            Some(Ok(line)) => return obey(line, counters, configuration, host),
        };
        Heard { action: None, refusal: None, answered }
    }

    /// Obeys or refuses a command that did not come over a wire, and answers it as [`Self::push`]
    /// does. `values` have commas between them; `None` asks for the value in force.
    ///
    /// Key and values must be text that a sentence may contain. A line that is not complete stays.
    pub fn set<W: Write>(
        &mut self,
        key: &str,
        values: Option<&str>,
        configuration: &mut Configuration,
        host: &mut W,
    ) -> Heard<W::Error> {
        obey(Line::without_checksum(key, values), &mut self.counters, configuration, host)
    }

    /// Returns the counters by name: commands obeyed and refused (wrong checksums and unknown keys
    /// included), lines with another address, and lines cut by noise.
    pub fn counters(&self) -> impl Iterator<Item = (&'static str, u32)> + use<> {
        COUNTERS.into_iter().zip(self.counts())
    }

    /// Returns the counter with this number.
    pub(crate) fn counter(&self, mut number: usize) -> Option<(&'static str, u32)> {
        counters::at(&COUNTERS, &self.counts(), &mut number)
    }

    /// Returns the counts in the order of [`COUNTERS`].
    const fn counts(&self) -> [u32; COUNTERS.len()] {
        let Counters { obeyed, refused, checksum, too_long, unknown_key, foreign, noise } = self.counters;
        [obeyed, refused, checksum, unknown_key, too_long, foreign, noise]
    }
}

/// Names of the counters.
const COUNTERS: [&str; 7] =
    ["cmd_ok", "cmd_refused", "cmd_checksum", "cmd_unknown_key", "cmd_too_long", "cmd_foreign", "cmd_noise"];

/// Obeys a complete line addressed to the module.
fn obey<W: Write>(
    line: Line<'_>,
    counters: &mut Counters,
    configuration: &mut Configuration,
    host: &mut W,
) -> Heard<W::Error> {
    match understand(line, configuration) {
        Ok(Understood::Question(setting)) => {
            count(&mut counters.obeyed);
            Heard { action: None, refusal: None, answered: configuration.answer(setting, host) }
        }
        Ok(Understood::Change(setting)) => {
            count(&mut counters.obeyed);
            let warning = (setting.row().warning)(configuration);
            let answered = write_answer(line.key(), line.values(), warning, host);
            Heard { action: Some(Action::Reconfigured), refusal: None, answered }
        }
        Ok(Understood::Order(order)) => {
            count(&mut counters.obeyed);
            let answered = match order {
                Order::Confirm | Order::Forget | Order::Week(_) | Order::Height(..) | Order::Reset => {
                    write_answer(line.key(), line.values(), None, host)
                }
                #[cfg(feature = "osnma")]
                Order::Trust(..) => write_answer(line.key(), line.values(), None, host),
                Order::Statistics | Order::SelfTest => Ok(()),
            };
            Heard { action: Some(Action::Order(order)), refusal: None, answered }
        }
        Err(refusal) => {
            if refusal == Refusal::UnknownKey {
                count(&mut counters.unknown_key);
            }
            refuse(refusal, line, counters, host)
        }
    }
}

/// Counts and answers a command that is refused.
fn refuse<W: Write>(
    refusal: Refusal,
    line: Line<'_>,
    counters: &mut Counters,
    host: &mut W,
) -> Heard<W::Error> {
    count(&mut counters.refused);
    Heard { action: None, refusal: Some(refusal), answered: refusal.answer(line.short_key(), host) }
}

/// Line that was accepted, by the work that is left.
enum Understood {
    Question(Setting),
    Change(Setting),
    Order(Order),
}

/// Parses and applies a line.
fn understand(line: Line<'_>, configuration: &mut Configuration) -> Result<Understood, Refusal> {
    let (key, mut values) = (line.key(), line.values());
    if let Some(order) = Order::read(key, values.clone()) {
        return order.map(Understood::Order);
    }
    let setting = Setting::named(key).ok_or(Refusal::UnknownKey)?;
    if values.clone().next().is_none() {
        return Ok(Understood::Question(setting));
    }
    *configuration = configuration.changed(setting, &mut values)?;
    Ok(Understood::Change(setting))
}
