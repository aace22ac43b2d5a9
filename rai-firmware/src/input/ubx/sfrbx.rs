//! RXM-SFRBX: navigation bits as u-blox receivers send them.
//!
//! | offset | type | field |
//! |---|---|---|
//! | 0 to 3 | u8 | system, satellite, signal, GLONASS channel + 7 |
//! | 4 | u8 | number of words |
//! | 6 | u8 | version, 1 or 2 |
//! | 8 | u32 each | words |
//!
//! | signal | words | message |
//! |---|---|---|
//! | GPS, QZSS L1 C/A (0) | 10 | LNAV |
//! | Galileo E1 (0, 1), E5b (5, 6) | 8 or 9 | I/NAV |
//! | Galileo E5a (3, 4) | 8 or 9 | F/NAV |
//! | `BeiDou` B1I, B2I, B3I (0 to 4, 10) | 10 | D2 of geostationary satellites, D1 of all others |
//! | GPS L2C (3, 4), L5 (6, 7); QZSS L2C (4, 5), L5 (8, 9) | 10 | CNAV, in builds with `cnav` |
//! | GLONASS L1, L2 (0, 2) | 4, of which the last identifies the frame | GLONASS strings |
//!
//! The receiver sends the words in the normal order of [`crate::input::navigation`]. For LNAV it
//! complements all 32 bits of a word whose `D30*` is 1.
//!
//! All other messages (`BeiDou`'s newer messages, SBAS) only increment a counter.
//!
//! Reference: [UBX-F9] RXM-SFRBX.
//!
//! [UBX-F9]: crate#references

use super::rawx;
use crate::input::calendar::Calendar;
use crate::input::navigation::{Kind, Navigation, Refusal, Transmission, beidou_kind};
use crate::input::system::System;
use crate::input::{Message, Unread};

/// Reads one frame's payload. The result is `None` if it is one part of a message whose other parts
/// have not all come.
pub(super) fn read<'a>(
    payload: &[u8],
    navigation: &mut Navigation,
    now_ms: u64,
    calendar: &Calendar,
) -> Result<Option<Message<'a>>, Unread> {
    const VERSIONS: core::ops::RangeInclusive<u8> = 1..=2;
    let (header, bytes) = payload.split_first_chunk::<8>().ok_or(Refusal::Malformed)?;
    let &[system, number, signal, _, many, _, version, _] = header;
    if !VERSIONS.contains(&version) || bytes.len() != 4 * usize::from(many) {
        return Err(Refusal::Malformed.into());
    }
    let system = rawx::system_of(system).ok_or(Unread::BitsOther)?;
    let satellite = system.satellite(number).ok_or(Unread::Satellite)?;
    let kind = match (system, signal, many) {
        // A frame of L1S has another length under the same number.
        (System::Gps, 0, _) | (System::Qzss, 0, 10) => Kind::Lnav,
        #[cfg(feature = "cnav")]
        (System::Gps, 3 | 4 | 6 | 7, 10) | (System::Qzss, 4 | 5 | 8 | 9, 10) => Kind::Cnav,
        (System::Galileo, 0 | 1 | 5 | 6, _) => Kind::Inav,
        (System::Galileo, 3 | 4, _) => Kind::Fnav,
        // Frames of newer signals have other lengths under the same numbers.
        (System::Beidou, 0..=4 | 10, 10) => beidou_kind(satellite),
        #[cfg(feature = "glonass")]
        (System::Glonass, 0 | 2, 4) => Kind::Glonass,
        _ => return Err(Unread::BitsOther),
    };
    let mut words = [0; Kind::WORDS];
    let mut count = 0;
    for (word, bytes) in words.iter_mut().zip(bytes.as_chunks::<4>().0) {
        *word = u32::from_le_bytes(*bytes);
        count += 1;
    }
    let words = words.get(..count).unwrap_or_default();
    let transmission = Transmission {
        satellite,
        kind,
        words,
        #[cfg(feature = "osnma")]
        is_e1: signal < 2,
    };
    navigation.read(&transmission, now_ms, calendar)
}
