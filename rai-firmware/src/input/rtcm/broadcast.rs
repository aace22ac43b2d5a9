//! The four ephemeris messages as one [`Broadcast`].

use rai_core::satellite::SatelliteId;
use rtcm_rs::Message;

use crate::ephemeris::{Broadcast, Health, Source, galileo_sisa_m, ura_m};
use crate::input::Unread;
use crate::input::calendar::{Calendar, MessageWeek};
use crate::raw::Band;

/// The elements all four messages name alike, with the system's own fields given by the caller.
macro_rules! broadcast {
    ($message:ident, $calendar:ident, $source:expr, $number:ident, $week:ident,
     clock: [$af0:ident, $af1:ident, $af2:ident], health: $health:expr, accuracy_m: $accuracy_m:expr,
     group_delays_s: $group_delays_s:expr) => {{
        let constellation = $source.constellation();
        let week = MessageWeek { constellation, week: $message.$week };
        let instant = |tow_s: f32| $calendar.resolve(week, f64::from(tow_s)).ok_or(Unread::Ephemeris);
        Ok(Broadcast {
            satellite: SatelliteId::new(constellation, $message.$number).ok_or(Unread::Ephemeris)?,
            source: $source,
            health: $health,
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
#[inline(never)]
pub(super) fn read(message: &Message, calendar: &Calendar) -> Result<Broadcast, Unread> {
    match message {
        Message::Msg1019(m) => broadcast!(m, calendar, Source::GpsLnav, gps_satellite_id, gps_week_number,
            clock: [af0_s, af1_s_s, af2_s_s2],
            health: Health::of_satellite(m.sv_health_ind == 0),
            accuracy_m: ura_m(m.ura_index),
            group_delays_s: [m.tgd_s, 0.0]),
        Message::Msg1042(m) => broadcast!(m, calendar, Source::BeidouD1D2, bds_satellite_id, bds_week_number,
            clock: [a0_s, a1_s_s, a2_s_s2],
            health: Health::of_satellite(m.sv_health_flag == 0),
            accuracy_m: ura_m(m.ura_index),
            group_delays_s: [m.tgd1_s, m.tgd2_s]),
        Message::Msg1045(m) => {
            broadcast!(m, calendar, Source::GalileoFnav, gal_satellite_id, gal_week_number,
            clock: [af0_s, af1_s_s, af2_s_s2],
            health: Health::UNKNOWN.with(Band::E5a, m.e5a_sig_health_ind == 0 && m.e5a_data_validity_flag == 0),
            accuracy_m: galileo_sisa_m(m.sisa_e1_e5a_index),
            group_delays_s: [m.bgd_e1_e5a_s, 0.0])
        }
        Message::Msg1046(m) => {
            broadcast!(m, calendar, Source::GalileoInav, gal_satellite_id, gal_week_number,
            clock: [af0_s, af1_s_s, af2_s_s2],
            health: Health::UNKNOWN
                .with(Band::E5b, m.e5b_sig_health_ind == 0 && m.e5b_data_validity_flag == 0)
                .with(Band::E1, m.e1_b_sig_health_ind == 0 && m.e1_b_data_validity_flag == 0),
            accuracy_m: galileo_sisa_m(m.sisa_e1_e5b_index),
            group_delays_s: [m.bgd_e1_e5a_s, m.bgd_e1_e5b_s])
        }
        _ => Err(Unread::Malformed),
    }
}
