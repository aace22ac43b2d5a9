//! The four ephemeris messages as one [`Broadcast`].

use rai_core::satellite::SatelliteId;
use rtcm_rs::Message;

use super::calendar::{Calendar, MessageWeek};
use crate::ephemeris::{Broadcast, Source, galileo_sisa_m, ura_m};

/// Why a message is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unreadable {
    /// It is too short for its type.
    Malformed,
    /// No such satellite, or no such time.
    Satellite,
}

/// The elements all four messages name alike, with the system's own fields given by the caller.
macro_rules! broadcast {
    ($message:ident, $calendar:ident, $source:expr, $number:ident, $week:ident,
     clock: [$af0:ident, $af1:ident, $af2:ident], healthy: $healthy:expr, accuracy_m: $accuracy_m:expr,
     group_delays_s: $group_delays_s:expr) => {{
        let constellation = $source.constellation();
        let week = MessageWeek { constellation, week: $message.$week };
        let instant = |tow_s: f32| $calendar.resolve(week, f64::from(tow_s)).ok_or(Unreadable::Satellite);
        Ok(Broadcast {
            satellite: SatelliteId::new(constellation, $message.$number).ok_or(Unreadable::Satellite)?,
            source: $source,
            healthy: $healthy,
            accuracy_m: $accuracy_m,
            toe: instant($message.toe_s)?,
            toc: instant($message.toc_s)?,
            sqrt_a_sqrt_m: $message.sqrt_a_sqrt_m,
            eccentricity: $message.eccentricity,
            m0_sc: $message.m0_sc,
            omega0_sc: $message.omega0_sc,
            i0_sc: $message.i0_sc,
            omega_sc: $message.omega_sc,
            delta_n_sc_s: f64::from($message.delta_n_sc_s),
            omegadot_sc_s: f64::from($message.omegadot_sc_s),
            idot_sc_s: f64::from($message.idot_sc_s),
            cuc_rad: $message.cuc_rad,
            cus_rad: $message.cus_rad,
            crc_m: $message.crc_m,
            crs_m: $message.crs_m,
            cic_rad: $message.cic_rad,
            cis_rad: $message.cis_rad,
            af0_s: f64::from($message.$af0),
            af1_s_s: f64::from($message.$af1),
            af2_s_s2: f64::from($message.$af2),
            group_delays_s: $group_delays_s,
        })
    }};
}

/// Reads an ephemeris message.
pub(super) fn read(message: &Message, calendar: &Calendar) -> Result<Broadcast, Unreadable> {
    match message {
        Message::Msg1019(m) => broadcast!(m, calendar, Source::GpsLnav, gps_satellite_id, gps_week_number,
            clock: [af0_s, af1_s_s, af2_s_s2],
            healthy: m.sv_health_ind == 0,
            accuracy_m: ura_m(m.ura_index),
            group_delays_s: [m.tgd_s, 0.0]),
        Message::Msg1042(m) => broadcast!(m, calendar, Source::BeidouD1D2, bds_satellite_id, bds_week_number,
            clock: [a0_s, a1_s_s, a2_s_s2],
            healthy: m.sv_health_flag == 0,
            accuracy_m: ura_m(m.ura_index),
            group_delays_s: [m.tgd1_s, m.tgd2_s]),
        Message::Msg1045(m) => {
            broadcast!(m, calendar, Source::GalileoFnav, gal_satellite_id, gal_week_number,
            clock: [af0_s, af1_s_s, af2_s_s2],
            healthy: m.e5a_sig_health_ind == 0 && m.e5a_data_validity_flag == 0,
            accuracy_m: galileo_sisa_m(m.sisa_e1_e5a_index),
            group_delays_s: [m.bgd_e1_e5a_s, 0.0])
        }
        Message::Msg1046(m) => {
            broadcast!(m, calendar, Source::GalileoInav, gal_satellite_id, gal_week_number,
            clock: [af0_s, af1_s_s, af2_s_s2],
            healthy: [m.e5b_sig_health_ind, m.e5b_data_validity_flag, m.e1_b_sig_health_ind,
                m.e1_b_data_validity_flag].iter().all(|flag| *flag == 0),
            accuracy_m: galileo_sisa_m(m.sisa_e1_e5b_index),
            group_delays_s: [m.bgd_e1_e5a_s, m.bgd_e1_e5b_s])
        }
        _ => Err(Unreadable::Malformed),
    }
}
