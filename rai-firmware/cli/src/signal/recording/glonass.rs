//! GLONASS records: a state vector in three rows, and from RINEX 3.05 on a fourth that may have the
//! accuracy.
//!
//! | row | |
//! |---|---|
//! | 0 | `−τ_n`, `γ_n`, time of the message |
//! | 1 | x (km), its rate, its acceleration, health |
//! | 2 | y, its rate, its acceleration, frequency slot |
//! | 3 | z, its rate, its acceleration, age |
//! | 4 | status, L2 later than L1, `F_T`, health of the strings |
//!
//! RINEX 2 has the first four rows in a file of their own. Dates are UTC. References: [RINEX-2.11]
//! table A11, [RINEX-3.05] table A10.
//!
//! [RINEX-2.11]: crate#references
//! [RINEX-3.05]: crate#references

use anyhow::{Result, ensure};
use raim_core::satellite::SatelliteId;
use raim_firmware::time::{GLONASS_OFFSET_MS, GpsTime};
use rtcm_rs::msg::Msg1020T;

use crate::signal::measurement::{Ephemeris, TimedEphemeris};

/// Assumed `F_T` of a file without it: 4 m, about the error of such orbits. Most such files have
/// 15, which on the air means no promise.
const ASSUMED_FT: u8 = 3;

/// Time before its reference time at which a set is first sent, ms: a quarter of an hour.
const LEAD_MS: u64 = 15 * 60_000;

/// Returns the first of the four years in which GLONASS counts days.
fn first_year(time: GpsTime) -> u16 {
    /// Days from 1980-01-06 to 1996-01-01, and days of four years.
    const TO_1996: u64 = 5839;
    const FOUR_YEARS: u64 = 1461;
    let day = time.to_ms() / 86_400_000;
    1996 + 4 * (day.saturating_sub(TO_1996) / FOUR_YEARS) as u16
}

/// Checks that the numbers fit the fields of the message ([GLONASS-ICD] table 4.5), because a
/// larger one was not broadcast.
///
/// [GLONASS-ICD]: crate#references
pub(super) fn check(values: &[f64]) -> Result<()> {
    let clock = values.iter().take(2).zip([2e-3, 1e-9]);
    let state = values.iter().skip(3).take(12).enumerate();
    let state = state.filter(|(index, _)| index % 4 < 3).map(|(index, value)| {
        // Limits of position in km, velocity in km/s, acceleration in km/s².
        (value, [32_768.0, 8.0, 1.5e-8][index % 4])
    });
    ensure!(clock.chain(state).all(|(value, limit)| value.abs() <= limit), "a number beyond its field");
    let slot = values.get(10).copied().unwrap_or(0.0);
    ensure!((-7.0..=13.0).contains(&slot), "frequency slot {slot} is not within -7 to 13");
    Ok(())
}

/// Returns a record's numbers, three in the first row and four in each other, as a message. `toe`
/// is GPS time.
pub(super) fn ephemeris(satellite: SatelliteId, toe: GpsTime, leap_s: u8, values: &[f64]) -> TimedEphemeris {
    let at = |row: usize, column: usize| values.get(4 * row - 1 + column).copied().unwrap_or(0.0);
    let known = |value: f64| if value.abs() < 0.999e9 { value } else { 0.0 };
    let utc_ms = toe.to_ms().saturating_sub(u64::from(leap_s) * 1000);
    let of_day_min = (utc_ms + GLONASS_OFFSET_MS) / 60_000 % 1440;
    let ft = at(4, 2) as u8;
    let message = Msg1020T {
        glo_satellite_id: satellite.number(),
        glo_satellite_freq_chan_number: at(2, 3) as i8,
        glo_eph_health_flag: u8::from(at(1, 3) != 0.0),
        tb_min: of_day_min as u16,
        tau_n_s: -values[0],
        gamma_n: values[1] as f32,
        xn_km: at(1, 0),
        xn_first_deriv_km_s: at(1, 1),
        xn_second_deriv_km_s2: at(1, 2) as f32,
        yn_km: at(2, 0),
        yn_first_deriv_km_s: at(2, 1),
        yn_second_deriv_km_s2: at(2, 2) as f32,
        zn_km: at(3, 0),
        zn_first_deriv_km_s: at(3, 1),
        zn_second_deriv_km_s2: at(3, 2) as f32,
        en_d: known(at(3, 3)) as u8 & 31,
        glo_m_delta_tau_n_s: known(at(4, 1)) as f32,
        glo_m_ft_ind: if (1..15).contains(&ft) { ft } else { ASSUMED_FT },
        glo_m_n4_year: first_year(toe),
        ..Msg1020T::default()
    };
    let sent = GpsTime::from_ms(toe.to_ms().saturating_sub(LEAD_MS));
    TimedEphemeris { satellite, toe, sent, message: Ephemeris::Glonass(message) }
}
