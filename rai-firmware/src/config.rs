//! Configuration of the module, and the commands that change it.
//!
//! `$PRAIC,key,value…*CS` is answered with `$PRAIA,key,value…,OK*CS` or with `$PRAIA,key,ERR,why*CS`. A command
//! makes a whole new [`Configuration`] or none: what is refused changes nothing.
//!
//! | key | values | field | unit |
//! |---|---|---|---|
//! | `PHASE` | `ENROUTE`, `TERMINAL`, `NPA`, `LPV200`; `CUSTOM` keeps the present numbers | `phase`, `requirements` | |
//! | `HAL` | 0.1 to 99999.9 | `hal_m` | m |
//! | `VAL` | 0.1 to 99999.9, or `OFF` | `val_m` | m |
//! | `PFA`, `PMD` | a probability of the committed tables | `false_alarm`, `missed_detection` | |
//! | `TTA` | 0.1 to 3600 | `time_to_alert_s` | s |
//! | `MASK` | 0 to 60 | `mask_rad` | ° |
//! | `POLICY` | `T1`, `T2`, `TOP` | `policy` | |
//! | `METHOD` | `BAARDA`, `SIMULTANEOUS`, `SEQUENTIAL`, `HYBRID`, `GROUPING`, `RANSAC` | `method` | |
//! | `CLOCKAID` | `ON`, `OFF` | `clock_aid` | |
//! | `IONO` | 4 α, 4 β | `klobuchar` | s, s/semicircle, … as broadcast |
//! | `STATS`, `SELFTEST`, `RESET` | none | an [`Action`] | |
//!
//! A single number that is set makes the phase `CUSTOM`. `SEPARATION` is known and refused with
//! `not in this build`. The answer repeats the values as they came; where that would make
//! it longer than 82 characters (eight long coefficients), it carries the key and `OK` alone.
//!
//! References: [IS-GPS-200] table 20-X for the range of the ionospheric coefficients.

use embedded_io::Write;
use rai_core::monitor::{Method, Strategy};
use rai_core::requirements::Requirements;
use rai_core::threshold::policy::Policy;
use rai_core::threshold::{ThresholdError, Thresholds};

use crate::nmea::{write_answer, write_refusal};

mod command;
mod line;
mod number;

pub use command::{Command, Setting};
pub use line::MAX_LINE;
pub use number::{decimal, scientific};

use line::{LineAssembler, LineError};

/// What the module is used for: a set of requirements with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// En route.
    EnRoute,
    /// Terminal area.
    Terminal,
    /// Non-precision approach.
    NonPrecisionApproach,
    /// Approach with vertical guidance down to 200 ft.
    Lpv200,
    /// Numbers set one by one.
    Custom,
}

impl Phase {
    /// The requirements of a named phase; `None` for numbers set one by one.
    pub const fn requirements(self) -> Option<Requirements> {
        match self {
            Self::EnRoute => Some(Requirements::en_route()),
            Self::Terminal => Some(Requirements::terminal()),
            Self::NonPrecisionApproach => Some(Requirements::non_precision_approach()),
            Self::Lpv200 => Some(Requirements::lpv200()),
            Self::Custom => None,
        }
    }
}

/// Everything that a command can change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Configuration {
    /// Where the requirements come from.
    pub phase: Phase,
    /// What is required of the position.
    pub requirements: Requirements,
    /// Satellites below this elevation are left out, rad.
    pub mask_rad: f64,
    /// Threshold of the global test.
    pub policy: Policy,
    /// Identification of the faulty satellite.
    pub method: Method,
    /// Is the predicted receiver clock used as an aiding row?
    pub clock_aid: bool,
    /// Broadcast coefficients of the single-frequency ionospheric model, α0 to α3 and β0 to β3.
    pub klobuchar: Option<[f64; 8]>,
}

/// Elevation mask at start: below 10° the atmosphere's error grows faster than the geometry gains, rad.
const MASK_RAD: f64 = 10.0 * core::f64::consts::PI / 180.0;

impl Configuration {
    /// As the module starts: non-precision approach, 10° mask, no ionospheric coefficients.
    pub const fn at_start() -> Self {
        Self {
            phase: Phase::NonPrecisionApproach,
            requirements: Requirements::non_precision_approach(),
            mask_rad: MASK_RAD,
            policy: Policy::T1,
            method: Method::Baarda,
            clock_aid: false,
            klobuchar: None,
        }
    }

    /// This configuration with one thing changed.
    ///
    /// # Errors
    /// [`Refusal`] where the result could not be used: a probability without thresholds, a limit out of its range.
    pub fn with(mut self, setting: Setting) -> Result<Self, Refusal> {
        let required = &mut self.requirements;
        match setting {
            Setting::Phase(phase) => return Ok(self.in_phase(phase)),
            Setting::HorizontalAlertLimit(limit_m) => required.hal_m = limit_m,
            Setting::VerticalAlertLimit(limit_m) => required.val_m = limit_m,
            Setting::FalseAlarm(probability) => required.false_alarm = probability,
            Setting::MissedDetection(probability) => required.missed_detection = probability,
            Setting::TimeToAlert(time_s) => required.time_to_alert_s = time_s,
            Setting::Mask(mask_rad) => return Ok(Self { mask_rad, ..self }),
            Setting::Policy(policy) => return Ok(Self { policy, ..self }),
            Setting::Method(method) => return Ok(Self { method, ..self }),
            Setting::ClockAid(clock_aid) => return Ok(Self { clock_aid, ..self }),
            Setting::Ionosphere(coefficients) => return Ok(Self { klobuchar: Some(coefficients), ..self }),
        }
        self.phase = Phase::Custom;
        self.requirements = self.requirements.validate().map_err(|_| Refusal::OutOfRange)?;
        Thresholds::from_tables(self.requirements.false_alarm, self.requirements.missed_detection)?;
        Ok(self)
    }

