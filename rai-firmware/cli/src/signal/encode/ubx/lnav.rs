//! GPS LNAV subframes as a u-blox receiver sends them: ten words of 24 data bits and six parity
//! bits.
//!
//! Bits 31 and 30 of a word are the last two of the word before, `D29*` and `D30*`. If `D30*` is 1,
//! the satellite inverts the data, and the receiver complements all 32 bits.
//!
//! References: [IS-GPS-200] figure 20-1, table 20-XIV.

use anyhow::Result;
use rtcm_rs::msg::Msg1019T;

use super::bits::{Row, number};

/// Source bits of each parity, and the bit of the word before that belongs to it, 29 or 30
/// ([IS-GPS-200] table 20-XIV).
const PARITIES: [(usize, &[usize]); 6] = [
    (29, &[1, 2, 3, 5, 6, 10, 11, 12, 13, 14, 17, 18, 20, 23]),
    (30, &[2, 3, 4, 6, 7, 11, 12, 13, 14, 15, 18, 19, 21, 24]),
    (29, &[1, 3, 4, 5, 7, 8, 12, 13, 14, 15, 16, 19, 20, 22]),
    (30, &[2, 4, 5, 6, 8, 9, 13, 14, 15, 16, 17, 20, 21, 23]),
    (30, &[1, 3, 5, 6, 7, 9, 10, 14, 15, 16, 17, 18, 21, 22, 24]),
    (29, &[3, 5, 6, 8, 9, 10, 11, 13, 15, 19, 22, 23, 24]),
];

/// Content of a broadcast of the ionosphere and UTC.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IonosphereAndUtc {
    /// Klobuchar's coefficients, `α0…α3, β0…β3`.
    pub klobuchar: [f64; 8],
    /// GPS time minus UTC, s, before and after the change.
    pub leap_s: (i8, i8),
    /// Week and day (1 to 7) of the change.
    pub change: (u16, u8),
}

/// Returns subframes 1 to 3, of which the first begins `frame` × 30 s into the week.
pub(super) fn ephemeris(m: &Msg1019T, frame: u32) -> Result<Vec<Vec<u32>>> {
    let first = opening(frame, 1)?
        .unsigned(u64::from(m.gps_week_number), 10)?
        .unsigned(u64::from(m.code_on_l2_ind), 2)?
        .unsigned(u64::from(m.ura_index), 4)?
        .unsigned(u64::from(m.sv_health_ind), 6)?
        .unsigned(u64::from(m.iodc >> 8), 2)?
        .unsigned(u64::from(m.l2_p_data_flag), 1)?
        .until(160)?
        .scaled(f64::from(m.tgd_s), 8, -31)?
        .unsigned(u64::from(m.iodc & 255), 8)?
        .positive(f64::from(m.toc_s), 16, 4)?
        .scaled(f64::from(m.af2_s_s2), 8, -55)?
        .scaled(f64::from(m.af1_s_s), 16, -43)?
        .scaled(m.af0_s, 22, -31)?;
    let second = opening(frame, 2)?
        .unsigned(u64::from(m.iode), 8)?
        .scaled(f64::from(m.crs_m), 16, -5)?
        .scaled(f64::from(m.delta_n_sc_s), 16, -43)?
        .scaled(m.m0_sc, 32, -31)?
        .scaled(f64::from(m.cuc_rad), 16, -29)?
        .positive(m.eccentricity, 32, -33)?
        .scaled(f64::from(m.cus_rad), 16, -29)?
        .positive(m.sqrt_a_sqrt_m, 32, -19)?
        .positive(f64::from(m.toe_s), 16, 4)?
        .unsigned(u64::from(m.fit_interval_ind), 1)?;
    let third = opening(frame, 3)?
        .scaled(f64::from(m.cic_rad), 16, -29)?
        .scaled(m.omega0_sc, 32, -31)?
        .scaled(f64::from(m.cis_rad), 16, -29)?
        .scaled(m.i0_sc, 32, -31)?
        .scaled(f64::from(m.crc_m), 16, -5)?
        .scaled(m.omega_sc, 32, -31)?
        .scaled(m.omegadot_sc_s, 24, -43)?
        .unsigned(u64::from(m.iode), 8)?
        .scaled(m.idot_sc_s, 14, -43)?;
    [first, second, third].into_iter().map(words).collect()
}

