//! Bits of unsigned numbers, appended to others.

/// Row of bits.
#[derive(Clone, Default)]
pub(super) struct Bits(pub(super) Vec<bool>);

impl Bits {
    /// Appends the lowest bits of a number.
    pub(super) fn put(mut self, value: u64, width: usize) -> Self {
        self.0.extend((0..width).rev().map(|bit| value >> bit & 1 == 1));
        self
    }

    /// Appends bytes.
    pub(super) fn put_all(self, bytes: &[u8]) -> Self {
        bytes.iter().fold(self, |bits, byte| bits.put((*byte).into(), 8))
    }

    /// Returns the bytes; zeros fill the last one.
    pub(super) fn bytes(&self) -> Vec<u8> {
        let byte = |bits: &[bool]| {
            bits.iter().enumerate().fold(0, |byte, (place, bit)| byte | u8::from(*bit) << (7 - place))
        };
        self.0.chunks(8).map(byte).collect()
    }
}
