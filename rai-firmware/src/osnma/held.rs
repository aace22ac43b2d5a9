//! MACK messages that wait for their keys.
//!
//! All satellites complete a subframe at once. Their messages bring the key of those of the subframe
//! before, which therefore must not give way to all of them: [`FOR_THE_KEY`] of the new ones suffice for
//! the key.

use super::gst::Subframe;
use super::tags::{MACK, Mack};
use super::{Osnma, take};

/// Number of messages of a subframe that are kept for its key, though tags of the one before wait.
const FOR_THE_KEY: usize = 4;

/// Slot behind the last one.
pub(super) const CHECKED: u8 = u8::MAX;

/// MACK message that waits for its keys.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    pub(super) satellite: u8,
    /// Header of the subframe.
    pub(super) header: u8,
    pub(super) subframe: Subframe,
    pub(super) mack: [u8; MACK],
    pub(super) belief: Belief,
    /// Next slot to be checked, from 1, or [`CHECKED`]; 0 is `MACSEQ`.
    pub(super) next: u8,
    /// True if its flexible slots are what the sender meant.
    pub(super) is_in_order: bool,
}

/// What is known of the key in a MACK message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Belief {
    Unknown,
    Right,
    Wrong,
}

impl Held {
    pub(super) const fn message(&self) -> Mack<'_> {
        Mack { bytes: &self.mack, sender: self.satellite, status: self.header >> 6, subframe: self.subframe }
    }

    /// Number of the chain that the header states.
    pub(super) const fn chain(&self) -> u8 {
        self.header >> 4 & 3
    }

    /// Returns true if nothing of it is left to be checked.
    fn is_done(&self) -> bool {
        self.belief == Belief::Wrong || self.next == CHECKED
    }
}

impl<const S: usize, const R: usize, const L: usize> Osnma<S, R, L> {
    /// Makes room for a message of a subframe; returns false if others of it are worth more.
    pub(super) fn give_way(&mut self, subframe: Subframe) -> bool {
        let of_it = self.held.iter().filter(|held| held.subframe == subframe).count();
        let done = self.held.iter().position(Held::is_done);
        if done.is_none() && of_it >= FOR_THE_KEY && self.chains.iter().any(Option::is_some) {
            return false;
        }
        let oldest =
            || (0..self.held.len()).min_by_key(|&index| self.held.get(index).map(|held| held.subframe));
        done.or_else(oldest).map(|index| take(&mut self.held, index));
        true
    }
}
