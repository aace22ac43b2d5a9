//! What the receiver has decoded: the ephemerides `GPSNav`, `GALNav`, `BDSNav` and `GLONav`, the
//! coefficients of the ionosphere `GPSIon` and `BDSIon`, and the leap seconds `GPSUtc` and `GALUtc`.
//!
//! Many logs have these and no navigation bits. Angles are in semicircles and rates in semicircles
//! per second, as in the messages of the satellites. A set takes part like one of RTCM 3; a set of
//! the same issue that came as bits stays in use, because the module has checked its parities
//! itself ([`crate::ephemeris::Store`]).
//!
//! | block | week | reference times |
//! |---|---|---|
//! | `GPSNav` | modulo 1,024 | GPS time |
//! | `GALNav` | of GPS | GPS time |
//! | `BDSNav` | of `BeiDou` | `BeiDou` time |
//! | `GLONav` | of GPS, modulo 1,024 | GPS time, leap seconds included |
//!
//! The block states the full week of its reception. The week of the reference time is the nearest
//! one, and must be the stated one modulo 1,024: a set of another week is refused. A value that the
//! receiver does not know is −2·10¹⁰ and refuses the set, because no field of a message holds it.
//!
//! Reference: [SBF] 4.2.3 to 4.2.6.
//!
//! [SBF]: crate#references

use raim_core::satellite::{Constellation, SatelliteId};

use super::block::Block;
use super::signals;
#[cfg(feature = "glonass")]
use crate::ephemeris::StateBroadcast;
use crate::ephemeris::{Broadcast, Health, Source, galileo_sisa_m, ura_m};
use crate::input::calendar::Calendar;
use crate::input::navigation::Announcement;
use crate::input::system::System;
use crate::input::{Message, Unread};
use crate::raw::Band;
use crate::time::{BEIDOU_OFFSET_MS, BEIDOU_WEEK_OFFSET, GpsTime, WEEK_MS};

/// Offsets of the elements.
struct Table {
    bytes: usize,
    /// `√A` and `e`.
    ellipse: [usize; 2],
    /// `M0`, `Ω0`, `i0` and `ω`.
    angles: [usize; 4],
    /// `Δn`, `Ω̇` and `i̇`.
    rates: [usize; 3],
    /// `Cuc`, `Cus`, `Cic`, `Cis`, `Crc` and `Crs`.
    corrections: [usize; 6],
    toe: usize,
    toc: usize,
    /// Week of `toe`.
    week: usize,
    /// `af1` and `af2`.
    clock: [usize; 2],
    /// Both group delays.
    group_delays: [usize; 2],
}

/// `GPSNav`, and `BDSNav`, which has another group delay in the place of the first `toc`.
const GPS: Table = Table {
    bytes: 140,
    ellipse: [80, 68],
    angles: [56, 96, 108, 120],
    rates: [52, 128, 132],
    corrections: [64, 76, 92, 104, 116, 48],
    toe: 88,
    toc: 32,
    week: 138,
    clock: [40, 36],
    group_delays: [28, 28],
};

const BEIDOU: Table = Table { group_delays: [24, 28], ..GPS };

const GALILEO: Table = Table {
    bytes: 149,
    ellipse: [16, 32],
    angles: [24, 56, 40, 48],
    rates: [72, 64, 68],
    corrections: [76, 80, 92, 96, 84, 88],
    toe: 100,
    toc: 104,
    week: 124,
    clock: [112, 108],
    group_delays: [136, 140],
};