    /// How the core is to monitor.
    pub const fn strategy(&self) -> Strategy {
        Strategy { policy: self.policy, method: self.method, clock_aid: self.clock_aid }
    }

    fn in_phase(self, phase: Phase) -> Self {
        Self { phase, requirements: phase.requirements().unwrap_or(self.requirements), ..self }
    }
}

/// Why a command changed nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// The checksum is missing or does not match.
    Checksum,
    /// The line is longer than [`MAX_LINE`].
    TooLong,
    /// There is no such key.
    UnknownKey,
    /// A value is missing.
    MissingValue,
    /// There are more values than the key takes.
    ExtraValue,
    /// A value is not one of the key's words.
    UnknownValue,
    /// The word is right, but what it asks for is not built in.
    NotInBuild,
    /// A value is not a decimal number.
    NotANumber,
    /// A number is outside the key's range.
    OutOfRange,
    /// The probability is not in the tables.
    NotInTables {
        /// The one that is, with the closest ratio.
        nearest: rai_core::probability::Probability,
    },
}

impl From<ThresholdError> for Refusal {
    fn from(error: ThresholdError) -> Self {
        match error {
            ThresholdError::FalseAlarm { nearest } | ThresholdError::MissedDetection { nearest } => {
                Self::NotInTables { nearest }
            }
        }
    }
}

impl Refusal {
    const fn why(self) -> &'static str {
        match self {
            Self::Checksum => "checksum",
            Self::TooLong => "too long",
            Self::UnknownKey => "unknown key",
            Self::MissingValue => "missing value",
            Self::ExtraValue => "extra value",
            Self::UnknownValue => "unknown value",
            Self::NotInBuild => "not in this build",
            Self::NotANumber => "not a number",
            Self::OutOfRange => "out of range",
            Self::NotInTables { .. } => "not in the tables",
        }
    }

    fn answer<W: Write>(self, key: &str, host: &mut W) -> Result<(), W::Error> {
        match self {
            Self::NotInTables { nearest } => {
                let mut why = heapless::String::<40>::new();
                // Both pieces fit: at most 8 and 17 characters.
                let _ = why.push_str("nearest ");
                let _ = why.push_str(&scientific(nearest.get()));
                write_refusal(key, &why, host)
            }
            other => write_refusal(key, other.why(), host),
        }
    }
}

/// What a command asks of the receiver, beyond the answer that it got already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// The configuration has changed, and the change was answered.
    Reconfigured,
    /// Answer with [`crate::nmea::write_counters`].
    Statistics,
    /// Run the known-answer tests and answer with [`crate::nmea::write_answer`] or [`crate::nmea::write_refusal`].
    SelfTest,
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

    /// What came in, by name: commands obeyed and refused (the next three among them), sentences that are no
    /// command, and breaks by characters that belong to none.
    pub fn counters(&self) -> impl Iterator<Item = (&'static str, u32)> + use<> {
        let Counters { obeyed, refused, checksum, too_long, unknown_key, foreign, noise } = self.counters;
        [
            ("cmd_ok", obeyed),
            ("cmd_refused", refused),
            ("cmd_checksum", checksum),
            ("cmd_unknown_key", unknown_key),
            ("cmd_too_long", too_long),
            ("cmd_foreign", foreign),
            ("cmd_noise", noise),
        ]
        .into_iter()
    }
}

fn count(counter: &mut u32) {
    *counter = counter.saturating_add(1);
}

/// Obeys a complete line that is addressed to the module.
fn obey<W: Write>(
    line: line::Line<'_>,
    counters: &mut Counters,
    configuration: &mut Configuration,
    host: &mut W,
) -> Heard<W::Error> {
    match understand(line, configuration) {
        Ok(action) => {
            count(&mut counters.obeyed);
            let answered = match action {
                Action::Reconfigured | Action::Reset => write_answer(line.key(), line.values(), host),
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

/// Checks, reads and applies a line.
fn understand(line: line::Line<'_>, configuration: &mut Configuration) -> Result<Action, Refusal> {
    if !line.checksum_matches() {
        return Err(Refusal::Checksum);
    }
    match Command::read(line.key(), line.values())? {
        Command::Set(setting) => {
            *configuration = configuration.with(setting)?;
            Ok(Action::Reconfigured)
        }
        Command::Statistics => Ok(Action::Statistics),
        Command::SelfTest => Ok(Action::SelfTest),
        Command::Reset => Ok(Action::Reset),
    }
}
