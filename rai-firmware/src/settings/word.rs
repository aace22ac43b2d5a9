//! Word of the wire that stands for a value; `words` has all of them.

use super::Refusal;
use super::read::{Values, next};

/// Meaning that a word of the wire stands for.
pub(super) trait Word: Copy + 'static {
    /// Words in the order of [`Self::MEANINGS`].
    const WORDS: &'static [&'static str];
    /// Meanings, `None` where this build lacks the feature.
    const MEANINGS: &'static [Option<Self>];

    /// Returns the word of this meaning.
    fn word(self) -> &'static str;
}

/// Reads a word and returns its place among others, once for all types.
#[inline(never)]
pub(super) fn next_word(values: Values<'_, '_>, words: &[&str]) -> Result<usize, Refusal> {
    let word = next(values)?;
    words.iter().position(|known| *known == word).ok_or(Refusal::UnknownValue)
}
