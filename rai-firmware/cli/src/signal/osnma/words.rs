//! Navigation words that a signed sky sends.

use anyhow::{Context as _, Result};
use raim_firmware::time::GALILEO_WEEK_OFFSET;
use sha2::{Digest as _, Sha256};

use super::{Bits, SUBFRAME_S, WEEK};
use crate::signal::encode::ubx::inav_words;
use crate::signal::measurement::{Ephemeris, TimedEphemeris};

/// Source of words. Words that a tag is about must not change within a subframe.
pub trait Words: Send + Sync {
    /// Returns the word of a type, 1 to 63, on a page that begins at a second of Galileo system time.
    fn word(&self, satellite: u8, kind: u8, begin_s: u32) -> [u8; 16];
}

/// Words without a meaning, which change every twenty subframes.
pub struct Arbitrary {
    /// They follow from it.
    pub seed: u8,
}

impl Words for Arbitrary {
    fn word(&self, satellite: u8, kind: u8, begin_s: u32) -> [u8; 16] {
        let issue = begin_s / 600;
        let content = Sha256::digest([self.seed, satellite, kind, issue as u8]);
        let mut bits = Bits::default().put(kind.into(), 6);
        if (1..=4).contains(&kind) {
            bits = bits.put(u64::from(issue % 1024), 10);
        }
        bits = bits.put_all(&content);
        bits.0.truncate(128);
        let word = u128::from_be_bytes(bits.bytes().try_into().expect("16 bytes"));
        (if kind == 5 { timed(word, begin_s) } else { word }).to_be_bytes()
    }
}

/// Puts the time into word 5, behind its content of 73 bits.
fn timed(word: u128, begin_s: u32) -> u128 {
    let time = ((begin_s / (WEEK * SUBFRAME_S)) << 20) | (begin_s % (WEEK * SUBFRAME_S));
    word >> 55 << 55 | u128::from(time) << 23
}

/// Words of broadcast ephemerides, each from its time of broadcast on.
pub struct Sets(Vec<Set>);

struct Set {
    satellite: u8,
    sent_s: u32,
    /// Words 1 to 5.
    words: [[u8; 16]; 5],
}

impl Sets {
    /// Takes the sets of Galileo's I/NAV; others are left out.
    ///
    /// # Errors
    /// A number does not fit its word.
    pub fn new(ephemerides: &[TimedEphemeris]) -> Result<Self> {
        let mut sets = Vec::new();
        for ephemeris in ephemerides {
            let Ephemeris::GalileoInav(message) = &ephemeris.message else { continue };
            let week_ms = u64::from(GALILEO_WEEK_OFFSET) * u64::from(WEEK * SUBFRAME_S) * 1000;
            let words = inav_words(message).with_context(|| ephemeris.satellite.to_string())?;
            let sent_s = (ephemeris.sent.to_ms().saturating_sub(week_ms) / 1000) as u32;
            sets.push(Set { satellite: ephemeris.satellite.number(), sent_s, words });
        }
        sets.sort_by_key(|set| set.sent_s);
        Ok(Self(sets))
    }
}

impl Words for Sets {
    fn word(&self, satellite: u8, kind: u8, begin_s: u32) -> [u8; 16] {
        let begun_s = begin_s / SUBFRAME_S * SUBFRAME_S;
        let mut sent = self.0.iter().rev().filter(|set| set.satellite == satellite && set.sent_s <= begun_s);
        let word = match (kind, sent.next()) {
            (1..=5, Some(set)) => u128::from_be_bytes(set.words[usize::from(kind) - 1]),
            // Leap seconds, 18 before and after.
            (6, _) => u128::from(kind) << 122 | 18 << (128 - 70) | 18 << (128 - 105),
            _ => u128::from(kind) << 122,
        };
        (if kind == 5 { timed(word, begin_s) } else { word }).to_be_bytes()
    }
}
