//! Slices of the work that need a proved chain: keys of satellites, and tags.

use super::chain::{Chain, Link, Linked};
use super::gst::Subframe;
use super::held::{Belief, CHECKED, Held};
use super::table::Slot;
use super::tags::Tag;
use super::verdicts::{Finding, units};
use super::{Osnma, SLOW, Slow, Worked, take};
use crate::counters::count;

/// Status of the header under which tags must not be used.
pub(super) const DONT_USE: u8 = 3;

impl Slow {
    fn new(tag: &Tag, subframe: Subframe) -> Self {
        let [_, _, _, value @ ..] = tag.value.to_be_bytes();
        Self {
            value,
            sender: tag.sender,
            subject: tag.subject,
            cop_slot: tag.cop << 4 | tag.slot & 15,
            status: tag.status,
            subframe: subframe.short(),
        }
    }

    fn tag(&self) -> Tag {
        let [a, b, c, d, e] = self.value;
        Tag {
            value: u64::from_be_bytes([0, 0, 0, a, b, c, d, e]),
            sender: self.sender,
            subject: self.subject,
            adkd: 12,
            cop: self.cop_slot >> 4,
            slot: self.cop_slot & 15,
            status: self.status,
        }
    }
}

impl<const S: usize, const R: usize, const L: usize> Osnma<S, R, L> {
    /// Returns the chain that proved the newest key.
    fn active(&self) -> Option<&Chain> {
        self.chain_of(self.active)
    }

    fn chain_of(&self, number: u8) -> Option<&Chain> {
        self.chains.iter().flatten().find(|chain| chain.parameters.chain == number)
    }

    /// Goes on with the key that is being compared.
    pub(super) fn work_on_link(&mut self, now_ms: u64) -> Option<Worked> {
        let link = self.link.as_mut()?;
        let mut chains = self.chains.iter_mut().flatten();
        let Some(chain) = chains.find(|chain| chain.parameters.chain == link.chain) else {
            self.link = None;
            return Some(Worked::Something);
        };
        match link.go_on(chain, units(now_ms)) {
            Linked::NotYet => {}
            Linked::Right => {
                self.active = link.chain;
                self.link = None;
            }
            Linked::Wrong => {
                let (satellite, subframe) = (link.satellite, link.subframe);
                self.link = None;
                self.disbelieve(satellite, subframe, now_ms);
            }
        }
        Some(Worked::Something)
    }

    /// Begins to compare a key that is newer than the chain's.
    pub(super) fn begin_link(&mut self, now_ms: u64) -> bool {
        let Self { held, chains, link, .. } = self;
        for held in held.iter_mut().filter(|held| held.belief == Belief::Unknown) {
            let mut known = chains.iter().flatten();
            let Some(chain) = known.find(|chain| chain.parameters.chain == held.chain()) else { continue };
            let key = held.message().key(&chain.parameters);
            *link = Link::new(chain, held.satellite, held.subframe, key, units(now_ms));
            if link.is_some() {
                return true;
            }
        }
        false
    }

    /// Compares the keys of messages with those of the chain that are known, and discards messages
    /// whose keys will not come any more.
    pub(super) fn believe(&mut self, now_ms: u64) {
        while let Some(index) = self.held.iter().position(|held| {
            held.belief == Belief::Unknown
                && self.chain_of(held.chain()).is_some_and(|chain| chain.newest >= held.subframe)
        }) {
            let Some(held) = self.held.get(index) else { return };
            let key = self
                .chain_of(held.chain())
                .map(|chain| (chain.key_of(held.subframe).copied(), held.message().key(&chain.parameters)));
            match key {
                Some((Some(right), key)) if right == key => {
                    count(&mut self.tally.osnma_keys_right);
                    self.trust(index);
                }
                Some((Some(_), _)) => {
                    let (satellite, subframe) = (held.satellite, held.subframe);
                    self.disbelieve(satellite, subframe, now_ms);
                }
                // Older than the two newest keys.
                _ => drop(take(&mut self.held, index)),
            }
        }
        if let Some(newest) = self.active().map(|chain| chain.newest) {
            self.held.retain(|held| held.subframe >= newest.back(1));
            let now = newest.short();
            self.slow.retain(|slow| now.wrapping_sub(slow.subframe).cast_signed() <= SLOW.cast_signed());
        }
    }

    /// Believes a message whose key is right, and stores its tags with a later key.
    fn trust(&mut self, index: usize) {
        let Some(held) = self.held.get_mut(index) else { return };
        held.belief = Belief::Right;
        let held = *held;
        let Some(parameters) = self.chain_of(held.chain()).map(|chain| chain.parameters) else { return };
        for slot in 2..=parameters.tags() as u8 {
            if let Some((tag, Slot::Fixed(12, _))) = held.message().tag(&parameters, slot) {
                self.delay(&tag, held.subframe);
            }
        }
    }

