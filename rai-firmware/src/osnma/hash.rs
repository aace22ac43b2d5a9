//! SHA-256 and HMAC of messages in parts, one copy of each for all callers.
//!
//! Only the compression of a block is the crate's. Its buffer for parts of any length can panic for all
//! that a linker knows.
//!
//! Reference: [FIPS-180-4].
//!
//! [FIPS-180-4]: crate#references

use sha2::compress256;

/// Bytes of a block.
const BLOCK: usize = 64;

/// State before the first block.
const START: [u32; 8] =
    [0x6a09_e667, 0xbb67_ae85, 0x3c6e_f372, 0xa54f_f53a, 0x510e_527f, 0x9b05_688c, 0x1f83_d9ab, 0x5be0_cd19];

/// Hash of the bytes so far.
struct Hash {
    state: [u32; 8],
    block: [u8; BLOCK],
    /// Number of bytes so far.
    length: u32,
}

impl Hash {
    fn push(&mut self, byte: u8) {
        if let Some(place) = self.block.get_mut(self.length as usize % BLOCK) {
            *place = byte;
        }
        self.length = self.length.wrapping_add(1);
        if (self.length as usize).is_multiple_of(BLOCK) {
            compress256(&mut self.state, &[self.block.into()]);
        }
    }
}

/// Returns the hash of a message in parts, which are shorter than 512 MiB.
#[inline(never)]
pub(super) fn sha256(parts: &[&[u8]]) -> [u8; 32] {
    /// Bytes of the length at the end of the last block.
    const LENGTH: usize = 8;
    let mut hash = Hash { state: START, block: [0; BLOCK], length: 0 };
    parts.iter().flat_map(|part| part.iter()).for_each(|byte| hash.push(*byte));
    let bits = u64::from(hash.length) * 8;
    hash.push(0x80);
    // At most a block of zeros.
    for _ in 0..BLOCK {
        if hash.length as usize % BLOCK == BLOCK - LENGTH {
            break;
        }
        hash.push(0);
    }
    bits.to_be_bytes().into_iter().for_each(|byte| hash.push(byte));
    let mut bytes = [0; 32];
    for (place, word) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(hash.state) {
        *place = word.to_be_bytes();
    }
    bytes
}

/// Returns the code of a message by a key of at most a block.
///
/// `H((K ⊕ 5C…) ∥ H((K ⊕ 36…) ∥ message))`
#[inline(never)]
pub(super) fn hmac(key: &[u8], message: &[u8]) -> [u8; 32] {
    let padded = |with: u8| {
        let mut block = [with; BLOCK];
        block.iter_mut().zip(key).for_each(|(place, byte)| *place ^= byte);
        block
    };
    let inner = sha256(&[&padded(0x36), message]);
    sha256(&[&padded(0x5C), &inner])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Test cases 2 and 4 of RFC 4231.
    #[test]
    fn codes_are_those_of_the_standard() {
        let first = hmac(b"Jefe", b"what do ya want for nothing?");
        assert_eq!(first[..8], [0x5b, 0xdc, 0xc1, 0x46, 0xbf, 0x60, 0x75, 0x4e]);
        assert_eq!(first[24..], [0x9d, 0xec, 0x58, 0xb9, 0x64, 0xec, 0x38, 0x43]);
        let key: [u8; 25] = core::array::from_fn(|index| index as u8 + 1);
        let second = hmac(&key, &[0xCD; 50]);
        assert_eq!(second[..8], [0x82, 0x55, 0x8a, 0x38, 0x9a, 0x44, 0x3c, 0x0e]);
    }

    /// A message of every length has the hash of the crate.
    #[test]
    fn hashes_are_those_of_the_crate() {
        use sha2::{Digest as _, Sha256};
        let message: [u8; 200] = core::array::from_fn(|index| index as u8 ^ 0x5A);
        for length in 0..message.len() {
            let (first, second) = message[..length].split_at(length / 3);
            let want: [u8; 32] = Sha256::digest(&message[..length]).into();
            assert_eq!(sha256(&[first, second]), want, "{length} bytes");
        }
    }
}
