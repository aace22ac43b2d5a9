//! What tags say of the words of a satellite.
//!
//! | verdict | when |
//! |---|---|
//! | `Proved` | a tag of the present words is right |
//! | `False` | a tag is wrong although all words that it is about came in their subframe, and none has been right |
//! | `Unproved` | else |
//!
//! Words that were proved stay so: a wrong tag is then no evidence against them. A satellite whose
//! words were false stays out until words of it are proved, also if it sends others.
//!
//! **Alarm**: false words of two satellites, or keys of two satellites that do not follow from the
//! chain, within [`TOGETHER_MS`].

use core::num::NonZeroU8;

use heapless::Vec;

use super::gst::Subframe;
use super::pages::Clock;
use super::words::{FormerWords, Words};

/// Longest time between two satellites' false words that are an alarm, ms. The alarm lasts as long.
const TOGETHER_MS: u64 = 300_000;

/// Time after which a satellite that sends no page is out of view, ms.
const OUT_OF_VIEW_MS: u64 = 120_000;

/// Time after which a proof is too old, in units of 1.024 s: 4 h.
const OLD: u32 = 14_062;

/// What is known of the words of a satellite.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing.
    #[default]
    Unproved,
    /// The system made them.
    Proved,
    /// The system made them, also by a tag with a later key.
    ProvedLater,
    /// The system made others.
    False,
}

/// Tags that are proof, which depends on how well the time is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proof {
    /// None.
    None,
    /// Those with a later key.
    Slow,
    /// All.
    All,
}

/// Verdict on one version of a satellite's words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Seal {
    /// Number of the version, from 1 to 255 in turn; `None` if not all words are known.
    pub version: Option<NonZeroU8>,
    /// Verdict.
    pub verdict: Verdict,
}

impl Verdict {
    /// Returns true if the system made the words.
    pub const fn is_proved(self) -> bool {
        matches!(self, Self::Proved | Self::ProvedLater)
    }
}

impl Seal {
    /// No verdict.
    pub const NONE: Self = Self { version: None, verdict: Verdict::Unproved };

    /// Returns true if the words are proved by tags that are proof.
    pub(crate) fn is_proved(self, proof: Proof) -> bool {
        match proof {
            Proof::None => false,
            Proof::Slow => self.verdict == Verdict::ProvedLater,
            Proof::All => self.verdict.is_proved(),
        }
    }
}

/// What a tag says.
#[allow(clippy::struct_excessive_bools, reason = "they are independent of each other")]
#[derive(Clone, Copy, Debug)]
pub(super) struct Finding {
    pub(super) is_right: bool,
    /// True if a wrong tag is evidence.
    pub(super) is_sure: bool,
    /// True if the tag has a later key.
    pub(super) is_slow: bool,
    /// True if it is about the present words, not about former ones.
    pub(super) is_of_present: bool,
}

/// Satellite that sends pages.
#[derive(Clone, Copy, Debug)]
pub(super) struct Satellite {
    pub(super) number: u8,
    /// Number of the version of its words.
    version: NonZeroU8,
    verdict: Verdict,
    /// True if a tag with the next key has proved the present words.
    is_proved_at_once: bool,
    heard: Subframe,
    /// Arrival of its last page, and time of the last proof, in units of 1.024 s.
    heard_at: u32,
    proved_at: u32,
    clock: Clock,
    pub(super) words: Words,
}

/// Returns a time in units of 1.024 s.
pub(super) const fn units(ms: u64) -> u32 {
    (ms >> 10) as u32
}

impl Satellite {
    const fn new(number: u8) -> Self {
        Self {
            number,
            version: NonZeroU8::MIN,
            verdict: Verdict::Unproved,
            is_proved_at_once: false,
            heard: Subframe(0),
            heard_at: 0,
            proved_at: 0,
            clock: Clock::UNSET,
            words: Words::NONE,
        }
    }

    /// Returns the place of a satellite. If there is none, one that is out of view gives way.
    pub(super) fn place<const S: usize>(
        all: &mut Vec<Self, S>,
        number: u8,
        now_ms: u64,
    ) -> Option<&mut Self> {
        if !(1..=36).contains(&number) {
            return None;
        }
        let known = all.iter().position(|satellite| satellite.number == number);
        if known.is_none() {
            if all.is_full() {
                let gone = all.iter().position(|satellite| !satellite.is_in_view(now_ms))?;
                super::take(all, gone);
            }
            all.push(Self::new(number)).ok()?;
        }
        let index = known.unwrap_or(all.len() - 1);
        let satellite = all.get_mut(index)?;
        satellite.heard_at = units(now_ms);
        Some(satellite)
    }

