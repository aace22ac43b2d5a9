//! Root key of a chain, as `DSM-KROOT` states it, and its signature's message.
//!
//! `NB 4 | PKID 4 | CIDKR 2 | 2 | HF 2 | MF 2 | KS 4 | TS 4 | MACLT 8 | 4 | WNK 12 | TOWHK 8 | α 48 | KROOT | DS 512 | padding`
//!
//! The signature is of `M`, the header of the subframe and the message from `CIDKR` to the root key.
//! The padding is the beginning of SHA-256(`M` ∥ `DS`). It dismisses a message of mixed blocks for the
//! price of two blocks of SHA-256.
//!
//! Other functions than SHA-256 and HMAC-SHA-256, and signatures by P-521, are not supported.
//!
//! Reference: [OSNMA-ICD] 3.2.3.
//!
//! [OSNMA-ICD]: crate#references

use super::chain::Parameters;
use super::gst::{Subframe, WEEK};
use super::hash::sha256;
use super::table;
use crate::input::bits::Bits;

/// Bytes before the root key.
const HEAD: usize = 13;

/// Bytes of a signature by P-256.
const SIGNATURE: usize = 64;

/// A root key.
#[derive(Clone, Copy, Debug)]
pub(super) struct Root {
    /// Number of the key that has signed.
    pub(super) pkid: u8,
    /// Header that came with the message.
    pub(super) header: u8,
    pub(super) parameters: Parameters,
    /// Subframe of the root key, and the key.
    pub(super) subframe: Subframe,
    pub(super) key: [u8; 32],
}

/// Signature of a message, and the hash of what it signs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Signed {
    pub(super) hash: [u8; 32],
    /// First bytes of the hash of what is signed and the signature, which no other message has: one with
    /// another signature is another message.
    pub(super) mark: u64,
    pub(super) signature: [u8; SIGNATURE],
}

/// Reason for which a message is no root key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoRoot {
    /// The blocks do not belong together, or a field has no meaning.
    Invalid,
    /// The functions are not supported.
    Unsupported,
}

impl Root {
    /// Reads a complete message.
    pub(super) fn read(message: &[u8], header: u8) -> Result<(Self, Signed), NoRoot> {
        let bits = Bits(message);
        let (hash_function, mac_function) = (bits.small(12, 2), bits.small(14, 2));
        if hash_function != 0 || mac_function != 0 {
            return Err(NoRoot::Unsupported);
        }
        let key_bytes: u8 = match bits.unsigned(16, 4) {
            size @ 0..=4 => 12 + size as u8,
            size @ 5..=8 => 4 * size as u8,
            _ => return Err(NoRoot::Invalid),
        };
        let tag_bits: u8 = match bits.unsigned(20, 4) {
            size @ 5..=8 => 4 * size as u8,
            9 => 40,
            _ => return Err(NoRoot::Invalid),
        };
        let (week, hour) = (bits.unsigned(36, 12), bits.unsigned(48, 8));
        let maclt = bits.small(24, 8);
        if table::sequence(maclt, false).is_none() || hour >= 168 {
            return Err(NoRoot::Invalid);
        }
        let end = HEAD + usize::from(key_bytes);
        let (Some(signed), Some(stated), Some(signature), Some(padding)) = (
            message.get(1..end),
            message.get(HEAD..end),
            message.get(end..).and_then(|behind| behind.first_chunk::<SIGNATURE>()),
            message.get(end + SIGNATURE..),
        ) else {
            return Err(NoRoot::Unsupported);
        };
        let check = sha256(&[&[header], signed, signature]);
        if padding.is_empty() || !padding.iter().zip(&check).all(|(have, want)| have == want) {
            // A longer signature has its padding elsewhere.
            let is_longer = padding.len() > SIGNATURE;
            return Err(if is_longer { NoRoot::Unsupported } else { NoRoot::Invalid });
        }
        let mut key = [0; 32];
        key.iter_mut().zip(stated).for_each(|(place, byte)| *place = *byte);
        let alpha = message.get(7..).and_then(|behind| behind.first_chunk()).copied();
        let hash = sha256(&[&[header], signed]);
        let root = Self {
            pkid: bits.small(4, 4),
            header,
            parameters: Parameters {
                chain: bits.small(8, 2),
                key_bytes,
                tag_bits,
                maclt,
                alpha: alpha.unwrap_or_default(),
            },
            subframe: Subframe(week * WEEK + hour * 120).back(1),
            key,
        };
        let mark = check.first_chunk().copied().map_or(0, u64::from_be_bytes);
        Ok((root, Signed { hash, mark, signature: *signature }))
    }
}
