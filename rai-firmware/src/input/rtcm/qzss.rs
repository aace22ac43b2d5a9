//! 1044: the ephemeris of a QZSS satellite.
//!
//! | offset | width | field |
//! |---|---|---|
//! | 12 | 4 | satellite |
//! | 16, 32, 40, 56 | 16, 8, 16, 22 | toc, af2, af1, af0 |
//! | 78, 86, 102, 118 | 8, 16, 16, 32 | IODE, Crs, Δn, M0 |
//! | 150, 166, 198, 214, 246 | 16, 32, 16, 32, 16 | Cuc, e, Cus, √A, toe |
//! | 262, 278, 310, 326, 358, 374, 406, 430 | 16, 32, 16, 32, 16, 32, 24, 14 | Cic, Ω0, Cis, i0, Crc, ω, Ω̇, i̇ |
//! | 446, 456, 460, 466 | 10, 4, 6, 8 | week, URA, health, TGD |
//!
//! The bits are those that the satellite sends in LNAV, in another order. Reference: [RTCM-10403.3] 3.5.12.3, table
//! 3.5-22.
//!
//! [RTCM-10403.3]: crate#references

use rai_core::satellite::{Constellation, SatelliteId};

use crate::ephemeris::{Broadcast, Health, Source, ura_m};
use crate::input::Unread;
use crate::input::bits::Bits;
use crate::input::calendar::{Calendar, MessageWeek};

/// Bytes of the message.
const LENGTH: usize = 61;

/// Reads the message.
#[inline(never)]
pub(super) fn read(payload: &[u8], calendar: &Calendar) -> Result<Broadcast, Unread> {
    let bits = Bits(payload.get(..LENGTH).ok_or(Unread::Malformed)?);
    let week = MessageWeek { constellation: Constellation::Gps, week: bits.unsigned(446, 10) as u16 };
    let instant =
        |start| calendar.resolve(week, f64::from(16 * bits.unsigned(start, 16))).ok_or(Unread::Ephemeris);
    Ok(Broadcast {
        satellite: SatelliteId::qzss(bits.small(12, 4)).ok_or(Unread::Satellite)?,
        source: Source::QzssLnav,
        health: Health::of_qzss(bits.small(460, 6)),
        accuracy_m: ura_m(bits.small(456, 4)),
        toe: instant(246)?,
        toc: instant(16)?,
        sqrt_a_sqrt_m: bits.positive(214, 32, -19),
        eccentricity: bits.positive(166, 32, -33),
        m0_sc: bits.scaled(118, 32, -31),
        omega0_sc: bits.scaled(278, 32, -31),
        i0_sc: bits.scaled(326, 32, -31),
        omega_sc: bits.scaled(374, 32, -31),
        delta_n_sc_s: bits.scaled(102, 16, -43),
        omegadot_sc_s: bits.scaled(406, 24, -43),
        idot_sc_s: bits.scaled(430, 14, -43),
        cuc_rad: bits.scaled_f32(150, 16, -29),
        cus_rad: bits.scaled_f32(198, 16, -29),
        crc_m: bits.scaled_f32(358, 16, -5),
        crs_m: bits.scaled_f32(86, 16, -5),
        cic_rad: bits.scaled_f32(262, 16, -29),
        cis_rad: bits.scaled_f32(310, 16, -29),
        af0_s: bits.scaled(56, 22, -31),
        af1_s_s: bits.scaled(40, 16, -43),
        af2_s_s2: bits.scaled(32, 8, -55),
        group_delays_s: [bits.scaled_f32(466, 8, -31), 0.0],
    })
}
