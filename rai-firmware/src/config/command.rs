//! Keys and words to commands.
//!
//! A word that is known but not built in stands in its table with `None`, so that the answer can tell a wrong word
//! from a missing feature.

use rai_core::identification::parity;
use rai_core::monitor::Method;
use rai_core::probability::Probability;
use rai_core::threshold::policy::Policy;

use super::{Phase, Refusal, decimal};

/// What a line asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Change the configuration.
    Set(Setting),
    /// `STATS`: say the counters.
    Statistics,
    /// `SELFTEST`: run the known-answer tests.
    SelfTest,
    /// `RESET`: start again.
    Reset,
}

/// One change of the configuration, each number within its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Setting {
    /// `PHASE`.
    Phase(Phase),
    /// `HAL`, m.
    HorizontalAlertLimit(f64),
    /// `VAL`, m; `None` for `OFF`.
    VerticalAlertLimit(Option<f64>),
    /// `PFA`.
    FalseAlarm(Probability),
    /// `PMD`.
    MissedDetection(Probability),
    /// `TTA`, s.
    TimeToAlert(f64),
    /// `MASK`, rad (degrees on the wire).
    Mask(f64),
    /// `POLICY`.
    Policy(Policy),
    /// `METHOD`.
    Method(Method),
    /// `CLOCKAID`.
    ClockAid(bool),
    /// `IONO`, α0 to α3 and β0 to β3 as broadcast.
    Ionosphere([f64; 8]),
}

/// A key's words, and what each means in this build.
type Words<T> = [(&'static str, Option<T>)];

const PHASES: &Words<Phase> = &[
    ("ENROUTE", Some(Phase::EnRoute)),
    ("TERMINAL", Some(Phase::Terminal)),
    ("NPA", Some(Phase::NonPrecisionApproach)),
    ("LPV200", Some(Phase::Lpv200)),
    ("CUSTOM", Some(Phase::Custom)),
];

const POLICIES: &Words<Policy> =
    &[("T1", Some(Policy::T1)), ("T2", Some(Policy::T2)), ("TOP", Some(Policy::TOp))];

const METHODS: &Words<Method> = &[
    ("BAARDA", Some(Method::Baarda)),
    ("SIMULTANEOUS", Some(Method::Parity(parity::Method::Simultaneous))),
    ("SEQUENTIAL", Some(Method::Parity(parity::Method::Sequential))),
    ("HYBRID", Some(Method::Parity(parity::Method::Hybrid))),
    ("GROUPING", Some(Method::Parity(parity::Method::Grouping))),
    ("RANSAC", Some(Method::Ransac)),
    ("SEPARATION", None),
];

const SWITCH: &Words<bool> = &[("OFF", Some(false)), ("ON", Some(true))];

/// Alert limits, m: `PRAIS` has room for five digits before the point.
const LIMIT_M: (f64, f64) = (0.1, 99_999.9);

/// Time to alert, s.
const TIME_S: (f64, f64) = (0.1, 3600.0);

/// Elevation mask, degrees: above, no position is left.
const MASK_DEG: (f64, f64) = (0.0, 60.0);

/// Largest magnitude of each ionospheric coefficient as broadcast: 128 units of its scale ([IS-GPS-200] table 20-X).
const IONOSPHERE_LIMITS: [f64; 8] = {
    const fn units(exponent: u64) -> f64 {
        128.0 / (1_u64 << exponent) as f64
    }
    const fn thousands(exponent: u64) -> f64 {
        128.0 * (1_u64 << exponent) as f64
    }
    [units(30), units(27), units(24), units(24), thousands(11), thousands(14), thousands(16), thousands(16)]
};

impl Command {
    /// Reads a key with its values.
    ///
    /// # Errors
    /// [`Refusal`] says what is wrong with them.
    pub fn read<'v>(key: &str, values: impl Iterator<Item = &'v str>) -> Result<Self, Refusal> {
        let setting = match key {
            "STATS" => return none(values).map(|()| Self::Statistics),
            "SELFTEST" => return none(values).map(|()| Self::SelfTest),
            "RESET" => return none(values).map(|()| Self::Reset),
            "PHASE" => Setting::Phase(word(one(values)?, PHASES)?),
            "HAL" => Setting::HorizontalAlertLimit(number(one(values)?, LIMIT_M)?),
            "VAL" => Setting::VerticalAlertLimit(vertical_limit(one(values)?)?),
            "PFA" => Setting::FalseAlarm(probability(one(values)?)?),
            "PMD" => Setting::MissedDetection(probability(one(values)?)?),
            "TTA" => Setting::TimeToAlert(number(one(values)?, TIME_S)?),
            "MASK" => Setting::Mask(number(one(values)?, MASK_DEG)? * (core::f64::consts::PI / 180.0)),
            "POLICY" => Setting::Policy(word(one(values)?, POLICIES)?),
            "METHOD" => Setting::Method(word(one(values)?, METHODS)?),
            "CLOCKAID" => Setting::ClockAid(word(one(values)?, SWITCH)?),
            "IONO" => Setting::Ionosphere(coefficients(values)?),
            _ => return Err(Refusal::UnknownKey),
        };
        Ok(Self::Set(setting))
    }
}

fn none<'v>(mut values: impl Iterator<Item = &'v str>) -> Result<(), Refusal> {
    values.next().map_or(Ok(()), |_| Err(Refusal::ExtraValue))
}

fn one<'v>(mut values: impl Iterator<Item = &'v str>) -> Result<&'v str, Refusal> {
    let value = values.next().filter(|value| !value.is_empty()).ok_or(Refusal::MissingValue)?;
    none(values).map(|()| value)
}

fn word<T: Copy>(value: &str, words: &Words<T>) -> Result<T, Refusal> {
    let (_, meaning) = words.iter().find(|(word, _)| *word == value).ok_or(Refusal::UnknownValue)?;
    meaning.ok_or(Refusal::NotInBuild)
}

fn number(value: &str, (lowest, highest): (f64, f64)) -> Result<f64, Refusal> {
    let number = decimal(value).ok_or(Refusal::NotANumber)?;
    if (lowest..=highest).contains(&number) { Ok(number) } else { Err(Refusal::OutOfRange) }
}

fn vertical_limit(value: &str) -> Result<Option<f64>, Refusal> {
    if value == "OFF" { Ok(None) } else { number(value, LIMIT_M).map(Some) }
}

fn probability(value: &str) -> Result<Probability, Refusal> {
    let tail = decimal(value).ok_or(Refusal::NotANumber)?;
    Probability::new(tail).ok_or(Refusal::OutOfRange)
}

fn coefficients<'v>(mut values: impl Iterator<Item = &'v str>) -> Result<[f64; 8], Refusal> {
    let mut coefficients = [0.0; 8];
    for (coefficient, limit) in coefficients.iter_mut().zip(IONOSPHERE_LIMITS) {
        let value = values.next().filter(|value| !value.is_empty()).ok_or(Refusal::MissingValue)?;
        *coefficient = number(value, (-limit, limit))?;
    }
    none(values).map(|()| coefficients)
}