/// Reads `GPSNav`, `BDSNav` or `GALNav`.
// Not inlined, so that the ephemeris leaves the stack before an epoch is judged.
#[inline(never)]
pub(super) fn elements(number: u16, block: &Block<'_>) -> Result<Broadcast, Unread> {
    let (system, table) = match number {
        5891 => (System::Gps, &const { GPS }),
        4081 => (System::Beidou, &const { BEIDOU }),
        _ => (System::Galileo, &const { GALILEO }),
    };
    block.at_least(table.bytes)?;
    let received = block.time()?;
    let satellite = satellite(block, system)?;
    let single = |at| f64::from(block.f32(at));
    let [sqrt_a_sqrt_m, eccentricity] = table.ellipse.map(|at| block.f64(at));
    let [m0_sc, omega0_sc, i0_sc, omega_sc] = table.angles.map(|at| block.f64(at));
    let [delta_n_sc_s, omegadot_sc_s, idot_sc_s] = table.rates.map(single);
    let [cuc_rad, cus_rad, cic_rad, cis_rad, crc_m, crs_m] = table.corrections.map(|at| block.f32(at));
    let [af1_s_s, af2_s_s2] = table.clock.map(single);
    let group_delays_s = table.group_delays.map(|at| block.f32(at));
    let toe = instant(system, block.u32(table.toe), received)?;
    is_of_week(system, toe, block.u16(table.week))?;
    let Promise { source, health, accuracy_m } = promise(number, block)?;
    Ok(Broadcast {
        satellite,
        source,
        health,
        accuracy_m,
        toe,
        toc: instant(system, block.u32(table.toc), toe)?,
        sqrt_a_sqrt_m,
        eccentricity,
        m0_sc,
        omega0_sc,
        i0_sc,
        omega_sc,
        delta_n_sc_s,
        omegadot_sc_s,
        idot_sc_s,
        cuc_rad,
        cus_rad,
        crc_m,
        crs_m,
        cic_rad,
        cis_rad,
        // Only Galileo's has more bits than a single holds.
        af0_s: if system == System::Galileo { block.f64(116) } else { block.f32(44).into() },
        af1_s_s,
        af2_s_s2,
        group_delays_s: match (source, group_delays_s) {
            (Source::GpsLnav | Source::GalileoFnav, [first, _]) => [first, 0.0],
            (_, both) => both,
        },
    })
}

/// What a set says about itself.
struct Promise {
    source: Source,
    health: Health,
    /// Sigma of the ranges, m.
    accuracy_m: Option<f32>,
}

/// Reads health and accuracy.
fn promise(number: u16, block: &Block<'_>) -> Result<Promise, Unread> {
    /// Sources of a set of Galileo.
    const INAV: u8 = 2;
    const FNAV: u8 = 16;
    let of_satellite = |source, is_well, index| Promise {
        source,
        health: Health::of_satellite(is_well),
        accuracy_m: ura_m(index),
    };
    // Four bits for each signal: known, data validity, and two of its health.
    let flags = block.u16(130);
    let with = |health: Health, band, start: u16| match flags >> start {
        flags if flags & 1 == 1 => health.with_galileo(band, (flags >> 2 & 3).into(), flags >> 1 & 1 == 1),
        _ => health,
    };
    match (number, block.u8(15)) {
        (5891, _) => Ok(of_satellite(Source::GpsLnav, block.u8(20) == 0, block.u8(19))),
        (4081, _) => Ok(of_satellite(Source::BeidouD1D2, block.u8(19) == 0, block.u8(18))),
        (_, INAV) => Ok(Promise {
            source: Source::GalileoInav,
            health: with(with(Health::UNKNOWN, Band::E1, 0), Band::E5b, 4),
            accuracy_m: galileo_sisa_m(block.u8(134)),
        }),
        (_, FNAV) => Ok(Promise {
            source: Source::GalileoFnav,
            health: with(Health::UNKNOWN, Band::E5a, 8),
            accuracy_m: galileo_sisa_m(block.u8(133)),
        }),
        _ => Err(Unread::Ephemeris),
    }
}

