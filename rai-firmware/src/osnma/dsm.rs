//! Blocks of a digital signature message, from all satellites.
//!
//! A message comes in blocks of 13 bytes, one in each subframe, and satellites send different blocks
//! at the same time.
//!
//! **Poison.** One satellite that sends wrong blocks must not keep the true message from completing.
//! Two contents are kept of each block and of the header, with the number of times that the sender
//! changed. [`Collector::combination`] passes the combinations in order, that of the most-sent
//! contents first. What follows from a combination (the padding of a root key, the root of a tree)
//! dismisses a mixed one at little cost.
//!
//! Two messages of one kind are collected side by side, so that one satellite that sends blocks under
//! ever new numbers does not keep the others out either.

use core::cmp::Reverse;

/// Bytes of a block.
pub(super) const BLOCK: usize = 13;

/// Largest number of blocks of a root key, and of a new key or an alert, that are read.
pub(super) const OF_ROOT: usize = 9;
pub(super) const OF_KEY: usize = 13;

/// Bytes of the longest message.
pub(super) const BYTES: usize = BLOCK * OF_KEY;

/// Time without a block after which a message is discarded, in units of 1.024 s: an hour. It is that of
/// the module's clock, because a satellite may state any.
const FORGOTTEN: u32 = 3515;

/// Time of two subframes, in the same units.
const MINUTE: u32 = 59;

/// One content of a block.
#[derive(Clone, Copy, Debug)]
struct Content {
    bytes: [u8; BLOCK],
    /// Number of times that it came from another satellite than before; 0 if there is none.
    votes: u8,
    sender: u8,
}

impl Content {
    const NONE: Self = Self { bytes: [0; BLOCK], votes: 0, sender: 0 };

    /// Takes that a satellite sent it.
    fn receive(&mut self, sender: u8) {
        if core::mem::replace(&mut self.sender, sender) != sender {
            self.votes = self.votes.saturating_add(1);
        }
    }
}

/// Two contents of a block; the first is the one that was sent more often.
#[derive(Clone, Copy, Debug)]
struct Block([Content; 2]);

impl Block {
    const NONE: Self = Self([Content::NONE; 2]);

    /// Takes a content; returns true if that changes what the combinations are.
    fn take(&mut self, bytes: &[u8; BLOCK], sender: u8) -> bool {
        let [first, second] = &mut self.0;
        let is_this = |content: &Content| content.votes > 0 && content.bytes == *bytes;
        if is_this(first) {
            first.receive(sender);
            return false;
        }
        if is_this(second) {
            second.receive(sender);
            let is_turned = second.votes > first.votes;
            if is_turned {
                core::mem::swap(first, second);
            }
            return is_turned;
        }
        let new = Content { bytes: *bytes, votes: 1, sender };
        // A satellite that contradicts itself replaces what it sent before.
        let place =
            if first.votes == 0 || (first.sender == sender && first.votes == 1) { first } else { second };
        *place = new;
        true
    }

    const fn is_ambiguous(&self) -> bool {
        let [_, second] = &self.0;
        second.votes > 0
    }
}

/// Message whose blocks come in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Collector<const BLOCKS: usize> {
    /// Number of the message, from 0 to 15.
    id: u8,
    /// Arrival of its last block, in the same units.
    touched: u32,
    blocks: [Block; BLOCKS],
    header: Block,
    /// Number of the next combination; [`DONE`] if all were passed.
    next: u16,
}

const DONE: u16 = u16::MAX;

impl<const BLOCKS: usize> Collector<BLOCKS> {
    pub(super) const EMPTY: Self =
        Self { id: u8::MAX, touched: 0, blocks: [Block::NONE; BLOCKS], header: Block::NONE, next: DONE };

    /// Takes a block of this message.
    fn take(&mut self, header: u8, block: u8, bytes: &[u8; BLOCK], sender: u8, now: u32) {
        if now.wrapping_sub(self.touched) > FORGOTTEN {
            *self = Self { id: self.id, ..Self::EMPTY };
        }
        self.touched = now;
        let mut of_header = [0; BLOCK];
        of_header[0] = header;
        let mut is_new = self.header.take(&of_header, sender);
        if let Some(place) = self.blocks.get_mut(usize::from(block)) {
            is_new |= place.take(bytes, sender);
        }
        if is_new {
            self.next = 0;
        }
    }

    /// Returns true if a combination has not been passed yet.
    pub(super) const fn has_more(&self) -> bool {
        self.next != DONE
    }

    /// Returns the next combination, with its number of bytes and its header; `None` if the message is
    /// incomplete, or if every combination has been passed.
    pub(super) fn combination(&mut self, message: &mut [u8; BYTES]) -> Option<(usize, u8)> {
        let Block([first, second]) = self.blocks.first()?;
        let mut number = self.next;
        let is_second = number & 1 != 0 && second.votes > 0;
        let many = blocks_of(if is_second { second } else { first });
        let blocks = self.blocks.get(..many).filter(|blocks| {
            many > 0 && blocks.iter().all(|Block([first, _])| first.votes > 0) && self.next != DONE
        });
        let Some(blocks) = blocks else {
            self.next = DONE;
            return None;
        };
        let mut pick = |block: &Block| {
            let Block([first, second]) = *block;
            let is_second = block.is_ambiguous() && number & 1 != 0;
            number >>= u32::from(block.is_ambiguous());
            if is_second { second.bytes } else { first.bytes }
        };
        for (place, block) in message.as_chunks_mut::<BLOCK>().0.iter_mut().zip(blocks) {
            *place = pick(block);
        }
        let [header, ..] = pick(&self.header);
        // What is left of the number counts combinations that do not exist.
        let is_last = number > 0;
        self.next = if is_last { DONE } else { self.next.saturating_add(1) };
        (!is_last).then_some((many * BLOCK, header))
    }
}

