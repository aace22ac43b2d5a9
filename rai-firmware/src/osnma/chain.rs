//! Chain of keys: each is the hash of the one that follows it.
//!
//! ```text
//! K(t − 30 s) = first bits of SHA-256( K(t) ∥ GST(t − 30 s) ∥ α )
//! ```
//!
//! A new key is right if hashing it back arrives at the newest right key at exactly its time. The
//! first right key is the root key, which a signature proves. A key is at most [`LONGEST`] steps
//! ahead, and a slice makes [`STEPS`] of them.
//!
//! Reference: [OSNMA-ICD] 6.4.
//!
//! [OSNMA-ICD]: crate#references

use super::gst::{Subframe, WEEK};
use super::hash::sha256;

/// Largest number of steps from one right key to the next: a week.
const LONGEST: u32 = WEEK;

/// Number of steps of a slice, at most 4,900 instructions each.
pub(super) const STEPS: u32 = 11;

/// Properties of a chain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Parameters {
    /// Number of the chain, from 0 to 3.
    pub(super) chain: u8,
    pub(super) key_bytes: u8,
    pub(super) tag_bits: u8,
    /// Number of the sequence of tags.
    pub(super) maclt: u8,
    pub(super) alpha: [u8; 6],
}

impl Parameters {
    /// Returns the number of tags in a MACK message of 480 bits.
    pub(super) const fn tags(&self) -> usize {
        (480 - 8 * self.key_bytes as usize) / (self.tag_bits as usize + 16)
    }

    /// Returns the key of the subframe before.
    fn back(&self, key: &[u8; 32], before: Subframe) -> [u8; 32] {
        let count = usize::from(self.key_bytes);
        let time = before.bits().to_be_bytes();
        let mut back = sha256(&[key.get(..count).unwrap_or_default(), &time, &self.alpha]);
        back.iter_mut().skip(count).for_each(|byte| *byte = 0);
        back
    }
}

/// Chain whose root key was proved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chain {
    pub(super) parameters: Parameters,
    /// Newest right key, its subframe, and the key before.
    pub(super) newest: Subframe,
    pub(super) key: [u8; 32],
    pub(super) before: [u8; 32],
    /// When the newest key was proved by the module's clock, in units of 1.024 s; `None` for the root key.
    pub(super) proved_at: Option<u32>,
}

impl Chain {
    pub(super) fn new(parameters: Parameters, subframe: Subframe, key: [u8; 32]) -> Self {
        let before = parameters.back(&key, subframe.back(1));
        Self { parameters, newest: subframe, key, before, proved_at: None }
    }

    /// Returns the largest number of steps to a key that comes now. The root key may be a week old. A
    /// later key is as old as the module's clock says; a satellite that states another time would cost
    /// thousands of steps else.
    fn longest(&self, now: u32) -> u32 {
        /// Units of a subframe, and subframes that the clock may be wrong by.
        const UNITS: u32 = 29;
        const SLACK: u32 = 10;
        self.proved_at.map_or(LONGEST, |then| (now.wrapping_sub(then) / UNITS + SLACK).min(LONGEST))
    }

    /// Returns the right key of a subframe, if it is one of the two newest.
    pub(super) fn key_of(&self, subframe: Subframe) -> Option<&[u8; 32]> {
        if subframe == self.newest {
            return Some(&self.key);
        }
        (subframe == self.newest.back(1)).then_some(&self.before)
    }
}

/// Comparison of a key with the chain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub(super) chain: u8,
    pub(super) satellite: u8,
    /// Subframe of the key, the key, and the key before it once it is known.
    pub(super) subframe: Subframe,
    key: [u8; 32],
    before: [u8; 32],
    /// Where hashing back has arrived.
    at: Subframe,
    present: [u8; 32],
}

/// What a slice of a comparison leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Linked {
    NotYet,
    Right,
    Wrong,
}

impl Link {
    /// Begins a comparison; `None` if the key is not newer, or too much newer, than the chain's.
    pub(super) fn new(
        chain: &Chain,
        satellite: u8,
        subframe: Subframe,
        key: [u8; 32],
        now: u32,
    ) -> Option<Self> {
        let is_ahead = subframe > chain.newest && subframe.0 - chain.newest.0 <= chain.longest(now);
        let number = chain.parameters.chain;
        is_ahead.then_some(Self {
            chain: number,
            satellite,
            subframe,
            key,
            before: key,
            at: subframe,
            present: key,
        })
    }

    /// Makes the steps of one slice. A right key becomes the chain's newest.
    pub(super) fn go_on(&mut self, chain: &mut Chain, now: u32) -> Linked {
        for _ in 0..STEPS {
            if self.at <= chain.newest {
                break;
            }
            self.at = self.at.back(1);
            self.present = chain.parameters.back(&self.present, self.at);
            if self.at == self.subframe.back(1) {
                self.before = self.present;
            }
        }
        if self.at > chain.newest {
            return Linked::NotYet;
        }
        if chain.key_of(self.at) != Some(&self.present) {
            return Linked::Wrong;
        }
        (chain.newest, chain.key, chain.before) = (self.subframe, self.key, self.before);
        chain.proved_at = Some(now);
        Linked::Right
    }
}
