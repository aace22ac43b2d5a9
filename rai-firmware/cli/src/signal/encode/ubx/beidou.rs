//! `BeiDou` subframes as a receiver sends them: ten words of 30 bits with their parities.
//!
//! References: [BDS-SIS-B1I] 5.1.3, figures 5-3 to 5-6 (D1) and 5-11 (D2).

use anyhow::Result;
use rtcm_rs::msg::Msg1042T;

use super::bits::{Row, bch, number};

/// Returns subframes 1 to 3 of D1; the first begins at that second of the week.
pub(super) fn d1(m: &Msg1042T, second_of_week: u32) -> Result<Vec<Vec<u32>>> {
    let toe = m.toe_s as u64 / 8;
    let first = health_and_clock(opening(1, second_of_week)?, m)?
        // Klobuchar's coefficients are left out.
        .until(162)?
        .scaled(f64::from(m.a2_s_s2), 11, -66)?
        .scaled(m.a0_s, 24, -33)?
        .scaled(m.a1_s_s, 22, -50)?
        .unsigned(u64::from(m.aode), 5)?;
    let second = opening(2, second_of_week + 6)?
        .scaled(f64::from(m.delta_n_sc_s), 16, -43)?
        .scaled(f64::from(m.cuc_rad), 18, -31)?
        .scaled(m.m0_sc, 32, -31)?
        .positive(m.eccentricity, 32, -33)?
        .scaled(f64::from(m.cus_rad), 18, -31)?
        .scaled(f64::from(m.crc_m), 18, -6)?
        .scaled(f64::from(m.crs_m), 18, -6)?
        .positive(m.sqrt_a_sqrt_m, 32, -19)?
        .unsigned(toe >> 15, 2)?;
    let third = opening(3, second_of_week + 12)?
        .unsigned(toe & 0x7FFF, 15)?
        .scaled(m.i0_sc, 32, -31)?
        .scaled(f64::from(m.cic_rad), 18, -31)?
        .scaled(m.omegadot_sc_s, 24, -43)?
        .scaled(f64::from(m.cis_rad), 18, -31)?
        .scaled(m.idot_sc_s, 14, -43)?
        .scaled(m.omega0_sc, 32, -31)?
        .scaled(m.omega_sc, 32, -31)?;
    [first, second, third].into_iter().map(words).collect()
}

/// Returns pages 1 to 10 of subframe 1 of D2; the first begins at that second of the week.
pub(super) fn d2(m: &Msg1042T, second_of_week: u32) -> Result<Vec<Vec<u32>>> {
    let page = |index: u32| opening(1, second_of_week + 3 * (index - 1))?.unsigned(u64::from(index), 4);
    let whole = |value: f64, width: usize, exponent: i32| Row::default().scaled(value, width, exponent);
    let (a1, cuc) = (whole(m.a1_s_s, 22, -50)?, whole(f64::from(m.cuc_rad), 18, -31)?);
    let (cic, i0) = (whole(f64::from(m.cic_rad), 18, -31)?, whole(m.i0_sc, 32, -31)?);
    let (omegadot, omega) = (whole(m.omegadot_sc_s, 24, -43)?, whole(m.omega_sc, 32, -31)?);
    let eccentricity = Row::default().positive(m.eccentricity, 32, -33)?;
    let pages = [
        health_and_clock(page(1)?, m)?,
        page(2)?,
        page(3)?.until(80)?.scaled(m.a0_s, 24, -33)?.then(&a1.bits()[..4]),
        page(4)?
            .then(&a1.bits()[4..])
            .scaled(f64::from(m.a2_s_s2), 11, -66)?
            .unsigned(u64::from(m.aode), 5)?
            .scaled(f64::from(m.delta_n_sc_s), 16, -43)?
            .then(&cuc.bits()[..14]),
        page(5)?
            .then(&cuc.bits()[14..])
            .scaled(m.m0_sc, 32, -31)?
            .scaled(f64::from(m.cus_rad), 18, -31)?
            .then(&eccentricity.bits()[..10]),
        page(6)?.then(&eccentricity.bits()[10..]).positive(m.sqrt_a_sqrt_m, 32, -19)?.then(&cic.bits()[..10]),
        page(7)?
            .then(&cic.bits()[10..])
            .scaled(f64::from(m.cis_rad), 18, -31)?
            .unsigned(m.toe_s as u64 / 8, 17)?
            .then(&i0.bits()[..21]),
        page(8)?
            .then(&i0.bits()[21..])
            .scaled(f64::from(m.crc_m), 18, -6)?
            .scaled(f64::from(m.crs_m), 18, -6)?
            .then(&omegadot.bits()[..19]),
        page(9)?.then(&omegadot.bits()[19..]).scaled(m.omega0_sc, 32, -31)?.then(&omega.bits()[..27]),
        page(10)?.then(&omega.bits()[27..]).scaled(m.idot_sc_s, 14, -43)?,
    ];
    pages.into_iter().map(words).collect()
}

/// Returns preamble, four reserved bits, number and time of a subframe.
fn opening(number: u64, second_of_week: u32) -> Result<Row> {
    Row::default()
        .unsigned(0b111_0001_0010, 11)?
        .until(15)?
        .unsigned(number, 3)?
        .unsigned(u64::from(second_of_week % 604_800), 20)
}

/// Appends the fields that D1 and D2 have in the same order.
fn health_and_clock(row: Row, m: &Msg1042T) -> Result<Row> {
    let delay = |seconds: f32| f64::from((seconds * 1e10).round());
    let is_d2 = row.bits().len() == 42;
    let row = row.unsigned(u64::from(m.sv_health_flag), 1)?.unsigned(u64::from(m.aodc), 5)?;
    assert_eq!(row.bits().len(), if is_d2 { 48 } else { 44 });
    row.unsigned(u64::from(m.ura_index), 4)?
        .unsigned(u64::from(m.bds_week_number), 13)?
        .unsigned(m.toc_s as u64 / 8, 17)?
        .signed(delay(m.tgd1_s), 10)?
        .signed(delay(m.tgd2_s), 10)
}

/// Returns ten words: 15 bits unchanged and eleven with four parities, then in each word twice
/// eleven with their parities.
pub(super) fn words(row: Row) -> Result<Vec<u32>> {
    let row = row.until(26 + 9 * 22)?;
    let (first, others) = row.bits().split_at(26);
    let protected = |elevens: &[&[bool]]| -> Vec<bool> {
        let parities = elevens.iter().flat_map(|eleven| bch(eleven));
        elevens.concat().into_iter().chain(parities).collect()
    };
    let first = [first[..15].to_vec(), protected(&[&first[15..]])].concat();
    let others = others.chunks(22).map(|word| number(&protected(&[&word[..11], &word[11..]])));
    Ok(std::iter::once(number(&first)).chain(others).collect())
}
