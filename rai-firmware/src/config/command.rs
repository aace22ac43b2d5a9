//! Keys and values to commands.

use rai_core::numeric::probability::Probability;

use super::key::Key;
use super::promises::{support, system};
use super::setting::{Heights, Recovery, Setting, Systems};
use super::value::{Values, next, next_number, next_whole, none, number};
use super::words::{
    BIT_RATES, FREQUENCIES, LEVELS, METHODS, PHASES, POLICIES, SIGMAS, SUPPORTS, SWITCH, meaning,
};
use super::{Refusal, decimal};
use crate::output::schedule::Item;

/// What a line asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Change the configuration.
    Set(Setting),
    /// A key without a value: say what is in force.
    Ask(Key),
    /// `STATS`: say the counters.
    Statistics,
    /// `SELFTEST`: run the known-answer tests.
    SelfTest,
    /// `CONFIRM`.
    Confirm,
    /// `FORGET`: the last position counts for nothing.
    Forget,
    /// `WEEK`: the GPS week, not rolled over, of the next epoch.
    Week(u16),
    /// `RESET`: start again.
    Reset,
}

/// Alert limits, m: `PRAIS` has room for five digits before the point.
const LIMIT_M: (f64, f64) = (0.1, 99_999.9);

/// Time to alert, s; each phase has its own greatest one below this.
const TIME_S: (f64, f64) = (0.1, 3600.0);

/// Elevation mask, degrees: above, no position is left.
const MASK_DEG: (f64, f64) = (0.0, 60.0);

/// Signal mask, dB-Hz: no receiver shows more than this in the open.
const SIGNAL_MASK: (f64, f64) = (0.0, 55.0);

/// Greatest speed, m/s: from a walk to an orbit around the earth.
const SPEED_M_S: (f64, f64) = (1.0, 10_000.0);

/// Heights above the ellipsoid, m: from the deepest trench to below the satellites.
const HEIGHT_M: (f64, f64) = (-12_000.0, 2_000_000.0);

/// Epochs and seconds of agreement after an alert.
const RECOVERY_EPOCHS: (f64, f64) = (1.0, 100.0);
const RECOVERY_S: (f64, f64) = (0.0, 600.0);

/// Every how many epochs something is sent.
const EVERY: (f64, f64) = (0.0, 255.0);

/// GPS weeks, not rolled over: to the end of the eighth cycle, in 2137.
const WEEKS: (f64, f64) = (0.0, 8191.0);

/// Fault-free risk: beyond, the levels would promise what no sigma is known for, or nothing.
const FAULT_FREE: (f64, f64) = (1e-12, 1e-2);

/// Largest magnitude of each ionospheric coefficient as broadcast: 128 units of its scale ([IS-GPS-200] table 20-X).
///
/// [IS-GPS-200]: crate#references
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
    pub fn read<'v>(name: &str, mut values: impl Iterator<Item = &'v str>) -> Result<Self, Refusal> {
        Self::of(name, &mut values)
    }

    /// As [`Self::read`], once for all that values may come from.
    #[inline(never)]
    fn of(name: &str, values: Values<'_, '_>) -> Result<Self, Refusal> {
        let key = Key::named(name).ok_or(Refusal::UnknownKey)?;
        if !key.is_built() {
            return Err(Refusal::NotInBuild);
        }
        match key {
            Key::Statistics => none(values).map(|()| Self::Statistics),
            Key::SelfTest => none(values).map(|()| Self::SelfTest),
            Key::Confirm => none(values).map(|()| Self::Confirm),
            Key::Forget => none(values).map(|()| Self::Forget),
            Key::Week => {
                let week = next_number(values, WEEKS)?;
                none(values).map(|()| Self::Week(week as u16))
            }
            Key::Reset => none(values).map(|()| Self::Reset),
            _ => match values.next() {
                Some(first) => Setting::read(key, &mut core::iter::once(first).chain(values)).map(Self::Set),
                None => Ok(Self::Ask(key)),
            },
        }
    }
}

impl Setting {
    /// Reads the values of a key that has any.
    fn read(key: Key, values: Values<'_, '_>) -> Result<Self, Refusal> {
        let setting = match key {
            Key::Heights => Self::Heights(heights(values)?),
            Key::Recovery => Self::Recovery(recovery(values)?),
            Key::Ionosphere => Self::Ionosphere(ionosphere(values)?),
            Key::Output => output(values)?,
            Key::Support => promise(values)?,
            _ => Self::of_one(key, next(values)?)?,
        };
        none(values).map(|()| setting)
    }

