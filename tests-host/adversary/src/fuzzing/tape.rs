//! Bytes read as choices and numbers: the way a fuzzer writes a structured input.
//!
//! Every byte string is some input, and a short one reads as if zeros followed, so that no mutation
//! is wasted.

/// Share of numbers with an arbitrary bit pattern, of 256.
const HOSTILE: u8 = 12;

/// Unread bytes.
#[derive(Clone, Debug)]
pub(super) struct Tape<'t> {
    rest: &'t [u8],
}

impl<'t> Tape<'t> {
    pub(super) fn new(bytes: &'t [u8]) -> Self {
        Self { rest: bytes }
    }

    /// Returns true if only zeros would follow.
    pub(super) fn is_over(&self) -> bool {
        self.rest.is_empty()
    }

    /// Returns the number of unread bytes.
    pub(super) fn left(&self) -> usize {
        self.rest.len()
    }

    /// Returns all unread bytes.
    pub(super) fn rest(self) -> &'t [u8] {
        self.rest
    }

    pub(super) fn byte(&mut self) -> u8 {
        let [byte] = self.bytes();
        byte
    }

    fn bytes<const K: usize>(&mut self) -> [u8; K] {
        let mut bytes = [0; K];
        let (read, rest) = self.rest.split_at(K.min(self.rest.len()));
        self.rest = rest;
        bytes[..read.len()].copy_from_slice(read);
        bytes
    }

    /// Draws one of a list.
    pub(super) fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[usize::from(self.byte()) % choices.len()]
    }

    /// Draws a 32-bit number.
    pub(super) fn word(&mut self) -> u32 {
        u32::from_le_bytes(self.bytes())
    }

    /// Draws a number within bounds, both included.
    pub(super) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.word()) / f64::from(u32::MAX)
    }

    /// Draws mostly a number within bounds, sometimes any bit pattern of an `f64`.
    pub(super) fn number(&mut self, low: f64, high: f64) -> f64 {
        if self.byte() < HOSTILE {
            f64::from_bits(u64::from_le_bytes(self.bytes()))
        } else {
            self.within(low, high)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Tape;

    #[test]
    fn a_short_tape_reads_as_if_zeros_followed() {
        let mut tape = Tape::new(&[1, 2]);
        assert_eq!((tape.word(), tape.is_over(), tape.word()), (0x0201, true, 0));
    }

    #[test]
    fn bounds_are_reached() {
        let mut tape = Tape::new(&[0, 0, 0, 0, 255, 255, 255, 255]);
        assert_eq!((tape.within(-2.0, 5.0), tape.within(-2.0, 5.0)), (-2.0, 5.0));
    }
}