/// Reads `GLONav`.
///
/// `−τ_n` is the satellite clock minus the time of the system, as in the strings.
#[cfg(feature = "glonass")]
#[inline(never)]
pub(super) fn state(block: &Block<'_>) -> Result<StateBroadcast, Unread> {
    const KM: f64 = 1e3;
    /// Accuracy that the receiver does not know.
    const UNKNOWN: u16 = u16::MAX;
    block.at_least(97)?;
    let received = block.time()?;
    let satellite = satellite(block, System::Glonass)?;
    let toe = instant(System::Glonass, block.u32(76), received)?;
    is_of_week(System::Glonass, toe, block.u16(80))?;
    // The first of the three bits of B_n, and l_n.
    let is_well = block.u8(85) & 0b100 == 0 && block.u8(90) & 1 == 0;
    let single = |at| f64::from(block.f32(at));
    Ok(StateBroadcast {
        satellite,
        health: Health::of_satellite(is_well),
        accuracy_m: Some(block.u16(94)).filter(|&cm| cm != UNKNOWN).map(|cm| f32::from(cm) * 0.01),
        toe,
        position_m: [16, 24, 32].map(|at| block.f64(at) * KM),
        velocity_m_s: [40, 44, 48].map(|at| single(at) * KM),
        acceleration_m_s2: [52, 56, 60].map(|at| (single(at) * KM) as f32),
        clock_s: -single(68),
        clock_s_s: single(64),
        delay_l2_s: block.f32(72),
    })
}

/// Reads the coefficients of `GPSIon` or `BDSIon`.
///
/// No satellite sends one beyond 2²³, as 8 bits in units of 2¹⁶. A value that the receiver does not
/// know is far beyond.
pub(super) fn ionosphere<'a>(number: u16, block: &Block<'_>) -> Result<Message<'a>, Unread> {
    const MOST: f64 = (1 << 23) as f64;
    block.at_least(48)?;
    block.time()?;
    let system = if number == 4120 { Constellation::Beidou } else { Constellation::Gps };
    let coefficients = [16, 20, 24, 28, 32, 36, 40, 44].map(|at| f64::from(block.f32(at)));
    if !coefficients.iter().all(|coefficient| libm::fabs(*coefficient) <= MOST) {
        return Err(Unread::Malformed);
    }
    Ok(Message::Corrections(Some((system, coefficients)), None))
}

/// Reads the leap seconds of `GPSUtc` or `GALUtc`.
pub(super) fn leap_seconds<'a>(block: &Block<'_>, calendar: &Calendar) -> Result<Message<'a>, Unread> {
    block.at_least(37)?;
    block.time()?;
    let announcement = Announcement {
        now_s: block.u8(33).cast_signed().into(),
        then_s: block.u8(36).cast_signed().into(),
        week: block.u8(34),
        day: block.u8(35),
    };
    Ok(Message::Corrections(None, calendar.present().and_then(|present| announcement.at(present))))
}

/// Returns the satellite of a set of this system.
fn satellite(block: &Block<'_>, system: System) -> Result<SatelliteId, Unread> {
    match signals::numbered(block.u8(14)) {
        Some((its, number)) if its == system => system.satellite(number).ok_or(Unread::Satellite),
        _ => Err(Unread::Satellite),
    }
}

/// Returns the instant at a second of the week of a system, in the week nearest to another instant.
fn instant(system: System, tow_s: u32, near: GpsTime) -> Result<GpsTime, Unread> {
    let ahead_ms = if system == System::Beidou { BEIDOU_OFFSET_MS } else { 0 };
    let tow_ms = tow_s.checked_mul(1000).filter(|tow_ms| *tow_ms < WEEK_MS).ok_or(Unread::Ephemeris)?;
    Ok(GpsTime::nearest((tow_ms + ahead_ms) % WEEK_MS, near))
}

/// Refuses a set whose reference time is of another week than its number states, modulo 1,024.
fn is_of_week(system: System, toe: GpsTime, week: u16) -> Result<(), Unread> {
    let (offset, ahead_ms) =
        if system == System::Beidou { (BEIDOU_WEEK_OFFSET, BEIDOU_OFFSET_MS) } else { (0, 0) };
    // The first seconds of a week of GPS belong to the week before of BeiDou.
    let own = toe.week.wrapping_sub(offset).wrapping_sub((toe.tow_ms < ahead_ms).into());
    if own.wrapping_sub(week) % 1024 == 0 { Ok(()) } else { Err(Unread::Ephemeris) }
}
