//! Galileo pages as a receiver sends them: I/NAV as even and odd part, F/NAV as one.
//!
//! References: [OS-SIS-ICD] 4.2.2, 4.3.2, 4.2.4 to 4.3.5.

use anyhow::Result;
use rtcm_rs::msg::{Msg1045T, Msg1046T};

use super::bits::{Row, crc24q};
use super::lnav::IonosphereAndUtc;

/// Time at which a page is sent, in the system's own count.
#[derive(Clone, Copy, Debug)]
pub(super) struct SystemTime {
    pub(super) week: u16,
    pub(super) tow_s: u32,
}

impl SystemTime {
    fn append(self, row: Row) -> Result<Row> {
        row.unsigned(u64::from(self.week % 4096), 12)?.unsigned(u64::from(self.tow_s), 20)
    }
}

fn word(kind: u64) -> Result<Row> {
    Row::default().unsigned(kind, 6)
}

/// Returns words 2, 4, 1, 3, 5, in the order in which a satellite sends them.
pub(super) fn inav(m: &Msg1046T, sent: SystemTime) -> Result<Vec<Vec<u32>>> {
    let [first, second, third, fourth, fifth] = words(m)?;
    [second, fourth, first, third, sent.append(fifth)?].into_iter().map(inav_page).collect()
}

/// Returns words 1 to 5 as bytes, without a time in the last.
#[cfg(feature = "sign")]
pub(super) fn inav_words(m: &Msg1046T) -> Result<[[u8; 16]; 5]> {
    let mut bytes = [[0; 16]; 5];
    for (place, word) in bytes.iter_mut().zip(words(m)?) {
        let word = word.until(128)?.words().into_iter().flat_map(u32::to_be_bytes);
        place.iter_mut().zip(word).for_each(|(place, byte)| *place = byte);
    }
    Ok(bytes)
}

/// Returns words 1 to 5, the last one up to its time.
fn words(m: &Msg1046T) -> Result<[Row; 5]> {
    let issue = u64::from(m.iodnav);
    let first = word(1)?
        .unsigned(issue, 10)?
        .unsigned(u64::from(m.toe_s as u32 / 60), 14)?
        .scaled(m.m0_sc, 32, -31)?
        .positive(m.eccentricity, 32, -33)?
        .positive(m.sqrt_a_sqrt_m, 32, -19)?;
    let second = word(2)?
        .unsigned(issue, 10)?
        .scaled(m.omega0_sc, 32, -31)?
        .scaled(m.i0_sc, 32, -31)?
        .scaled(m.omega_sc, 32, -31)?
        .scaled(f64::from(m.idot_sc_s), 14, -43)?;
    let third = word(3)?
        .unsigned(issue, 10)?
        .scaled(m.omegadot_sc_s, 24, -43)?
        .scaled(f64::from(m.delta_n_sc_s), 16, -43)?
        .scaled(f64::from(m.cuc_rad), 16, -29)?
        .scaled(f64::from(m.cus_rad), 16, -29)?
        .scaled(f64::from(m.crc_m), 16, -5)?
        .scaled(f64::from(m.crs_m), 16, -5)?
        .unsigned(u64::from(m.sisa_e1_e5b_index), 8)?;
    let fourth = word(4)?
        .unsigned(issue, 10)?
        .unsigned(u64::from(m.gal_satellite_id), 6)?
        .scaled(f64::from(m.cic_rad), 16, -29)?
        .scaled(f64::from(m.cis_rad), 16, -29)?
        .unsigned(u64::from(m.toc_s as u32 / 60), 14)?
        .scaled(m.af0_s, 31, -34)?
        .scaled(m.af1_s_s, 21, -46)?
        .scaled(f64::from(m.af2_s_s2), 6, -59)?;
    let fifth = word(5)?
        .until(47)?
        .scaled(f64::from(m.bgd_e1_e5a_s), 10, -32)?
        .scaled(f64::from(m.bgd_e1_e5b_s), 10, -32)?
        .unsigned(u64::from(m.e5b_sig_health_ind), 2)?
        .unsigned(u64::from(m.e1_b_sig_health_ind), 2)?
        .unsigned(u64::from(m.e5b_data_validity_flag), 1)?
        .unsigned(u64::from(m.e1_b_data_validity_flag), 1)?;
    Ok([first, second, third, fourth, fifth])
}