    /// Takes a word; returns the time at which its page began, s, or `None` if it is not sure.
    pub(super) fn take<const R: usize>(
        &mut self,
        word: &[u8; 16],
        is_e1: bool,
        came_ms: u64,
        former: &mut FormerWords<R>,
    ) -> Option<u32> {
        /// Distance of subframes beyond which their numbers modulo 256 mean nothing.
        const FAR: u32 = 60;
        let begin_s = self.clock.of(word, is_e1, came_ms);
        let subframe = begin_s.map(Subframe::of);
        if let Some(subframe) = subframe.filter(|subframe| *subframe != self.heard) {
            if subframe.0.abs_diff(self.heard.0) > FAR {
                self.words = Words::NONE;
                former.forget(self.number);
                self.change();
            }
            self.words.age(subframe);
            self.heard = subframe;
        }
        if self.words.take(self.number, word, subframe, former) {
            self.change();
        }
        begin_s
    }

    /// Begins another version of the words.
    fn change(&mut self) {
        self.version = self.version.checked_add(1).unwrap_or(NonZeroU8::MIN);
        self.is_proved_at_once = false;
        if self.verdict.is_proved() {
            self.verdict = Verdict::Unproved;
        }
    }

    /// Takes what a tag says; returns true if the verdict is another.
    ///
    /// A right tag of former words says nothing about the present ones, but a wrong one does: a
    /// satellite that sends other false words in each subframe would never be found out else.
    pub(super) fn receive(&mut self, finding: Finding, alarm: &mut Alarm, now_ms: u64) -> bool {
        if finding.is_right && !finding.is_of_present {
            return false;
        }
        let verdict = match (self.verdict, finding.is_right) {
            (Verdict::ProvedLater, true) => Verdict::ProvedLater,
            (_, true) if finding.is_slow => Verdict::ProvedLater,
            (_, true) => Verdict::Proved,
            (Verdict::Unproved, false) if finding.is_sure => Verdict::False,
            (verdict, false) => verdict,
        };
        if finding.is_right {
            self.proved_at = units(now_ms);
            self.is_proved_at_once |= !finding.is_slow;
        }
        let is_other = core::mem::replace(&mut self.verdict, verdict) != verdict;
        if is_other && verdict == Verdict::False {
            alarm.hear_false(self.number, now_ms);
        }
        is_other
    }

    /// Returns the verdict on the present words.
    pub(super) fn seal(&self) -> Seal {
        Seal { version: self.words.has_orbit().then_some(self.version), verdict: self.verdict }
    }

    pub(super) fn forget_verdict(&mut self) {
        self.verdict = Verdict::Unproved;
        self.is_proved_at_once = false;
    }

    /// Returns true if proved words may decide between systems: not by tags with a later key alone.
    pub(super) const fn is_witness(&self) -> bool {
        self.is_proved_at_once
    }

    pub(super) fn is_in_view(&self, now_ms: u64) -> bool {
        u64::from(units(now_ms).wrapping_sub(self.heard_at)) << 10 <= OUT_OF_VIEW_MS
    }

    /// Returns the age of the last proof of the present words, s; `None` if they are not proved, or
    /// no longer.
    pub(super) fn proof_age_s(&self, now_ms: u64) -> Option<u32> {
        let age = units(now_ms).wrapping_sub(self.proved_at);
        (self.verdict.is_proved() && age < OLD).then(|| age * 128 / 125)
    }

    pub(super) fn is_false(&self) -> bool {
        self.verdict == Verdict::False
    }
}

/// Signs of forged messages of more than one satellite.
#[derive(Clone, Copy, Debug)]
pub(super) struct Alarm {
    /// Last satellite with false words, and with a wrong key, and when.
    false_words: Option<(u8, u64)>,
    wrong_key: Option<(u8, u64)>,
    raised_ms: Option<u64>,
}

impl Alarm {
    pub(super) const NONE: Self = Self { false_words: None, wrong_key: None, raised_ms: None };

    pub(super) fn hear_false(&mut self, satellite: u8, now_ms: u64) {
        receive(&mut self.false_words, &mut self.raised_ms, satellite, now_ms);
    }

    pub(super) fn hear_wrong_key(&mut self, satellite: u8, now_ms: u64) {
        receive(&mut self.wrong_key, &mut self.raised_ms, satellite, now_ms);
    }

    /// Returns true while the alarm lasts.
    pub(super) fn is_raised(&self, now_ms: u64) -> bool {
        self.raised_ms.is_some_and(|raised_ms| now_ms.abs_diff(raised_ms) <= TOGETHER_MS)
    }
}

fn receive(last: &mut Option<(u8, u64)>, raised_ms: &mut Option<u64>, satellite: u8, now_ms: u64) {
    if last.is_some_and(|(other, ms)| other != satellite && now_ms.abs_diff(ms) <= TOGETHER_MS) {
        *raised_ms = Some(now_ms);
    }
    *last = Some((satellite, now_ms));
}
