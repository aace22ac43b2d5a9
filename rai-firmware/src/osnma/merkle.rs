//! New keys and alerts, which the root of a tree of hashes proves.
//!
//! `NB 4 | MID 4 | four nodes of 256 | NPKT 4 | NPKID 4 | key | padding`
//!
//! ```text
//! leaf = SHA-256(NPKT ∥ NPKID ∥ key);   node = SHA-256(left ∥ right), four times, up to the root
//! ```
//!
//! Bit `j` of `MID` states whether our node is the right one at level `j`.
//!
//! Reference: [OSNMA-ICD] 3.2.2, 6.2.
//!
//! [OSNMA-ICD]: crate#references

use super::hash::sha256;
use crate::input::bits::Bits;

/// Bytes of a key as it is sent: a point of the curve in its compressed form.
pub(super) const KEY: usize = 33;

/// What a message says that the root proves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Proved {
    /// The key with this number.
    Key(u8, [u8; KEY]),
    /// Authentication must not be used.
    Alert,
    /// The key has a type that is not supported.
    Unsupported,
}

/// Reads a complete message; `None` if the root does not prove it.
pub(super) fn read(message: &[u8], root: &[u8; 32]) -> Option<Proved> {
    let (head, leaf) = message.split_at_checked(129)?;
    let (_, nodes) = head.split_first()?;
    let bits = Bits(leaf);
    let (kind, pkid) = (bits.small(0, 4), bits.small(4, 4));
    let (length, proved) = match kind {
        1 => (1 + KEY, Proved::Key(pkid, *leaf.get(1..)?.first_chunk()?)),
        3 => (68, Proved::Unsupported),
        // An alert fills the message, and has no key.
        4 => (leaf.len(), Proved::Alert),
        _ => return None,
    };
    let place = Bits(head).small(4, 4);
    let mut node = sha256(&[leaf.get(..length)?]);
    for (level, other) in nodes.as_chunks::<32>().0.iter().enumerate() {
        let is_right = place >> level & 1 != 0;
        let (left, right) = if is_right { (other, &node) } else { (&node, other) };
        node = sha256(&[left, right]);
    }
    (node == *root).then_some(proved)
}