    /// Reads the value of a key that takes one.
    fn of_one(key: Key, value: &str) -> Result<Self, Refusal> {
        Ok(match key {
            Key::Phase => Self::Phase(meaning(value, PHASES)?),
            Key::HorizontalAlertLimit => Self::HorizontalAlertLimit(number(value, LIMIT_M)?),
            Key::VerticalAlertLimit => Self::VerticalAlertLimit(vertical_limit(value)?),
            Key::FalseAlarm => Self::FalseAlarm(probability(value)?),
            Key::MissedDetection => Self::MissedDetection(probability(value)?),
            Key::FaultFree => Self::FaultFree(fault_free(value)?),
            Key::TimeToAlert => Self::TimeToAlert(number(value, TIME_S)?),
            Key::Policy => Self::Policy(meaning(value, POLICIES)?),
            Key::Method => Self::Method(meaning(value, METHODS)?),
            Key::Levels => Self::Levels(meaning(value, LEVELS)?),
            Key::Systems => Self::Systems(systems(value)?),
            Key::Mask => Self::Mask(number(value, MASK_DEG)? * (core::f64::consts::PI / 180.0)),
            Key::ClockAid => Self::ClockAid(meaning(value, SWITCH)?),
            Key::SignalMask => Self::SignalMask(number(value, SIGNAL_MASK)?),
            Key::GreatestSpeed => Self::GreatestSpeed(number(value, SPEED_M_S)?),
            Key::Frequencies => Self::Frequencies(meaning(value, FREQUENCIES)?),
            Key::Sigma => Self::Sigma(meaning(value, SIGMAS)?),
            Key::BitRate => Self::BitRate(meaning(value, BIT_RATES)?),
            _ => return Err(Refusal::NotInBuild),
        })
    }
}

fn vertical_limit(value: &str) -> Result<Option<f64>, Refusal> {
    if value == "OFF" { Ok(None) } else { number(value, LIMIT_M).map(Some) }
}

fn probability(value: &str) -> Result<Probability, Refusal> {
    let tail = decimal(value).ok_or(Refusal::NotANumber)?;
    Probability::new(tail).ok_or(Refusal::OutOfRange)
}

fn fault_free(value: &str) -> Result<Probability, Refusal> {
    Probability::new(number(value, FAULT_FREE)?).ok_or(Refusal::OutOfRange)
}

fn heights(values: Values<'_, '_>) -> Result<Heights, Refusal> {
    let least_m = next_number(values, HEIGHT_M)?;
    let greatest_m = next_number(values, HEIGHT_M)?;
    if least_m < greatest_m { Ok(Heights { least_m, greatest_m }) } else { Err(Refusal::OutOfRange) }
}

fn recovery(values: Values<'_, '_>) -> Result<Recovery, Refusal> {
    let epochs = next_whole(values, RECOVERY_EPOCHS)?;
    let seconds = next_number(values, RECOVERY_S)?;
    Ok(Recovery { epochs, seconds })
}

fn output(values: Values<'_, '_>) -> Result<Setting, Refusal> {
    let item = Item::named(next(values)?).ok_or(Refusal::UnknownValue)?;
    if !item.is_built() {
        return Err(Refusal::NotInBuild);
    }
    Ok(Setting::Output(item, next_whole(values, EVERY)?))
}

/// A preset, or a system with its five values.
fn promise(values: Values<'_, '_>) -> Result<Setting, Refusal> {
    let value = next(values)?;
    match system(value) {
        Some(constellation) => Ok(Setting::SupportOf(constellation, support(values)?)),
        None => Ok(Setting::Support(meaning(value, SUPPORTS)?)),
    }
}

/// Letters of systems.
fn systems(value: &str) -> Result<Systems, Refusal> {
    let systems = Systems::of(value).ok_or(Refusal::UnknownValue)?;
    if systems.contains('R') && !cfg!(feature = "glonass") {
        return Err(Refusal::NotInBuild);
    }
    Ok(systems)
}

/// `AUTO`, or eight coefficients of which at least one says something.
fn ionosphere(values: Values<'_, '_>) -> Result<Option<[f64; 8]>, Refusal> {
    let mut coefficients = [0.0; 8];
    let mut value = next(values)?;
    if value == "AUTO" {
        return none(values).map(|()| None);
    }
    for (index, (coefficient, limit)) in coefficients.iter_mut().zip(IONOSPHERE_LIMITS).enumerate() {
        if index > 0 {
            value = next(values)?;
        }
        // As it is said, with ten digits, the limit itself may be a little beyond itself.
        let limit = limit * (1.0 + 1e-9);
        *coefficient = number(value, (-limit, limit))?;
    }
    none(values)?;
    if coefficients.iter().all(|coefficient| *coefficient == 0.0) {
        return Err(Refusal::AllZero);
    }
    Ok(Some(coefficients))
}
