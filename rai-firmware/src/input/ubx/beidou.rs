//! `BeiDou` D1 and D2: subframes of ten words of 30 bits, on B1I, B2I and B3I.
//!
//! A page here is the information in a subframe without parities, in which the fields that the parities split join:
//! 26 bits of the first word, then 22 of each other. D1 spreads the ephemeris over subframes 1 to 3, D2 (of the
//! geostationary satellites) over ten pages of subframe 1, of which five words are used. Neither says to which issue
//! a subframe belongs; its second of the week does, since they follow each other without a gap.
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
//! The coefficients of the ionosphere are of another model than those of GPS ([`crate::correction::Klobuchar`]).
//!
//! References: [BDS-SIS-B1I] 5.2, 5.3; [BDS-SIS-B3I] 5.
//!
//! [BDS-SIS-B1I]: crate#references
//! [BDS-SIS-B3I]: crate#references

use rai_core::satellite::SatelliteId;

use super::Refusal;
use super::parity::is_beidou_word;
use crate::ephemeris::{Broadcast, Health, Source, ura_m};
use crate::input::bits::{Bits, Packed, joined, power_of_two};
use crate::input::calendar::{Calendar, MessageWeek};

/// Bytes of the information in a subframe.
pub(super) const D1_BYTES: usize = 28;

/// Subframes of a D1 ephemeris.
pub(super) const D1_PAGES: usize = 3;

/// Bytes of the information in a page of D2, five words.
pub(super) const D2_BYTES: usize = 15;

/// Pages of a D2 ephemeris.
pub(super) const D2_PAGES: usize = 10;

/// The first eleven bits of every subframe.
const PREAMBLE: u32 = 0b111_0001_0010;

/// Seconds of a step of the reference times.
const REFERENCE_STEP_S: u32 = 8;

/// Seconds of a step of the group delays.
const GROUP_DELAY_STEP_S: f32 = 1e-10;

