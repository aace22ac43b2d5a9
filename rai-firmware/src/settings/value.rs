//! Values: how the value of a setting is read, reported and sealed.

use raim_core::internals::numeric::probability::Probability;

use super::Refusal;
use super::number::{plain, scientific};
use super::read::{Values, next, next_number, number};
use super::word::{Word, next_word};

/// Takes one field.
pub(super) type Take<'t> = &'t mut dyn FnMut(&str);

/// Lowest and highest value of each number.
pub(super) type Ranges = [(f64, f64)];

/// Value of a setting. Settings are handled through this trait object, so that the code exists once
/// for all types.
pub(super) trait Value {
    /// Replaces the value, or a part of it, by the values of a command.
    fn change(&mut self, values: Values<'_, '_>, ranges: &Ranges) -> Result<(), Refusal>;

    /// Reports the value in a number of fields that depends on its type alone.
    fn say(&self, take: Take<'_>);

    /// Reports the value as commands write it and returns true, if that form differs from
    /// [`Self::say`]; else returns false.
    fn tell(&self, _: Take<'_>) -> bool {
        false
    }

    /// Returns how the fields of [`tell`] are divided into commands.
    fn commands(&self) -> Commands {
        Commands::One
    }
}

/// Division of the fields of a value into commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Commands {
    /// No command: the start value.
    None,
    /// One command with all fields.
    One,
    /// Several commands: number of fields of the first, and of each after it.
    Several(usize, usize),
}

/// Spelling of a type of value.
pub(super) trait Spelled {
    /// Number of ranges that its numbers have.
    const RANGES: usize;
    /// Words that the value may be.
    const WORDS: &'static [&'static str];
}

/// Reports a value as commands write it, without the fields that only keep places in `PRAIQ`.
pub(super) fn tell(value: &dyn Value, take: Take<'_>) {
    if !value.tell(take) {
        value.say(take);
    }
}

/// Returns the range of one number. The compiler checks that the table has a range for each.
pub(super) fn range(ranges: &Ranges, index: usize) -> (f64, f64) {
    ranges.get(index).copied().unwrap_or_default()
}

impl Spelled for f64 {
    const RANGES: usize = 1;
    const WORDS: &'static [&'static str] = &[];
}

impl Value for f64 {
    fn change(&mut self, values: Values<'_, '_>, ranges: &Ranges) -> Result<(), Refusal> {
        *self = next_number(values, range(ranges, 0))?;
        Ok(())
    }

    fn say(&self, take: Take<'_>) {
        take(&plain(*self));
    }
}

/// Word for a number that is not set.
const OFF: &str = "OFF";

impl Spelled for Option<f64> {
    const RANGES: usize = 1;
    const WORDS: &'static [&'static str] = &[OFF];
}

impl Value for Option<f64> {
    fn change(&mut self, values: Values<'_, '_>, ranges: &Ranges) -> Result<(), Refusal> {
        let value = next(values)?;
        *self = if value == OFF { None } else { Some(number(value, range(ranges, 0))?) };
        Ok(())
    }

    fn say(&self, take: Take<'_>) {
        take(&self.map(plain).unwrap_or_default());
    }

    fn tell(&self, take: Take<'_>) -> bool {
        if self.is_none() {
            take(OFF);
        }
        self.is_none()
    }
}

impl Spelled for Probability {
    const RANGES: usize = 1;
    const WORDS: &'static [&'static str] = &[];
}

impl Value for Probability {
    fn change(&mut self, values: Values<'_, '_>, ranges: &Ranges) -> Result<(), Refusal> {
        *self = Self::new(next_number(values, range(ranges, 0))?).ok_or(Refusal::OutOfRange)?;
        Ok(())
    }

    fn say(&self, take: Take<'_>) {
        take(&scientific(self.get()));
    }
}

impl<T: Word> Spelled for T {
    const RANGES: usize = 0;
    const WORDS: &'static [&'static str] = T::WORDS;
}

impl<T: Word> Value for T {
    fn change(&mut self, values: Values<'_, '_>, _: &Ranges) -> Result<(), Refusal> {
        let place = next_word(values, T::WORDS)?;
        *self = T::MEANINGS.get(place).copied().flatten().ok_or(Refusal::NotInBuild)?;
        Ok(())
    }

    fn say(&self, take: Take<'_>) {
        take(self.word());
    }
}
