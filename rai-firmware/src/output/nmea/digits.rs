//! Digits of numbers, written into their place from the last digit to the first.
//!
//! A field is opened with its length, so that each character is written once, in its final place.

use crate::division::divided;

/// Number of digits that are split off a number of more than 32 bits.
const LOW_DIGITS: usize = 9;

/// Powers of ten up to the largest number of decimals of a field.
pub(super) const SCALE: [u32; LOW_DIGITS + 1] =
    [1, 10, 100, 1000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000, 1_000_000_000];

/// Ten to the power of [`LOW_DIGITS`].
const SPLIT: u32 = 1_000_000_000;

/// Places of a field that are still free. The last of them is filled next.
pub(super) struct Digits<'f>(pub(super) &'f mut [u8]);

impl Digits<'_> {
    /// Writes a character in front of those written before.
    pub(super) fn put(&mut self, byte: u8) {
        if let Some((place, free)) = core::mem::take(&mut self.0).split_last_mut() {
            (*place, self.0) = (byte, free);
        }
    }

    /// Writes the last `count` digits of a number below 10¹⁸, with leading zeros, in front of the
    /// characters written before.
    pub(super) fn number(&mut self, value: u64, count: usize) {
        match u32::try_from(value) {
            Ok(value) => self.low(value, count),
            Err(_) => self.long(value, count),
        }
    }

    #[cold]
    #[inline(never)]
    fn long(&mut self, value: u64, count: usize) {
        let (high, low) = divided(value, SPLIT);
        self.low(low, LOW_DIGITS);
        self.low(high as u32, count.saturating_sub(LOW_DIGITS));
    }

    /// Writes the last `count` digits of a number of 32 bits in front of the characters written
    /// before.
    // Not inlined, because it has many callers, and flash is scarcer than time here.
    #[inline(never)]
    pub(super) fn low(&mut self, mut value: u32, count: usize) {
        let all = core::mem::take(&mut self.0);
        let Some((free, places)) = all.split_at_mut_checked(all.len().saturating_sub(count)) else { return };
        for place in places.iter_mut().rev() {
            *place = b'0' + (value % 10) as u8;
            value /= 10;
        }
        self.0 = free;
    }
}

/// Returns the number of digits of a number below 10¹⁸, which is at least one.
pub(super) fn digits(value: u64) -> usize {
    match u32::try_from(value) {
        Ok(value) => low_digits(value),
        Err(_) => low_digits(divided(value, SPLIT).0 as u32) + LOW_DIGITS,
    }
}

/// Returns the number of digits of a number of 32 bits, which is at least one.
pub(super) fn low_digits(value: u32) -> usize {
    /// The logarithm of 2 to the base 10, in 2⁻¹².
    const DIGITS_OF_A_BIT: u32 = 1233;
    // Zero has one digit, like 1.
    let value = value.max(1);
    // Numbers with as many bits have this many digits, or one more.
    let least = (((32 - value.leading_zeros()) * DIGITS_OF_A_BIT) >> 12) as usize;
    least + usize::from(SCALE.get(least).is_some_and(|power| value >= *power))
}

#[cfg(test)]
mod tests {
    use super::{Digits, digits};
    use std::string::ToString as _;

    #[test]
    fn numbers_have_the_digits_that_the_library_prints() {
        let powers = (0..18).map(|power| 10_u64.pow(power));
        let edges = powers.flat_map(|power| [power - 1, power, power + 1]);
        for value in edges.chain((0..59).flat_map(|bit| [(1 << bit) - 1, 1 << bit])) {
            let want = value.to_string();
            assert_eq!(digits(value), want.len(), "{value}");
            let mut field = [b' '; 24];
            Digits(&mut field).number(value, digits(value));
            assert_eq!(std::str::from_utf8(&field).expect("ASCII").trim_start(), want);
        }
    }

    #[test]
    fn a_field_takes_no_more_than_its_places() {
        let mut field = *b"   ";
        let mut digits = Digits(&mut field);
        digits.low(7, 2);
        digits.put(b'-');
        digits.put(b'-');
        digits.low(1, 1);
        assert_eq!(&field, b"-07");
    }
}
