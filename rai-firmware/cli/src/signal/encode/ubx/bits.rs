//! Bits in the order of transmission, and the sums that protect them.

use anyhow::{Result, ensure};

use crate::signal::checksum;

/// Row of bits that fields are appended to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Row {
    bits: Vec<bool>,
}

impl Row {
    /// Appends an unsigned field.
    pub(super) fn unsigned(mut self, value: u64, width: usize) -> Result<Self> {
        ensure!(width == 64 || value >> width == 0, "{value} has more than {width} bits");
        self.bits.extend((0..width).rev().map(|position| value >> position & 1 == 1));
        Ok(self)
    }

    /// Appends a field in two's complement, `value` in units of `2^exponent`.
    pub(super) fn scaled(self, value: f64, width: usize, exponent: i32) -> Result<Self> {
        self.signed((value / 2f64.powi(exponent)).round(), width)
    }

    /// Appends an unsigned field, `value` in units of `2^exponent`.
    pub(super) fn positive(self, value: f64, width: usize, exponent: i32) -> Result<Self> {
        let steps = (value / 2f64.powi(exponent)).round();
        ensure!(steps >= 0.0, "{value} is negative");
        self.unsigned(steps as u64, width)
    }

    /// Appends a whole number in two's complement.
    pub(super) fn signed(self, steps: f64, width: usize) -> Result<Self> {
        let half = (1_u64 << (width - 1)) as f64;
        ensure!((-half..half).contains(&steps), "{steps} does not fit {width} bits");
        let mask = (1_u64 << width) - 1;
        self.unsigned((steps as i64 as u64) & mask, width)
    }

    /// Appends zeros up to a length.
    pub(super) fn until(mut self, length: usize) -> Result<Self> {
        ensure!(self.bits.len() <= length, "{} bits where {length} are to be", self.bits.len());
        self.bits.resize(length, false);
        Ok(self)
    }

    /// Appends another row.
    pub(super) fn then(mut self, other: &[bool]) -> Self {
        self.bits.extend_from_slice(other);
        self
    }

    pub(super) fn bits(&self) -> &[bool] {
        &self.bits
    }

    /// Returns the words of 32 bits, the first bit highest; the last one is filled with zeros.
    pub(super) fn words(&self) -> Vec<u32> {
        self.bits.chunks(32).map(|bits| number(bits) << (32 - bits.len())).collect()
    }
}

/// Returns a number of at most 32 bits, the first highest.
pub(super) fn number(bits: &[bool]) -> u32 {
    bits.iter().fold(0, |number, bit| number << 1 | u32::from(*bit))
}

/// Returns the remainder of the long division of a row, followed by one zero less than the
/// polynomial has bits.
fn remainder(bits: &[bool], polynomial: &[bool]) -> Vec<bool> {
    let width = polynomial.len() - 1;
    let mut rest: Vec<bool> = bits.iter().copied().chain(std::iter::repeat_n(false, width)).collect();
    for start in 0..bits.len() {
        if rest[start] {
            rest[start..].iter_mut().zip(polynomial).for_each(|(bit, term)| *bit ^= term);
        }
    }
    rest.split_off(bits.len())
}

/// Returns the CRC-24Q. Zeros in front fill whole bytes, because they do not change it.
pub(super) fn crc24q(bits: &[bool]) -> Vec<bool> {
    let zeros = std::iter::repeat_n(false, bits.len().next_multiple_of(8) - bits.len());
    let filled: Vec<bool> = zeros.chain(bits.iter().copied()).collect();
    let bytes: Vec<u8> = filled.chunks(8).map(|byte| number(byte) as u8).collect();
    let parity = checksum::crc24q(&bytes);
    parity.iter().flat_map(|byte| (0..8).rev().map(move |power| byte >> power & 1 == 1)).collect()
}

/// Returns the four parity bits of eleven bits: `x⁴ + x + 1`.
pub(super) fn bch(bits: &[bool]) -> Vec<bool> {
    remainder(bits, &[true, false, false, true, true])
}
