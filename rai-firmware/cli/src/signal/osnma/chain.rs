//! Chain of keys: each is the hash of the one that follows it, and the first is signed.
//!
//! `K(t − 30 s)` is the beginning of SHA-256(`K(t)` ∥ GST(`t − 30 s`) ∥ α).

use sha2::{Digest as _, Sha256};

use super::{WEEK, gst};

/// Number of keys behind the root key of most systems: three hours and 20 minutes.
pub(super) const KEYS: u32 = 400;

/// Keys of subframes.
#[derive(Clone, Debug)]
pub struct Chain {
    pub(super) number: u8,
    /// Subframe of the root key.
    root: u32,
    pub(super) alpha: [u8; 6],
    keys: Vec<[u8; 16]>,
}

impl Chain {
    /// Returns the subframe of the root key that a week and an hour state: the one before.
    pub const fn root(week: u32, hour: u32) -> u32 {
        week * WEEK + hour * 120 - 1
    }

    /// Returns the chain of a number, 0 to 3, whose keys follow from a seed, with so many behind its root
    /// key.
    pub(super) fn new(seed: u8, number: u8, root: u32, keys_behind: u32) -> Self {
        let seed = seed ^ number << 6;
        let alpha = [seed, 2, 3, 4, 5, 6];
        let mut keys = vec![first_16(&Sha256::digest([seed, 2]))];
        for subframe in (root..root + keys_behind).rev() {
            let last = keys.last().expect("a key");
            let hash =
                Sha256::new().chain_update(last).chain_update(gst(subframe)).chain_update(alpha).finalize();
            keys.push(first_16(&hash));
        }
        keys.reverse();
        Self { number, root, alpha, keys }
    }

    /// Returns the key of a subframe.
    pub(super) fn key(&self, subframe: u32) -> &[u8; 16] {
        &self.keys[(subframe - self.root) as usize]
    }

    /// Returns the root key.
    pub(super) fn first(&self) -> &[u8; 16] {
        &self.keys[0]
    }

    /// Returns week and hour of the root key.
    pub(super) const fn week_and_hour(&self) -> (u32, u32) {
        ((self.root + 1) / WEEK, (self.root + 1) % WEEK / 120)
    }
}

fn first_16(hash: &[u8]) -> [u8; 16] {
    hash[..16].try_into().expect("16 bytes")
}
