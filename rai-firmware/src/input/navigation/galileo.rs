//! Galileo I/NAV and F/NAV: pages with a CRC.
//!
//! I/NAV comes as an even and an odd part, which make a word of 128 bits. Words 1 to 4 are the
//! ephemeris and state its issue. Word 5 has health, group delays and week, but no issue. E1 sends
//! the words in the order 2, 4, 1, 3, 5 in each 30 s, E5b in the order 1, 3, 5, 2, 4. A set is read
//! as soon as all five have come in any order, from either signal, with one issue in words 1 to 4.
//! These words stay, so that each later word 5 gives the set again with the present health. F/NAV
//! has the same content in four pages, each with its issue.
//!
//! | I/NAV word | fields |
//! |---|---|
//! | 1 | `IODnav` 6, toe 16, M0 30, e 62, √A 94 |
//! | 2 | `IODnav` 6, Ω0 16, i0 48, ω 80, i̇ 112 |
//! | 3 | `IODnav` 6, Ω̇ 16, Δn 40, Cuc 56, Cus 72, Crc 88, Crs 104, SISA 120 |
//! | 4 | `IODnav` 6, satellite 16, Cic 22, Cis 38, toc 54, af0 68, af1 99, af2 120 |
//! | 5 | BGD E1/E5a 47, E1/E5b 57, health 67 and 69, validity 71 and 72, week 73, TOW 85 |
//! | 6 | `Δt_LS` 62, week and day of the next 86, 94, `Δt_LSF` 97 |
//!
//! References: [OS-SIS-ICD] 4.2, 4.3, 5.1.
//!
//! [OS-SIS-ICD]: crate#references

use raim_core::satellite::SatelliteId;

use super::Refusal;
#[cfg(feature = "osnma")]
use super::Transmission;
use super::leap::Announcement;
use super::message::{NavigationMessage, Reader};
use crate::ephemeris::{Broadcast, Health, Source, galileo_sisa_m};
use crate::input::bits::{Bits, Packed};
use crate::input::calendar::Calendar;
use crate::input::calendar::MessageWeek;
use crate::input::crc24q::crc24q;
use crate::input::elements::{GALILEO, Head, Layout, on};
use crate::input::{Message, Unread};
use crate::raw::Band;

const INAV: Layout = Layout {
    form: &GALILEO,
    ellipse: [on(0, 94), on(0, 62)],
    angles: [on(0, 30), on(1, 16), on(1, 48), on(1, 80)],
    rates: [on(2, 40), on(2, 16), on(1, 112)],
    angle_corrections: [on(2, 56), on(2, 72), on(3, 22), on(3, 38)],
    length_corrections: [on(2, 88), on(2, 104)],
    clock: [on(3, 68), on(3, 99), on(3, 120)],
    group_delays: [Some(on(4, 47)), Some(on(4, 57))],
};

const FNAV: Layout = Layout {
    form: &GALILEO,
    ellipse: [on(1, 104), on(1, 72)],
    angles: [on(1, 16), on(1, 136), on(2, 16), on(2, 48)],
    rates: [on(2, 80), on(1, 48), on(1, 168)],
    angle_corrections: [on(2, 96), on(2, 112), on(3, 16), on(3, 32)],
    length_corrections: [on(2, 128), on(2, 144)],
    clock: [on(0, 36), on(0, 67), on(0, 88)],
    group_delays: [Some(on(0, 143)), None],
};

/// I/NAV.
pub(super) struct Inav;

impl NavigationMessage for Inav {
    const WORDS: usize = 8;
    const PAGE_BYTES: usize = 16;
    const PAGES: usize = 5;

    fn read<'a>(reader: &mut Reader<'_>) -> Result<Option<Message<'a>>, Unread> {
        /// Words 1 to 4.
        const WITH_ISSUE: u16 = 0b1111;
        let word = inav_word(reader.words()?)?;
        #[cfg(feature = "osnma")]
        {
            let bits = authentication_bits(reader.words()?);
            let &Transmission { satellite, is_e1, .. } = reader.transmission;
            // Before the set is read, so that its verdict is that of these words.
            reader.authentication.receive(satellite.number(), &word, bits, is_e1, reader.now_ms);
        }
        match kind(Bits(&word)) {
            kind @ 1..=5 => reader.complete(kind - 1, &word, WITH_ISSUE, inav_ephemeris),
            6 => Ok(Some(Message::Corrections(None, reader.leap_s(&utc(Bits(&word)))))),
            _ => Ok(None),
        }
    }
}

/// F/NAV. A page is stored up to its time, which ends at bit 192.
pub(super) struct Fnav;

impl NavigationMessage for Fnav {
    const WORDS: usize = 8;
    const PAGE_BYTES: usize = 24;
    const PAGES: usize = 4;

    fn read<'a>(reader: &mut Reader<'_>) -> Result<Option<Message<'a>>, Unread> {
        let page = fnav_page(reader.words()?)?;
        match kind(Bits(&page)) {
            kind @ 1..=4 => reader.complete(kind - 1, &page, 0, fnav_ephemeris),
            _ => Ok(None),
        }
    }
}

