//! LNAV of GPS and QZSS: subframes of ten words of 30 bits. Subframes 1 to 3 are the ephemeris;
//! page 18 of the fourth has the ionosphere and UTC.
//!
//! A page is a subframe without parities: 240 bits. The fields have these offsets:
//!
//! | subframe | fields |
//! |---|---|
//! | all | preamble 0 (8), TOW of the next 24 (17), alert 41 (1), number 43 (3) |
//! | 1 | week 48, URA 60, health 64, IODC 70 and 168, TGD 160, toc 176, af2 192, af1 200, af0 216 |
//! | 2 | IODE 48, Crs 56, Δn 72, M0 88, Cuc 120, e 136, Cus 168, √A 184, toe 216 |
//! | 3 | Cic 48, Ω0 64, Cis 96, i0 112, Crc 144, ω 160, Ω̇ 192, IODE 216, i̇ 224 |
//! | 4, page 56 | α 56, β 88, `Δt_LS` 192, week and day of the next 200, 208, `Δt_LSF` 216 |
//!
//! References: [IS-GPS-200] 20.3.2 to 20.3.5; [IS-QZSS-PNT] 4.1.
//!
//! [IS-GPS-200]: crate#references
//! [IS-QZSS-PNT]: crate#references

use raim_core::satellite::{Constellation, SatelliteId};

use super::Refusal;
use super::leap::Announcement;
use super::message::{NavigationMessage, Reader};
use super::parity::is_lnav_word;
use crate::ephemeris::{Broadcast, Health, Source, ura_m};
use crate::input::bits::{Bits, Packed};
use crate::input::calendar::Calendar;
use crate::input::calendar::MessageWeek;
use crate::input::elements::{GPS, Head, Layout, on};
use crate::input::{Message, Unread};

/// First eight bits of every subframe.
const PREAMBLE: u32 = 0x8B;

/// Alert flag of every subframe, by which a satellite withdraws its URA ([IS-GPS-200] 20.3.3.2).
///
/// [IS-GPS-200]: crate#references
const ALERT: usize = 41;

/// Longest time between the first and the last subframe of one ephemeris, s: two frames and a
/// margin for gaps.
const SPAN_S: u32 = 90;

/// Identity of the page with ionosphere and UTC.
const IONOSPHERE_AND_UTC: u32 = 56;

const LAYOUT: Layout = Layout {
    form: &GPS,
    ellipse: [on(1, 184), on(1, 136)],
    angles: [on(1, 88), on(2, 64), on(2, 112), on(2, 160)],
    rates: [on(1, 72), on(2, 192), on(2, 224)],
    angle_corrections: [on(1, 120), on(1, 168), on(2, 48), on(2, 96)],
    length_corrections: [on(2, 144), on(1, 56)],
    clock: [on(0, 216), on(0, 200), on(0, 192)],
    group_delays: [Some(on(0, 160)), None],
};

/// LNAV.
pub(super) struct Lnav;

impl NavigationMessage for Lnav {
    const WORDS: usize = 10;
    const PAGE_BYTES: usize = 30;
    const PAGES: usize = 3;

    fn read<'a>(reader: &mut Reader<'_>) -> Result<Option<Message<'a>>, Unread> {
        let subframe = subframe(reader.words()?)?;
        match number(Bits(&subframe)) {
            number @ 1..=3 => reader.complete(number - 1, &subframe, 0, ephemeris),
            4 => Ok(ionosphere_and_utc(Bits(&subframe)).map(|(coefficients, leap)| {
                Message::Corrections(Some((Constellation::Gps, coefficients)), reader.leap_s(&leap))
            })),
            5 => Ok(None),
            _ => Err(Refusal::Malformed.into()),
        }
    }
}

/// Returns the subframe without parities.
fn subframe(words: &[u32; Lnav::WORDS]) -> Result<[u8; Lnav::PAGE_BYTES], Refusal> {
    let mut packed = Packed::new();
    for &word in words {
        if !is_lnav_word(word) {
            return Err(Refusal::Parity);
        }
        packed.push(word >> 6, 24);
    }
    if Bits(&packed.bytes).unsigned(0, 8) == PREAMBLE { Ok(packed.bytes) } else { Err(Refusal::Malformed) }
}

/// Returns the number of a subframe; valid ones have 1 to 5.
fn number(subframe: Bits<'_>) -> u32 {
    subframe.unsigned(43, 3)
}

/// Returns the ephemeris in subframes 1 to 3.
fn ephemeris(satellite: SatelliteId, pages: &[Bits<'_>], calendar: &Calendar) -> Result<Broadcast, Refusal> {
    let &[first, second, third] = pages else { return Err(Refusal::Malformed) };
    let issue = second.unsigned(48, 8);
    if third.unsigned(216, 8) != issue
        || first.unsigned(168, 8) != issue
        || !is_one_frame([first, second, third])
    {
        return Err(Refusal::Mixed);
    }
    let week = MessageWeek { constellation: satellite.constellation(), week: first.unsigned(48, 10) as u16 };
    let instant = |sixteens: u32| calendar.stated(week, 16 * sixteens).ok_or(Refusal::Value);
    let (source, health) = match (satellite.is_qzss(), first.small(64, 6)) {
        (true, field) => (Source::QzssLnav, Health::of_qzss(field)),
        (false, field) => (Source::GpsLnav, Health::of_satellite(field == 0)),
    };
    let head = Head {
        satellite,
        source,
        health,
        // Under an alert the error may exceed the URA, so that no accuracy is promised.
        accuracy_m: ura_m(first.small(60, 4)).filter(|_| !pages.iter().any(|page| page.is_set(ALERT))),
        toe: instant(second.unsigned(216, 16))?,
        toc: instant(first.unsigned(176, 16))?,
    };
    Ok(const { LAYOUT }.read(&head, pages))
}

/// Returns true if the subframes are of one time, because an issue number returns after some hours.
fn is_one_frame(subframes: [Bits<'_>; Lnav::PAGES]) -> bool {
    const WEEK: u32 = 604_800 / 6;
    let [first, second, third] = subframes.map(|subframe| subframe.unsigned(24, 17));
    let is_near = |a: u32, b: u32| {
        let distance = a.abs_diff(b);
        distance.min(WEEK.abs_diff(distance)) * 6 <= SPAN_S
    };
    is_near(first, second) && is_near(second, third)
}

/// Returns Klobuchar's coefficients and the leap seconds, if a fourth subframe is page 18 of the
/// GPS satellites.
///
/// The satellites of QZSS send a page of the same identity with coefficients for their own region.
fn ionosphere_and_utc(subframe: Bits<'_>) -> Option<([f64; 8], Announcement)> {
    const GPS: u32 = 1;
    let is_page = subframe.unsigned(48, 2) == GPS && subframe.unsigned(50, 6) == IONOSPHERE_AND_UTC;
    is_page.then(|| {
        let leap = Announcement {
            now_s: subframe.signed(192, 8),
            then_s: subframe.signed(216, 8),
            week: subframe.small(200, 8),
            day: subframe.small(208, 8),
        };
        (subframe.klobuchar(56), leap)
    })
}