/// Returns word 6 with the leap seconds.
pub(super) fn utc(reported: &IonosphereAndUtc) -> Result<Vec<u32>> {
    let (before_s, after_s) = reported.leap_s;
    let (week, day) = reported.change;
    let row = word(6)?
        .until(62)?
        .signed(f64::from(before_s), 8)?
        .until(86)?
        .unsigned(u64::from(week % 256), 8)?
        .unsigned(u64::from(day), 3)?
        .signed(f64::from(after_s), 8)?;
    inav_page(row)
}

pub(super) fn inav_page(word: Row) -> Result<Vec<u32>> {
    signed_page(word, [0; 5])
}

/// Returns a page with its forty bits for authentication.
pub(super) fn signed_page(word: Row, authentication: [u8; 5]) -> Result<Vec<u32>> {
    let word = word.until(128)?;
    let (front, back) = word.bits().split_at(112);
    let even = Row::default().unsigned(0b00, 2)?.then(front);
    let odd = Row::default().unsigned(0b10, 2)?.then(back);
    let odd =
        authentication.iter().try_fold(odd, |odd, byte| odd.unsigned(u64::from(*byte), 8))?.until(82)?;
    let covered = even.clone().then(odd.bits());
    let odd = odd.then(&crc24q(covered.bits()));
    Ok(even.until(128)?.then(odd.until(128)?.bits()).words())
}

/// Returns pages 1 to 4.
pub(super) fn fnav(m: &Msg1045T, sent: SystemTime) -> Result<Vec<Vec<u32>>> {
    let issue = u64::from(m.iodnav);
    let first = word(1)?
        .unsigned(u64::from(m.gal_satellite_id), 6)?
        .unsigned(issue, 10)?
        .unsigned(u64::from(m.toc_s as u32 / 60), 14)?
        .scaled(m.af0_s, 31, -34)?
        .scaled(m.af1_s_s, 21, -46)?
        .scaled(f64::from(m.af2_s_s2), 6, -59)?
        .unsigned(u64::from(m.sisa_e1_e5a_index), 8)?
        .until(143)?
        .scaled(f64::from(m.bgd_e1_e5a_s), 10, -32)?
        .unsigned(u64::from(m.e5a_sig_health_ind), 2)?;
    let first = sent.append(first)?.unsigned(u64::from(m.e5a_data_validity_flag), 1)?;
    let second = word(2)?
        .unsigned(issue, 10)?
        .scaled(m.m0_sc, 32, -31)?
        .scaled(m.omegadot_sc_s, 24, -43)?
        .positive(m.eccentricity, 32, -33)?
        .positive(m.sqrt_a_sqrt_m, 32, -19)?
        .scaled(m.omega0_sc, 32, -31)?
        .scaled(f64::from(m.idot_sc_s), 14, -43)?;
    let third = word(3)?
        .unsigned(issue, 10)?
        .scaled(m.i0_sc, 32, -31)?
        .scaled(m.omega_sc, 32, -31)?
        .scaled(f64::from(m.delta_n_sc_s), 16, -43)?
        .scaled(f64::from(m.cuc_rad), 16, -29)?
        .scaled(f64::from(m.cus_rad), 16, -29)?
        .scaled(f64::from(m.crc_m), 16, -5)?
        .scaled(f64::from(m.crs_m), 16, -5)?
        .unsigned(u64::from(m.toe_s as u32 / 60), 14)?;
    let fourth = word(4)?.unsigned(issue, 10)?.scaled(f64::from(m.cic_rad), 16, -29)?.scaled(
        f64::from(m.cis_rad),
        16,
        -29,
    )?;
    let pages = [first, sent.append(second)?, sent.append(third)?, sent.append(fourth)?];
    pages.into_iter().map(fnav_page).collect()
}

pub(super) fn fnav_page(page: Row) -> Result<Vec<u32>> {
    let page = page.until(214)?;
    let crc = crc24q(page.bits());
    Ok(page.then(&crc).until(256)?.words())
}
