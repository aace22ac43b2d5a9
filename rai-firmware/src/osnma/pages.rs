//! Pages of one satellite: their time, and the bits for authentication until a subframe is complete.
//!
//! A page lasts 2 s, a subframe 15 pages. Pages of E1 begin at odd seconds of Galileo system time,
//! those of E5b at even ones. Words 5 and 0 state the time at which their page began. The module's
//! clock carries it on; a page whose arrival lies more than [`SURE_MS`] from a possible one is not
//! used.

use super::gst::{Subframe, WEEK_S};
use crate::input::bits::Bits;

/// Largest distance between the arrival of a page and the one that its place suggests, ms.
const SURE_MS: i32 = 700;

/// Longest time for which the time of a satellite is carried on, ms.
const CARRIED_MS: u32 = 600_000;

/// Number of pages of a subframe.
pub(super) const PAGES: usize = 15;

/// Mask of a complete subframe.
const COMPLETE: u16 = (1 << PAGES) - 1;

/// Time of a satellite's pages.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    /// Time that a word stated, s, and the arrival of its page, ms modulo 2^32.
    stated_s: u32,
    came_ms: u32,
    is_set: bool,
}

impl Clock {
    pub(super) const UNSET: Self = Self { stated_s: 0, came_ms: 0, is_set: false };

    /// Returns the time at which a page began, s; `None` if it is not sure.
    pub(super) fn of(&mut self, word: &[u8; 16], is_e1: bool, came_ms: u64) -> Option<u32> {
        let came_ms = came_ms as u32;
        if let Some(stated_s) = stated(Bits(word)) {
            *self = Self { stated_s, came_ms, is_set: stated_s % 2 == u32::from(is_e1) };
            return self.is_set.then_some(stated_s);
        }
        let elapsed_ms = came_ms.wrapping_sub(self.came_ms);
        if !self.is_set || elapsed_ms > CARRIED_MS {
            self.is_set = false;
            return None;
        }
        let parity = u32::from(is_e1);
        // The nearest second of that parity.
        let offset_s = (self.stated_s ^ parity) & 1;
        let pages = (elapsed_ms + 1000 * (1 - offset_s)) / 2000;
        let nearest_s = 2 * pages + offset_s;
        let apart_ms = (1000 * nearest_s).cast_signed() - elapsed_ms.cast_signed();
        (apart_ms.abs() <= SURE_MS).then_some(self.stated_s.wrapping_add(nearest_s))
    }
}

/// Returns the time that a word states, s.
fn stated(word: Bits<'_>) -> Option<u32> {
    let (week, second) = match word.unsigned(0, 6) {
        5 => (word.unsigned(73, 12), word.unsigned(85, 20)),
        0 if word.unsigned(6, 2) == 0b10 => (word.unsigned(96, 12), word.unsigned(108, 20)),
        _ => return None,
    };
    (second < WEEK_S).then_some(week * WEEK_S + second)
}

/// Bits for authentication of a subframe that is incomplete.
#[derive(Clone, Copy, Debug)]
pub(super) struct Collected {
    pub(super) satellite: u8,
    pub(super) subframe: Subframe,
    present: u16,
    /// The byte of `HKROOT`, and the four of `MACK`, of each page.
    pub(super) hkroot: [u8; PAGES],
    pub(super) mack: [[u8; 4]; PAGES],
}

impl Collected {
    pub(super) const fn new(satellite: u8, subframe: Subframe) -> Self {
        Self { satellite, subframe, present: 0, hkroot: [0; PAGES], mack: [[0; 4]; PAGES] }
    }

    /// Adds a page; returns true if that makes the subframe complete.
    pub(super) fn add(&mut self, index: usize, bits: [u8; 5]) -> bool {
        let was_complete = self.present == COMPLETE;
        let [head, mack @ ..] = bits;
        if let (Some(place), Some(of_mack)) = (self.hkroot.get_mut(index), self.mack.get_mut(index)) {
            (*place, *of_mack) = (head, mack);
            self.present |= 1 << index;
        }
        self.present == COMPLETE && !was_complete
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a word that states a time, or none.
    fn word(kind: u8, gst_s: u32) -> [u8; 16] {
        let mut word = crate::input::bits::Packed::<16>::new();
        word.push(u32::from(kind), 6);
        for _ in 0..67 {
            word.push(0, 1);
        }
        word.push(gst_s / WEEK_S, 12);
        word.push(gst_s % WEEK_S, 20);
        word.bytes
    }

    #[test]
    fn time_is_carried_on_from_page_to_page_of_both_signals() {
        let mut clock = Clock::UNSET;
        assert_eq!(clock.of(&word(1, 0), true, 500), None, "no time before a word states it");
        assert_eq!(clock.of(&word(5, 1001), true, 1000), Some(1001));
        for (came_ms, is_e1, want) in [
            (3000, true, Some(1003)),
            (3600, true, Some(1003)),
            (2100, false, Some(1002)),
            (1900, false, Some(1002)),
            (4000, true, None),
            (301_400, true, Some(1301)),
        ] {
            assert_eq!(clock.of(&word(1, 0), is_e1, came_ms), want, "{came_ms} ms");
        }
        assert_eq!(clock.of(&word(1, 0), true, 700_000), None, "carried on for too long");
        assert_eq!(clock.of(&word(1, 0), true, 5_000), None, "and not set again by an earlier page");
    }

    #[test]
    fn time_of_the_wrong_parity_or_beyond_the_week_is_not_used() {
        let mut clock = Clock::UNSET;
        assert_eq!(clock.of(&word(5, 1000), true, 1000), None);
        let mut late = [0xFF; 16];
        late[0] = 5 << 2;
        assert_eq!(clock.of(&late, true, 1000), None);
    }
}
