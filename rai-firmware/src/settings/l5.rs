//! Use of L5, which GPS calls unhealthy, as a value.
//!
//! Images without CNAV lack the setting. It therefore has no field in `PRAIQ` and in the hash while
//! it is as at start, so that every image reports the same there. Otherwise it has two: its key and
//! its word.

use super::Refusal;
use super::read::Values;
use super::value::{Commands, Ranges, Spelled, Take, Value};
use super::word::next_word;

/// Key of the setting.
pub(super) const KEY: &str = "L5";

const TRACKED: &str = "TRACKED";
const HEALTHY: &str = "HEALTHY";

/// Use of L5 of GPS and QZSS.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum L5 {
    /// Wherever the receiver tracks it.
    Tracked,
    /// Only where the satellite calls it healthy.
    Healthy,
}

impl Spelled for L5 {
    const RANGES: usize = 0;
    const WORDS: &'static [&'static str] = &[TRACKED, HEALTHY];
}

impl Value for L5 {
    fn change(&mut self, values: Values<'_, '_>, _: &Ranges) -> Result<(), Refusal> {
        *self = if next_word(values, Self::WORDS)? == 0 { Self::Tracked } else { Self::Healthy };
        Ok(())
    }

    fn say(&self, take: Take<'_>) {
        if *self == Self::Healthy {
            take(KEY);
            take(HEALTHY);
        }
    }

    fn tell(&self, take: Take<'_>) -> bool {
        take(if *self == Self::Healthy { HEALTHY } else { TRACKED });
        true
    }

    fn commands(&self) -> Commands {
        if *self == Self::Healthy { Commands::One } else { Commands::None }
    }
}
