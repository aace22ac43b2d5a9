//! Words of a satellite that tags are about, as they were in a subframe.
//!
//! A tag is about the words of the subframe before its own, and is checked one or eleven subframes
//! after it. Each word is therefore stored with the subframes in which it came. When it changes, its
//! former content is stored too, in one of a few places that all satellites share.
//!
//! | ADKD | words and bits |
//! |---|---|
//! | 0, 12 | 1, 2, 4: 6 to 125; 3: 6 to 127; 5: 6 to 72 |
//! | 4 | 6: 6 to 104; 10: 86 to 127 |
//!
//! **COP** of a tag is the number of subframes for which the words have not changed. A word that was
//! missed may be that many subframes old.
//!
//! Subframes are stored modulo 256. A word that has not come for [`FORGOTTEN`] subframes is
//! discarded, so that no number is ambiguous.

use heapless::Vec;

use super::gst::Subframe;
use crate::input::bits::{Bits, Packed};

/// Type, first bit, number of bits, and place of each word.
const PLACES: [(u8, usize, usize, usize); 7] = [
    (1, 6, 120, 0),
    (2, 6, 120, 15),
    (3, 6, 122, 30),
    (4, 6, 120, 46),
    (5, 6, 67, 61),
    (6, 6, 99, 70),
    (10, 86, 42, 83),
];

/// Bytes of all words.
const BYTES: usize = 89;

/// Mask of the words with orbit and clock.
const ORBIT: u8 = 0b001_1111;

/// Mask of the words with time parameters.
const TIMING: u8 = 0b110_0000;

/// Number of subframes without a word after which it is discarded.
const FORGOTTEN: u8 = 60;

/// What a tag is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum About {
    /// Orbit, clock and health.
    Orbit,
    /// Time parameters.
    Timing,
}

/// Words that a tag is about.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chosen {
    /// True if every word came in the very subframe, so that a wrong tag proves them false.
    pub(super) is_complete: bool,
    /// Mask of those with their former content.
    former: u8,
}

impl Chosen {
    /// Returns true if all of them are the present ones.
    pub(super) const fn is_present(self) -> bool {
        self.former == 0
    }

    const fn is_former(self, index: usize) -> bool {
        self.former >> index & 1 != 0
    }
}

/// Words of one satellite, as it sent them last.
#[derive(Clone, Copy, Debug)]
pub(super) struct Words {
    bytes: [u8; BYTES],
    /// Mask of the words that are known.
    known: u8,
    /// Subframes in which each came first and last.
    first: [u8; 7],
    last: [u8; 7],
}

/// Words of a satellite before some of them changed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Former {
    satellite: u8,
    /// Subframe of the change.
    changed: u8,
    words: Words,
}

/// Former words of the satellites that changed theirs last.
#[derive(Clone, Debug)]
pub(super) struct FormerWords<const N: usize>(Vec<Former, N>);

impl<const N: usize> FormerWords<N> {
    pub(super) const NONE: Self = Self(Vec::new());

    /// Discards those of a satellite.
    pub(super) fn forget(&mut self, satellite: u8) {
        self.0.retain(|former| former.satellite != satellite);
    }

    /// Stores the words of a satellite, the first time that some change in a subframe. If there is no
    /// room, those of the oldest change give way.
    fn store(&mut self, satellite: u8, words: &Words, now: u8) {
        let is_known = |former: &Former| former.satellite == satellite && former.changed == now;
        if self.0.iter().any(is_known) {
            return;
        }
        if self.0.is_full() {
            let age = |former: &Former| now.wrapping_sub(former.changed);
            let oldest = (0..self.0.len()).max_by_key(|&index| self.0.get(index).map(age));
            oldest.map(|index| super::take(&mut self.0, index));
        }
        let _ = self.0.push(Former { satellite, changed: now, words: *words });
    }

    /// Returns the words of a satellite before the first change behind a subframe.
    pub(super) fn of(&self, satellite: u8, subframe: u8) -> Option<&Words> {
        let behind = |former: &&Former| since(subframe, former.changed);
        let mine = self.0.iter().filter(|former| former.satellite == satellite && behind(former) > 0);
        mine.min_by_key(behind).map(|former| &former.words)
    }
}

impl Words {
    pub(super) const NONE: Self = Self { bytes: [0; BYTES], known: 0, first: [0; 7], last: [0; 7] };

    /// Returns true if all words with orbit and clock are known.
    pub(super) const fn has_orbit(&self) -> bool {
        self.known & ORBIT == ORBIT
    }

