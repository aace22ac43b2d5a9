//! The interface to the words of a value; `words` has the words of all types.

use super::Refusal;
use super::read::{Values, next};

/// Meaning of a word of the commands.
pub(super) trait Word: Copy + 'static {
    /// Words, in the order of [`Self::MEANINGS`].
    const WORDS: &'static [&'static str];
    /// Meanings; `None` if this build lacks the feature.
    const MEANINGS: &'static [Option<Self>];

    /// Returns the word of this meaning.
    fn word(self) -> &'static str;
}

/// Reads a word and returns its index. Not inlined, so that the code exists once for all types.
#[inline(never)]
pub(super) fn next_word(values: Values<'_, '_>, words: &[&str]) -> Result<usize, Refusal> {
    let word = next(values)?;
    words.iter().position(|known| *known == word).ok_or(Refusal::UnknownValue)
}