/// Returns page 18 of subframe 4.
pub(super) fn ionosphere_and_utc(reported: &IonosphereAndUtc, frame: u32) -> Result<Vec<u32>> {
    const EXPONENTS: [i32; 8] = [-30, -27, -24, -24, 11, 14, 16, 16];
    let mut row = opening(frame, 4)?.unsigned(1, 2)?.unsigned(56, 6)?;
    for (coefficient, exponent) in reported.klobuchar.into_iter().zip(EXPONENTS) {
        row = row.scaled(coefficient, 8, exponent)?;
    }
    let (before_s, after_s) = reported.leap_s;
    let (week, day) = reported.change;
    words(
        row.until(192)?
            .signed(f64::from(before_s), 8)?
            .unsigned(u64::from(week % 256), 8)?
            .unsigned(u64::from(day), 8)?
            .signed(f64::from(after_s), 8)?,
    )
}

/// Returns the first two words: preamble; time of the next subframe and number of this one.
fn opening(frame: u32, number: u32) -> Result<Row> {
    let next = (5 * frame + number) % 100_800;
    Row::default()
        .unsigned(0x8B, 8)?
        .until(24)?
        .unsigned(u64::from(next), 17)?
        .until(43)?
        .unsigned(u64::from(number), 3)?
        .until(48)
}

/// Returns the words that a receiver sends. The last two data bits of the second and the last word
/// make their last two parity bits zero ([IS-GPS-200] 20.3.3.2).
pub(super) fn words(row: Row) -> Result<Vec<u32>> {
    let row = row.until(240)?;
    let mut before = (false, false);
    let mut words = Vec::with_capacity(10);
    for (index, source) in row.bits().chunks(24).enumerate() {
        let mut source = source.to_vec();
        if index == 1 || index == 9 {
            for fill in 0..4 {
                (source[22], source[23]) = (fill & 2 == 2, fill & 1 == 1);
                if parities(&source, before)[4..] == [false, false] {
                    break;
                }
            }
        }
        let parities = parities(&source, before);
        words.push(as_sent(&source, &parities, before));
        before = (parities[4], parities[5]);
    }
    Ok(words)
}

/// Returns the word that the receiver sends of the data and the broadcast parity bits.
fn as_sent(source: &[bool], parities: &[bool], (before_29, before_30): (bool, bool)) -> u32 {
    let broadcast = source.iter().map(|bit| bit ^ before_30).chain(parities.iter().copied());
    let word: Vec<bool> = [before_29, before_30].into_iter().chain(broadcast).collect();
    if before_30 { !number(&word) } else { number(&word) }
}

/// Returns the six parity bits as broadcast ([IS-GPS-200] table 20-XIV).
fn parities(source: &[bool], (before_29, before_30): (bool, bool)) -> Vec<bool> {
    let parity = |(star, terms): &(usize, &[usize])| {
        let star = if *star == 29 { before_29 } else { before_30 };
        terms.iter().fold(star, |sum, term| sum ^ source[term - 1])
    };
    PARITIES.iter().map(parity).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_after_one_that_ends_in_1_are_complemented_with_their_parity() {
        // A word of zeros has no parity bits. One whose last data bit alone is 1 has D26, D29 and
        // D30; the next word of zeros then has D25 to D30 of D29* and D30*, all but none, and is
        // complemented.
        let one = Row::default().unsigned(1, 24).unwrap();
        let words = words(one).unwrap();
        let first = 1 << 6 | 0b01_0011;
        assert_eq!(words[0], first);
        // D25 to D30 are D29*, D30*, D29*, D30*, D30*, D29*: ones. Complemented they are zeros, as
        // are bits 31 and 30; the data, sent as ones, are zeros. The last two parity bits must be
        // zero, so the fill bits differ.
        assert_eq!(words[1] & 0xFFFF_FE00, 0);
        assert_eq!(words[1] & 0b11, 0b11, "zeros as broadcast");
    }
}