    /// Stores a tag until its later key comes. If there is no room, it is dropped, because one that has
    /// waited is nearer to its key.
    fn delay(&mut self, tag: &Tag, subframe: Subframe) {
        let _ = self.slow.push(Slow::new(tag, subframe));
    }

    fn disbelieve(&mut self, satellite: u8, subframe: Subframe, now_ms: u64) {
        count(&mut self.tally.osnma_keys_wrong);
        let mut held = self.held.iter_mut();
        if let Some(held) = held.find(|held| held.satellite == satellite && held.subframe == subframe) {
            held.belief = Belief::Wrong;
        }
        if self.is_nominal() {
            self.alarm.hear_wrong_key(satellite, now_ms);
        }
    }

    /// Checks the next tag, or the sequence, of a message whose key is known now.
    pub(super) fn check_held(&mut self, now_ms: u64) -> Option<Worked> {
        let &Chain { parameters, newest, key, .. } = self.active()?;
        let key = key.get(..usize::from(parameters.key_bytes)).unwrap_or_default();
        let is_due = |held: &Held| {
            held.belief == Belief::Right && held.subframe == newest.back(1) && held.next != CHECKED
        };
        while let Some(index) = self.held.iter().position(is_due) {
            let held = self.held.get_mut(index)?;
            let slot = held.next;
            held.next = if usize::from(slot) < parameters.tags() { slot + 1 } else { CHECKED };
            if held.header >> 6 == DONT_USE || self.header.is_none_or(|header| header >> 6 == DONT_USE) {
                held.next = CHECKED;
                continue;
            }
            if slot == 0 {
                held.is_in_order = held.message().has_right_sequence(&parameters, key);
                count(if held.is_in_order {
                    &mut self.tally.osnma_sequences_right
                } else {
                    &mut self.tally.osnma_sequences_wrong
                });
                return Some(Worked::Something);
            }
            let Some((tag, demanded)) = held.message().tag(&parameters, slot) else { continue };
            if demanded == Slot::Flexible && !held.is_in_order {
                continue;
            }
            let (subframe, is_in_order) = (held.subframe, held.is_in_order);
            if tag.adkd == 12 {
                if demanded == Slot::Flexible {
                    self.delay(&tag, subframe);
                }
                continue;
            }
            if let Some(worked) = self.check(&tag, subframe, parameters.tag_bits, key, is_in_order, now_ms) {
                return Some(worked);
            }
        }
        None
    }

    /// Checks a tag whose later key is known now.
    pub(super) fn check_slow(&mut self, now_ms: u64) -> Option<Worked> {
        let &Chain { parameters, newest, key, .. } = self.active()?;
        let key = key.get(..usize::from(parameters.key_bytes)).unwrap_or_default();
        let subframe = newest.back(u32::from(SLOW));
        while let Some(index) = self.slow.iter().position(|slow| slow.subframe == subframe.short()) {
            let Some(tag) = take(&mut self.slow, index).map(|slow| slow.tag()) else { continue };
            if self.header.is_none_or(|header| header >> 6 == DONT_USE) {
                continue;
            }
            if let Some(worked) = self.check(&tag, subframe, parameters.tag_bits, key, true, now_ms) {
                return Some(worked);
            }
        }
        None
    }

    /// Checks a tag; `None` if its words are unknown.
    fn check(
        &mut self,
        tag: &Tag,
        subframe: Subframe,
        bits: u8,
        key: &[u8],
        is_in_order: bool,
        now_ms: u64,
    ) -> Option<Worked> {
        // A tag with COP 0 is a dummy.
        if tag.cop == 0 {
            return None;
        }
        let Self { satellites, former, tally, alarm, .. } = self;
        let about = subframe.back(1).short();
        let former = former.of(tag.subject, about);
        let found = satellites.iter_mut().find(|satellite| satellite.number == tag.subject);
        let chosen = found.and_then(|satellite| {
            let chosen = satellite.words.choose(former, tag.about(), about, tag.cop)?;
            Some((satellite, chosen))
        });
        let Some((satellite, chosen)) = chosen else {
            count(&mut tally.osnma_tags_unread);
            return None;
        };
        let is_right = tag.is_right(bits, key, subframe, (&satellite.words, former, &chosen));
        count(match (tag.adkd, is_right) {
            (4, true) => &mut tally.osnma_times_right,
            (4, false) => &mut tally.osnma_times_wrong,
            (12, true) => &mut tally.osnma_slow_right,
            (12, false) => &mut tally.osnma_slow_wrong,
            (_, true) => &mut tally.osnma_orbits_right,
            (_, false) => &mut tally.osnma_orbits_wrong,
        });
        let finding = Finding {
            is_right,
            is_sure: chosen.is_complete && is_in_order,
            is_slow: tag.adkd == 12,
            is_of_present: chosen.is_present(),
        };
        if tag.adkd != 4 && satellite.receive(finding, alarm, now_ms) {
            return Some(Worked::Judged(satellite.number, satellite.seal()));
        }
        Some(Worked::Something)
    }
}
