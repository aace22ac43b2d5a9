//! `BeiDou` D1 and D2: subframes of ten words of 30 bits, on B1I, B2I and B3I.
//!
//! A page is a subframe without parities: 26 bits of the first word, then 22 bits of each other
//! word. Fields that the parities split are thus joined. D1 spreads the ephemeris over subframes 1
//! to 3. D2 (of the geostationary satellites) spreads it over ten pages of subframe 1, of which
//! five words are used. Neither states the issue of a subframe. The second of the week shows which
//! subframes are of one set, because they follow each other without a gap.
//!
//! | | fields |
//! |---|---|
//! | all | subframe 15 (3), SOW 18 (20) |
//! | D1, 1 | health 38, URAI 44, week 48, toc 61, TGD1 78, TGD2 88, α 98, β 130, a2 162, a0 173, a1 197 |
//! | D1, 2 | Δn 38, Cuc 54, M0 72, e 104, Cus 136, Crc 154, Crs 172, √A 190, toe's upper 222 |
//! | D1, 3 | toe's lower 38, i0 53, Cic 85, Ω̇ 103, Cis 127, i̇ 145, Ω0 159, ω 191 |
//! | D2, 2 | α 42, β 74 |
//! | D2, 1, 3, 4 | page 38; health 42, URAI 48, week 52, toc 65, TGD1 82, TGD2 92; a0 80, a1 104 and 42, a2 60, Δn 76, Cuc 92 |
//! | D2, 5, 6 | Cuc 42, M0 46, Cus 78, e 96 and 42, √A 64, Cic 96 |
//! | D2, 7, 8 | Cic 42, Cis 50, toe 68, i0 85 and 42, Crc 53, Crs 71, Ω̇ 89 |
//! | D2, 9, 10 | Ω̇ 42, Ω0 47, ω 79 and 42, i̇ 47 |
//!
//! The coefficients of the ionosphere are for another model than those of GPS
//! ([`crate::correction::Klobuchar`]).
//!
//! References: [BDS-SIS-B1I] 5.2, 5.3; [BDS-SIS-B3I] 5.
//!
//! [BDS-SIS-B1I]: crate#references
//! [BDS-SIS-B3I]: crate#references

use raim_core::satellite::{Constellation, SatelliteId};

use super::message::{NavigationMessage, Reader};
use super::parity::is_beidou_word;
use super::{Kind, Refusal};
use crate::ephemeris::{Broadcast, Health, Source, ura_m};
use crate::input::bits::{Bits, Packed};
use crate::input::calendar::Calendar;
use crate::input::calendar::MessageWeek;
use crate::input::elements::{BEIDOU, Head, Layout, on};
use crate::input::{Message, Unread};
use crate::time::GpsTime;

/// First eleven bits of every subframe.
const PREAMBLE: u32 = 0b111_0001_0010;

/// Step of the reference times, s.
const REFERENCE_STEP_S: u32 = 8;

const D1_LAYOUT: Layout = Layout {
    form: &BEIDOU,
    ellipse: [on(1, 190), on(1, 104)],
    angles: [on(1, 72), on(2, 159), on(2, 53), on(2, 191)],
    rates: [on(1, 38), on(2, 103), on(2, 145)],
    angle_corrections: [on(1, 54), on(1, 136), on(2, 85), on(2, 127)],
    length_corrections: [on(1, 154), on(1, 172)],
    clock: [on(0, 173), on(0, 197), on(0, 162)],
    group_delays: [Some(on(0, 78)), Some(on(0, 88))],
};

const D2_LAYOUT: Layout = Layout {
    form: &BEIDOU,
    ellipse: [on(5, 64), on(4, 96).behind(22)],
    angles: [on(4, 46), on(8, 47), on(6, 85).behind(11), on(8, 79).behind(5)],
    rates: [on(3, 76), on(7, 89).behind(5), on(9, 47)],
    angle_corrections: [on(3, 92).behind(4), on(4, 78), on(5, 96).behind(8), on(6, 50)],
    length_corrections: [on(7, 53), on(7, 71)],
    clock: [on(2, 80), on(2, 104).behind(18), on(3, 60)],
    group_delays: [Some(on(0, 82)), Some(on(0, 92))],
};

/// D1.
pub(super) struct D1;

impl NavigationMessage for D1 {
    const WORDS: usize = 10;
    const PAGE_BYTES: usize = 28;
    const PAGES: usize = 3;

    fn read<'a>(reader: &mut Reader<'_>) -> Result<Option<Message<'a>>, Unread> {
        let subframe = subframe(reader.words()?)?;
        let bits = Bits(&subframe);
        match number(bits) {
            number @ 1..=3 => {
                let ephemeris = reader.complete(number - 1, &subframe, 0, d1_ephemeris)?;
                Ok(ephemeris.or_else(|| (number == 1).then(|| ionosphere(bits, 98))))
            }
            4 | 5 => Ok(None),
            _ => Err(Refusal::Malformed.into()),
        }
    }
}

/// D2. Only the five words of a page that it uses are stored.
pub(super) struct D2;