/// Returns the number of blocks that the first block of a message states; 0 if it is not supported.
fn blocks_of(first: &Content) -> usize {
    let [code, ..] = first.bytes;
    match code >> 4 {
        // The same code for both kinds of messages: 7 to 14 blocks of a root key, 13 to 16 of a key.
        code @ 1..=7 => usize::from(code) + 6,
        _ => 0,
    }
}

/// Messages of one kind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Collectors<const N: usize, const BLOCKS: usize>(pub(super) [Collector<BLOCKS>; N]);

impl<const N: usize, const BLOCKS: usize> Collectors<N, BLOCKS> {
    pub(super) const EMPTY: Self = Self([Collector::EMPTY; N]);

    /// Passes all combinations again.
    pub(super) fn read_again(&mut self) {
        self.0.iter_mut().for_each(|collector| collector.next = 0);
    }

    /// Takes a block.
    pub(super) fn take(&mut self, hkroot: &[u8; 15], sender: u8, now: u32) {
        let [header, place, block @ ..] = hkroot;
        let (id, number) = (place >> 4, place & 15);
        let known = self.0.iter().position(|collector| collector.id == id);
        // One that was not heard for a minute gives way, or else the one with the fewest blocks.
        let worth = |collector: &Collector<BLOCKS>| {
            let age = now.wrapping_sub(collector.touched);
            let blocks = collector.blocks.iter().filter(|Block([first, _])| first.votes > 0).count();
            (age > MINUTE, Reverse(blocks), age)
        };
        let oldest = || (0..N).max_by_key(|&index| self.0.get(index).map(worth));
        let Some(collector) = known.or_else(oldest).and_then(|index| self.0.get_mut(index)) else { return };
        if collector.id != id {
            *collector = Collector { id, touched: now, ..Collector::EMPTY };
        }
        collector.take(*header, number, block, sender, now);
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;

    /// Returns block `number` of a message of 7 blocks.
    fn hkroot(number: u8, fill: u8) -> [u8; 15] {
        let mut hkroot = [fill; 15];
        (hkroot[0], hkroot[1]) = (0x52, 0x10 | number);
        if number == 0 {
            hkroot[2] = 0x10;
        }
        hkroot
    }

    fn combinations(collector: &mut Collector<OF_ROOT>) -> Vec<Vec<u8>> {
        let mut message = [0; BYTES];
        let mut all = Vec::new();
        while collector.has_more() {
            if let Some((many, header)) = collector.combination(&mut message) {
                assert_eq!((many, header), (91, 0x52));
                all.push(message[..many].chunks(BLOCK).map(|block| block[12]).collect());
            }
        }
        all
    }

    #[test]
    fn blocks_of_many_satellites_make_one_message() {
        let mut all = Collectors::<2, OF_ROOT>::EMPTY;
        for number in 0..7 {
            assert!(combinations(&mut all.0[0]).is_empty() && combinations(&mut all.0[1]).is_empty());
            all.take(&hkroot(number, number), 10 + number, 500);
        }
        let index = all.0.iter().position(|collector| collector.id == 1).expect("a collector");
        assert_eq!(combinations(&mut all.0[index]), [[0, 1, 2, 3, 4, 5, 6]]);
        all.take(&hkroot(3, 3), 30, 501);
        assert!(combinations(&mut all.0[index]).is_empty(), "the same again is no new combination");
    }

    #[test]
    fn wrong_blocks_of_one_satellite_do_not_keep_the_true_ones_out() {
        let mut all = Collectors::<2, OF_ROOT>::EMPTY;
        // The satellite that lies is the first that is heard, and changes its mind.
        for (subframe, fill) in [(500, 0x77), (501, 0x78)] {
            for number in 0..7 {
                all.take(&hkroot(number, fill), 9, subframe);
                all.take(&hkroot(number, number), 10, subframe);
            }
        }
        // It also begins messages that do not exist.
        for id in 2..12 {
            let mut other = hkroot(0, 1);
            other[1] = id << 4;
            all.take(&other, 9, 502 + u32::from(id));
            all.take(&hkroot(5, 5), 10, 502 + u32::from(id));
        }
        let index = all.0.iter().position(|collector| collector.id == 1).expect("a collector");
        let found = combinations(&mut all.0[index]);
        assert_eq!(found.len(), 128);
        assert!(found.contains(&(0..7).collect()), "the true ones are among them");
        // A second satellite that sends the true ones makes them the first to be tried.
        for number in 0..7 {
            all.take(&hkroot(number, number), 11, 520);
        }
        assert_eq!(combinations(&mut all.0[index]).first(), Some(&(0..7).collect()));
    }
}
