//! Messages in `HKROOT`: the root key of a chain, and what the root of a tree of hashes proves.
//!
//! ```text
//! NB 4 | PKID 4 | CIDKR 2 | 2 | HF 2 | MF 2 | KS 4 | TS 4 | MACLT 8 | 4 | WNK 12 | TOWHK 8 | α 48 | key | signature | padding
//! NB 4 | MID 4 | four nodes of 256 | NPKT 4 | NPKID 4 | key | padding
//! ```
//!
//! Reference: [OSNMA-ICD] 3.2.2, 3.2.3, 6.2.
//!
//! [OSNMA-ICD]: raim_firmware#references

use sha2::{Digest as _, Sha256};

use super::bits::Bits;
use super::chain::Chain;
use super::mack::SEQUENCE;
use super::secret::Secret;

/// Bytes of a block.
pub(super) const BLOCK: usize = 13;

/// Number of the message of a new key or an alert.
pub(super) const RENEWAL: u8 = 12;

/// Returns the message of a root key, signed by a key with its number.
pub(super) fn root_key(header: u8, (number, secret): (u8, &Secret), chain: &Chain, once: &[u8]) -> Vec<u8> {
    let (week, hour) = chain.week_and_hour();
    let head = Bits::default()
        .put(2, 4) // eight blocks
        .put(number.into(), 4)
        .put(chain.number.into(), 2)
        .put(0, 6) // SHA-256, HMAC-SHA-256
        .put(4, 4) // keys of 128 bits
        .put(9, 4) // tags of 40 bits
        .put(SEQUENCE, 8)
        .put(0, 4)
        .put(week.into(), 12)
        .put(hour.into(), 8);
    let mut message = head.bytes();
    message.extend(chain.alpha);
    message.extend(chain.first());
    let signed = Sha256::new().chain_update([header]).chain_update(&message[1..]);
    let signature = secret.sign(&signed.clone().finalize().into(), once);
    message.extend(signature);
    let padding = signed.chain_update(signature).finalize();
    message.extend(&padding[..8 * BLOCK - message.len()]);
    message
}

/// Tree of hashes over sixteen leaves: an alert, and the next public key at the place of its number.
pub(super) struct Tree {
    leaves: [Vec<u8>; 16],
    number: u8,
    /// Hashes of the leaves, then of each level up to the root.
    levels: Vec<Vec<[u8; 32]>>,
}

/// Blocks of a message of the tree, and the code of their number.
const BLOCKS: usize = 13;
const CODE: u64 = 7;

/// Bytes before the leaf.
const BEFORE_LEAF: usize = 129;

impl Tree {
    pub(super) fn new((number, key): (u8, [u8; 33])) -> Self {
        let mut leaves: [Vec<u8>; 16] = std::array::from_fn(|place| vec![place as u8]);
        // An alert has no key, and fills the message.
        leaves[0] = vec![0; BLOCKS * BLOCK - BEFORE_LEAF];
        leaves[0][0] = 4 << 4;
        leaves[usize::from(number)] = [&[1 << 4 | number][..], &key].concat();
        let mut levels = vec![leaves.iter().map(|leaf| Sha256::digest(leaf).into()).collect::<Vec<_>>()];
        while let Some(below) = levels.last().filter(|level| level.len() > 1) {
            levels.push(below.chunks(2).map(|pair| Sha256::digest(pair.concat()).into()).collect());
        }
        Self { leaves, number, levels }
    }

    pub(super) fn root(&self) -> [u8; 32] {
        self.levels[4][0]
    }

    /// Returns the message of the key.
    pub(super) fn key(&self) -> Vec<u8> {
        self.message(usize::from(self.number))
    }

    /// Returns the message of the alert.
    pub(super) fn alert(&self) -> Vec<u8> {
        self.message(0)
    }

    fn message(&self, place: usize) -> Vec<u8> {
        let mut message = Bits::default().put(CODE, 4).put(place as u64, 4).bytes();
        for (level, hashes) in self.levels.iter().take(4).enumerate() {
            message.extend(hashes[place >> level ^ 1]);
        }
        message.extend(&self.leaves[place]);
        let padding = Sha256::new().chain_update(self.root()).chain_update(&self.leaves[place]).finalize();
        message.extend(&padding[..BLOCKS * BLOCK - message.len()]);
        message
    }
}
