//! Coefficients of the ionosphere as a value: eight numbers, or those that the satellites
//! broadcast.

use super::Refusal;
use super::number::signed_scientific;
use super::read::{Values, next, none, number};
use super::value::{Commands, Ranges, Spelled, Take, Value, range};

/// Word for the coefficients that the satellites broadcast.
const AUTO: &str = "AUTO";

/// Ranges of the coefficients: 128 units of the scale of each ([IS-GPS-200] table 20-X). The hash
/// reports ten digits, so the limit itself may lie a little beyond itself.
///
/// [IS-GPS-200]: crate#references
pub(super) const RANGES: [(f64, f64); 8] = {
    const fn within(limit: f64) -> (f64, f64) {
        let limit = limit * (1.0 + 1e-9);
        (-limit, limit)
    }
    const fn units(exponent: u64) -> (f64, f64) {
        within(128.0 / (1_u64 << exponent) as f64)
    }
    const fn thousands(exponent: u64) -> (f64, f64) {
        within(128.0 * (1_u64 << exponent) as f64)
    }
    [units(30), units(27), units(24), units(24), thousands(11), thousands(14), thousands(16), thousands(16)]
};

impl Spelled for Option<[f64; 8]> {
    const RANGES: usize = 8;
    const WORDS: &'static [&'static str] = &[AUTO];
}

impl Value for Option<[f64; 8]> {
    fn change(&mut self, values: Values<'_, '_>, ranges: &Ranges) -> Result<(), Refusal> {
        let mut coefficients = [0.0; 8];
        let mut value = next(values)?;
        if value == AUTO {
            *self = None;
            return Ok(());
        }
        for (index, coefficient) in coefficients.iter_mut().enumerate() {
            if index > 0 {
                value = next(values)?;
            }
            *coefficient = number(value, range(ranges, index))?;
        }
        none(values)?;
        if coefficients.iter().all(|coefficient| *coefficient == 0.0) {
            return Err(Refusal::AllZero);
        }
        *self = Some(coefficients);
        Ok(())
    }

    fn say(&self, take: Take<'_>) {
        match self {
            Some(coefficients) => coefficients.iter().for_each(|value| take(&signed_scientific(*value))),
            None => [AUTO, "", "", "", "", "", "", ""].iter().for_each(|field| take(field)),
        }
    }

    fn tell(&self, take: Take<'_>) -> bool {
        if self.is_none() {
            take(AUTO);
        }
        self.is_none()
    }

    fn commands(&self) -> Commands {
        if self.is_some() { Commands::One } else { Commands::None }
    }
}