/// Returns the word of an I/NAV page.
fn inav_word(words: &[u32; Inav::WORDS]) -> Result<[u8; Inav::PAGE_BYTES], Refusal> {
    let page = bytes_of(words);
    let page = Bits(&page);
    // Both parts must be of a nominal page, the first even and the second odd. An alert page has
    // its bits set.
    if page.unsigned(0, 2) != 0b00 || page.unsigned(128, 2) != 0b10 {
        return Err(Refusal::Malformed);
    }
    // Four zeros precede the 114 and 82 bits, so that these fill whole bytes.
    let mut covered = Packed::<25>::new();
    covered.push(0, 4);
    append(&mut covered, page, 0, 114);
    append(&mut covered, page, 128, 82);
    if crc24q(&covered.bytes) != page.unsigned(210, 24) {
        return Err(Refusal::Parity);
    }
    let mut word = Packed::new();
    append(&mut word, page, 2, 112);
    append(&mut word, page, 130, 16);
    Ok(word.bytes)
}

/// Returns the forty bits for authentication of an I/NAV page. E5b has others there.
#[cfg(feature = "osnma")]
fn authentication_bits(words: &[u32; Inav::WORDS]) -> [u8; 5] {
    let mut bits = Packed::new();
    append(&mut bits, Bits(&bytes_of(words)), 146, 40);
    bits.bytes
}

/// Returns the front of an F/NAV page of 238 bits and a tail.
fn fnav_page(words: &[u32; Fnav::WORDS]) -> Result<[u8; Fnav::PAGE_BYTES], Refusal> {
    let page = bytes_of(words);
    let bits = Bits(&page);
    let mut covered = Packed::<27>::new();
    covered.push(0, 2);
    append(&mut covered, bits, 0, 214);
    if crc24q(&covered.bytes) != bits.unsigned(214, 24) {
        return Err(Refusal::Parity);
    }
    page.first_chunk().copied().ok_or(Refusal::Malformed)
}

fn bytes_of(words: &[u32; 8]) -> [u8; 32] {
    let mut packed = Packed::new();
    for &word in words {
        packed.push(word, 32);
    }
    packed.bytes
}

/// Appends `count` bits from `start` on.
fn append<const BYTES: usize>(packed: &mut Packed<BYTES>, from: Bits<'_>, start: usize, count: usize) {
    let mut done = 0;
    while done < count {
        let width = (count - done).min(32);
        packed.push(from.unsigned(start + done, width), width);
        done += width;
    }
}

/// Returns the type of a word or a page: its first six bits.
fn kind(page: Bits<'_>) -> u32 {
    page.unsigned(0, 6)
}

/// Returns the ephemeris in words 1 to 5.
fn inav_ephemeris(
    satellite: SatelliteId,
    pages: &[Bits<'_>],
    calendar: &Calendar,
) -> Result<Broadcast, Refusal> {
    let &[first, second, third, fourth, fifth] = pages else { return Err(Refusal::Malformed) };
    let issue = first.unsigned(6, 10);
    if [second, third, fourth].iter().any(|word| word.unsigned(6, 10) != issue) {
        return Err(Refusal::Mixed);
    }
    if fourth.small(16, 6) != satellite.number() {
        return Err(Refusal::Value);
    }
    let week = MessageWeek { constellation: satellite.constellation(), week: fifth.unsigned(73, 12) as u16 };
    let instant = |minutes: u32| calendar.stated(week, 60 * minutes).ok_or(Refusal::Value);
    let head = Head {
        satellite,
        source: Source::GalileoInav,
        health: Health::UNKNOWN
            .with_galileo(Band::E5b, fifth.unsigned(67, 2), fifth.is_set(71))
            .with_galileo(Band::E1, fifth.unsigned(69, 2), fifth.is_set(72)),
        accuracy_m: galileo_sisa_m(third.small(120, 8)),
        toe: instant(first.unsigned(16, 14))?,
        toc: instant(fourth.unsigned(54, 14))?,
    };
    Ok(const { INAV }.read(&head, pages))
}

/// Returns the leap seconds in word 6.
fn utc(word: Bits<'_>) -> Announcement {
    Announcement {
        now_s: word.signed(62, 8),
        then_s: word.signed(97, 8),
        week: word.small(86, 8),
        day: word.small(94, 3),
    }
}

/// Returns the ephemeris in pages 1 to 4 of F/NAV.
fn fnav_ephemeris(
    satellite: SatelliteId,
    pages: &[Bits<'_>],
    calendar: &Calendar,
) -> Result<Broadcast, Refusal> {
    let &[first, second, third, fourth] = pages else { return Err(Refusal::Malformed) };
    let issue = first.unsigned(12, 10);
    if [second, third, fourth].iter().any(|page| page.unsigned(6, 10) != issue) {
        return Err(Refusal::Mixed);
    }
    if first.small(6, 6) != satellite.number() {
        return Err(Refusal::Value);
    }
    let week = MessageWeek { constellation: satellite.constellation(), week: first.unsigned(155, 12) as u16 };
    let instant = |minutes: u32| calendar.stated(week, 60 * minutes).ok_or(Refusal::Value);
    let head = Head {
        satellite,
        source: Source::GalileoFnav,
        health: Health::UNKNOWN.with_galileo(Band::E5a, first.unsigned(153, 2), first.is_set(187)),
        accuracy_m: galileo_sisa_m(first.small(94, 8)),
        toe: instant(third.unsigned(160, 14))?,
        toc: instant(first.unsigned(22, 14))?,
    };
    Ok(const { FNAV }.read(&head, pages))
}
