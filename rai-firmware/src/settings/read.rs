//! Reads the values of a command one by one.

use super::{Refusal, decimal};

/// Values behind a key.
pub(super) type Values<'i, 'v> = &'i mut dyn Iterator<Item = &'v str>;

pub(super) fn none(values: Values<'_, '_>) -> Result<(), Refusal> {
    values.next().map_or(Ok(()), |_| Err(Refusal::ExtraValue))
}

pub(super) fn next<'v>(values: Values<'_, 'v>) -> Result<&'v str, Refusal> {
    values.next().filter(|value| !value.is_empty()).ok_or(Refusal::MissingValue)
}

#[inline(never)]
pub(super) fn number(value: &str, (lowest, highest): (f64, f64)) -> Result<f64, Refusal> {
    let number = decimal(value).ok_or(Refusal::NotANumber)?;
    if (lowest..=highest).contains(&number) { Ok(number) } else { Err(Refusal::OutOfRange) }
}

/// Reads the next value as [`number`].
#[inline(never)]
pub(super) fn next_number(values: Values<'_, '_>, range: (f64, f64)) -> Result<f64, Refusal> {
    number(next(values)?, range)
}

/// Reads the next value as a whole number within a range that a byte holds.
pub(super) fn next_whole(values: Values<'_, '_>, range: (f64, f64)) -> Result<u8, Refusal> {
    let number = next_number(values, range)?;
    let whole = number as u8;
    if f64::from(whole) < number { Err(Refusal::OutOfRange) } else { Ok(whole) }
}
