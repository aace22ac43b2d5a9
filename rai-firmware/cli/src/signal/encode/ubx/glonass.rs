//! GLONASS strings as a receiver sends them: 85 bits in three words, and a fourth that identifies
//! the frame.
//!
//! Numbers are a sign bit and a magnitude.
//!
//! References: [GLO-ICD] 4.4, tables 4.5 and 4.6; 4.7 for the check bits.

use anyhow::{Result, ensure};
use rtcm_rs::msg::Msg1020T;

use super::bits::Row;

/// Bits of a string before its check bits, the idle bit first.
const DATA: usize = 77;

/// Positions that each check bit sums, its own among them: bit 85 of the interface document (the
/// idle bit) first. The last is the parity of the whole string.
const SUMS: [[u8; 11]; 8] = [
    [0x55, 0x55, 0x5A, 0xAA, 0xAA, 0xAA, 0xB5, 0x55, 0x6A, 0xD8, 0x08],
    [0x66, 0x66, 0x6C, 0xCC, 0xCC, 0xCC, 0xD9, 0x99, 0xB3, 0x68, 0x10],
    [0x87, 0x87, 0x8F, 0x0F, 0x0F, 0x0F, 0x1E, 0x1E, 0x3C, 0x70, 0x20],
    [0x07, 0xF8, 0x0F, 0xF0, 0x0F, 0xF0, 0x1F, 0xE0, 0x3F, 0x80, 0x40],
    [0xF8, 0x00, 0x0F, 0xFF, 0xF0, 0x00, 0x1F, 0xFF, 0xC0, 0x00, 0x80],
    [0x00, 0x00, 0x0F, 0xFF, 0xFF, 0xFF, 0xE0, 0x00, 0x00, 0x01, 0x00],
    [0xFF, 0xFF, 0xF0, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x02, 0x00],
    [0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xF8],
];

/// Returns strings 1 to 4.
pub(super) fn ephemeris(m: &Msg1020T) -> Result<Vec<Vec<u32>>> {
    let first = opening(1)?.until(9)?.unsigned(of_day(m), 12)?;
    let first = axis(first, m.xn_first_deriv_km_s, m.xn_second_deriv_km_s2, m.xn_km)?;
    let second = opening(2)?
        .unsigned(u64::from(m.glo_eph_health_flag), 1)?
        .until(9)?
        .unsigned(u64::from(m.tb_min / 15), 7)?
        .until(21)?;
    let second = axis(second, m.yn_first_deriv_km_s, m.yn_second_deriv_km_s2, m.yn_km)?;
    let third = magnitude(opening(3)?.until(6)?, f64::from(m.gamma_n), 11, -40)?
        .until(20)?
        .unsigned(u64::from(m.glo_m_3str_ln_flag), 1)?;
    let third = axis(third, m.zn_first_deriv_km_s, m.zn_second_deriv_km_s2, m.zn_km)?;
    let fourth = magnitude(opening(4)?, m.tau_n_s, 22, -30)?;
    let fourth = magnitude(fourth, f64::from(m.glo_m_delta_tau_n_s), 5, -30)?
        .unsigned(u64::from(m.en_d), 5)?
        .until(52)?
        .unsigned(u64::from(m.glo_m_ft_ind), 4)?
        .until(59)?
        .unsigned(u64::from(m.glo_m_nt_d), 11)?
        .unsigned(u64::from(m.glo_satellite_id), 5)?;
    [first, second, third, fourth].into_iter().map(words).collect()
}

/// Returns `t_k`: hours, minutes and half minutes.
fn of_day(m: &Msg1020T) -> u64 {
    u64::from(m.tk_h) << 7 | u64::from(m.tk_min) << 1 | u64::from(m.tk_s / 30)
}

/// Returns the idle bit and the number of a string.
fn opening(number: u64) -> Result<Row> {
    Row::default().unsigned(number, 5)
}

/// Appends velocity, acceleration and position of one axis, km and s: the last fields of a string.
fn axis(row: Row, velocity: f64, acceleration: f32, position: f64) -> Result<Row> {
    let row = magnitude(row, velocity, 24, -20)?;
    magnitude(magnitude(row, f64::from(acceleration), 5, -30)?, position, 27, -11)
}

/// Appends a sign and a magnitude, `value` in units of `2^exponent`.
fn magnitude(row: Row, value: f64, width: usize, exponent: i32) -> Result<Row> {
    let steps = (value / 2f64.powi(exponent)).round();
    let most = (1_u64 << (width - 1)) - 1;
    ensure!(steps.abs() <= most as f64, "{steps} does not fit a sign and {} bits", width - 1);
    row.unsigned(u64::from(steps < 0.0), 1)?.unsigned(steps.abs() as u64, width - 1)
}

/// Returns the words of a string with its check bits; a frame number of 0 is unknown.
pub(super) fn words(string: Row) -> Result<Vec<u32>> {
    let mut bits = string.until(DATA)?.bits().to_vec();
    bits.resize(DATA + SUMS.len(), false);
    for (index, sum) in SUMS.iter().enumerate() {
        let is_summed = |position: &usize| sum[position / 8] >> (7 - position % 8) & 1 == 1;
        let is_odd = (0..bits.len()).filter(is_summed).filter(|position| bits[*position]).count() % 2 == 1;
        let own = bits.len() - 1 - index;
        bits[own] = is_odd;
    }
    Ok(Row::default().then(&bits).until(128)?.words())
}
