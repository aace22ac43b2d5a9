//! Fields of navigation messages: bits in the order of transmission, most significant first.
//!
//! Offsets and widths are constants in the tables of the decoders, and lie inside the pages. Bits
//! beyond the end read as zero.

use crate::ephemeris::times_power_of_two;

/// Bits of a page.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bits<'a>(pub(crate) &'a [u8]);

impl Bits<'_> {
    /// Returns an unsigned field of 1 to 32 bits.
    #[inline]
    pub(crate) fn unsigned(self, start: usize, width: usize) -> u32 {
        // Most fields are within four bytes, which the processor loads at once.
        let four = self.0.get(start / 8..).and_then(|from| from.first_chunk());
        match four {
            Some(four) if start % 8 + width <= 32 => {
                (u32::from_be_bytes(*four) << (start % 8)) >> (32 - width)
            }
            _ => self.gathered(start, width),
        }
    }

    /// Returns the same as [`Self::unsigned`], byte by byte.
    fn gathered(self, start: usize, width: usize) -> u32 {
        let end = start + width;
        let bytes = self.0.get(start / 8..end.div_ceil(8)).unwrap_or(&[]);
        let window = bytes.iter().fold(0_u64, |window, &byte| window << 8 | u64::from(byte));
        let behind = (8 - end % 8) % 8;
        ((window >> behind) & ((1 << width) - 1)) as u32
    }

    /// Returns a field in two's complement.
    pub(crate) fn signed(self, start: usize, width: usize) -> i32 {
        extend(self.unsigned(start, width), width)
    }

    /// Returns a field whose first bit is the sign and whose others are the magnitude, as in
    /// GLONASS.
    pub(crate) fn sign_magnitude(self, start: usize, width: usize) -> i32 {
        let magnitude = self.unsigned(start + 1, width - 1).cast_signed();
        if self.is_set(start) { -magnitude } else { magnitude }
    }

    /// Returns `sign_magnitude` in units of `2^exponent`.
    pub(crate) fn magnitude(self, start: usize, width: usize, exponent: i32) -> f64 {
        times_power_of_two(f64::from(self.sign_magnitude(start, width)), exponent)
    }

    /// Returns a single bit.
    pub(crate) fn is_set(self, position: usize) -> bool {
        self.unsigned(position, 1) == 1
    }

    /// Returns an unsigned field of at most 8 bits.
    pub(crate) fn small(self, start: usize, width: usize) -> u8 {
        self.unsigned(start, width) as u8
    }

    /// Returns `signed` in units of `2^exponent`.
    pub(crate) fn scaled(self, start: usize, width: usize, exponent: i32) -> f64 {
        times_power_of_two(f64::from(self.signed(start, width)), exponent)
    }

    /// Returns eight consecutive coefficients of eight bits, in Klobuchar's units: `α0…α3, β0…β3`.
    pub(crate) fn klobuchar(self, start: usize) -> [f64; 8] {
        const EXPONENTS: [i32; 8] = [-30, -27, -24, -24, 11, 14, 16, 16];
        let mut offset = start;
        EXPONENTS.map(|exponent| {
            let coefficient = self.scaled(offset, 8, exponent);
            offset += 8;
            coefficient
        })
    }
}

/// Joins a field in two's complement whose upper part is on another page.
pub(crate) const fn joined(upper: i32, lower: u32, lower_width: usize) -> i32 {
    upper << lower_width | lower.cast_signed()
}

/// Returns the value of `width` bits in two's complement.
const fn extend(field: u32, width: usize) -> i32 {
    let unused = 32 - width;
    (field << unused).cast_signed() >> unused
}

/// Page that fields are appended to, most significant bit first; bits that do not fit are dropped.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Packed<const BYTES: usize> {
    pub(crate) bytes: [u8; BYTES],
    bits: usize,
}

impl<const BYTES: usize> Packed<BYTES> {
    pub(crate) const fn new() -> Self {
        Self { bytes: [0; BYTES], bits: 0 }
    }

    /// Appends the low `width` bits of `field`, at most 32.
    pub(crate) fn push(&mut self, field: u32, width: usize) {
        self.bits = append(&mut self.bytes, self.bits, field, width);
    }
}

/// Writes the low `width` bits of `field` behind the first `bits`; returns the new number of bits.
#[inline(never)]
fn append(bytes: &mut [u8], mut bits: usize, field: u32, width: usize) -> usize {
    let mut left = width;
    while left > 0 {
        let room = 8 - bits % 8;
        let taken = room.min(left);
        left -= taken;
        // Puts the upper bits of the rest of the field at the upper end of the free bits.
        let part = (field >> left) as u8 & (0xFF >> (8 - taken));
        if let Some(byte) = bytes.get_mut(bits / 8) {
            *byte |= part << (room - taken);
        }
        bits += taken;
    }
    bits
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_read_across_bytes_and_signed_both_ways() {
        let bits = Bits(&[0b1010_0111, 0b1100_0001, 0xFF, 0x80, 0x01]);
        assert_eq!(bits.unsigned(4, 6), 0b01_1111);
        assert_eq!(bits.signed(0, 4), -6);
        assert_eq!(bits.sign_magnitude(0, 4), -2);
        assert_eq!(bits.unsigned(8, 32), 0xC1FF_8001);
        assert_eq!(bits.signed(8, 32), 0xC1FF_8001_u32.cast_signed());
        assert_eq!(bits.unsigned(36, 8), 0, "beyond the end");
    }

    #[test]
    fn a_field_is_the_same_loaded_at_once_and_byte_by_byte() {
        let bytes: [u8; 12] = core::array::from_fn(|index| (index as u8).wrapping_mul(151) ^ 0x5A);
        let bits = Bits(&bytes);
        for (start, width) in (0..64).flat_map(|start| (1..=32).map(move |width| (start, width))) {
            let one_by_one = (start..start + width).fold(0, |field, position| {
                let byte = bytes[position / 8];
                field << 1 | u32::from(byte >> (7 - position % 8) & 1)
            });
            assert_eq!(bits.unsigned(start, width), one_by_one, "{width} bits from {start}");
        }
    }

    #[test]
    fn a_joined_field_keeps_its_sign() {
        // −3 in ten bits, split after the sixth.
        assert_eq!(joined(-1, 0b1101, 4), -3);
    }

    #[test]
    fn what_is_packed_is_read() {
        let mut packed = Packed::<5>::new();
        packed.push(0b101, 3);
        packed.push(0xFFFF_0001, 32);
        packed.push(0b11, 2);
        let bits = Bits(&packed.bytes);
        assert_eq!((bits.unsigned(0, 3), bits.unsigned(3, 32), bits.unsigned(35, 2)), (5, 0xFFFF_0001, 3));
    }

    #[test]
    fn packed_fields_are_those_of_single_bits() {
        for (start, width) in (0..48).flat_map(|start| (0..=32).map(move |width| (start, width))) {
            let field = 0xB5C3_96E7_u32.rotate_left(start as u32);
            let (mut have, mut want) = ([0x80_u8, 0, 0, 0, 0, 0, 0], [0x80_u8, 0, 0, 0, 0, 0, 0]);
            assert_eq!(append(&mut have, start + 1, field, width), start + 1 + width);
            for (place, position) in (0..width).rev().zip(start + 1..) {
                // What lies beyond the page is dropped.
                if let Some(byte) = want.get_mut(position / 8) {
                    *byte |= ((field >> place & 1) as u8) << (7 - position % 8);
                }
            }
            assert_eq!(have, want, "{width} bits behind {start}");
        }
    }
}
