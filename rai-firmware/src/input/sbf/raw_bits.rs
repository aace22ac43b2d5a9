//! Navigation bits as Septentrio receivers send them.
//!
//! | offset | type | field |
//! |---|---|---|
//! | 14 | u8 | satellite ([`super::signals`]) |
//! | 15 | u8 | 0 if the receiver found a wrong parity or CRC |
//! | 17 | bits | 0 to 4: signal |
//! | 20 | u32 each | words, with the first bit in bit 31 |
//!
//! | block | words | bits | message |
//! |---|---|---|---|
//! | `GPSRawCA` 4017, `QZSRawL1CA` 4066 | 10 | 30 of each word, in its lower bits | LNAV |
//! | `GALRawFNAV` 4022 | 8 | 244 | F/NAV |
//! | `GALRawINAV` 4023 | 8 | 114 of the even part, without its tail, then 120 of the odd part | I/NAV |
//! | `GLORawCA` 4026 | 3 | 85 | GLONASS strings |
//! | `BDSRaw` 4047 | 10 | 300 | D2 of geostationary satellites, D1 of all others |
//! | `GPSRawL2C` 4018, `GPSRawL5` 4019, `QZSRawL2C` 4067, `QZSRawL5` 4068 | 10 | 300 | CNAV, in builds with `cnav` |
//! | `GEORawL1` 4020 | | | not read |
//!
//! F/NAV, CNAV and GLONASS strings are in the normal order of [`crate::input::navigation`]. The words of
//! LNAV have upright data and their parity `⊕ D30*`, but no bits of the word before. Bit 31 of
//! normal order is `D29* ⊕ D30*`, and the parity of both has the same inversion:
//!
//! ```text
//! bit 31 of a word = bit 1 ⊕ bit 0 of the word before; 0 in the first word, because the last one ends in zeros
//! ```
//!
//! The parities and CRCs are checked again, because the line may flip a bit.
//!
//! Reference: [SBF] 4.2.2.
//!
//! [SBF]: crate#references

use super::block::Block;
use super::signals;
use crate::input::bits::{Bits, Packed};
use crate::input::calendar::Calendar;
use crate::input::navigation::{Kind, Navigation, Refusal, Transmission, beidou_kind};
use crate::input::system::System;
use crate::input::{Message, Unread};

/// Offset of the words.
const WORDS: usize = 20;

/// Bytes of the longest page: ten words.
const PAGE: usize = 40;

/// Reads the block with one of these numbers. The result is `None` if it is one part of a message
/// whose other parts have not all come.
pub(super) fn read<'a>(
    number: u16,
    block: &Block<'_>,
    navigation: &mut Navigation,
    now_ms: u64,
    calendar: &Calendar,
) -> Result<Option<Message<'a>>, Unread> {
    let (system, kind, count) = match number {
        4017 => (System::Gps, Kind::Lnav, 10),
        4066 => (System::Qzss, Kind::Lnav, 10),
        4022 => (System::Galileo, Kind::Fnav, 8),
        4023 => (System::Galileo, Kind::Inav, 8),
        4047 => (System::Beidou, Kind::D1, 10),
        #[cfg(feature = "cnav")]
        4018 | 4019 => (System::Gps, Kind::Cnav, 10),
        #[cfg(feature = "cnav")]
        4067 | 4068 => (System::Qzss, Kind::Cnav, 10),
        #[cfg(feature = "glonass")]
        4026 => (System::Glonass, Kind::Glonass, 3),
        _ => return Err(Unread::BitsOther),
    };
    block.at_least(WORDS + 4 * count)?;
    block.time()?;
    // E5a, E5b and both together; the newer signals of BeiDou have blocks of their own.
    match (number, block.u8(17) & 31) {
        (4022, 20 | 22) | (4023, 17 | 21 | 22) | (4047, 28..=30) | (4017 | 4026 | 4066, _) => {}
        #[cfg(feature = "cnav")]
        (4018, 3) | (4019, 4) | (4067, 7) | (4068, 26) => {}
        _ => return Err(Unread::BitsOther),
    }
    let satellite = match signals::numbered(block.u8(14)) {
        Some((its, number)) if its == system => system.satellite(number).ok_or(Unread::Satellite)?,
        _ => return Err(Unread::Satellite),
    };
    if block.u8(15) == 0 {
        return Err(Refusal::Parity.into());
    }
    let mut words = [0; Kind::WORDS];
    for (word, offset) in words.iter_mut().zip((WORDS..).step_by(4)).take(count) {
        *word = block.u32(offset);
    }
    match kind {
        Kind::Lnav => link(&mut words),
        // The tail of the even part, and the unused bits before the odd one.
        Kind::Inav => words = arranged(&words, &[(0, 114, 14), (114, 120, 8)]),
        Kind::D1 => words = arranged_by_thirty(&words),
        _ => {}
    }
    let kind = if kind == Kind::D1 { beidou_kind(satellite) } else { kind };
    let words = words.get(..count).unwrap_or_default();
    let transmission = Transmission {
        satellite,
        kind,
        words,
        #[cfg(feature = "osnma")]
        is_e1: block.u8(17) & 31 == 17,
    };
    navigation.read(&transmission, now_ms, calendar)
}

/// Adds to each word of LNAV what its parity covers of the word before.
fn link(words: &mut [u32]) {
    let mut before = 0_u32;
    for word in words {
        let upright = *word & 0x3FFF_FFFF;
        *word = upright | (before ^ before >> 1) << 31;
        before = upright;
    }
}

/// Returns the words with zeros behind each part: its first bit, its length, and the number of
/// zeros.
fn arranged<const N: usize>(words: &[u32; N], parts: &[(usize, usize, usize)]) -> [u32; N] {
    let page = packed(words);
    let mut arranged = Packed::<PAGE>::new();
    for &(start, length, zeros) in parts {
        let mut done = 0;
        while done < length {
            let width = (length - done).min(32);
            arranged.push(Bits(&page).unsigned(start + done, width), width);
            done += width;
        }
        arranged.push(0, zeros);
    }
    let mut words = [0; N];
    for (word, bytes) in words.iter_mut().zip(arranged.bytes.as_chunks::<4>().0) {
        *word = u32::from_be_bytes(*bytes);
    }
    words
}

/// Returns 300 bits as ten words of thirty.
fn arranged_by_thirty<const N: usize>(words: &[u32; N]) -> [u32; N] {
    let page = packed(words);
    let mut arranged = [0; N];
    for (word, start) in arranged.iter_mut().zip((0..300).step_by(30)) {
        *word = Bits(&page).unsigned(start, 30);
    }
    arranged
}

/// Returns the bits of words, one word behind the other.
fn packed(words: &[u32]) -> [u8; PAGE] {
    let mut page = [0; PAGE];
    for (bytes, word) in page.as_chunks_mut::<4>().0.iter_mut().zip(words) {
        *bytes = word.to_be_bytes();
    }
    page
}