    /// Takes a word of a satellite that came in a subframe, or at an unknown time. Returns true if a
    /// word with orbit or clock has changed.
    ///
    /// A word of unknown time cannot be checked. If it differs from the known one, it discards that
    /// one, so that the words here are always those that the satellite sent last.
    pub(super) fn take<const N: usize>(
        &mut self,
        satellite: u8,
        word: &[u8; 16],
        subframe: Option<Subframe>,
        former: &mut FormerWords<N>,
    ) -> bool {
        let bits = Bits(word);
        let kind = bits.small(0, 6);
        let Some((index, &(_, start, count, place))) =
            PLACES.iter().enumerate().find(|(_, (its, ..))| *its == kind)
        else {
            return false;
        };
        let mask = 1 << index;
        let mut packed = Packed::<16>::new();
        push_bits(&mut packed, bits, start, count);
        let range = place..place + count.div_ceil(8);
        let (Some(new), Some(now)) = (packed.bytes.get(..range.len()), self.bytes.get(range.clone())) else {
            return false;
        };
        let is_known = self.known & mask != 0;
        let is_same = is_known && *now == *new;
        let Some(subframe) = subframe else {
            if !is_same {
                self.known &= !mask;
            }
            return is_known && !is_same && mask & ORBIT != 0;
        };
        if !is_same {
            if is_known {
                former.store(satellite, self, subframe.short());
            }
            self.bytes.iter_mut().skip(place).zip(new).for_each(|(place, byte)| *place = *byte);
            self.known |= mask;
        }
        if let (Some(first), Some(last)) = (self.first.get_mut(index), self.last.get_mut(index)) {
            *first = if is_same { *first } else { subframe.short() };
            *last = subframe.short();
        }
        !is_same && mask & ORBIT != 0
    }

    /// Discards what has not come for long. To be called once in each subframe.
    pub(super) fn age(&mut self, subframe: Subframe) {
        let now = subframe.short();
        for (index, (first, last)) in self.first.iter_mut().zip(&self.last).enumerate() {
            if now.wrapping_sub(*last) > FORGOTTEN {
                self.known &= !(1 << index);
            }
            if now.wrapping_sub(*first) > FORGOTTEN {
                *first = now.wrapping_sub(FORGOTTEN);
            }
        }
    }

    /// Returns which words were in force in a subframe, according to a tag with this COP; `None` if
    /// one of them is unknown.
    pub(super) fn choose(
        &self,
        former: Option<&Self>,
        about: About,
        subframe: u8,
        cop: u8,
    ) -> Option<Chosen> {
        let mask = mask_of(about);
        let mut chosen = Chosen { is_complete: true, former: 0 };
        for (index, (first, last)) in self.first.iter().zip(&self.last).enumerate() {
            let bit = 1 << index;
            if mask & bit == 0 {
                continue;
            }
            let is_now = self.known & bit != 0 && since(*first, subframe) >= 0;
            let late = if is_now {
                since(*last, subframe)
            } else {
                let former = former.filter(|former| former.known & bit != 0)?;
                if since(*former.first.get(index)?, subframe) < 0 {
                    return None;
                }
                chosen.former |= bit;
                since(*former.last.get(index)?, subframe)
            };
            if late >= cop.max(1).cast_signed() {
                return None;
            }
            chosen.is_complete &= late <= 0;
        }
        let is_mixed = about == About::Orbit && {
            let issue = |index| self.slice(former, index, chosen).map(|word| Bits(word).unsigned(0, 10));
            (1..4).any(|index| issue(index) != issue(0))
        };
        (!is_mixed).then_some(chosen)
    }

    /// Appends the bits of chosen words.
    pub(super) fn push<const N: usize>(
        &self,
        former: Option<&Self>,
        about: About,
        chosen: Chosen,
        to: &mut Packed<N>,
    ) {
        let mask = mask_of(about);
        for (index, (_, _, count, _)) in PLACES.iter().enumerate() {
            if mask >> index & 1 != 0 {
                push_bits(to, Bits(self.slice(former, index, chosen).unwrap_or_default()), 0, *count);
            }
        }
    }

    fn slice<'a>(&'a self, former: Option<&'a Self>, index: usize, chosen: Chosen) -> Option<&'a [u8]> {
        let &(_, _, count, place) = PLACES.get(index)?;
        let from = if chosen.is_former(index) { &former?.bytes } else { &self.bytes };
        from.get(place..place + count.div_ceil(8))
    }
}

const fn mask_of(about: About) -> u8 {
    match about {
        About::Orbit => ORBIT,
        About::Timing => TIMING,
    }
}

/// Returns by how many subframes `then` is before `subframe`.
const fn since(then: u8, subframe: u8) -> i8 {
    subframe.wrapping_sub(then).cast_signed()
}

fn push_bits<const N: usize>(to: &mut Packed<N>, from: Bits<'_>, start: usize, count: usize) {
    let mut done = 0;
    while done < count {
        let width = (count - done).min(32);
        to.push(from.unsigned(start + done, width), width);
        done += width;
    }
}