/// The information in a subframe.
pub(super) fn subframe(words: &[u32; 10]) -> Result<[u8; D1_BYTES], Refusal> {
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

/// The number of a subframe, 1 to 5.
pub(super) fn number(subframe: Bits<'_>) -> u32 {
    subframe.unsigned(15, 3)
}

/// The page of a D2 subframe, 1 to 10.
pub(super) fn page(subframe: Bits<'_>) -> u32 {
    subframe.unsigned(38, 4)
}

/// The second of the week at which a subframe began.
fn second_of_week(subframe: Bits<'_>) -> u32 {
    subframe.unsigned(18, 20)
}

/// Whether each page began that many seconds after the one before; across the end of the week, too.
fn follow_each_other(pages: &[Bits<'_>], step_s: u32) -> bool {
    const WEEK_S: u32 = 604_800;
    pages.iter().zip(pages.iter().skip(1)).all(|(&before, &after)| {
        let expected = second_of_week(before) + step_s;
        second_of_week(after) == if expected >= WEEK_S { expected - WEEK_S } else { expected }
    })
}

/// The coefficients of the ionosphere in subframe 1 of D1.
pub(super) fn d1_ionosphere(subframe: Bits<'_>) -> [f64; 8] {
    subframe.klobuchar(98)
}

/// The same on page 2 of D2.
pub(super) fn d2_ionosphere(page: Bits<'_>) -> [f64; 8] {
    page.klobuchar(42)
}

/// The ephemeris in subframes 1 to 3 of D1.
pub(super) fn d1_ephemeris(
    satellite: SatelliteId,
    pages: [Bits<'_>; D1_PAGES],
    calendar: &Calendar,
) -> Result<Broadcast, Refusal> {
    let [first, second, third] = pages;
    let toe = second.unsigned(222, 2) << 15 | third.unsigned(38, 15);
    let toc = first.unsigned(61, 17);
    if !follow_each_other(&pages, 6) || toe != toc {
        return Err(Refusal::Mixed);
    }
    let week = MessageWeek { constellation: satellite.constellation(), week: first.unsigned(48, 13) as u16 };
    let reference = calendar.resolve(week, f64::from(REFERENCE_STEP_S * toe)).ok_or(Refusal::Value)?;
    Ok(Broadcast {
        satellite,
        source: Source::BeidouD1D2,
        health: Health::of_satellite(!first.is_set(38)),
        accuracy_m: ura_m(first.small(44, 4)),
        toe: reference,
        toc: reference,
        sqrt_a_sqrt_m: second.positive(190, 32, -19),
        eccentricity: second.positive(104, 32, -33),
        m0_sc: second.scaled(72, 32, -31),
        omega0_sc: third.scaled(159, 32, -31),
        i0_sc: third.scaled(53, 32, -31),
        omega_sc: third.scaled(191, 32, -31),
        delta_n_sc_s: second.scaled(38, 16, -43),
        omegadot_sc_s: third.scaled(103, 24, -43),
        idot_sc_s: third.scaled(145, 14, -43),
        cuc_rad: second.scaled_f32(54, 18, -31),
        cus_rad: second.scaled_f32(136, 18, -31),
        crc_m: second.scaled_f32(154, 18, -6),
        crs_m: second.scaled_f32(172, 18, -6),
        cic_rad: third.scaled_f32(85, 18, -31),
        cis_rad: third.scaled_f32(127, 18, -31),
        af0_s: first.scaled(173, 24, -33),
        af1_s_s: first.scaled(197, 22, -50),
        af2_s_s2: first.scaled(162, 11, -66),
        group_delays_s: [group_delay_s(first, 78), group_delay_s(first, 88)],
    })
}

/// The ephemeris in the ten pages of D2.
pub(super) fn d2_ephemeris(
    satellite: SatelliteId,
    pages: [Bits<'_>; D2_PAGES],
    calendar: &Calendar,
) -> Result<Broadcast, Refusal> {
    let [p1, _, p3, p4, p5, p6, p7, p8, p9, p10] = pages;
    let (toe, toc) = (p7.unsigned(68, 17), p1.unsigned(65, 17));
    if !follow_each_other(&pages, 3) || toe != toc {
        return Err(Refusal::Mixed);
    }
    let week = MessageWeek { constellation: satellite.constellation(), week: p1.unsigned(52, 13) as u16 };
    let reference = calendar.resolve(week, f64::from(REFERENCE_STEP_S * toe)).ok_or(Refusal::Value)?;
    let split = |upper: i32, lower: Bits<'_>, width: usize, exponent: i32| {
        f64::from(joined(upper, lower.unsigned(42, width), width)) * power_of_two(exponent)
    };
    let eccentricity = p5.unsigned(96, 10) << 22 | p6.unsigned(42, 22);
    Ok(Broadcast {
        satellite,
        source: Source::BeidouD1D2,
        health: Health::of_satellite(!p1.is_set(42)),
        accuracy_m: ura_m(p1.small(48, 4)),
        toe: reference,
        toc: reference,
        sqrt_a_sqrt_m: p6.positive(64, 32, -19),
        eccentricity: f64::from(eccentricity) * power_of_two(-33),
        m0_sc: p5.scaled(46, 32, -31),
        omega0_sc: p9.scaled(47, 32, -31),
        i0_sc: split(p7.signed(85, 21), p8, 11, -31),
        omega_sc: split(p9.signed(79, 27), p10, 5, -31),
        delta_n_sc_s: p4.scaled(76, 16, -43),
        omegadot_sc_s: split(p8.signed(89, 19), p9, 5, -43),
        idot_sc_s: p10.scaled(47, 14, -43),
        cuc_rad: split(p4.signed(92, 14), p5, 4, -31) as f32,
        cus_rad: p5.scaled_f32(78, 18, -31),
        crc_m: p8.scaled_f32(53, 18, -6),
        crs_m: p8.scaled_f32(71, 18, -6),
        cic_rad: split(p6.signed(96, 10), p7, 8, -31) as f32,
        cis_rad: p7.scaled_f32(50, 18, -31),
        af0_s: p3.scaled(80, 24, -33),
        af1_s_s: split(p3.signed(104, 4), p4, 18, -50),
        af2_s_s2: p4.scaled(60, 11, -66),
        group_delays_s: [group_delay_s(p1, 82), group_delay_s(p1, 92)],
    })
}

fn group_delay_s(page: Bits<'_>, start: usize) -> f32 {
    page.signed(start, 10) as f32 * GROUP_DELAY_STEP_S
}
