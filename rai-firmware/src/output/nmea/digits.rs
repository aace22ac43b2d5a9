//! Numbers in digits, written from the last one to the first, so that a field is one piece.

use crate::division::divided;

/// Room for the longest field: two numbers of sixteen digits less their sign, point and comma.
const ROOM: usize = 32;

/// Number of digits in the lower part of a split number.
pub(super) const LOW_DIGITS: usize = 9;

/// Ten to the power of [`LOW_DIGITS`].
const SPLIT: u32 = 1_000_000_000;

/// Characters that grow to the front.
pub(super) struct Digits {
    text: [u8; ROOM],
    first: usize,
}

impl Digits {
    pub(super) const fn new() -> Self {
        Self { text: [b'0'; ROOM], first: ROOM }
    }

    /// Returns what was written.
    pub(super) fn text(&self) -> &[u8] {
        self.text.get(self.first..).unwrap_or_default()
    }

    /// Writes a character before the others.
    pub(super) fn put(&mut self, byte: u8) {
        self.first = self.first.saturating_sub(1);
        if let Some(place) = self.text.get_mut(self.first) {
            *place = byte;
        }
    }

    /// Writes a number before the others, with leading zeros up to `width` digits, at least one.
    pub(super) fn number(&mut self, value: u64, width: usize) {
        let (high, low) = split(value);
        if high == 0 {
            self.low(low, width.max(1));
        } else {
            self.low(low, LOW_DIGITS);
            self.number(high, width.saturating_sub(LOW_DIGITS));
        }
    }

    /// Writes a number of 32 bits before the others.
    // Not inlined, because it has many callers, and flash is scarcer than time here.
    #[inline(never)]
    pub(super) fn low(&mut self, mut value: u32, width: usize) {
        let mut count = 0;
        // The room is all zeros.
        for digit in self.text.get_mut(..self.first).unwrap_or_default().iter_mut().rev() {
            if value == 0 && count >= width {
                break;
            }
            *digit += (value % 10) as u8;
            value /= 10;
            count += 1;
        }
        self.first = self.first.saturating_sub(count);
    }
}

/// Splits off the last nine digits.
pub(super) fn split(value: u64) -> (u64, u32) {
    if value < u64::from(SPLIT) { (0, value as u32) } else { divided(value, SPLIT) }
}
