//! Output rates as a value. A command sets one of them by its name.

use super::Refusal;
use super::number::plain;
use super::read::{Values, next, next_whole};
use super::value::{Commands, Ranges, Spelled, Take, Value, range};
use crate::output::schedule::{Item, Schedule};

impl Spelled for Schedule {
    const RANGES: usize = 1;
    const WORDS: &'static [&'static str] = Item::NAMES;
}

impl Value for Schedule {
    fn change(&mut self, values: Values<'_, '_>, ranges: &Ranges) -> Result<(), Refusal> {
        let item = Item::named(next(values)?).ok_or(Refusal::UnknownValue)?;
        let every = next_whole(values, range(ranges, 0))?;
        // Sealed settings name every item, and one that is not built is never sent.
        if every > 0 && !item.is_built() {
            return Err(Refusal::NotInBuild);
        }
        *self = self.with(item, every);
        Ok(())
    }

    fn say(&self, take: Take<'_>) {
        self.rates().for_each(|(_, every)| take(&plain(f64::from(every))));
    }

    fn tell(&self, take: Take<'_>) -> bool {
        for (name, every) in self.rates() {
            take(name);
            take(&plain(f64::from(every)));
        }
        true
    }

    fn commands(&self) -> Commands {
        Commands::Several(2, 2)
    }
}