impl NavigationMessage for D2 {
    const WORDS: usize = 10;
    const PAGE_BYTES: usize = 15;
    const PAGES: usize = 10;

    fn read<'a>(reader: &mut Reader<'_>) -> Result<Option<Message<'a>>, Unread> {
        let subframe = subframe(reader.words()?)?;
        let bits = Bits(&subframe);
        match (number(bits), page(bits)) {
            (1, page @ 1..=10) => {
                let ephemeris = reader.complete(page - 1, &subframe, 0, d2_ephemeris)?;
                Ok(ephemeris.or_else(|| (page == 2).then(|| ionosphere(bits, 42))))
            }
            (1..=5, _) => Ok(None),
            _ => Err(Refusal::Malformed.into()),
        }
    }
}

/// Returns the message that a satellite sends: D2 if it is geostationary, otherwise D1.
pub(in crate::input) fn kind_of(satellite: SatelliteId) -> Kind {
    if matches!(satellite.number(), 1..=5 | 59..=63) { Kind::D2 } else { Kind::D1 }
}

/// Returns the information in a subframe.
fn subframe(words: &[u32; D1::WORDS]) -> Result<[u8; D1::PAGE_BYTES], Refusal> {
    let mut packed = Packed::new();
    for (index, &word) in words.iter().enumerate() {
        let (is_first, word) = (index == 0, word & 0x3FFF_FFFF);
        if !is_beidou_word(word, is_first) {
            return Err(Refusal::Parity);
        }
        if is_first { packed.push(word >> 4, 26) } else { packed.push(word >> 8, 22) }
    }
    if Bits(&packed.bytes).unsigned(0, 11) == PREAMBLE { Ok(packed.bytes) } else { Err(Refusal::Malformed) }
}

/// Returns the number of a subframe, 1 to 5.
fn number(subframe: Bits<'_>) -> u32 {
    subframe.unsigned(15, 3)
}

/// Returns the page of a D2 subframe, 1 to 10.
fn page(subframe: Bits<'_>) -> u32 {
    subframe.unsigned(38, 4)
}

/// Returns the second of the week at which a subframe began.
fn second_of_week(subframe: Bits<'_>) -> u32 {
    subframe.unsigned(18, 20)
}

/// Returns true if each page began `step_s` after the one before, also across the end of the week.
fn follow_each_other(pages: &[Bits<'_>], step_s: u32) -> bool {
    const WEEK_S: u32 = 604_800;
    pages.iter().zip(pages.iter().skip(1)).all(|(&before, &after)| {
        let expected = second_of_week(before) + step_s;
        second_of_week(after) == if expected >= WEEK_S { expected - WEEK_S } else { expected }
    })
}

/// Returns the coefficients of the ionosphere from a bit on. If a page completes an ephemeris, only
/// the ephemeris is reported; the coefficients come again.
fn ionosphere<'a>(page: Bits<'_>, start: usize) -> Message<'a> {
    Message::Corrections(Some((Constellation::Beidou, page.klobuchar(start))), None)
}

/// Returns the ephemeris in subframes 1 to 3 of D1.
fn d1_ephemeris(
    satellite: SatelliteId,
    pages: &[Bits<'_>],
    calendar: &Calendar,
) -> Result<Broadcast, Refusal> {
    let &[first, second, third] = pages else { return Err(Refusal::Malformed) };
    let toe = second.unsigned(222, 2) << 15 | third.unsigned(38, 15);
    let toc = first.unsigned(61, 17);
    if !follow_each_other(pages, 6) || toe != toc {
        return Err(Refusal::Mixed);
    }
    let week = MessageWeek { constellation: satellite.constellation(), week: first.unsigned(48, 13) as u16 };
    let reference = calendar.stated(week, REFERENCE_STEP_S * toe).ok_or(Refusal::Value)?;
    let health = Health::of_satellite(!first.is_set(38));
    Ok(const { D1_LAYOUT }.read(&head(satellite, health, first.small(44, 4), reference), pages))
}

/// Returns the ephemeris in the ten pages of D2.
fn d2_ephemeris(
    satellite: SatelliteId,
    pages: &[Bits<'_>],
    calendar: &Calendar,
) -> Result<Broadcast, Refusal> {
    let &[first, _, _, _, _, _, seventh, ..] = pages else { return Err(Refusal::Malformed) };
    let (toe, toc) = (seventh.unsigned(68, 17), first.unsigned(65, 17));
    if !follow_each_other(pages, 3) || toe != toc {
        return Err(Refusal::Mixed);
    }
    let week = MessageWeek { constellation: satellite.constellation(), week: first.unsigned(52, 13) as u16 };
    let reference = calendar.stated(week, REFERENCE_STEP_S * toe).ok_or(Refusal::Value)?;
    let health = Health::of_satellite(!first.is_set(42));
    Ok(const { D2_LAYOUT }.read(&head(satellite, health, first.small(48, 4), reference), pages))
}

fn head(satellite: SatelliteId, health: Health, accuracy: u8, reference: GpsTime) -> Head {
    Head {
        satellite,
        source: Source::BeidouD1D2,
        health,
        accuracy_m: ura_m(accuracy),
        toe: reference,
        toc: reference,
    }
}
